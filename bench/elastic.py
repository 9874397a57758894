"""Times the finite elements beside scikit-fem with SciPy and beside CalculiX.

    python bench/compare.py ELASTIC        (bench/run.sh sets up and does this)

ELASTIC is the program made from bench/elastic.f90. Prints a Markdown table.
Every repeat takes each contender once, in turn, so that a busy machine slows
all alike; medians are shown. Only Python's contenders import their libraries
and warm up beforehand.
"""
import datetime
import pathlib
import platform
import re
import subprocess
import sys
import tempfile
import time
from statistics import median

import numpy as np
import scipy
import skfem
from scipy.sparse.linalg import LinearOperator, eigsh, splu
from skfem.helpers import ddot, dot, eye, sym_grad, trace

MODES = 10
YOUNG, POISSON, DENSITY, WIDTH = 2.15e11, 0.3, 8750.0, 0.125
# Elements across a tooth: some 2e3, 2e4 and 1e5 unknowns.
GRIDS = {6: 9, 19: 5, 42: 3}  # and repeats
FIRST_GRIDS, FIRST_FINEST = (3, 4, 6, 8, 10, 12, 13, 14, 16, 24, 32), 64
# Elements across the loaded tooth and the others, places of the load.
PATHS = ((6, 3, 9), (8, 4, 9), (10, 4, 17), (12, 4, 17), (14, 4, 17), (16, 4, 17), (20, 5, 17), (24, 8, 17), (32, 12, 33))
PATH_FINEST = (64, 24, 49)
REPEATS = 5
elastic = sys.argv[1]


def run_elastic(*arguments):
    answer = subprocess.run([elastic, *map(str, arguments)], capture_output=True, text=True, check=True)
    return np.array(answer.stdout.split(), dtype=float)


class Grid:
    """As bench/elastic.f90 writes it: nodes of each element corners first, then midsides."""

    def __init__(self, across, folder):
        path = folder / 'grid'
        run_elastic('grid', across, path)
        with path.open() as lines:
            nodes, elements = map(int, next(lines).split())
            table = np.loadtxt(lines, max_rows=nodes)
            self.element = np.loadtxt(lines, dtype=int).reshape(elements, 8) - 1
        self.x, self.held = table[:, :2], table[:, 2] > 0


def quadratic_mesh(grid):
    """The same curved elements: a middle node where the eight others map to."""
    corners, index = np.unique(grid.element[:, :4], return_inverse=True)
    straight = skfem.MeshQuad(grid.x[corners].T.copy(), index.reshape(-1, 4).T.copy())
    mesh = skfem.MeshQuad2.from_mesh(straight)
    places = mesh.doflocs.copy()
    points = grid.x[grid.element]
    places[:, mesh.dofs.element_dofs[:8]] = points.transpose(2, 1, 0)
    places[:, mesh.dofs.element_dofs[8]] = (points[:, 4:].sum(1) / 2 - points[:, :4].sum(1) / 4).T
    return skfem.MeshQuad2(places, mesh.t)


def scipy_modes(grid, mesh, symmetric):
    """Seconds of assembly and of the rest, frequencies. `symmetric` tells SuperLU what it
    could know: a symmetric order of elimination, no pivoting."""
    start = time.perf_counter()
    basis = skfem.Basis(mesh, skfem.ElementVector(skfem.ElementQuadS2()), intorder=5)
    shear = YOUNG / (2 * (1 + POISSON))
    first = YOUNG * POISSON / (1 - POISSON**2)  # plane stress

    @skfem.BilinearForm
    def stiffness(u, v, _):
        strain = sym_grad(u)
        return ddot(2 * shear * strain + first * eye(trace(strain), 2), sym_grad(v))

    @skfem.BilinearForm
    def mass(u, v, _):
        return DENSITY * dot(u, v)

    k, m = stiffness.assemble(basis), mass.assemble(basis)
    held = {tuple(p) for p in grid.x[grid.held]}
    fixed = [i for i, p in enumerate(basis.doflocs.T) if tuple(p) in held]
    k, m = skfem.condense(k, m, D=np.array(fixed), expand=False)
    assembled = time.perf_counter()
    inverse = None
    if symmetric:
        factor = splu(k.tocsc(), permc_spec='MMD_AT_PLUS_A', diag_pivot_thresh=0, options={'SymmetricMode': True})
        inverse = LinearOperator(k.shape, factor.solve)
    values = eigsh(k, MODES, m, sigma=0, OPinv=inverse, tol=1e-8, return_eigenvectors=True)[0]
    done = time.perf_counter()
    return assembled - start, done - assembled, np.sqrt(np.sort(values)) / (2 * np.pi)


