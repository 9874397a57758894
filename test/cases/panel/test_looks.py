"""How the panel looks and is reached: sizes, light and dark, colours, the keyboard, motion, the tour."""

import re

import pytest
from conftest import ROOT, Window

SIZES = [(1280, 800, 'light'), (1280, 800, 'dark'), (800, 900, 'light'), (800, 900, 'dark')]


@pytest.mark.parametrize('width, height, scheme', SIZES)
def test_nothing_sticks_out(width, height, scheme, browser, front):
    window = Window(browser, front.address, viewport={'width': width, 'height': height}, color_scheme=scheme)
    for tab in ('pictures', 'tables', 'answer', 'compare', 'text'):
        window.tab(tab).page.wait_for_timeout(300)
        inner = window.page.evaluate('() => [document.documentElement.scrollWidth, innerWidth, document.querySelector("#results").scrollWidth - document.querySelector("#results").clientWidth]')
        assert inner[0] <= inner[1] and inner[2] <= 0, tab
        window.shoot(f'{tab}_{width}_{scheme}')
    window.close()


def luminance(color):
    red, green, blue = (int(part) / 255 for part in re.findall(r'\d+', color)[:3])
    linear = [part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4 for part in (red, green, blue)]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def contrast(a, b):
    high, low = sorted((luminance(a), luminance(b)), reverse=True)
    return (high + 0.05) / (low + 0.05)


@pytest.mark.parametrize('scheme', ['light', 'dark'])
def test_letters_stand_out_from_their_ground_as_wcag_asks(scheme, browser, front):
    """4.5 to 1 for letters, 3 to 1 for curves, by the relative luminance of WCAG 2."""
    window = Window(browser, front.address, color_scheme=scheme)
    colors = window.page.evaluate("""() => Object.fromEntries(['ground', 'back', 'sheet', 'ink', 'muted', 'bad', 'note', 'accent', 'force', 'strong', 'onstrong'].map((name) => {
        const node = document.createElement('i'); node.style.color = `var(--${name})`; document.body.append(node);
        const found = getComputedStyle(node).color; node.remove(); return [name, found]; }))""")
    for ink in ('ink', 'muted', 'bad', 'note', 'accent'):
        for ground in ('ground', 'back', 'sheet'):
            assert contrast(colors[ink], colors[ground]) >= 4.5, (ink, ground)
    assert contrast(colors['strong'], colors['onstrong']) >= 4.5
    curves = window.page.evaluate("() => [...document.querySelectorAll('.chart .curve')].map((one) => getComputedStyle(one).stroke)")
    assert len(curves) == 5
    light = [luminance(one) for one in curves]
    assert light == sorted(light) or light == sorted(light, reverse=True)  # in order of their lightness: so told apart in grey
    assert min(contrast(one, colors['ground']) for one in curves) >= 2
    dashes = window.page.evaluate("() => [...document.querySelectorAll('.chart .curve')].map((one) => one.getAttribute('stroke-dasharray'))")
    assert len(set(dashes)) == 5  # and without any colour
    window.close()


def test_all_is_reached_by_the_keyboard(browser, front):
    window = Window(browser, front.address)
    page = window.page
    page.keyboard.press('Tab')
    assert page.evaluate('() => document.activeElement.className') == 'skip'
    reached = set()
    for _ in range(400):
        page.keyboard.press('Tab')
        reached.add(page.evaluate('() => document.activeElement.id || document.activeElement.tagName'))
    for name in ('cases', 'new', 'open', 'save', 'tour', 'look', 'calculate', 'auto', 'find', 'pinion.teeth', 'relief.amount_um', 'case.tasks.stability', 'play', 'phase', 'loading', 'tab.pictures', 'picture'):
        assert name in reached or (name == 'tab.pictures' and any(one.startswith('tab.') for one in reached)), name
    page.focus('#tab\\.pictures')
    page.keyboard.press('ArrowRight')
    assert page.evaluate('() => document.activeElement.id') == 'tab.tables'
    page.locator('#table').wait_for()
    window.close()


def test_fields_and_buttons_have_names(window):
    unnamed = window.page.evaluate("""() => [...document.querySelectorAll('input, select, textarea, button')].filter((one) => !one.hidden && one.type !== 'file' && !(
        one.labels?.length || one.getAttribute('aria-label') || one.getAttribute('aria-labelledby') || one.textContent.trim() || one.title)).map((one) => one.outerHTML)""")
    assert unnamed == []


def test_the_pair_turns_and_stands_where_less_motion_is_wanted(browser, front):
    window = Window(browser, front.address)
    before = int(window.page.get_attribute('#teeth', 'data-frames'))
    window.page.wait_for_timeout(1000)
    assert int(window.page.get_attribute('#teeth', 'data-frames')) > before + 2
    window.page.click('#play')
    still = window.page.get_attribute('#phase', 'value'), window.page.input_value('#phase')
    window.page.wait_for_timeout(300)
    assert window.page.input_value('#phase') == still[1]
    window.close()
    window = Window(browser, front.address, reduced_motion='reduce')
    assert window.page.inner_text('#play') == 'Turn'
    window.close()


