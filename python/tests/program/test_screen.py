"""What the program's screen says, against values worked out here from its tables or from closed forms."""

import csv
import itertools
import math
import re

import numpy as np
import pytest
from conftest import CHAOTIC, ROOT

# A geometry, whose lines have closed forms; a prescribed mesh whose pairs part, with too few steps for its
# slow speeds; and one of which the best relief lies at the end of the range searched.
CASES = {
    'geared': """&case tasks = 'geometry', 'mesh', 'load', 'sweep', 'optimum' /
&pair module_mm = 3 face_width_mm = 20 centre_distance_mm = 84.2 /
&pinion teeth = 21 profile_shift = 0.2 effective_mass_kg = 0.5 /
&gear teeth = 34 profile_shift = 0.1 effective_mass_kg = 0.9 /
&load normal_force_n = 4000 / &relief amount_um = 4, 0, 10 / &mesh model = 'weber' corner_contact = .false. /
&sweep rpm_first = 3000 rpm_last = 26000 rpm_step = 200 load_rpm = 4000, 6000 /
""",
    'parted': """&case tasks = 'mesh', 'load', 'sweep', 'optimum' /
&pinion teeth = 25 effective_mass_kg = 0.8 / &gear effective_mass_kg = 0.9 /
&load normal_force_n = 6858 / &relief amount_um = 0, 15, 25 /
&mesh model = 'polynomial' contact_ratio = 1.6 coefficients = 400, 0, -120 /
&dynamics damping_ratio = 0.02 / &numerics steps_per_period = 30 /
&sweep rpm_first = 500 rpm_last = 16000 rpm_step = 100 load_rpm = 600, 3000 /
""",
    'narrow': """&case tasks = 'sweep', 'optimum' /
&pinion teeth = 25 effective_mass_kg = 0.8 / &gear effective_mass_kg = 0.9 /
&load normal_force_n = 6858 / &relief amount_um = 0, 2 /
&mesh model = 'polynomial' contact_ratio = 1.1 coefficients = 400, 0, 120 /
&sweep rpm_first = 12000 rpm_last = 16000 rpm_step = 500 /
""",
}
# Finite elements on coarse grids, with what --verbose tells.
CASES_VERBOSE = {
    'elements': """&case tasks = 'mesh', 'static', 'modal', 'load', 'sweep', 'optimum' /
&pair module_mm = 3 face_width_mm = 20 /
&pinion teeth = 21 profile_shift = 0.2 effective_mass_kg = 0.5 / &gear teeth = 34 effective_mass_kg = 0.9 /
&load normal_force_n = 4000 / &relief amount_um = 0, 10 / &mesh model = 'fe' /
&section elements_across = 4 / &static positions = 5 / &modal modes = 3 /
&sweep rpm_first = 3000 rpm_last = 30000 rpm_step = 4000 load_rpm = 4000, 6000 /
""",
    'chaotic': CHAOTIC,
    'chaotic last': CHAOTIC.replace('0, 10', '10, 0'),
}
ANSWERED = {'ok', 'marginal', 'subharmonic', 'inexact'}


class Run:
    """The screen of a case as lines, its exit code, and its tables as lists of rows."""

    def __init__(self, program, name, folder, *options):
        (folder / f'{name}.nml').write_text((CASES | CASES_VERBOSE)[name])
        done = program(f'{name}.nml', '--out', 'out', *options, cwd=folder)
        self.out = folder / 'out'
        self.code, self.lines = done.returncode, done.stdout.splitlines()
        self.tables = {}
        for path in (folder / 'out').glob('*.csv'):
            with open(path) as file:
                self.tables[path.suffixes[0][1:]] = list(csv.DictReader(line for line in file if not line.startswith('#')))

    def line(self, begin, part=''):
        """What stands right of this beginning, in the one line that has it."""
        found = [line for line in self.lines if line.lstrip().startswith(begin) and part in line]
        assert len(found) == 1, f'{begin}: {found}'
        return found[0].lstrip()[len(begin) :].strip()

    def below(self, title, rows):
        """Words of the lines that follow a heading of columns."""
        at = next(i for i, line in enumerate(self.lines) if line.startswith(title))
        return [line.split() for line in self.lines[at + 1 : at + 1 + rows]]

    def numbers(self, table, *columns):
        return [tuple(float(row[column]) for column in columns) for row in self.tables[table]]


@pytest.fixture(scope='module')
def runs(program, tmp_path_factory):
    return {name: Run(program, name, tmp_path_factory.mktemp(name)) for name in CASES}


@pytest.fixture(scope='module')
def elements(program, tmp_path_factory):
    return Run(program, 'elements', tmp_path_factory.mktemp('elements'), '--verbose')