def write_deck(grid, folder):
    """Thin, as CalculiX makes bricks of plane elements and a thick section is stiffer than plane stress."""
    thickness = 0.01 * np.linalg.norm(grid.x[grid.element[:, 1]] - grid.x[grid.element[:, 0]], axis=1).min()
    with (folder / 'section.inp').open('w') as deck:
        deck.write('*NODE, NSET=ALL\n')
        deck.writelines(f'{i + 1}, {p[0]:.12e}, {p[1]:.12e}, 0\n' for i, p in enumerate(grid.x))
        deck.write('*ELEMENT, TYPE=CPS8, ELSET=BODY\n')
        deck.writelines(f'{i + 1}, ' + ', '.join(map(str, nodes + 1)) + '\n' for i, nodes in enumerate(grid.element))
        deck.write('*NSET, NSET=HELD\n')
        deck.writelines(f'{i + 1},\n' for i in np.flatnonzero(grid.held))
        deck.write(f'*BOUNDARY\nHELD, 1, 2\n*MATERIAL, NAME=STEEL\n*ELASTIC\n{YOUNG}, {POISSON}\n*DENSITY\n{DENSITY}\n'
                   f'*SOLID SECTION, ELSET=BODY, MATERIAL=STEEL\n{thickness:.9e}\n'
                   f'*STEP\n*FREQUENCY\n{MODES}\n*END STEP\n')


def calculix_modes(folder):
    """Seconds of the whole program, which writes nothing but the frequencies."""
    start = time.perf_counter()
    subprocess.run(['ccx', '-i', 'section'], cwd=folder, check=True, stdout=subprocess.DEVNULL)
    seconds = time.perf_counter() - start
    rows = [line.split() for line in (folder / 'section.dat').read_text().splitlines()]
    return seconds, np.array([float(row[3]) for row in rows if len(row) == 5 and row[0].isdigit()][:MODES])


def times(values):
    return ' | '.join('%.3g' % value for value in values)


def compare_modes(folder):
    print('## Ten modes on the same grid\n\n'
          'Seconds, from the grid to frequencies and shapes; CalculiX includes reading its deck. Ratios of the\n'
          'medians. SciPy\'s factor is within eigen: `eigsh` as it comes, then with SuperLU told of the symmetry.\n'
          'Last column: largest relative difference of the ten frequencies from gearsweep\'s.\n')
    print('| unknowns | repeats | | assembly | factor | eigen | all | gearsweep is faster by | differs by |')
    print('|---|---|---|---|---|---|---|---|---|')
    for across, repeats in GRIDS.items():
        grid = Grid(across, folder)
        mesh = quadratic_mesh(grid)
        write_deck(grid, folder)
        own, plain, told, deck = [], [], [], []
        for _ in range(repeats):
            own.append(run_elastic('modes', across, MODES))
            plain.append(scipy_modes(grid, mesh, False))
            told.append(scipy_modes(grid, mesh, True))
            deck.append(calculix_modes(folder))
        unknowns, stages = int(own[0][0]), np.array(own)[:, 2:5]
        frequency = own[0][6:]
        whole = median(stages.sum(1))
        print(f'| {unknowns} | {repeats} | gearsweep | {times(np.median(stages, 0))} | {whole:.3g} | | |')
        for name, runs in (('scikit-fem, SciPy', plain), ('the same, symmetric', told)):
            both = median(run[0] + run[1] for run in runs)
            print(f'| | | {name} | {median(run[0] for run in runs):.3g} | | {median(run[1] for run in runs):.3g}'
                  f' | {both:.3g} | {both / whole:.1f} | {apart(runs[0][2], frequency):.1e} |')
        both = median(run[0] for run in deck)
        print(f'| | | CalculiX | | | | {both:.3g} | {both / whole:.1f} | {apart(deck[0][1], frequency):.1e} |', flush=True)


