"""The program's tables: every number of the screen stands in one of them, and doc/tables.md describes each column."""

import csv
import math
import re

import pytest
from conftest import GEARED, PARTIAL, PRESCRIBED, ROOT

from gearsweep.core import library

DATA = sorted(path.stem for path in (ROOT / 'data').glob('*.nml'))
WRITTEN = {'geared': GEARED, 'prescribed': PRESCRIBED, 'partial': PARTIAL}
# Cases of tables and columns that none of these has.
RARE = {
    'design': '''! Reliefs of each gear judged by the dynamic transmission error over two torques; stress at a position.
&case tasks = 'mesh', 'optimum', 'static' /
&pair module_mm = 3 face_width_mm = 20 /
&pinion teeth = 21 hub_inertia_kgm2 = 1e-3 / &gear teeth = 34 hub_inertia_kgm2 = 1e-3 /
&load torques_nm = 80, 120 torque_shares = 0.7, 0.3 /
&optimum judged = 'dte_rms' over_torques = 'weighted' each_gear = .true. /
&section elements_across = 4 / &static positions = 5 field_position = 2 /
&sweep rpm_first = 3000 rpm_last = 9000 rpm_step = 2000 /
''',
    'quiet': '''! One relief for both gears judged by the dynamic transmission error.
&case tasks = 'mesh', 'optimum' /
&pair module_mm = 3 face_width_mm = 20 /
&pinion teeth = 21 / &gear teeth = 34 /
&load torques_nm = 80, 120 / &relief amount_um = 0, 10 /
&optimum judged = 'dte_rms' / &mesh model = 'weber' /
&sweep rpm_first = 3000 rpm_last = 9000 rpm_step = 2000 /
''',
    'long': '''! Amount and length of a relief.
&case tasks = 'optimum' /
&pair module_mm = 3 face_width_mm = 20 /
&pinion teeth = 21 / &gear teeth = 34 /
&load torque_nm = 80 / &optimum with_length = .true. / &mesh model = 'weber' /
&sweep rpm_first = 3000 rpm_last = 9000 rpm_step = 2000 /
''',
    'helical': '''! Helical gears with thinner teeth.
&case tasks = 'geometry', 'face_load', 'rating' /
&pair module_mm = 2 face_width_mm = 26 helix_angle_deg = 20 pinion_hand = 'left' centre_distance_mm = 69.172 /
&pinion teeth = 25 generating_shift = -0.02 / &gear teeth = 40 /
&load line_load_n_mm = 150 / &rating rpm = 3000 / &section elements_across = 4 / &face_load misalignment_um = 0, 10 /
''',
    'rated': '''! Rating and life by the curves of the material, on a stiffness by ISO 6336.
&case tasks = 'mesh', 'rating', 'life' /
&pair module_mm = 3 face_width_mm = 20 /
&pinion teeth = 21 / &gear teeth = 34 /
&load line_load_n_mm = 80 / &relief amount_um = 0 / &mesh model = 'iso6336' /
&rating rpm = 3000 material = '18CrNiMo7-6' life_h = 1000 /
&life rpm = 3000, 2000 load_factor = 10, 1 duration_h = 0.1, 1 relief_um = 0 /
''',
    'ramped': '''! All motions at each speed, and slow runs through the speeds at a rate.
&case tasks = 'sweep', 'hysteresis' /
&pinion teeth = 25 effective_mass_kg = 0.8 / &gear effective_mass_kg = 0.9 /
&load normal_force_n = 6858 / &relief amount_um = 0 /
&mesh model = 'polynomial' contact_ratio = 1.6 coefficients = 400, 0, -120 /
&dynamics damping_ratio = 0.05 /
&sweep rpm_first = 8000 rpm_last = 16000 rpm_step = 500 direction = 'all' /
&hysteresis ramp_rpm_s = 5000 /
''',
    'built': '''! Gears as built with all that is computed on request.
&case tasks = 'as_built' /
&pair module_mm = 3 face_width_mm = 20 /
&pinion teeth = 20 / &gear teeth = 20 /
&load torque_nm = 100 / &relief amount_um = 0, 10 / &mesh model = 'weber' /
&as_built rpm = 3000, 6000 waterfall = .true. with_ste = .true. ste_harmonic = 1 with_root_stress = .true. /
&deviations pinion_class = 6 gear_class = 7 draws = 2 /
''',
}
# Where the numbers below a line that begins so must be found, up to the next such line.
PLACES = {
    'Pair': 'gears geometry',
    'Diameters': 'gears',
    'Path of contact': 'geometry contact_points gears',
    'Tip relief': 'deflection_relief',
    'Gears as built': 'as_built_summary as_built_worst',
    'Tip': 'gears geometry',
    'Undercut': 'gears geometry',
    'Tooth thickness': 'gears',
    'Stiffness': 'motion',
    'Natural frequencies of the section': 'modal mode_energy section',
    'Root stress of the': 'root_stress root_rating',
    'Static transmission error': 'transmission_error harmonics',
    'Load over the face width': 'face_load_summary',
    'Dynamic factor at chosen speeds': 'load_points',
    'Transmitted torque': 'torque_points',
    'Dynamic factor over': 'sweep_summary sweep sweep_worst resonances',
    'Best of the list': 'sweep_summary',
    'Points': 'sweep_summary stability',
    'Stability with': 'stability tongues tongue_edges',
    'Slow run': 'hysteresis hysteresis_changes',
    'Changes': 'hysteresis hysteresis_changes',
    'Motion seen once': 'poincare lyapunov',
    'Attracting motions': 'attractors attractor_points',
    'Several motions': 'attractors attractor_points',
    'Best single amount': 'optimum optimum_curve optimum_loads',
    'Best design': 'optimum_design optimum_loads',
    'Branches of periodic motions': 'branches branch_changes',
    'Relative slope': 'sensitivity',
    'Precision at': 'precision precision_finest',
    'Flanks': 'flank_losses',
    'Rating by': 'rating dynamic_factors rating_factors',
    'Root stress while': 'transient_peaks',
    'Resonances of the section': 'section_resonances',
    'Life of the tooth roots': 'life life_curve contact_curve',
    'Natural modes of the': 'body_modes gear_body',
    'Printed values and ours': 'published',
}
# Digits that are part of words.
WORDS = ('ISO 6336-1', 'n_E1', 'ISO 6336-2 and -3', 'ISO 6336-3', '95 factor', 'ISO 6336,', '30 degree tangents', 'sigma_F0', '(within 15 %)', 'harmonics 1, 2, 3 um', '9 starts each', '1e-2     1e-4     1e-6',
         'passed 1e4 static ones')