def curves(run, column='dynamic_factor'):
    """Dynamic factor over speed of each relief, in the order of the case: {relief: {rpm: factor}}."""
    found = {}
    for row in run.tables['sweep']:
        found.setdefault(float(row['relief_um']), {})[float(row['rpm'])] = float(row[column])
    return found


def windows(resonances):
    """15 % about each speed, and no farther than half-way to the next."""
    ends = [0, *((a + b) / 2 for a, b in itertools.pairwise(resonances)), math.inf]
    return [(max(0.85 * peak, begin), min(1.15 * peak, end)) for peak, (begin, end) in zip(resonances, itertools.pairwise(ends))]


def largest(curve):
    """(factor, rpm) of the largest; nothing where no speed has an answer."""
    return max(((factor, -rpm) for rpm, factor in curve.items() if not math.isnan(factor)), default=(math.nan, 0))


def standing_out(curve):
    """Peaks that fall by 0.01 to both sides before the curve is higher or ends, at most five of the largest:
    the speed where a parabola through the three points has its top."""
    rpm, factor = list(curve), list(curve.values())

    def falls(values):
        fall = 0
        for value in values:
            if value > values[0]:
                break
            if not math.isnan(value):
                fall = max(fall, values[0] - value)
        return fall >= 0.01

    found = []
    for i in range(1, len(rpm) - 1):
        a, b, c = factor[i - 1 : i + 2]
        if not (a < b >= c and falls(factor[i:]) and falls(factor[i::-1])):
            continue
        x = [speed - rpm[i] for speed in rpm[i - 1 : i + 2]]
        # y = b + p x + q x^2.
        q = ((c - b) / x[2] - (a - b) / x[0]) / (x[2] - x[0])
        p = (c - b) / x[2] - q * x[2]
        found.append((b - p**2 / (4 * q), rpm[i] - p / (2 * q)))
    return sorted(speed for _, speed in sorted(found)[-5:])


@pytest.mark.parametrize('name', CASES)
def test_worst_and_resonances(runs, name):
    run = runs[name]
    factor = curves(run)
    speeds = list(next(iter(factor.values())))
    assert run.line('Dynamic factor over ') == f'{len(speeds)} speeds, {speeds[0]:.0f} to {speeds[-1]:.0f} rpm'
    resonances = standing_out(factor[min(factor)])
    heading = next(line for line in run.lines if line.lstrip().startswith('relief um     worst'))
    assert ('of a peak at rpm' in heading) == bool(resonances)
    rows = run.below('   relief um     worst', len(factor) + bool(resonances))
    if resonances:
        said = [float(word) for word in rows.pop(0)]
        assert said == pytest.approx(resonances, abs=0.51)
    # Beside the worst of the larger motions stands what was seen of those that do not repeat, and that of the smaller ones, where
    # the two ways of the sweep differ.
    seen = curves(run, 'seen_dynamic_factor') if 'seen' in heading else {}
    smaller = curves(run, 'other_dynamic_factor') if 'other' in heading else {}
    for words, (relief, curve) in zip(rows, factor.items(), strict=True):
        worst, rpm = largest(curve)
        other, other_rpm = largest(smaller[relief]) if smaller else (0, 0)
        near = [largest({speed: df for speed, df in curve.items() if begin < speed <= end})[0] for begin, end in windows(resonances)]
        beside = [other, -other_rpm] if smaller else []
        if seen:
            most, most_rpm = largest(seen[relief])
            assert words[3] == (f'{most:.4f}' if most_rpm else 'none')
            assert not most_rpm or float(words[4]) == -most_rpm
            words = words[:3] + words[4 + bool(most_rpm) :]
        assert [float(word) for word in words] == pytest.approx([relief, worst, -rpm, *beside, *near], abs=0.51e-4)


@pytest.mark.parametrize('name', CASES)
def test_best_of_the_list(runs, name):
    seen = curves(runs[name], 'seen_dynamic_factor')
    _, worst, relief = min((np.fmax(largest(curve)[0], largest(seen[relief])[0]), largest(curve)[0], relief)
                           for relief, curve in curves(runs[name]).items())  # fmt: skip
    assert runs[name].line('Best of the list') == f'{relief:g} um: worst DF {worst:.4f}'


