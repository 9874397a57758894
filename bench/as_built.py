"""Gears as built: the time of a whole turn of 25 teeth, beside that of 25 mesh periods of perfect gears.

    python bench/as_built.py PROGRAMS       (bench/run.sh as_built sets up and does this)
"""
import csv
import os
import pathlib
import re
import subprocess
import tempfile
from statistics import median

from report import BENCH, Report, machine

TEETH = 25
REPEATS = 5
MORE = {'as_built': 10, 'sweep': 200}            # draws, or reliefs, that one run has more than the other
SAMPLED, MANY = 100, 200                         # with quick, draws from which on as many are in the sample, and how many more
CASE = (BENCH.parent / 'data' / 'as_built.nml').read_text()
PROGRAM = BENCH.parent / 'build' / 'run' / 'gearsweep'


def case_of(task, count, step, corners, quick=False):
    """The case with so many draws (task as_built) or reliefs (task sweep)."""
    text = CASE.replace("'as_built'", f"'{task}'").replace("model = 'fe'", f"model = 'fe'  corner_contact = .{str(corners).lower()}.")
    text = re.sub(r'rpm_step = \d+', f'rpm_step = {step}', text)
    if task == 'sweep':
        amounts = ', '.join(str(15 + k / 1000) for k in range(count))
        return re.sub(r'amount_um = .*', f'amount_um = {amounts}', text.split('&deviations')[0])
    text = re.sub(r'draws = \d+', f'draws = {count}', re.sub(r'amount_um = .*', 'amount_um = 15', text))
    return text + '&as_built quick = .true. /\n' if quick else text


def run(text, column=None):
    """Processor time of a case, and the numbers of a column 'table.column'."""
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / 'case.nml'
        path.write_text(text)
        before = os.times()
        subprocess.run([PROGRAM, path, '--quiet', '--threads', '1', '--out', folder], check=True)
        after = os.times()
        numbers = []
        if column:
            table, name = column.split('.')
            with open(pathlib.Path(folder) / f'case.{table}.csv') as lines:
                numbers = [float(row[name]) for row in csv.DictReader(line for line in lines if not line.startswith('#'))]
    return after.children_user + after.children_system - before.children_user - before.children_system, numbers


def per_point(task, speeds, step, corners):
    """Processor time of one operating point (s): what so many draws or reliefs more take."""
    fewer, more = case_of(task, 1, step, corners), case_of(task, 1 + MORE[task], step, corners)
    return median(run(more)[0] - run(fewer)[0] for _ in range(REPEATS)) / (MORE[task] * speeds)


def quickly(speeds, step, corners):
    """Processor time of an operating point of many draws (s), and the largest difference to the sample to the tolerance."""
    taken, errors = [], []
    for _ in range(REPEATS):
        (fewer, _), (more, error) = (run(case_of('as_built', count, step, corners, quick=True), 'as_built_summary.sample_error')
                                     for count in (SAMPLED, SAMPLED + MANY))
        taken.append(more - fewer)
        errors += error
    return median(taken) / (MANY * speeds), max(errors)


def both_ways(grade):
    """How many dynamic factors of gears of this class there are, by how much the quick ones differ at most, and how many by above 1e-3."""
    exact, quick = (re.sub(r'(_class) = \d+', rf'\1 = {grade}', case_of('as_built', 91, 60, corners=False, quick=way))
                    .replace('amount_um = 15', 'amount_um = 0, 8, 15') for way in (False, True))
    off = [abs(a - b) for a, b in zip(*(run(text, 'as_built.dynamic_factor')[1] for text in (exact, quick)), strict=True)]
    return len(off), max(off), sum(one > 1e-3 for one in off)


def main():
    report = Report('as_built', 'Whole turns of gears as built')
    report.add(f'{machine()}, one thread. `data/as_built.nml` with a relief of 15 um: processor time of an operating point over a '
               f'turn of {TEETH} teeth at the tolerance 1e-6, with its errors of teeth and its tables, and of one mesh period of perfect '
               f"gears. Each is what {MORE['as_built']} draws or {MORE['sweep']} reliefs more take, the median of {REPEATS} runs.\n")
    rows = []
    for corners in (False, True):
        for speeds, step in ((327, 60), (1307, 15)):
            turn, period = (per_point(task, speeds, step, corners) for task in ('as_built', 'sweep'))
            rows.append(('A to E and beyond' if corners else 'A to E', str(speeds), f'{1e6 * turn:.0f} us', f'{1e6 * period:.2g} us',
                         turn / (TEETH * period)))
    report.table(('contact', 'speeds', 'a turn', 'a mesh period', f'turn over {TEETH} mesh periods'), rows)
    report.add(f'\nWith `quick`, 327 speeds: what {MANY} draws more take than {SAMPLED}, and by how much the dynamic factors of the '
               'sample differ at most from those to the tolerance.\n')
    lanes = []
    for corners in (False, True):
        turn, error = quickly(327, 60, corners)
        lanes.append(('A to E and beyond' if corners else 'A to E', f'{1e6 * turn:.0f} us', f'{error:.1e}'))
    report.table(('contact', 'a turn', 'largest difference'), lanes)
    report.add('\nOf 91 pairs of gears of a class at 327 speeds with reliefs of 0, 8 and 15 um, all dynamic factors both ways, not a sample alone.\n')
    found = [(str(grade), *both_ways(grade)) for grade in (5, 6, 7, 8)]
    report.table(('class', 'dynamic factors', 'largest difference', 'above 1e-3'),
                 [(grade, str(count), f'{most:.1e}', str(above)) for grade, count, most, above in found])
    report.tell(f'with quick a turn takes {lanes[0][1]}, with contact beyond A and E {lanes[1][1]}.')
    report.tell(f'a turn of {TEETH} teeth takes {rows[0][2]} at 327 speeds and {rows[1][2]} at 1307, with contact beyond A and E '
                f'{rows[2][2]} and {rows[3][2]}.')
    report.save()


if __name__ == '__main__':
    main()