NUMBER = re.compile(r'(?<![\w.])[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?(?![\w.]*[A-Za-z_])')


@pytest.fixture(scope='module')
def runs(program, tmp_path_factory):
    """By name of a case the lines of its screen, and its tables: what their header tells of each column, and the columns."""
    done = {}

    def run_of(name):
        if name not in done:
            folder = tmp_path_factory.mktemp(name)
            path = ROOT / 'data' / f'{name}.nml'
            if text := WRITTEN.get(name) or RARE.get(name):
                path = folder / 'case.nml'
                path.write_text(text)
            said = program(path, '--out', folder / 'out', cwd=folder)
            assert said.returncode in (0, 4), said.stderr
            title = re.search(r"title = '(.*)'", path.read_text())
            lines = [line for line in said.stdout.splitlines()[1:] if not title or line != title[1]]
            done[name] = lines, {path.name.split('.')[-2]: read(path) for path in (folder / 'out').glob('*.csv')}
        return done[name]

    return run_of


@pytest.fixture(params=[*DATA, *WRITTEN])
def run(request, runs):
    return runs(request.param)


def read(path):
    lines = path.read_text().splitlines()
    told = {}
    for line in lines[lines.index('# columns:') + 1 : lines.index('# case:')]:
        name, unit, meaning = re.fullmatch(r'#   (\w+)(?: \((.+?)\))?: (.+)', line).groups()
        told[name] = (unit or '', meaning)
    rows = list(csv.reader(line for line in lines if not line.startswith('#')))
    assert list(told) == rows[0]
    return told, dict(zip(rows[0], zip(*rows[1:]) if rows[1:] else [()] * len(rows[0]), strict=True))