@pytest.mark.parametrize('name', CASES)
def test_counts_and_errors(runs, name):
    run, rows = runs[name], runs[name].tables['sweep']
    states = [row['status'] for row in rows]
    said = re.fullmatch(r'(\d+), without an answer (\d+); estimated error of DF at most (\S+) \(asked for (\S+)\)', run.line('Points '))
    assert (int(said[1]), int(said[2])) == (len(rows), sum(state not in ANSWERED for state in states))
    estimates = [float(row['error_estimate']) for row in rows if row['status'] in ANSWERED]
    assert float(said[3]) == pytest.approx(max(estimates), rel=0.051)
    assert float(said[4]) == 1e-6
    at = next(i for i, line in enumerate(run.lines) if line.startswith('Points '))
    counts, words = {}, {}
    for line in run.lines[at + 1 :]:
        if not line.startswith(' ' * 19):
            break
        if '"seen"' in line:
            continue
        number, word, *more = line.split()[:3]
        word = f'with {more[0]}' if word == 'with' else word
        counts[word.rstrip(':')] = int(number)
        words[word.rstrip(':')] = line.split(': ', 1)[-1].strip()
    expected = {state: states.count(state) for state in states if state != 'ok'}
    lost = sum(row['contact'] in ('lost', 'coast') for row in rows)
    two = sum(row['other_dynamic_factor'] != row['dynamic_factor'] for row in rows if 'other_dynamic_factor' in row)
    assert counts == expected | ({'with loss': lost} if lost else {}) | ({'with another': two} if two else {})
    # Each says what it means.
    for state, part in {'inexact': 'error exceeds the tolerance', 'unresolved': 'too low', 'subharmonic': 'several mesh periods',
                        'aperiodic': 'no periodic motion', 'chaotic': 'disturbances keep growing', 'transient': 'had not died away',
                        'unbounded': 'no bound was seen'}.items():
        assert part in words.get(state, part)


def test_the_periods_that_were_watched_are_those_of_the_largest_of_all_reliefs(program, tmp_path):
    run = Run(program, 'chaotic last', tmp_path)
    row = max(run.tables['sweep'], key=lambda one: float(one['seen_dynamic_factor'].replace('NaN', '0')))
    assert float(row['relief_um']) == 0 and int(row['seen_periods']) > 100
    assert run.line('"seen"').endswith(f'watched for {row["seen_periods"]} mesh periods')


def test_what_was_seen_of_motions_that_do_not_repeat(program, tmp_path):
    run = Run(program, 'chaotic', tmp_path)
    seen = {relief: largest(curve) for relief, curve in curves(run, 'seen_dynamic_factor').items()}
    worst, rpm = max(seen.values(), key=lambda one: -1 if math.isnan(one[0]) else one[0])
    periods = next(row['seen_periods'] for row in run.tables['sweep'] if float(row['rpm']) == -rpm)
    assert run.line('"seen"') == f': DF is at least {worst:.4f} in a motion that does not repeat, watched for {int(float(periods))} mesh periods'
    rows = run.below('   relief um     worst    at rpm      seen    at rpm', 2)
    assert rows[0][3:5] == [f'{worst:.4f}', f'{-rpm:g}'] and rows[1][3:] == ['none'] and math.isnan(seen[10][0])


def test_parted_has_what_is_counted(runs):
    states = {row['status'] for row in runs['parted'].tables['sweep']}
    assert {'ok', 'inexact', 'unresolved'} <= states
    assert {'full', 'lost'} <= {row['contact'] for row in runs['parted'].tables['sweep']}


def top_of(rows):
    """The largest value of a curve from its rows (place, value), by the parabola through the largest and its neighbours."""
    at = max(range(len(rows)), key=lambda i: rows[i][1])
    place, value = rows[at]
    before = next((row for row in rows[at::-1] if row[0] < place), None)
    after = next((row for row in rows[at:] if row[0] > place), None)
    if before is None or after is None:
        return value
    (a, u), (b, v) = ((x - place, y - value) for x, y in (before, after))
    bend = (v / b - u / a) / (b - a)
    slope = u / a - bend * a
    return value - slope**2 / (4 * bend) if bend < 0 else value


@pytest.mark.parametrize('name', CASES)
def test_chosen_speeds(runs, name):
    run = runs[name]
    if 'load' not in run.tables:
        return
    loads = {}
    for row in run.tables['load']:
        key = (float(row['relief_um']), float(row['rpm']))
        loads.setdefault(key, []).append((float(row['s']), float(row['load_ratio'])))
    rows = run.below('Dynamic factor at chosen speeds', 8)[2:]
    asked = {'geared': [4000, 6000], 'parted': [600, 3000]}[name]
    assert sorted((float(a), float(b)) for a, b, *_ in rows) == sorted((relief, rpm) for relief in curves(run) for rpm in asked)
    for relief, rpm, factor, estimate, status in rows:
        if status in ANSWERED:
            # What a parabola through three rows leaves: little with 200 steps a period, more with 30.
            assert float(factor) == pytest.approx(top_of(loads[float(relief), float(rpm)]), abs=2e-3 if name == 'geared' else 1e-2)
            assert float(estimate) > 0
        else:
            assert (factor, estimate) == ('-', '-')


