"""Finite elements: error against run time, beside scikit-fem with SciPy and beside CalculiX.

    python bench/elastic.py PROGRAMS        (bench/run.sh elastic sets up and does this)

Every repeat takes each contender once, in turn, so that a busy machine slows all alike; medians are
shown. Only Python's contenders import their libraries and warm up beforehand.
"""
import pathlib
import platform
import sys
import tempfile
from statistics import median

import numpy as np
import scipy
import skfem
from peers.elastic_peers import Grid, calculix_modes, calculix_static, scipy_modes, scipy_static, solvers
from pictures import draw
from report import Report, first_line, machine, run

MODES = 10
# Elements across a tooth: some 2e3, 2e4 and 1e5 unknowns; and repeats.
GRIDS = {6: 9, 19: 5, 42: 3}
FIRST_GRIDS, FIRST_FINEST = (3, 4, 6, 8, 10, 12, 13, 14, 16, 24, 32), 64
# Elements across the loaded tooth and the others, places of the load.
PATHS = ((6, 3, 9), (8, 4, 9), (10, 4, 17), (12, 4, 17), (14, 4, 17), (16, 4, 17), (20, 5, 17), (24, 8, 17), (32, 12, 33))
PATH_FINEST = (64, 24, 49)
REPEATS = 5
STUDY = {4: 5, 6: 5, 8: 5, 12: 3, 16: 3, 24: 1, 32: 1}
STUDY_FINEST = (16, 32, 64)
QUANTITIES = ('first frequency', 'largest root tension', 'deflection')
AIMS = (1e-4, 5e-3, 1e-3)  # for each
SOLVERS, LOADS = {12: 3, 24: 3, 36: 1}, 20

elastic = pathlib.Path(sys.argv[1]) / 'elastic'


def run_elastic(*arguments):
    return np.array(run(elastic, *arguments).split(), dtype=float)


def make_grid(kind, across, folder):
    run(elastic, 'grid', kind, across, folder / 'grid')
    return Grid(folder / 'grid')


def times(values):
    return ' | '.join(f'{value:.3g}' for value in values)


def apart(a, b):
    return np.abs(a / b - 1).max()


def compare_modes(report, folder):
    report.add('**Ten modes on the same grid.** Seconds, from the grid to frequencies and shapes; CalculiX is a whole program: its\n'
               'time includes reading its input, and it turns plane elements into bricks, with more unknowns.\n'
               'SciPy\'s factor is within eigen: `eigsh` as it comes, then with SuperLU told of the symmetry. Last column: largest\n'
               'relative difference of the ten frequencies from gearsweep\'s.\n')
    rows = []
    for across, repeats in GRIDS.items():
        grid = make_grid('graded', across, folder)
        mesh = grid.quadratic()
        own, plain, told, deck = [], [], [], []
        for _ in range(repeats):
            own.append(run_elastic('modes', across, MODES))
            plain.append(scipy_modes(grid, mesh, MODES, False))
            told.append(scipy_modes(grid, mesh, MODES, True))
            deck.append(calculix_modes(grid, folder, MODES))
        stages, frequency = np.median(np.array(own)[:, 1:4], 0), own[0][5:]
        whole = median(np.array(own)[:, 1:4].sum(1))
        rows.append((str(int(own[0][0])), str(repeats), 'gearsweep', *stages, whole, '', ''))
        for name, runs in (('scikit-fem, SciPy', plain), ('the same, symmetric', told)):
            both = median(run[0] + run[1] for run in runs)
            rows.append(('', '', name, median(run[0] for run in runs), '', median(run[1] for run in runs), both,
                         f'{both / whole:.1f}', f'{apart(runs[0][2], frequency):.1e}'))
        both = median(run[0] for run in deck)
        rows.append(('', '', 'CalculiX', '', '', '', both, f'{both / whole:.1f}', f'{apart(deck[0][1], frequency):.1e}'))
    as_it_comes, symmetric = (median(run[0] + run[1] for run in runs) / whole for runs in (plain, told))
    report.tell(f'Ten natural frequencies of a grid with {int(own[0][0])} unknowns: {whole:.2g} s; scikit-fem with SciPy takes '
                f'{as_it_comes:.2g} times that,\n  {symmetric:.2g} times with SuperLU told of the symmetry; CalculiX {both / whole:.2g} times, '
                'as a whole program that reads its input and\n  turns the plane elements into bricks.')
    report.table(('unknowns', 'repeats', '', 'assembly', 'factor', 'eigen', 'all', 'gearsweep is faster by', 'differs by'), rows)


