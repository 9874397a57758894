"""The library's motions against an independent solver, at random points.

    python campaign.py all|light COUNT [SEED]

The Python package is asked for the dynamic factor of each row of rows.py by itself, and for all attracting motions; the
solver of motions.cpp finds attractors from its own starts, and tells what each motion of the library is. Printed is

- wrong: an answer of the sweep, or a motion said to attract, that is not what the solver makes of it;
- refused: no answer of the sweep although the solver knows an attracting motion of up to 8 mesh periods;
- by rounding: answers of the sweep that are another motion with the damping ratio changed in its 13th digit;
- estimates: errors above twice their estimate, by decades of damping, among the sweep's answers;
- found: of the solver's attractors to which more than 1 % of its starts lead, those that the task `attractors` lists.
"""

import os
import subprocess
import sys
import time
import warnings
from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from math import floor, log10
from pathlib import Path

from rows import rows

import gearsweep

HERE = Path(__file__).parent
BUILD = HERE.parents[2] / 'build' / 'motions'
STARTS, LONGEST = 100, 1500
MOST_PERIODS, TOLERANCE = 8, 1e-6
GIVEN = dict(item.split('=') for item in os.environ.get('ATTRACTORS', '').split())  # keys of &attractors to try


def case_of(row):
    (_, z1, z2, angle, ratio, pitch, n, *coef, m1, m2, load, zeta, friction, backlash, relief, _, shape, rpm) = row
    changes = {
        'pinion': {'teeth': z1, 'effective_mass_kg': m1}, 'gear': {'effective_mass_kg': m2}, 'load': {'normal_force_n': load},
        'mesh': {'model': 'polynomial', 'contact_ratio': ratio, 'coefficients': coef[:n]}, 'relief': {'amount_um': relief},
        'dynamics': {'damping_ratio': zeta}, 'numerics': {'tolerance': TOLERANCE},
        'sweep': {'rpm_first': rpm, 'rpm_last': rpm, 'rpm_step': 1, 'direction': 'each'}, 'attractors': GIVEN,
    }  # fmt: skip
    if friction > 0:
        changes['dynamics']['friction'] = friction
        changes['mesh']['pitch_point'] = pitch
        changes['gear']['teeth'] = z2
        changes['pair'] = {'pressure_angle_deg': angle}
    if relief > 0:
        changes['relief']['shape'] = 'linear' if shape == 1 else 'parabolic'
    if backlash >= 0:
        changes.setdefault('pair', {})['backlash_um'] = backlash
    return gearsweep.Case('').changed(**changes)


def answers(row):
    """Of the library: the sweep's DF, its estimate and status, its motion, all motions, and the time of the search."""
    case = case_of(row)
    with warnings.catch_warnings():
        warnings.simplefilter('ignore')
        start = time.perf_counter()
        sweep = gearsweep.run(case, 'sweep', threads=1).sweep
        middle = time.perf_counter()
        nearly = gearsweep.run(case_of([*row[:15], row[15] * (1 + 3e-13), *row[16:]]), 'sweep', threads=1).sweep
        begin = time.perf_counter()
        study = gearsweep.run(case, 'attractors', threads=1)
        end = time.perf_counter()
    point = study.attractor_points
    motions = []
    if study.attractors.rows:
        table = study.attractors
        columns = (table[name] for name in ('mesh_periods', 'dynamic_factor', 'error_estimate', 'dte_um', 'dte_rate_mm_s', 'share', 'status'))
        motions = [tuple(value.item() for value in values) for values in zip(*columns)]
    flat = lambda values: values.ravel()[0].item()
    return {
        'factor': flat(sweep.dynamic_factor), 'estimate': flat(sweep.error_estimate), 'status': flat(sweep.status),
        'shown': flat(point.each_motion), 'unsettled': flat(point.unsettled_share), 'motions': motions,
        'nearly': flat(nearly.dynamic_factor), 'times': (middle - start, end - begin),
    }  # fmt: skip


def solver():
    """The program of motions.cpp."""
    BUILD.mkdir(parents=True, exist_ok=True)
    program = BUILD / 'motions'
    if not program.exists() or program.stat().st_mtime < (HERE / 'motions.cpp').stat().st_mtime:
        subprocess.run(['g++', '-O2', '-std=c++17', HERE / 'motions.cpp', '-o', program], check=True)
    return program


def solve(program, starts, longest, lines):
    """Its answers, by row: lists of numbers."""
    text = subprocess.run([program, str(starts), str(longest)], input='\n'.join(lines), text=True, capture_output=True, check=True).stdout
    found = {}
    for line in text.splitlines():
        number, *values = line.split()
        found.setdefault(int(number), []).append([float(value) for value in values])
    return found


