"""How honest the reported error estimates are: random meshes against an independent reference, random gear bodies against
finer grids.

    python bench/honesty.py PROGRAMS        (bench/run.sh honesty sets up and does this)
"""
import itertools
import pathlib
import subprocess
import sys
import tempfile

import numpy as np
from honesty_bodies import compare
from pictures import draw
from report import Report, machine, run

MESHES, SPEEDS = 80, 12
KINDS = ('of any kind', 'short smooth intervals', 'strong damping')    # of test/properties/random_meshes.f90
DRAWS, PIECE = 1250, 50             # of test/properties/random_motions.f90, at eight speeds each; how many the program takes at once
MOTION = ('draw', 'contact_ratio', 'relief', 'friction', 'backlash', 'damping_ratio', 'frequency_ratio', 'tolerance', 'contact',
          'graded', 'estimate', 'error')
ROUNDING = 1e-12    # true errors below it are left to rounding
COLUMNS = ('mesh', 'contact_ratio', 'relief', 'damping_ratio', 'frequency_ratio', 'tolerance', 'status', 'contact', 'periods',
           'dynamic_factor', 'estimate', 'compared')
STATUS = ('ok', 'marginal', 'subharmonic', 'inexact', 'unstable', 'aperiodic', 'unresolved', 'chatter',
          'chaotic', 'transient', 'unbounded', 'stopped')
CONTACT = ('full', 'partial', 'lost')

programs = pathlib.Path(sys.argv[1])


def measure(kind):
    """All points of a kind, which of them are compared, and the true errors of those."""
    with tempfile.TemporaryDirectory() as name:
        problems = pathlib.Path(name) / 'problems'
        with problems.open('w') as file:
            answer = subprocess.run([programs / 'honesty', str(MESHES), str(SPEEDS), str(kind)], stdout=file,
                                    stderr=subprocess.PIPE, text=True, check=True)
        rows = np.array([line.split() for line in answer.stderr.splitlines()], float)
        reference = np.array(run(programs / 'reference', problems, 1e-14).split(), float)
    points = {column: rows[:, i] for i, column in enumerate(COLUMNS)}
    chosen = points['compared'] == 1
    error = np.full(len(rows), np.nan)
    error[chosen] = np.abs(points['dynamic_factor'][chosen] - reference)
    return points, chosen, error


def motions():
    """All motions found among the draws."""
    text = ''.join(run(programs / 'honesty', 'motions', first, min(first + PIECE - 1, DRAWS))
                   for first in range(1, DRAWS + 1, PIECE))
    rows = np.array([line.split() for line in text.splitlines()], float)
    return {column: rows[:, i] for i, column in enumerate(MOTION)}


def motion_classes(points):
    """Name and mask of each class of motions."""
    corners = points['draw'] % 8 == 0
    above = points['contact_ratio'] % 1
    graded = points['graded'] == 1
    yield 'all', np.ones(len(corners), bool)
    yield 'short smooth intervals, with relief', ~corners & (above < 0.15) & (points['relief'] > 0)
    yield 'tip corners touch, spline stiffness', corners
    yield 'with friction', points['friction'] > 0
    yield 'with backlash', points['backlash'] == 1
    for i, name in enumerate(CONTACT):
        yield f'contact {name}', points['contact'] == i
    for low, high in itertools.pairwise((1e-4, 1e-3, 1e-2, 0.1, 0.5, 1, 2, 5, 50)):
        yield (f'damping ratio {low:g} to {high:g}, equal steps',
               ~graded & (points['damping_ratio'] >= low) & (points['damping_ratio'] < high))
    yield 'graded steps', graded


def classes(points, chosen):
    """Name and mask of each class of the points with a number to compare."""
    yield 'all', chosen
    for i, name in enumerate(CONTACT):
        yield f'contact {name}', chosen & (points['contact'] == i)
    for low, high in ((1e-3, 1e-2), (1e-2, 1e-1), (1e-1, 1)):
        yield f'damping ratio {low:g} to {high:g}', chosen & (points['damping_ratio'] >= low) & (points['damping_ratio'] < high)
    for low, high in ((1e-8, 1e-6), (1e-6, 1e-4), (1e-4, 1e-3)):
        yield f'tolerance {low:g} to {high:g}', chosen & (points['tolerance'] >= low) & (points['tolerance'] < high)