def rounds(command, grids):
    """Answers of all rounds for each grid."""
    return np.array([[run_elastic(command, *grid) for grid in grids] for _ in range(REPEATS)])


def time_kept(aim, errors, seconds):
    """Of the cheapest grid from which on every finer one keeps the aim as well."""
    kept = [i for i in range(len(errors)) if max(errors[i:]) <= aim]
    return min((seconds[i] for i in kept), default=float('nan'))


def first_mode(report):
    runs = rounds('first', [(n,) for n in FIRST_GRIDS])
    exact = run_elastic('first', FIRST_FINEST)[1]
    seconds = np.median(runs, 0)
    errors = np.abs(runs[0, :, 1] / exact - 1)
    report.add(f'**First mode of Hassan\'s section.** Grid included. Error against {FIRST_FINEST} elements across a tooth ({exact:.3f} Hz).\n')
    report.table(('across', 'unknowns', 'Hz', 'error', 'own estimate', 's', 's with estimate'),
                 [(str(n), str(int(row[0])), f'{row[1]:.3f}', f'{error:.1e}', f'{row[2]:.1e}', *taken[3:])
                  for n, row, error, taken in zip(FIRST_GRIDS, runs[0], errors, seconds)])
    report.add(f'To 1e-4: {time_kept(1e-4, errors, seconds[:, 3]):.3f} s, with the estimate '
               f'{time_kept(1e-4, errors, seconds[:, 4]):.3f} s.\n')
    report.tell(f'The first frequency of a three-tooth section to 1e-4: {time_kept(1e-4, errors, seconds[:, 3]):.2g} s, '
                f'with the estimate of its error {time_kept(1e-4, errors, seconds[:, 4]):.2g} s.')


def compliance(report):
    runs = rounds('compliance', PATHS)
    exact = run_elastic('compliance', *PATH_FINEST)[1:]
    seconds = np.median(runs[:, :, 0], 0)
    errors = [apart(row[1:], exact) for row in runs[0]]
    report.add('**Pair compliance along the path.** Dogan\'s case 1; equal gears, hence one gear\'s time. Largest error over 101 points\n'
               f'of the path against {PATH_FINEST[0]} and {PATH_FINEST[1]} elements across, {PATH_FINEST[2]} places.\n')
    report.table(('across', 'other teeth', 'places', 'error', 'ms a gear'),
                 [(*map(str, path), f'{error:.1e}', 1000 * taken) for path, error, taken in zip(PATHS, errors, seconds)])
    report.add(f'To 0.1 %: {1000 * time_kept(1e-3, errors, seconds):.3g} ms a gear.\n')
    report.tell(f"A gear's compliance along the whole path to 0.1 %: {1000 * time_kept(1e-3, errors, seconds):.2g} ms.")


def limit():
    """Values of an infinitely fine grid, by the order that three grids show."""
    coarse, middle, fine = (run_elastic('study', 'graded', across)[1:4] for across in STUDY_FINEST)
    order = np.clip(np.log2(np.abs((coarse - middle) / (middle - fine))), 1, 4)
    return fine + (fine - middle) / (2**order - 1), np.abs(fine / (fine + (fine - middle) / (2**order - 1)) - 1)


def study_peers(across, folder):
    """Frequency, tension, deflection and their seconds, on the graded grid."""
    grid = make_grid('graded', across, folder)
    mesh = grid.quadratic()
    *modes, frequency = scipy_modes(grid, mesh, 1, True)
    tension, deflection, both, deflected = scipy_static(grid, mesh)
    yield 'scikit-fem, SciPy', (frequency[0], tension, deflection, sum(modes), both, deflected)
    seconds, frequency = calculix_modes(grid, folder, 1)
    tension, deflection, static = calculix_static(grid, folder)
    yield 'CalculiX', (frequency[0], tension, deflection, seconds, static, static)