@pytest.mark.parametrize('name', CASES)
def test_optimum(runs, name):
    """The best is the least of the curve; the true one lies between its neighbours, which is how exact it is."""
    run = runs[name]
    curve = run.numbers('optimum_curve', 'relief_um', 'worst_dynamic_factor', 'rpm', 'points_without_answer')
    best = min(range(len(curve)), key=lambda i: (curve[i][1], i))
    relief, factor, rpm, failed = curve[best]
    at = next(i for i, line in enumerate(run.lines) if line.startswith('Best single amount'))
    said = re.search(r'(\S+) um \(within (\S+)\),\s+judged by the largest dynamic factor over the speeds\D*.*?\s+worst DF (\S+) at (\S+) rpm',
                     ' '.join(run.lines[at : at + 3]))  # fmt: skip
    assert float(said[1]) == pytest.approx(relief, rel=0.51e-3)
    assert float(said[3]) == pytest.approx(factor, abs=0.51e-4)
    assert float(said[4]) == pytest.approx(rpm, rel=1e-5)
    beside = [abs(curve[i][0] - relief) for i in (best - 1, best + 1) if 0 <= i < len(curve)]
    # One digit is said.
    assert float(said[2]) == pytest.approx(max(beside), rel=0.51)
    assert float(said[2]) < 0.02
    text = '\n'.join(run.lines)
    assert ('at the end of the range searched' in text) == (best == len(curve) - 1)
    assert (f'{failed:.0f} speeds have no answer there' in text) == (failed > 0)
    assert ('speeds have no answer' in text) == (failed > 0)


def test_what_each_optimum_shows(runs):
    assert 'at the end of the range searched' in '\n'.join(runs['narrow'].lines)
    assert 'speeds have no answer there' in '\n'.join(runs['parted'].lines)


def test_failed_speeds_of_the_optimum_alone_change_the_exit_code(program, tmp_path):
    text = CASES['parted'].replace("tasks = 'mesh', 'load', 'sweep', 'optimum'", "tasks = 'optimum'")
    (tmp_path / 'alone.nml').write_text(text)
    done = program('alone.nml', '--out', 'out', cwd=tmp_path)
    assert 'speeds have no answer there' in done.stdout
    assert done.returncode == 4


def test_exit_codes(runs):
    assert (runs['geared'].code, runs['parted'].code, runs['narrow'].code) == (0, 4, 0)


# --- geometry and mesh: closed forms -----------------------------------------


def involute(angle):
    return math.tan(angle) - angle


def test_geometry_lines(runs):
    """Radii of the pair of 21 and 34 teeth, module 3, profile C of ISO 53, at a stated centre distance."""
    alpha, teeth, shift, module, centre = math.radians(20), (21, 34), (0.2, 0.1), 3.0, 84.2
    reference = [module * z for z in teeth]
    base = [d * math.cos(alpha) for d in reference]
    tip = [d + 2 * module * (1 + x) for d, x in zip(reference, shift)]
    root = [d - 2 * module * (1.25 - x) for d, x in zip(reference, shift)]
    working = math.acos(sum(base) / 2 / centre)
    # Play on the line of action: base pitches less the base tooth thicknesses of both, at the working angle.
    play = 2 * centre * math.cos(working) * (involute(working) - involute(alpha)) - 2 * sum(shift) * module * math.sin(alpha)
    run = runs['geared']
    text = '\n'.join(run.lines)
    said = re.search(r'centre distance (\S+) mm, working angle (\S+) deg, backlash (\S+) um', text)
    assert [float(word) for word in said.groups()] == pytest.approx([centre, math.degrees(working), 1000 * play], rel=2e-4)
    said = re.search(r'tip (\S+)/(\S+), reference (\S+)/(\S+), base (\S+)/(\S+), root (\S+)/(\S+) mm', text)
    assert [float(word) for word in said.groups()] == pytest.approx([*tip, *reference, *base, *root], rel=1e-6)
    # Path of contact: from the gear's tip (A) to the pinion's (E); from the pinion's base point.
    long = centre * math.sin(working)
    reach = [math.sqrt(t**2 - b**2) / 2 for t, b in zip(tip, base)]
    pitch = math.pi * module * math.cos(alpha)
    a, e = long - reach[1], reach[0]
    along = [a, e - pitch, base[0] / 2 * math.tan(working), a + pitch, e]
    said = re.search(r'contact ratio (\S+); pinion radius at A (\S+), B (\S+), P (\S+), D (\S+), E (\S+) mm', text)
    radii = [math.hypot(base[0] / 2, place) for place in along]
    assert [float(word) for word in said.groups()] == pytest.approx([(e - a) / pitch, *radii], rel=1e-6)
    # The same along the path: distance from A, radius and curvatures.
    for s, path, radius, own, other in run.numbers('mesh', 's', 'path_mm', 'pinion_radius_mm', 'pinion_curvature_mm', 'gear_curvature_mm'):
        assert path == pytest.approx(s * pitch, rel=1e-12, abs=1e-12)
        assert radius == pytest.approx(math.hypot(base[0] / 2, a + path), rel=1e-12)
        assert (own, other) == pytest.approx((a + path, long - a - path), rel=1e-11)