def summary(points, error, mask):
    ratio = error[mask] / points['estimate'][mask]
    small = error[mask] <= ROUNDING
    share = [100 * np.mean((ratio > factor) & ~small) for factor in (1, 2)]
    beyond = 100 * np.mean((error[mask] > points['tolerance'][mask]) & ~small)
    return (str(mask.sum()), f'{share[0]:.1f} %', f'{share[1]:.1f} %', f'{beyond:.1f} %', f'{np.median(ratio):.2g}',
            f'{ratio[~small].max(initial=0):.2g}')


def main():
    points, chosen, error = measure(0)
    lost = np.sum((points['status'] <= 3) & (points['periods'] == 1) & ~chosen)
    report = Report('honesty', 'Honesty of the error estimates')
    report.add(f'{machine()}.\n{MESHES} random prescribed meshes (contact ratio 1.05 to 2.9, damping ratio 1e-3 to 1, relief none to '
               f'1.6 mean\ndeflections, 0.05 to 3 times the main resonance) at {SPEEDS} speeds each, tolerance 1e-8 to 1e-3. Reference: '
               'marching in\nextended precision, from the motion found, until it repeats; true errors below '
               f'{ROUNDING:g} count as rounding errors.\nWithout ' + ', '.join(f'{np.sum(points["status"] == i)} {STATUS[i]}' for i in range(len(STATUS)) if i in
                                      points['status'] and (i > 3 or i == 2)) + f', and {lost} that the reference did not find again.\n')
    heads = ('', 'points', 'true error above the estimate', 'above twice', 'above the tolerance', 'median ratio', 'largest')
    rows = [(name, *summary(points, error, mask)) for name, mask in classes(points, chosen) if mask.any()]
    for kind in (1, 2):
        others, compared, errors = measure(kind)
        rows.append((KINDS[kind], *summary(others, errors, compared)))
    report.table(heads, rows)
    report.add('The last two rows are as many other meshes: contact ratios 0.005 to 0.15 above a whole number, with\n'
               'relief, and damping ratios of 0.5 to 50 at 0.1 to 2.6 times the main resonance.\n')
    worst = [i for i in np.argsort(-np.where(chosen & (error > ROUNDING), error / points['estimate'], 0))[:10]
             if error[i] > 2 * points['estimate'][i]]
    far = np.mean(error[chosen] > np.maximum(2 * points['estimate'][chosen], ROUNDING))
    beyond = np.mean(error[chosen] > np.maximum(points['tolerance'][chosen], ROUNDING))
    report.tell(f'Error estimates of {chosen.sum()} random operating points: the true error is above twice the estimate at '
                f'{100 * far:.1f} %, above the tolerance at {100 * beyond:.1f} %.')
    if worst:
        report.add('The least honest:\n')
        report.table(('mesh', 'frequency ratio', 'damping ratio', 'contact', 'tolerance', 'estimate', 'true error'),
                     [(f'{points["mesh"][i]:.0f}', f'{points["frequency_ratio"][i]:.4f}', f'{points["damping_ratio"][i]:.4f}',
                       CONTACT[int(points['contact'][i])], f'{points["tolerance"][i]:.1e}', f'{points["estimate"][i]:.1e}',
                       f'{error[i]:.1e}') for i in worst])
    found = motions()
    rows = [(name, *summary(found, found['error'], mask)) for name, mask in motion_classes(found) if mask.any()]
    _, count, _, far, beyond, *_ = rows[0]
    report.tell(f'Error estimates of {count} random motions, every eighth with tip corners that touch: the true error is '
                f'above twice the\n  estimate at {far}, above the tolerance at {beyond}.')
    report.add(f'{DRAWS} random draws at eight speeds each (test/properties/random_motions.f90): damping ratio 1e-4 to 50, contact ratio\n'
               '1.05 to 2.9 or, in half of them, 0.005 to 0.15 above 1 or 2, relief, backlash, friction, 0.05 to 3 times the main\n'
               'resonance, tolerance 1e-10 to 1e-3; every eighth a pair like case 1 whose tip corners touch. Reference: four times\n'
               'as many steps and more, divided in another way.\n')
    report.table(heads, rows)
    largest = np.argmax(np.where(found['error'] > ROUNDING, found['error'] / found['estimate'], 0))
    report.add(f'The largest ratio belongs to an error of {found["error"][largest]:.1g}; the tolerance there is {found["tolerance"][largest]:.1g}.\n')
    report.csv('honesty_motions', MOTION, np.column_stack([*found.values()]))
    report.csv('honesty', (*COLUMNS, 'true_error'), np.column_stack([*points.values(), error]))
    draw('honesty')
    compare(report, programs)
    report.save()


main()