def study(report, folder):
    exact, left = limit()
    answers = {}
    for across, repeats in STUDY.items():
        for _ in range(repeats):
            for kind in ('graded', 'uniform'):
                answers.setdefault((f'gearsweep, {kind}', across), []).append(run_elastic('study', kind, across)[1:])
            for name, answer in study_peers(across, folder):
                answers.setdefault((name, across), []).append(answer)
    table = {key: np.median(runs, 0) for key, runs in answers.items()}
    errors = {key: np.abs(row[:3] / exact - 1) for key, row in table.items()}
    report.add('**Hassan\'s section, one load.** First frequency, largest root tension, and deflection at a depth below a load near the\n'
               'tip: seconds, from the grid on, on the coarsest grid from which all finer ones keep the error. Errors are relative to the limit\n'
               f'that grids of {", ".join(map(str, STUDY_FINEST))} elements across show, from which the finest is '
               + ', '.join(f'{value:.1e}' for value in left) + ' away.\nGraded: the library\'s grid, which the peers get too; '
               f'uniform: the same outline in elements of equal size; {", ".join(map(str, STUDY))}\nacross. Stress: the peers\' largest '
               'principal stress at the nodes of the fillet, projected (scikit-fem) or extrapolated (CalculiX).\n')
    names = list(dict.fromkeys(name for name, _ in table))
    rows = []
    for name in names:
        cells = []
        for k, aim in enumerate(AIMS):
            cells.append(time_kept(aim, [errors[name, across][k] for across in STUDY], [table[name, across][3 + k] for across in STUDY]))
            cells.append(f'{errors[name, 16][k]:.1e}')
        rows.append((name, *(cell if isinstance(cell, str) or np.isfinite(cell) else '-' for cell in cells)))
    report.table(('', *(text for quantity, aim in zip(QUANTITIES, AIMS)
                        for text in (f'{quantity} to {aim:g}, s', 'error at 16 across'))), rows)
    report.csv('elastic', ('method', 'across', *(f'{q} error' for q in QUANTITIES), *(f'{q} seconds' for q in QUANTITIES)),
               [(name, across, *errors[name, across], *table[name, across][3:]) for name, across in table])
    draw('elastic')


def compare_solvers(report, folder):
    rows = []
    for across, repeats in SOLVERS.items():
        grid = make_grid('graded', across, folder)
        mesh = grid.quadratic()
        own, others = [], {}
        for _ in range(repeats):
            own.append(run_elastic('solver', across, LOADS))
            for name, *answer in solvers(grid, mesh, LOADS):
                others.setdefault(name, []).append(answer)
        unknowns, *ours = np.median(own, 0)
        rows.append((f'{unknowns:.0f}', 'gearsweep', *ours[:3], '', ''))
        for name, runs in others.items():
            taken = np.median(runs, 0)
            rows.append(('', name, *taken[:3], f'{(taken[0] + taken[1]) / (ours[0] + ours[1]):.1f}', f'{abs(taken[3] / ours[3] - 1):.1e}'))
    report.add(f'**Solvers on the same matrix.** Seconds to factor, for one right side and for {LOADS}; ratio of factor and one right side.\n')
    report.table(('unknowns', '', 'factor', 'one', str(LOADS), 'gearsweep is faster by', 'differs by'), rows)


def main():
    blas = first_line('dpkg-query', '-W', '-f', '${Package} ${Version}', 'libopenblas0-pthread')
    report = Report('elastic', 'Finite elements: error against run time')
    report.add(f'{machine()}, one thread.\n{blas}; Python {platform.python_version()}, NumPy {np.__version__}, SciPy {scipy.__version__}, '
               f'scikit-fem {skfem.__version__}; CalculiX {first_line("ccx", "-v").split()[-1]}.\n')
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        small = make_grid('graded', 3, folder)
        scipy_modes(small, small.quadratic(), MODES, False)
        scipy_static(small, small.quadratic())
        compare_modes(report, folder)
        study(report, folder)
        compare_solvers(report, folder)
    first_mode(report)
    compliance(report)
    report.save()


main()