def mean_and_range(run):
    """Mesh stiffness over a mesh period by the trapezoidal rule, and the range of one pair's."""
    rows = [row for row in run.numbers('mesh', 'relief_um', 's', 'pair_stiffness_n_um') if row[0] == run.numbers('mesh', 'relief_um')[0][0]]
    area = sum((b[1] - a[1]) * (a[2] + b[2]) / 2 for a, b in itertools.pairwise(rows))
    return area, min(row[2] for row in rows), max(row[2] for row in rows)


@pytest.mark.parametrize(('name', 'force', 'mass', 'teeth'), [('geared', 4000, (0.5, 0.9), 21), ('parted', 6858, (0.8, 0.9), 25)])
def test_mesh_lines(runs, name, force, mass, teeth):
    run = runs[name]
    mean, least, most = mean_and_range(run)
    text = '\n'.join(run.lines)
    said = re.search(r'pair (\S+) to (\S+), mesh mean (\S+) N/um(?: \((\S+) N/um per mm of width\))?', text)
    assert [float(word) for word in said.groups()[:3]] == pytest.approx([least, most, mean], rel=1e-3)
    if name == 'geared':
        assert float(said[4]) == pytest.approx(mean / 20, rel=1e-3)
    hertz = math.sqrt(mean * 1e6 * (1 / mass[0] + 1 / mass[1])) / (2 * math.pi)
    said = re.search(r'Natural frequency\s+(\S+) Hz: the mesh excites it at (\S+) rpm', text)
    assert [float(word) for word in said.groups()] == pytest.approx([hertz, 60 * hertz / teeth], rel=1e-3)
    said = re.search(r'Load\s+(\S+) N on the line of action, effective masses (\S+) and (\S+) kg', text)
    assert [float(word) for word in said.groups()] == pytest.approx([force, *mass], rel=1e-4)


@pytest.mark.parametrize(('name', 'force'), [('geared', 4000), ('parted', 6858)])
def test_static_error_lines(runs, name, force):
    run = runs[name]
    reliefs = list(curves(run))
    for words, relief in zip(run.below('   relief um   peak-to-peak um', len(reliefs)), reliefs, strict=True):
        ste = [row[1] for row in run.numbers('mesh', 'relief_um', 'ste_um') if row[0] == relief]
        share = [row[1] for row in run.numbers('mesh', 'relief_um', 'load_share') if row[0] == relief]
        order = {row[1]: row[2] for row in run.numbers('harmonics', 'relief_um', 'harmonic', 'amplitude_um') if row[0] == relief}
        expected = [relief, max(ste) - min(ste), order[0], order[1], order[2], order[3]]
        # Where one pair carries all for a while, that is no column.
        if any('largest pair load/static' in line for line in run.lines):
            expected.append(max(share))
        else:
            assert max(share) == pytest.approx(1, abs=5e-5)
        # Extremes lie between the rows of the table, too.
        assert [float(word) for word in words] == pytest.approx(expected, rel=6e-3)
    assert 'peak-to-peak' in '\n'.join(run.lines)


def test_load_table(runs):
    """Loads over the static one, and shares of all pairs that make up the load where nothing moves."""
    for row in runs['geared'].tables['load']:
        assert float(row['load_ratio']) == pytest.approx(float(row['pair_load_n']) / 4000, rel=1e-12, abs=1e-15)


# --- finite elements, and what --verbose tells -------------------------------


def test_notes_count_what_the_tables_have(elements):
    tables = elements.tables
    rpm = {(row['relief_um'], row['rpm']) for row in tables['load']}
    sections = re.search(r'grid: (\d+) elements, (\d+) nodes', '\n'.join(elements.lines))
    assert {
        'mesh: pair stiffness by model fe',
        f'modal: {len(tables["modal"])} modes',
        'static: root stress at 5 positions of the load',
        'section: two grids made and factored',
        f'sweep: {len(tables["sweep"])} operating points',
        f'load: {len(rpm)} motions followed over the path',
        f'optimum: {len(tables["optimum_curve"])} reliefs swept',
    } <= set(elements.lines)
    assert len({row['s'] for row in tables['static']}) >= 5
    grid = (elements.out / 'elements.mode_shapes.vtu').read_text()
    assert f'NumberOfPoints="{sections[2]}" NumberOfCells="{sections[1]}"' in grid


def test_modes_lines(elements):
    rows = elements.below('   mode          Hz', 3)
    for words, row in zip(rows, elements.tables['modal'], strict=True):
        assert words[0] == str(int(float(row['mode'])))
        assert float(words[1]) == pytest.approx(float(row['frequency_hz']), rel=1e-5)
        estimate = next(float(value) for key, value in row.items() if 'estimate' in key)
        assert float(words[2]) == pytest.approx(100 * estimate, rel=0.02)
        # Energies of the rim and of each tooth make up the whole.
        assert sum(map(float, words[4:])) == pytest.approx(100, abs=2)