def references(kind, count, seed, points, workers):
    """What the solver finds from its own starts; kept, as it takes long."""
    program = solver()
    kept = BUILD / f'{kind}.{count}.{seed}.{STARTS}.{LONGEST}.dat'
    if not kept.exists():
        lines = [' '.join(map(str, row)) for row in points]
        parts = [lines[i::50] for i in range(50)]
        with ProcessPoolExecutor(workers) as pool:
            found = {}
            for part in pool.map(solve, [program] * 50, [STARTS] * 50, [LONGEST] * 50, parts):
                found |= part
        kept.write_text('\n'.join(' '.join(map(repr, [number, *values])) for number in sorted(found) for values in found[number]))
    found = {}
    for line in kept.read_text().splitlines():
        number, *values = line.split()
        found.setdefault(int(number), []).append([float(value) for value in values])
    return found


def checks(points, given):
    """What the solver says of each motion of the library, in their order."""
    lines = [' '.join(map(str, [*row, motion[0], motion[3], motion[4] / 1000])) for row in points for motion in given[row[0]]['motions']
             if motion[1] == motion[1]]  # fmt: skip
    return solve(solver(), 0, 0, lines)


def is_listed(orbit, motions):
    return any(motion[0] == orbit[0] and abs(motion[1] - orbit[1]) < 1e-4 * max(1, orbit[1]) for motion in motions)


def main(kind, count, seed):
    points = rows(kind, count, seed)
    workers = int(os.environ.get('WORKERS', '2'))
    known = references(kind, count, seed, points, workers)
    with ProcessPoolExecutor(workers) as pool:
        given = dict(zip((row[0] for row in points), pool.map(answers, points, chunksize=20)))
    checked = checks(points, given)
    report(points, known, given, checked)


def report(points, known, given, checked):
    refused, wrong, statuses = [], [], Counter()
    estimates, missed, large = Counter(), [], 0
    several = more = 0
    for row in points:
        number, zeta = row[0], row[15]
        mine, orbits = given[number], [orbit for orbit in known[number] if orbit[0] > 0]
        answered = mine['factor'] == mine['factor']
        statuses[mine['status']] += 1
        found = [motion for motion in mine['motions'] if motion[1] == motion[1]]
        for motion, orbit in zip(found, checked.get(number, [])):
            true = len(orbit) > 1 and orbit[0] == motion[0] and orbit[2] < 1 + 1e-6 and abs(orbit[1] - motion[1]) < 1e-4 * orbit[1]
            if not true:
                wrong.append(('motion', number, motion, orbit))
        if not answered:
            if any(orbit[0] <= MOST_PERIODS for orbit in orbits):
                refused.append((number, mine['status'], zeta))
        else:
            same = [orbit[1] for orbit in orbits]
            if mine['shown'] > 0:
                same.append(checked[number][mine['shown'] - 1][1] if len(checked[number][mine['shown'] - 1]) > 1 else float('nan'))
            error = min((abs(mine['factor'] - factor) for factor in same), default=float('inf'))
            decade = floor(log10(zeta))
            estimates[decade, 'all'] += 1
            if error > 1e-3:
                wrong.append(('answer', number, mine['factor'], same))
            elif error > 2 * mine['estimate']:
                estimates[decade, 'low'] += 1
        total = known[number][-1][2]
        for orbit in orbits:
            if orbit[6] <= 0.01 * total or orbit[0] > MOST_PERIODS:
                continue
            large += 1
            if not is_listed(orbit, found):
                missed.append((number, orbit[0], round(orbit[1], 6), orbit[6] / total, zeta))
        several += len(found) > 1
        if answered and found:
            more += max(motion[1] for motion in found) > 1.02 * mine['factor']
    n = len(points)
    pairs = [(mine['factor'], mine['nearly']) for mine in given.values()]
    other = sum((a == a) != (b == b) or abs(a - b) > 1e-4 * a for a, b in pairs)
    print(f'{n} points; status of the sweep by single speeds: ' + ', '.join(f'{m} {name}' for name, m in statuses.most_common()))
    print(f'another motion with the damping ratio changed in its 13th digit: {other}')
    print(f'wrong: {len(wrong)}', *wrong[:10], sep='\n  ')
    print(f'refused although a motion is known: {len(refused)}, {100 * len(refused) / n:.2f} %', *refused[:10], sep='\n  ')
    for decade in sorted({key[0] for key in estimates}):
        low, all_ = estimates[decade, 'low'], estimates[decade, 'all']
        print(f'error above twice the estimate, damping ratio from 1e{decade}: {low} of {all_}, {100 * low / all_:.2f} %')
    print(f'attractors with a share above 1 %: {large}, of which listed {100 * (1 - len(missed) / max(1, large)):.2f} %',
          *missed[:20], sep='\n  ')  # fmt: skip
    print(f'several motions at {100 * several / n:.1f} % of the points; one with a DF 2 % above the answer at {100 * more / n:.1f} %')
    for i, what in enumerate(('sweep', 'attractors')):
        times = sorted(mine['times'][i] for mine in given.values())
        print(f'time of {what}: median {1e3 * times[n // 2]:.2f} ms, mean {1e3 * sum(times) / n:.2f}, longest {1e3 * times[-1]:.1f}')


if __name__ == '__main__':
    main(sys.argv[1], int(sys.argv[2]), int(sys.argv[3]) if len(sys.argv) > 3 else 1)