def apart(a, b):
    return np.abs(a / b - 1).max()


def rounds(command, grids):
    """Answers of the first round for each grid, medians of the times at `place`."""
    return [[run_elastic(command, *grid) for grid in grids] for _ in range(REPEATS)]


def time_at(aim, errors, seconds):
    """Of the cheapest grid from which on every finer one keeps the aim as well."""
    kept = [i for i in range(len(errors)) if max(errors[i:]) <= aim]
    return min((seconds[i] for i in kept), default=float('nan'))


def first_mode():
    runs = np.array(rounds('first', [(n,) for n in FIRST_GRIDS]))
    exact = run_elastic('first', FIRST_FINEST)[1]
    seconds = np.median(runs, 0)
    errors = np.abs(runs[0, :, 1] / exact - 1)
    print('\n## First mode of Hassan\'s section: error against time\n\n'
          f'Grid included. Error against a grid of {FIRST_FINEST} elements across a tooth ({exact:.3f} Hz).\n')
    print('| across | unknowns | Hz | error | own estimate | s | s with estimate |\n|---|---|---|---|---|---|---|')
    for n, row, error, taken in zip(FIRST_GRIDS, runs[0], errors, seconds):
        print(f'| {n} | {int(row[0])} | {row[1]:.3f} | {error:.1e} | {row[2]:.1e} | {times(taken[3:])} |')
    print(f'\nTo 1e-4: {time_at(1e-4, errors, seconds[:, 3]):.3f} s, with the estimate '
          f'{time_at(1e-4, errors, seconds[:, 4]):.3f} s.')


def compliance():
    runs = np.array(rounds('compliance', PATHS))
    exact = run_elastic('compliance', *PATH_FINEST)[1:]
    seconds = np.median(runs[:, :, 0], 0)
    errors = [apart(row[1:], exact) for row in runs[0]]
    print('\n## Pair compliance along the path: error against time\n\n'
          'Dogan\'s case 1; equal gears, hence one gear\'s time. Largest error over 101 points of the path against\n'
          f'{PATH_FINEST[0]} and {PATH_FINEST[1]} elements across, {PATH_FINEST[2]} places.\n')
    print('| across | other teeth | places | error | ms a gear |\n|---|---|---|---|---|')
    for path, error, taken in zip(PATHS, errors, seconds):
        print(f'| {path[0]} | {path[1]} | {path[2]} | {error:.1e} | {1000 * taken:.3g} |')
    print(f'\nTo 0.1 %: {1000 * time_at(1e-3, errors, seconds):.3g} ms a gear.')


def first_line(*command):
    answer = subprocess.run(command, capture_output=True, text=True)
    return (answer.stdout + answer.stderr).strip().splitlines()[0].strip()


def head():
    cpu = re.search(r'model name\s*: (.*)', pathlib.Path('/proc/cpuinfo').read_text())
    blas = first_line('dpkg-query', '-W', '-f', '${Package} ${Version}', 'libopenblas0-pthread')
    print(f'# Finite elements: how fast\n\n{datetime.date.today()}, {cpu[1] if cpu else platform.processor()},'
          f' one thread. {first_line("gfortran", "--version")}; {blas}.\n'
          f'Python {platform.python_version()}, NumPy {np.__version__}, SciPy {scipy.__version__},'
          f' scikit-fem {skfem.__version__}; CalculiX {first_line("ccx", "-v").split()[-1]}.\n')


with tempfile.TemporaryDirectory() as name:
    small = Grid(3, pathlib.Path(name))
    scipy_modes(small, quadratic_mesh(small), False)
    head()
    compare_modes(pathlib.Path(name))
first_mode()
compliance()