def test_root_lines(elements):
    """The table has the stress where a tangent of 30 degrees touches the fillet; the largest along the fillet
    lies a few degrees from there and a little higher."""
    for words, relief in zip(elements.below('Root stress of the pinion', 4)[2:], (0, 10), strict=True):
        numbers = [float(row['sigma_mpa']) for row in elements.tables['static'] if float(row['relief_um']) == relief]
        said = [float(word) for word in words]
        assert said[0] == relief
        assert 1 <= said[1] / max(numbers) < 1.1
        assert 1 <= said[3] / min(numbers) < 1.1
        assert all(25 < tangent < 50 for tangent in (said[2], said[4]))
        assert 0 < said[5] < 0.2


def test_headings_stand_apart(elements):
    """A blank line before each block."""
    for begin in ('Natural frequencies', 'Root stress', 'Static transmission', 'Dynamic factor at', 'Dynamic factor over'):
        at = next(i for i, line in enumerate(elements.lines) if line.startswith(begin))
        assert elements.lines[at - 1] == ''
        assert elements.lines[at - 2] != ''


@pytest.mark.parametrize(('body', 'model', 'word', 'stands'), [
    ('bore_mm = 10 hub_inertia_kgm2 = 7.8e-4', "'fe' / &section teeth = 0 fixed = 'rim' elements_across = 4", 'turn too softly', True),
    ('bore_mm = 40 hub_inertia_kgm2 = 7.8e-4', "'fe' / &section teeth = 0 fixed = 'rim' elements_across = 4", 'turn too softly', False),
    ('bore_mm = 40 hub_inertia_kgm2 = 7.8e-4', "'fe' / &section teeth = 0 fixed = 'rim' elements_across = 4", 'four inertias', True),
    ('bore_mm = 40', "'fe' / &section teeth = 0 fixed = 'rim' elements_across = 4", 'four inertias', False),
    ('profile_shift = 0.2', "'iso6336'", 'the standard has its formula', False),
    ('profile_shift = -0.3', "'iso6336'", 'the standard has its formula', True),
    ('addendum = 0.7', "'iso6336'", 'up to a tenth less', True),
    ('addendum = 0.8', "'iso6336'", 'up to a tenth less', False),
])
def test_cautions(program, tmp_path, body, model, word, stands):
    (tmp_path / 'one.nml').write_text(f"""&case tasks = 'mesh' / &pair module_mm = 3.18 face_width_mm = 25.4 / &load line_load_n_mm = 276 /
&pinion teeth = 25 effective_mass_kg = 0.556 {body} / &gear teeth = 25 effective_mass_kg = 0.556 {body} / &mesh model = {model} /""")
    assert (word in program('one.nml', cwd=tmp_path).stdout) is stands


@pytest.mark.parametrize(('torque', 'word', 'stands'), [
    (10000, 'if N mm is meant, write 10', True),
    (1000, 'caution', False),
])
def test_a_torque_that_no_flank_bears_is_reported(program, tmp_path, torque, word, stands):
    """Hertz at the pitch point of two equal gears of steel, both curved by r_b tan(alpha): p**2 = w E/(pi (1 - nu**2) r_b tan(alpha)).
    Roller bearings have 4000 MPa in ISO 76."""
    (tmp_path / 'one.nml').write_text(f"""&case tasks = 'mesh' / &pair module_mm = 3 face_width_mm = 20 / &load torque_nm = {torque} /
&pinion teeth = 25 / &gear teeth = 25 / &mesh model = 'weber' /""")
    alpha = math.radians(20)
    base_mm = 37.5 * math.cos(alpha)
    per_mm = 1e3 * torque / base_mm / 20
    pressure = math.sqrt(per_mm * 206e3 / (math.pi * 0.91 * base_mm * math.tan(alpha)))
    screen = program('one.nml', cwd=tmp_path).stdout
    assert (pressure > 4000) is stands
    assert (word in screen) is stands
    if stands:
        assert float(re.search(r'torque_nm = 10000 makes a pressure of (\S+) MPa', screen)[1]) == pytest.approx(pressure, rel=1e-3)