def is_in(number, tables):
    """Does one of these tables have the number, to its digits? A value in parts of one may be shown in per cent, the
    amount of a pressure may have lost its sign, and a count may be that of rows or of different values."""
    digits = number.lower().partition('e')
    step = 10.0 ** (int(digits[2] or 0) - len(digits[0].partition('.')[2]))
    shown = float(number)
    for _, columns in tables:
        for name, values in columns.items():
            counts = [len(values), len(set(values))]
            if name == 'floquet_modulus':
                counts.append(sum(as_number(value) > 1 for value in values))  # unstable points
            if number.isdigit() and shown in counts:
                return True
            for value in values:
                for factor in (1, 100) if re.search('share|estimate|deviation|within_class', name) else (1,):
                    near = factor * as_number(value)
                    if abs(near - shown) <= 0.5000001 * step or (number.isdigit() and is_round(near, shown)):
                        return True
    return False


def as_number(word):
    try:
        return float(word)
    except ValueError:
        return math.nan


def is_round(value, shown):
    """A whole number may be one of few digits, with zeros in their place: 44600 of 44597."""
    zeros = len(str(int(shown))) - len(str(int(shown)).rstrip('0'))
    return abs(value - shown) <= 0.5000001 * 10**zeros and math.log10(max(shown, 1)) - zeros >= 1


def test_every_number_of_the_screen_is_in_a_table(run):
    lines, tables = run
    place, looked_for = None, 0
    for line in lines:
        if line.startswith(('Time', 'Wrote', 'Not used')):
            break
        place = next((PLACES[begin] for begin in PLACES if line.startswith(begin)), place)
        assert place or not line.strip()
        # The names and places of published quantities have digits of their own, as have the reasons under them, which are the table's.
        if place == 'published' and line.startswith('      '):
            said = line.strip().rstrip('.')
            assert any(said[1:] in reason for reason in tables['published'][1]['reason']), line
            continue
        shown = line[43:] if place == 'published' else line
        if place and place.startswith('precision ') and (time := re.search(r' +(\d+) (us|ms|s)$', line)):
            seconds = int(time[1]) * {'us': 1e-6, 'ms': 1e-3, 's': 1}[time[2]]
            assert any(f'{float(one):.0e}' == f'{seconds:.0e}' for one in tables['precision'][1]['run_time_s']), line
            shown = line[: time.start()]
        for words in WORDS:
            shown = shown.replace(words, '')
        for number in NUMBER.findall(shown.replace('+/-', ' ').replace('/', ' / ')):
            looked_for += 1
            assert is_in(number, [tables[name] for name in place.split() if name in tables]), f'{number}: {line}'
    assert looked_for > 10


@pytest.mark.parametrize('case', [*DATA, *WRITTEN, *RARE])
def test_the_page_tells_of_every_column(case, runs):
    page = (ROOT / 'doc/tables.md').read_text()
    shared = meanings_in(page.split('## Columns of many tables')[1].split('\n## ')[0])
    for name, (told, _) in runs(case)[1].items():
        section = re.search(rf'^\*\*{name}\*\*.*?(?=^\*\*|^## )', page, re.MULTILINE | re.DOTALL)
        assert section, f'doc/tables.md lacks the table {name}'
        written = {column: shared[column] for column in also_in(section[0])} | meanings_in(section[0])
        for other, columns in others_in(section[0]):
            there = meanings_in(re.search(rf'^\*\*{other}\*\*.*?(?=^\*\*|^## )', page, re.MULTILINE | re.DOTALL)[0])
            written |= {column: there[column] for column in columns}
        for column, (_, meaning) in told.items():
            # The page says with which key a column is there.
            said = re.sub(r'^with [^:]*: ', '', written.get(column, ''))
            assert said in (meaning, without_blanks(meaning)) or written.get(column) == meaning, f'doc/tables.md: {name}, {column}'


