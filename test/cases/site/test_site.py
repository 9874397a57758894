"""The site: its notebook says what the page says, readers find what they look for, and nothing comes from elsewhere."""

import importlib.util
import json
import os
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]
SITE = ROOT / 'build' / 'site'
ORDER = ['First answer', 'Tutorial', 'How to', 'Subjects', 'Reference', 'Accuracy', 'Development']
EXAMPLE = re.compile(r'<!-- a case: (\S+) -->\n```text\n(.*?)```.*?<!-- from what it prints -->\n```text\n(.*?)```', re.DOTALL)
#: What readers ask, words that they may look for, and the place that answers it.
ASKED = {
    'which damping ratio': ('damping, damping ratio, which damping', 'choices.html#the-damping-ratio'),
    'price of a hunting pair': ('hunting, hunting pair, hunting tooth', 'as_built.html#hunting-pairs-and-their-run-time'),
    'the S-N curve of a life': ('S-N, S-N curve, SN curve, which S-N curve, Wöhler', 'strength.html#s-n-curves-and-damage'),
    'a call from Fortran 77': ('Fortran 77, fortran, call from Fortran', 'linking.html#fortran-77'),
    'how to cite': ('cite, citation, how to cite', 'questions.html#how-do-i-cite-it'),
}
SEARCHES = [(words, place) for asked, place in ASKED.values() for words in asked.split(', ')]
#: How many pages a reader of a minute looks at.
LOOKED_AT = 3

_spec = importlib.util.spec_from_file_location('compare', ROOT / 'test' / 'properties' / 'extreme' / 'compare.py')
compare = importlib.util.module_from_spec(_spec)
_spec.loader.exec_module(compare)


def article(name):
    """The text of a page, without navigation."""
    return re.search(r'<article.*?</article>', (SITE / name).read_text(), re.DOTALL)[0]


def links(name):
    return re.findall(r'href="([^"]+)"', article(name))


def test_the_notebook_runs_each_case_and_says_what_the_page_shows():
    shown = {case: lines for _, case, lines in EXAMPLE.findall((ROOT / 'doc/from_a_drawing.md').read_text())}
    cells = [cell for cell in json.loads((SITE / 'from_a_drawing.ipynb').read_text())['cells'] if cell['cell_type'] == 'code']
    assert all(cell['execution_count'] for cell in cells)
    run = {}
    for cell in cells:
        if case := re.search(r'Case\("""(.*?)"""\)', ''.join(cell['source']), re.DOTALL):
            assert not [output for output in cell['outputs'] if output.get('name') == 'stderr'], case[1]
            run[case[1]] = ''.join(''.join(output['text']) for output in cell['outputs'])
    assert run.keys() == shown.keys()
    for case, lines in shown.items():
        said = re.sub(' +', ' ', run[case]).splitlines(keepends=True)
        lines, length = re.sub(' +', ' ', lines), lines.count('\n')
        assert any(compare.alike(lines, ''.join(said[at : at + length]), compare.LEAST) for at in range(len(said))), case
    assert len(re.findall('image/png', json.dumps(cells))) == len(shown)


def test_the_page_of_the_notebook_has_its_pictures():
    assert 'from_a_drawing.ipynb' in links('from_a_drawing.html')
    drawn = re.findall(r'<img[^>]* src="(pictures/from_a_drawing-\d\.png)"', article('from_a_drawing.html'))
    assert len(drawn) == 6 and all((SITE / name).stat().st_size > 5000 for name in drawn)


def test_every_link_leads_to_a_file_and_to_a_heading_that_are_there():
    for path in SITE.glob('*.html'):
        if path.name == '404.html':
            continue
        for link in links(path.name):
            if re.match(r'\w+:', link):
                continue
            name, _, anchor = link.partition('#')
            target = SITE / name if name else path
            assert target.exists(), f'{path.name} leads to {link}'
            if anchor and target.parent == SITE:
                assert f'id="{anchor}"' in target.read_text(), f'{path.name} leads to {link}'


@pytest.mark.parametrize('question', ASKED)
def test_an_answer_is_two_clicks_from_the_first_page(question):
    _, place = ASKED[question]
    page, _, anchor = place.partition('#')
    assert 'questions.html' in links('index.html')
    assert any(link.partition('#')[0] == page for link in links('questions.html') + links('index.html')), question
    assert f'id="{anchor}"' in article(page), question


def test_the_answer_on_citing_leads_to_the_citation():
    assert 'files/CITATION.cff.txt' in links('questions.html')


@pytest.mark.parametrize('words, place', SEARCHES)
def test_the_search_finds_it_without_a_network(words, place, page):
    page.goto((SITE / 'index.html').as_uri())
    page.locator('.md-search__input').click()
    page.locator('.md-search__input').type(words)
    page.locator('.md-search-result__link').first.wait_for()
    read = (f'(items) => items.slice(0, {LOOKED_AT}).flatMap((one) => '
            '[...one.querySelectorAll(".md-search-result__link")].map((link) => link.getAttribute("href")))')
    places = []
    for _ in range(40):  # the list changes with each word until the last one is in
        page.wait_for_timeout(250)
        hrefs = page.locator('.md-search-result__item').evaluate_all(read)
        places = [re.sub(r'\?h=[^#]*', '', href.rpartition('/')[2]) for href in hrefs]
        if place in places:
            break
    assert place in places, (words, places)


@pytest.mark.parametrize('width, scheme', [(1280, 'light'), (1280, 'dark'), (420, 'light')])
def test_the_first_page_shows_three_pictures_side_by_side(width, scheme, page):
    page.set_viewport_size({'width': width, 'height': 900})
    page.emulate_media(color_scheme=scheme)
    page.goto((SITE / 'index.html').as_uri())
    boxes = [image.bounding_box() for image in page.locator('article table img').all()]
    if folder := os.environ.get('GEARSWEEP_SHOTS'):
        page.screenshot(path=f'{folder}/site_{width}_{scheme}.png')
    assert len(boxes) == 3 and all(box['width'] > width / 8 for box in boxes)
    assert boxes[0]['x'] < boxes[1]['x'] < boxes[2]['x']
    assert page.evaluate('document.documentElement.scrollWidth <= innerWidth')


def test_the_pages_come_in_the_order_in_which_they_are_read(page):
    page.goto((SITE / 'index.html').as_uri())
    top = page.locator('.md-nav--primary > .md-nav__list > .md-nav__item')
    said = [re.sub(r'\s+', ' ', one.locator('> label, > .md-nav__link, > .md-nav__container').first.text_content()).strip() for one in top.all()]
    assert said == ORDER