def test_attractors_that_no_start_reaches_are_reported_as_such(program, tmp_path):
    """Their numbers of starts and shares are 0."""
    (tmp_path / 'one.nml').write_text("""&case tasks = 'attractors' / &pair module_mm = 3 face_width_mm = 20 backlash_um = 80 /
&pinion teeth = 25 / &gear teeth = 25 / &load torque_nm = 100 / &dynamics damping_ratio = 0.02 / &attractors rpm = 16000 /""")
    lines = program('one.nml', cwd=tmp_path).stdout.splitlines()
    with open(tmp_path / 'results/one.attractors.csv') as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith('#')))
    at = next(i for i, line in enumerate(lines) if line.startswith('Attracting motions')) + 3
    said = [line.split()[4:6] for line in lines[at : at + len(rows)]]
    assert ['0', '0'] in said
    assert [float(starts) for starts, _ in said] == [int(row['starts']) for row in rows]
    assert [float(share) for _, share in said] == pytest.approx([float(row['share']) for row in rows], rel=1e-4)


def test_one_speed_is_reported_as_one(program, tmp_path):
    (tmp_path / 'one.nml').write_text(CASES['narrow'].replace('rpm_last = 16000', 'rpm_last = 12000').replace(", 'optimum'", ''))
    assert 'Dynamic factor over 1 speed, 12000 rpm\n' in program('one.nml', cwd=tmp_path).stdout