def without_blanks(meaning):
    """A meaning without its last clause, if that has a reason for NaN that the page names for all columns."""
    return re.sub(r'; NaN where (there is no answer|it is not known|none has an answer|there is none|that is not known)$', '', meaning)


def meanings_in(text):
    """Meanings by column in a section of doc/tables.md; a line may name several columns."""
    lines = re.findall(r'^- (`\w+`(?:, `\w+`)*): (.*)$', text, re.MULTILINE)
    return {column: meaning for names, meaning in lines for column in re.findall(r'\w+', names)}


def also_in(text):
    """Columns of the list for many tables that a table has too."""
    found = re.search(r'^Also: ([^.]*)\.$', text, re.MULTILINE)
    return re.findall(r'\w+', found[1]) if found else []


def others_in(text):
    """Other tables, each with the columns that have the same meaning there."""
    return [(other, re.findall(r'\w+', names)) for other, names in re.findall(r'^As in `(\w+)`: ([^.]*)\.$', text, re.MULTILINE)]


def test_every_column_of_the_page_is_compared(runs):
    """What the page says of a column is compared above only where a case has it."""
    written = {}
    for name in (*DATA, *WRITTEN, *RARE):
        for table, (told, _) in runs(name)[1].items():
            written.setdefault(table, set()).update(told)
    page = (ROOT / 'doc/tables.md').read_text()
    for table, text in re.findall(r'^\*\*(\w+)\*\*(.*?)(?=^\*\*\w+\*\*|^## )', page, re.MULTILINE | re.DOTALL):
        columns = {*meanings_in(text), *also_in(text), *(one for _, names in others_in(text) for one in names)}
        assert not columns - written.get(table, set()), f'no case has these columns of {table}'


def test_tables_without_an_error_estimate_are_listed():
    """A table has a column with one, or is in the list of doc/accuracy.md."""
    sections = re.findall(r'^\*\*(\w+)\*\*(.*?)(?=^\*\*\w+\*\*|^## )', (ROOT / 'doc/tables.md').read_text(), re.MULTILINE | re.DOTALL)
    columns = {name: [*meanings_in(text), *also_in(text), *(one for _, names in others_in(text) for one in names)] for name, text in sections}
    declared = {table for task in library.declared()['tasks'] for table in task['tables']}
    assert set(columns) == declared - {'nodes', 'elements', 'mode_shapes', 'stress'} | {'motion', 'published'}  # without grids
    without = {name for name, names in columns.items() if not any(re.search(r'estimate|(^|_)error(_nm)?$', column) for column in names)}
    listed = (ROOT / 'doc/accuracy.md').read_text().partition('<!-- tables without an error estimate -->')[2]
    cells = re.findall(r'^\| (`\w+`(?:, `\w+`)*) \|', listed, re.MULTILINE)
    named = [name for cell in cells for name in re.findall(r'\w+', cell)]
    assert len(named) == len(set(named)) and set(named) == without


def test_every_task_has_its_places():
    """The lists that are kept by hand have every task that the library declares."""
    readme = (ROOT / 'README.md').read_text()
    rows = dict(re.findall(r'^\| `(\w+)` \| .*? \| (.*) \|$', (ROOT / 'doc/case.md').read_text().split('## Keys')[0], re.MULTILINE))
    places = ' '.join(PLACES.values()).split()
    for task in library.declared()['tasks']:
        name = task['name']
        assert f'`{name}`' in readme, f'add `{name}` to the list of tasks in README.md'
        assert name in rows, f'add a row for `{name}` to the table of tasks in doc/case.md'
        for table in set(task['tables']) - {'nodes', 'elements'}:  # which the row has as its grid
            assert f'`{table}`' in rows[name], f'add the table `{table}` to the row of `{name}` among the tasks of doc/case.md'
        assert set(task['tables']) & set(places), f'add how the lines of `{name}` begin on the screen to PLACES in {__file__}'