def test_the_tour_goes_through_to_its_end(browser, front):
    window = Window(browser, front.address)
    window.page.click('#tour')
    window.page.locator('#guide').wait_for()
    steps = 0
    while window.page.locator('#guide').is_visible():
        steps += 1
        window.page.wait_for_timeout(400)
        window.shoot(f'tour_{steps}')
        window.page.locator('#guide button.strong').click()
        assert steps < 20
    assert steps >= 5 and window.said == []
    window.close()


def test_the_tour_gives_the_case_back(window):
    window.type('pinion', 'teeth', '18')
    window.page.select_option('#picture', 'load')
    before = window.text()
    window.page.click('#tour')
    window.until(lambda: window.page.title().startswith('case1 '))
    window.page.locator('#guide button', has_text='End').click()
    window.until(lambda: window.text() == before)
    window.up_to_date()
    assert window.page.title().startswith('small ') and window.field('pinion', 'teeth').input_value() == '18'
    window.page.locator('#view[data-picture=load]').wait_for()
    window.page.click('#undo')  # of what was done before the tour
    window.until(lambda: 'teeth = 21' in window.text())


def test_on_a_phone_a_button_leads_down_to_the_results(browser, front):
    window = Window(browser, front.address, viewport={'width': 390, 'height': 800})
    top = "() => document.querySelector('#results').getBoundingClientRect().top"
    assert window.page.evaluate(top) > 800
    window.page.click('#toresults')
    window.until(lambda: window.page.evaluate(top) < 100)
    assert window.page.evaluate('() => document.documentElement.scrollWidth') <= 390
    window.close()
    window = Window(browser, front.address)
    assert window.page.locator('#toresults').is_hidden()
    before = window.page.evaluate("() => getComputedStyle(document.body).backgroundColor")
    window.page.click('#look')  # each click shows
    assert window.page.evaluate("() => getComputedStyle(document.body).backgroundColor") != before
    window.close()


def test_escape_ends_the_tour(browser, front):
    window = Window(browser, front.address)
    window.page.click('#tour')
    window.page.locator('#guide').wait_for()
    window.page.keyboard.press('Escape')
    assert window.page.locator('#guide').is_hidden()
    window.close()


PICTURES = {
    'case1.nml': ['sweep', 'dte_rms', 'dte_range', 'sweep_map', 'optimum', 'factor_torques', 'factor_map', 'load', 'dte', 'share', 'ste', 'stiffness', 'pair_stiffness', 'profile_error', 'harmonics', 'own'],
    'hassan.nml': ['root', 'modes', 'section'],
    'fzg_c40.nml': ['pressure', 'sliding', 'flash', 'film'],
    'face_load.nml': ['contact_pattern', 'face_factor'],
    'helical.nml': ['contact_pattern', 'face_misalignment', 'sweep'],
    'torques.nml': ['optimum_ste', 'ste_torques', 'ste_map'],
    'precision.nml': ['precision'],
    'deflection_relief.nml': ['relief_flank', 'relief_search'],
    'more.nml': ['stress', 'stability', 'tongues', 'hysteresis', 'ramps', 'poincare', 'section_plane', 'lyapunov', 'attractors', 'basins', 'rating'],
    'rest.nml': ['largest', 'coast', 'dte_harmonics', 'load_harmonics', 'transient', 'transient_peaks', 'branches', 'branches_factor', 'life', 'gear_modes', 'frequency', 'campbell', 'body_campbell',
                 'torque', 'torque_gear', 'torque_friction', 'torque_harmonics', 'sensitivity'],
    'built.nml': ['as_built', 'assemblies', 'turn', 'teeth', 'orders', 'waterfall'],
}


def test_every_picture_is_drawn_here():
    listed = re.findall(r"{ id: '(\w+)'", (ROOT / 'python/gearsweep/panel/static/pictures.js').read_text())
    assert len(listed) > 20 and set(listed) == {one for pictures in PICTURES.values() for one in pictures}


@pytest.mark.parametrize('scheme', ['light', 'dark'])
@pytest.mark.parametrize('name', PICTURES)
def test_pictures_are_drawn(name, scheme, browser, front):
    window = Window(browser, front.address, color_scheme=scheme).open(name, 'folder' if name in ('more.nml', 'rest.nml', 'built.nml', 'torques.nml', 'helical.nml') else 'data')
    for picture in PICTURES[name]:
        window.page.select_option('#picture', picture)
        window.page.locator(f'#view[data-picture={picture}]').wait_for()
        window.page.wait_for_timeout(200)
        assert window.page.locator('#view .chart .body > *, #view canvas').count() > 0
        assert 'NaN' not in window.page.locator('#view').inner_html()
        window.shoot(f'{picture}_{scheme}')
    assert window.said == []
    window.close()