@pytest.mark.parametrize(('coast_deg', 'cautions'), [(20, 0), (25, 3)])
def test_iso_6336_3_of_asymmetric_teeth_comes_with_a_caution(program, tmp_path, coast_deg, cautions):
    """Once for each task that shows such values; the standard is made for equal flanks."""
    (tmp_path / 'case.nml').write_text(f"""&case tasks = 'static', 'rating', 'life' /
&pair module_mm = 3 face_width_mm = 20 coast_angle_deg = {coast_deg} / &pinion teeth = 21 / &gear teeth = 34 /
&load normal_force_n = 4000 / &relief amount_um = 0 / &mesh model = 'weber' / &section elements_across = 4 / &static positions = 3 /
&rating rpm = 3000 / &life rpm = 3000 duration_h = 1 tensile_strength_mpa = 900 curve_cycles = 1e3, 1e6 curve_stress_mpa = 500, 86 /
""")
    done = program('case.nml', cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert done.stdout.count('ISO 6336-3 is made for equal flanks') == cautions
    for table in ('root_rating', 'rating_factors', 'life'):
        with open(tmp_path / f'results/case.{table}.csv') as lines:
            rows = list(csv.DictReader(line for line in lines if not line.startswith('#')))
        assert {row['equal_flanks'] for row in rows} == {str(int(cautions == 0))}, rows


def test_a_safety_factor_says_what_it_rests_on(program, tmp_path):
    """Above the numbers of `rating` and `flank`: what of them is the case's own, and what nobody computed."""
    (tmp_path / 'case.nml').write_text("""&case tasks = 'rating', 'flank' / &pair module_mm = 3 face_width_mm = 20 /
&pinion teeth = 21 / &gear teeth = 34 / &load torque_nm = 100 application_factor = 1.25 / &mesh model = 'weber' / &relief amount_um = 0 /
&rating rpm = 3000 accuracy_grade = 6 face_load_factor = 1.1 material = '18CrNiMo7-6', 'alloy_steel' / &flank rpm = 3000 viscosity_mpa_s = 45 /
""")
    done = program('case.nml', cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    screen = done.stdout
    above = screen[screen.index('Rating by ISO 6336') : screen.index('stress MPa')]
    for words in ('by the larger of Methods A', 'K_A 1.25', 'K_H_beta 1.1,', 'K_H_alpha and K_F_alpha 1 (not computed)', 'accuracy grade 6',
                  'pinion: 18CrNiMo7-6 as case_hardened of grade mq: sigma_Hlim 1500, sigma_Flim 425 MPa', 'sigma_FG 850 MPa',
                  'gear: alloy_steel of grade mq: sigma_Hlim 766.9'):  # fmt: skip
        assert words in above, words
    assert 'oil of 45 mPa s where it enters the contact, X_L 1, roughness Ra 0.5 um' in screen


@pytest.mark.parametrize('method', ['larger', 'a', 'b'])
def test_a_rating_names_the_method_of_its_dynamic_factor(program, tmp_path, method):
    (tmp_path / 'case.nml').write_text(f"""&case tasks = 'rating' / &pair module_mm = 3 face_width_mm = 20 /
&pinion teeth = 21 / &gear teeth = 34 / &load torque_nm = 100 / &mesh model = 'weber' /
&rating rpm = 3000 dynamic_factor_method = '{method}' /
""")
    screen = program('case.nml', cwd=tmp_path).stdout
    named = {'larger': 'by the larger of Methods A (motion) and B (formula)', 'a': 'by Method A (motion', 'b': 'by Method B (formula)'}
    assert f'with K_v {named[method]}' in screen and 'no limits and no material are stated' in screen


def test_of_several_motions_the_screen_says_how_many_there_are(program, tmp_path):
    (tmp_path / 'case.nml').write_text("""&case tasks = 'rating', 'load', 'attractors' / &pair module_mm = 3.18 face_width_mm = 25.4 /
&pinion teeth = 25 / &gear teeth = 25 / &load line_load_n_mm = 276 / &mesh model = 'weber' corner_contact = .false. /
&dynamics damping_ratio = 0.02 / &rating rpm = 9500 / &sweep load_rpm = 100, 9500 load_torque = .true. / &attractors rpm = 9500 /
""")
    done = program('case.nml', cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    with open(tmp_path / 'results/case.attractors.csv') as lines:
        reached = sum(float(row['share']) > 0 for row in csv.DictReader(line for line in lines if not line.startswith('#')))
    assert reached > 1
    told = f'rows: {reached} motions attract at the speed; this is the one with the largest dynamic factor'
    assert f'1 of 1 {told}' in done.stdout and f'1 of 2 {told}' in done.stdout


@pytest.mark.parametrize(
    'model, mass, words',
    [
        ('weber', '', 'count in the masses; not in the stiffness by weber'),
        ('iso6336', '', 'count in the masses; in the stiffness by C_R'),
        ('weber', 'effective_mass_kg = 1', 'do not count in the masses, which are stated; not in the stiffness by weber'),
        ('fe', '', 'count in the masses; in the stiffness as rims that sections of 5 teeth hold at their sides'),
        ('fe', 'effective_mass_kg = 1', 'do not count in the masses, which are stated; in the stiffness as rims'),
    ],
)
def test_the_screen_says_what_of_rims_and_webs_counts(program, tmp_path, model, mass, words):
    teeth = f'teeth = 40 bore_mm = 20 {mass}'
    text = f"""&case tasks = 'mesh' / &pair module_mm = 2 face_width_mm = 20 / &load torque_nm = 50 / &mesh model = '{model}' /
&pinion {teeth} / &gear {teeth} WEB /
"""
    (tmp_path / 'solid.nml').write_text(text.replace('WEB', ''))
    (tmp_path / 'webbed.nml').write_text(text.replace('WEB', 'rim_thickness_mm = 5 web_thickness_mm = 4'))
    solid, webbed = (program(name, cwd=tmp_path).stdout for name in ('solid.nml', 'webbed.nml'))
    assert f'Rim and web        {words}' in webbed and 'Rim and web' not in solid


@pytest.mark.parametrize(
    'words',
    [
        ['--help'], ['--help', 'sweep'], ['--help', 'pair', 'module_mm'], ['--help', 'profile', 'shift'], ['--help', 'modul'],
        ['--new', 'sweep'], ['--new', '--short', 'sweep', 'optimum'], ['--new'], ['--new', 'swep'], ['--version'],
        ['--describe'], ['--describe', 'keys'], ['--describe', 'nothing'],
    ],
    ids=' '.join,
)  # fmt: skip
def test_both_programs_answer_alike(program, words, capfd):
    """The package's command line and the program's have the same words, apart from the general help."""
    from gearsweep.__main__ import main

    one = program(*words, cwd=ROOT)
    code = main(words)
    said = capfd.readouterr()
    assert (code, said.err) == (one.returncode, one.stderr)
    if words != ['--help']:
        assert said.out == one.stdout


def test_numbers_of_all_gears_as_built(program, tmp_path):
    """Quantiles by NumPy of the table's rows."""
    (tmp_path / 'a.nml').write_text("""&case tasks = 'as_built' / &pair module_mm = 3 face_width_mm = 20 / &pinion teeth = 10 profile_shift = 0.4 /
&gear teeth = 15 / &load torque_nm = 100 / &relief amount_um = 5, 10 / &mesh model = 'iso6336' /
&sweep rpm_first = 9000 rpm_last = 9000 rpm_step = 1 / &deviations pinion_class = 6 draws = 4 /
&as_built with_ste = .true. with_root_stress = .true. /""")
    lines = program('a.nml', '--out', 'out', cwd=tmp_path).stdout.splitlines()
    with open(tmp_path / 'out' / 'a.as_built_worst.csv') as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith('#')))
    for title, column in (('peak-to-peak static transmission error, um', 'ste_peak_to_peak_um'),
                          ('root stress of the pinion, MPa', 'pinion_root_stress_mpa'), ('root stress of the gear, MPa', 'gear_root_stress_mpa')):
        at = lines.index(f'Gears as built: {title}') + 2
        for amount, line in zip(('5', '10'), lines[at : at + 2], strict=True):
            mine = [row for row in rows if float(row['relief_um']) == float(amount)]
            values = [float(row[column]) for row in mine]
            expected = [float(mine[0][f'nominal_{column}']), *np.quantile(values, [0, 0.5, 0.95, 1])]
            told = [float(word) for word in line.split()]
            assert len(values) == 4 and told[0] == float(amount) and told[1:] == pytest.approx(expected, abs=0.0051)
