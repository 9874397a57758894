"""A panel's server in a folder of its own, and pages of it in a browser without a window."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

import gearsweep

ROOT = Path(__file__).parents[3]
SMALL = """! A small pair on a coarse grid.
&case title = 'Small pair' tasks = 'mesh', 'load', 'sweep', 'optimum' /
&pair module_mm = 3 face_width_mm = 20 /
&pinion teeth = 21 /  ! the driving one
&gear teeth = 34 /
&load torque_nm = 100 /
&relief amount_um = 0, 10 /
&mesh model = 'fe' /
&section elements_across = 4 /
&sweep rpm_first = 3000 rpm_last = 9000 rpm_step = 500 load_rpm = 4000 /
"""
# What the papers' cases do not ask for.
MORE = """&case tasks = 'static', 'modal', 'stability', 'hysteresis', 'poincare', 'attractors', 'rating' /
&pair module_mm = 3 face_width_mm = 20 backlash_um = 60 /
&pinion teeth = 21 /
&gear teeth = 34 /
&load torque_nm = 20 /
&relief amount_um = 0, 10 /
&mesh model = 'fe' /
&section elements_across = 4 /
&dynamics damping_ratio = 0.01 /
&sweep rpm_first = 8000 rpm_last = 30000 rpm_step = 500 /
&static field_position = 16 /
&hysteresis ramp_rpm_s = 20000 /
&modal modes = 4 /
&stability damping_count = 21 tongues = 4 /
&poincare settling_periods = 100 kept_periods = 30 /
&attractors rpm = 12000, 16000, 20000 starts = 4 /
&rating rpm = 5000, 10000, 15000 /
"""
RATED = """&case tasks = 'rating' /
&pair module_mm = 3 face_width_mm = 20 /
&pinion teeth = 21 / &gear teeth = 34 /
&load torque_nm = 100 application_factor = 1.25 /
&mesh model = 'weber' /
&rating rpm = 3000, 9000 material = '18CrNiMo7-6', '42CrMo4' /
"""
HELICAL = """&case tasks = 'face_load', 'sweep' /
&pair module_mm = 3 face_width_mm = 30 helix_angle_deg = 20 /
&pinion teeth = 25 crowning_um = 5 /
&gear teeth = 40 /
&load torque_nm = 300 /
&mesh model = 'fe' /
&section teeth = 3 elements_across = 4 /
&face misalignment_um = 20 /
&face_load misalignment_um = -30, 0, 30 /
&sweep rpm_first = 3000 rpm_last = 9000 rpm_step = 500 /
"""
# The tasks that no other case here asks for.
REST = """&case tasks = 'sweep', 'load', 'transient', 'branches', 'life', 'body_modes', 'harmonic', 'sensitivity' /
&pair module_mm = 3 face_width_mm = 20 backlash_um = 60 /
&pinion teeth = 21 bore_mm = 20 /
&gear teeth = 34 /
&load torque_nm = 20 /
&relief amount_um = 0, 10 /
&mesh model = 'weber' /
&section elements_across = 3 /
&dynamics damping_ratio = 0.01 friction = 0.05 /
&sensitivity rpm = 4000, 9000 /
&sweep rpm_first = 8000 rpm_last = 10000 rpm_step = 1000 load_rpm = 9000 load_torque = .true. direction = 'all' /
&transient rpm = 4000, 6000 modes = 3 samples = 20 /
&harmonic frequency_hz = 0, 1e5 modes = 3 /
&branches first = 12000 last = 20000 seeds = 2 points = 20 most_periods = 1 /
&life rpm = 4000, 6000 duration_h = 10, 20 tensile_strength_mpa = 900 curve_cycles = 1e3, 1e6 curve_stress_mpa = 500, 86 /
&body_modes nodal_diameters = 2 elements_across = 2 shapes = 3 /
"""
BUILT = """&case tasks = 'as_built' /
&pair module_mm = 3 face_width_mm = 20 /
&pinion teeth = 14 profile_shift = 0.3 / &gear teeth = 21 /
&load torque_nm = 100 /
&relief amount_um = 0, 10 /
&mesh model = 'weber' /
&sweep rpm_first = 5000 rpm_last = 9000 rpm_step = 1000 /
&as_built turn_rpm = 6000, 9000 waterfall = .true. /
&deviations pinion_class = 6 gear_class = 7 draws = 2 assembly = 'all' /
"""
TORQUES = """&case tasks = 'optimum' /
&pair module_mm = 3 face_width_mm = 20 /
&pinion teeth = 21 / &gear teeth = 34 /
&load torques_nm = 40, 70, 100 /
&relief amount_um = 0, 10 /
&mesh model = 'weber' /
&optimum judged = 'ste_peak_to_peak' /
"""
LONG = """&case tasks = 'poincare' /
&pinion teeth = 25 effective_mass_kg = 0.8 / &gear effective_mass_kg = 0.9 /
&load normal_force_n = 6858 / &relief amount_um = 0 /
&mesh model = 'polynomial' contact_ratio = 1.6 coefficients = 400, 0, -120 /
&sweep rpm_first = 2000 rpm_last = 16000 rpm_step = 10 /
&poincare settling_periods = 1000000 /
"""


class Front:
    """The command `gearsweep panel` in a folder."""

    def __init__(self, folder, port=0):
        words = [sys.executable, '-m', 'gearsweep', 'panel', str(folder), '--no-browser', '--port', str(port)]
        self.process = subprocess.Popen(words, stdout=subprocess.PIPE, text=True)
        self.address = re.search(r'http\S+', self.process.stdout.readline())[0]
        self.port = int(self.address.rstrip('/').rpartition(':')[2])

    def end(self):
        self.process.kill()
        self.process.communicate()


@pytest.fixture(scope='session')
def folder(tmp_path_factory):
    path = tmp_path_factory.mktemp('cases')
    (path / 'small.nml').write_text(SMALL)
    (path / 'long.nml').write_text(LONG)
    (path / 'more.nml').write_text(MORE)
    (path / 'helical.nml').write_text(HELICAL)
    (path / 'rest.nml').write_text(REST)
    (path / 'built.nml').write_text(BUILT)
    (path / 'torques.nml').write_text(TORQUES)
    (path / 'rated.nml').write_text(RATED)
    return path


@pytest.fixture(scope='session')
def front(folder):
    one = Front(folder)
    yield one
    one.end()


class Window:
    """A page of the panel, and what people do with it."""

    def __init__(self, browser, address, **options):
        self.context = browser.new_context(**{'viewport': {'width': 1280, 'height': 900}, 'accept_downloads': True} | options)
        self.context.set_default_timeout(60000)
        self.page = self.context.new_page()
        self.said, self.asked = [], []
        self.page.on('console', lambda message: self.said.append(message.text) if message.type in ('error', 'warning') else None)
        self.page.on('pageerror', lambda error: self.said.append(str(error)))
        self.page.on('request', lambda request: self.asked.append(request.url))
        self.address = address
        self.page.goto(address)
        self.ready()

    def ready(self):
        """Waits until no run is under way and the state tells so."""
        self.page.locator('#state', has_text=re.compile('Done in|must|missing|refused|Stopped|needs')).wait_for()
        self.page.locator('#cancel').wait_for(state='hidden')
        return self

    def open(self, name, place='folder'):
        self.page.select_option('#cases', f'{place}/{name}')
        self.until(lambda: self.page.title().startswith(f'{name.removesuffix(".nml")} '))
        return self.up_to_date()

    def up_to_date(self):
        """Waits until the results are those of the case: nothing is stale, or an error is told. On a busy machine, on which runs last
        longer, the page waits for the button."""
        done, due = (self.page.locator(name) for name in ('#results:not(.stale), #state.error', '#calculate.due'))
        done.or_(due).first.wait_for()
        self.page.wait_for_timeout(200)  # a run may just begin
        if done.count() == 0 and due.count() > 0:
            self.page.click('#calculate')
        done.first.wait_for()
        return self.ready()

    def field(self, group, key):
        return self.page.locator(f'#{group}\\.{key}')

    def type(self, group, key, words):
        """Types into a field, and waits for what follows from it."""
        before = self.text()
        field = self.field(group, key)
        field.fill(words)
        field.dispatch_event('change')
        self.until(lambda: self.text() != before)
        return self.up_to_date()

    def text(self):
        """The case's text as this window keeps it."""
        return self.page.evaluate("() => JSON.parse(sessionStorage.getItem('gearsweep')).text")

    def until(self, what):
        for _ in range(600):
            if what():
                return
            self.page.wait_for_timeout(50)
        raise AssertionError('it did not come about')

    def tab(self, name):
        self.page.click(f'#tab\\.{name}')
        return self

    def number(self, name):
        """What the numbers at a glance say."""
        return self.page.locator('#numbers > div', has_text=name).locator('b').inner_text()

    def shoot(self, name):
        """A picture for whoever wants to look."""
        if os.environ.get('GEARSWEEP_SHOTS'):
            Path(os.environ['GEARSWEEP_SHOTS']).mkdir(exist_ok=True, parents=True)
            self.page.screenshot(path=f'{os.environ["GEARSWEEP_SHOTS"]}/{name}.png')

    def close(self):
        self.context.close()


@pytest.fixture
def window(browser, front):
    """A new window with the small pair."""
    one = Window(browser, front.address)
    one.open('small.nml')
    yield one
    assert one.said == [], 'the browser complained'
    one.close()


@pytest.fixture(scope='session')
def small():
    """What the library itself says of the small pair."""
    return gearsweep.run(gearsweep.Case(SMALL))


def shown(value, digits=5):
    """A number as the page writes it."""
    if float(value).is_integer() and abs(value) < 1e7:
        return str(int(value))
    mantissa, _, power = repr(float(f'{value:.{digits}g}')).removesuffix('.0').replace('-', '−').partition('e')
    return f'{mantissa}e{power[0]}{power[1:].lstrip("0")}' if power else mantissa
