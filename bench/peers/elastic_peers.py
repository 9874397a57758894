"""The same grids solved by scikit-fem with SciPy and by CalculiX, and SciPy's solvers on the same matrix."""
import subprocess
import time

import numpy as np
import skfem
from scipy.linalg import cho_solve_banded, cholesky_banded
from scipy.sparse.linalg import LinearOperator, eigsh, splu
from skfem.helpers import ddot, dot, eye, sym_grad, trace

YOUNG, POISSON, DENSITY, WIDTH = 2.15e11, 0.3, 8750.0, 0.125
SHEAR = YOUNG / (2 * (1 + POISSON))
FIRST = YOUNG * POISSON / (1 - POISSON**2)  # plane stress


class Grid:
    """As `elastic grid` writes it: nodes of each element corners first, then midsides."""

    def __init__(self, path):
        with path.open() as lines:
            nodes, elements = map(int, next(lines).split())
            table = np.loadtxt(lines, max_rows=nodes)
            self.element = np.loadtxt(lines, dtype=int).reshape(elements, 8) - 1
        self.x, self.load, self.reading = table[:, :2], table[:, 2:4], table[:, 4:6]
        self.held, self.root = table[:, 6] > 0, table[:, 7] > 0

    def quadratic(self):
        """The same curved elements for scikit-fem: a middle node where the eight others map to."""
        corners, index = np.unique(self.element[:, :4], return_inverse=True)
        straight = skfem.MeshQuad(self.x[corners].T.copy(), index.reshape(-1, 4).T.copy())
        mesh = skfem.MeshQuad2.from_mesh(straight)
        places = mesh.doflocs.copy()
        points = self.x[self.element]
        places[:, mesh.dofs.element_dofs[:8]] = points.transpose(2, 1, 0)
        places[:, mesh.dofs.element_dofs[8]] = (points[:, 4:].sum(1) / 2 - points[:, :4].sum(1) / 4).T
        return skfem.MeshQuad2(places, mesh.t)


@skfem.BilinearForm
def stiffness(u, v, _):
    strain = sym_grad(u)
    return WIDTH * ddot(2 * SHEAR * strain + FIRST * eye(trace(strain), 2), sym_grad(v))


@skfem.BilinearForm
def mass(u, v, _):
    return WIDTH * DENSITY * dot(u, v)


class Assembled:
    """Basis, stiffness and free unknowns by scikit-fem."""

    def __init__(self, grid, mesh):
        self.basis = skfem.Basis(mesh, skfem.ElementVector(skfem.ElementQuadS2()), intorder=5)
        self.stiffness = stiffness.assemble(self.basis)
        node = {tuple(p): i for i, p in enumerate(grid.x)}
        self.node = np.array([node[tuple(p)] for p in self.basis.doflocs.T])  # of each unknown
        self.direction = np.zeros(len(self.node), int)
        for dofs in (self.basis.nodal_dofs, self.basis.facet_dofs):
            self.direction[dofs[1]] = 1
        self.free = np.flatnonzero(~grid.held[self.node])

    def matrix(self):
        return self.stiffness[self.free][:, self.free]

    def gathered(self, at_nodes):
        return at_nodes[self.node, self.direction]


def symmetric_factor(matrix):
    """SuperLU told what it could know: a symmetric order of elimination, no pivoting."""
    return splu(matrix.tocsc(), permc_spec='MMD_AT_PLUS_A', diag_pivot_thresh=0, options={'SymmetricMode': True})


def scipy_modes(grid, mesh, count, symmetric):
    """Seconds of assembly and of the rest, frequencies."""
    start = time.perf_counter()
    body = Assembled(grid, mesh)
    k, m = body.matrix(), mass.assemble(body.basis)[body.free][:, body.free]
    assembled = time.perf_counter()
    inverse = LinearOperator(k.shape, symmetric_factor(k).solve) if symmetric else None
    values = eigsh(k, count, m, sigma=0, OPinv=inverse, tol=1e-8, return_eigenvectors=True)[0]
    done = time.perf_counter()
    return assembled - start, done - assembled, np.sqrt(np.sort(values)) / (2 * np.pi)


def scipy_static(grid, mesh):
    """Largest root tension and deflection at depth under the load; seconds for both and for the second."""
    start = time.perf_counter()
    body = Assembled(grid, mesh)
    u = np.zeros(len(body.node))
    u[body.free] = symmetric_factor(body.matrix()).solve(body.gathered(grid.load)[body.free])
    deflection = body.gathered(grid.reading) @ u
    deflected = time.perf_counter() - start
    strain = sym_grad(body.basis.interpolate(u))
    law = 2 * SHEAR * strain + FIRST * eye(trace(strain), 2)
    scalar = body.basis.with_element(skfem.ElementQuadS2())
    xx, yy, xy = (scalar.project(component) for component in (law[0, 0], law[1, 1], law[0, 1]))
    largest = (xx + yy) / 2 + np.hypot((xx - yy) / 2, xy)
    root = {tuple(p) for p in grid.x[grid.root]}
    tension = max(value for value, p in zip(largest, scalar.doflocs.T) if tuple(p) in root)
    return tension, deflection, time.perf_counter() - start, deflected


def write_deck(grid, folder, step):
    """Thin, as CalculiX makes bricks of plane elements and a thick section is stiffer than plane stress."""
    thickness = 0.01 * np.linalg.norm(grid.x[grid.element[:, 1]] - grid.x[grid.element[:, 0]], axis=1).min()
    with (folder / 'section.inp').open('w') as deck:
        deck.write('*NODE, NSET=ALL\n')
        deck.writelines(f'{i + 1}, {p[0]:.12e}, {p[1]:.12e}, 0\n' for i, p in enumerate(grid.x))
        deck.write('*ELEMENT, TYPE=CPS8, ELSET=BODY\n')
        deck.writelines(f'{i + 1}, ' + ', '.join(map(str, nodes + 1)) + '\n' for i, nodes in enumerate(grid.element))
        for name, chosen in (('HELD', grid.held), ('ROOT', grid.root)):
            deck.write(f'*NSET, NSET={name}\n')
            deck.writelines(f'{i + 1},\n' for i in np.flatnonzero(chosen))
        deck.write(f'*BOUNDARY\nHELD, 1, 2\n*MATERIAL, NAME=STEEL\n*ELASTIC\n{YOUNG}, {POISSON}\n*DENSITY\n{DENSITY}\n'
                   f'*SOLID SECTION, ELSET=BODY, MATERIAL=STEEL\n{thickness:.9e}\n*STEP\n')
        if step == 'static':
            deck.write('*STATIC\n*CLOAD\n')
            deck.writelines(f'{n + 1}, {d + 1}, {grid.load[n, d] * thickness / WIDTH:.12e}\n' for n, d in np.argwhere(grid.load))
            deck.write('*NODE FILE, OUTPUT=2D, NSET=ALL\nU\n*EL FILE, OUTPUT=2D, NSET=ROOT\nS\n')
        else:
            deck.write(f'*FREQUENCY\n{step}\n')
        deck.write('*END STEP\n')


def run_calculix(folder):
    """Seconds of the whole program."""
    start = time.perf_counter()
    subprocess.run(['ccx', '-i', 'section'], cwd=folder, check=True, stdout=subprocess.DEVNULL)
    return time.perf_counter() - start


def calculix_modes(grid, folder, count):
    """Seconds and frequencies; it writes nothing else."""
    write_deck(grid, folder, count)
    seconds = run_calculix(folder)
    rows = [line.split() for line in (folder / 'section.dat').read_text().splitlines()]
    return seconds, np.array([float(row[3]) for row in rows if len(row) == 5 and row[0].isdigit()][:count])


def calculix_static(grid, folder):
    """Largest root tension and deflection at depth, seconds."""
    write_deck(grid, folder, 'static')
    seconds = run_calculix(folder)
    values = read_frd(folder / 'section.frd')
    u = np.zeros_like(grid.x)
    for node, (x, y, *_) in values['DISP'].items():
        u[node - 1] = x, y
    tension = max((s[0] + s[1]) / 2 + np.hypot((s[0] - s[1]) / 2, s[3]) for s in values['STRESS'].values())
    return tension, (grid.reading * u).sum(), seconds


def read_frd(path):
    """Values of each result at the nodes."""
    results, name = {}, None
    for line in path.read_text().splitlines():
        if line.startswith(' -4'):
            name = line.split()[1]
            results[name] = {}
        elif line.startswith(' -3'):
            name = None
        elif line.startswith(' -1') and name:
            results[name][int(line[3:13])] = [float(line[i:i + 12]) for i in range(13, len(line) - 11, 12)]
    return results


def banded(matrix, order):
    """Upper band storage of a symmetric matrix with its rows in another order."""
    place = np.empty(len(order), int)
    place[order] = np.arange(len(order))
    entries = matrix.tocoo()
    i, j = place[entries.row], place[entries.col]
    width = np.abs(i - j).max()
    band = np.zeros((width + 1, len(order)))
    upper = i <= j
    band[width + i[upper] - j[upper], j[upper]] = entries.data[upper]
    return band


def solvers(grid, mesh, loads):
    """For each of SciPy's solvers: name, seconds to factor, for one and for all right sides, deflection at depth."""
    body = Assembled(grid, mesh)
    matrix, load, reading = body.matrix(), body.gathered(grid.load)[body.free], body.gathered(grid.reading)[body.free]
    order = np.lexsort((body.direction[body.free], body.node[body.free]))  # gearsweep's
    band = banded(matrix, order)

    def banded_solver():
        factor = cholesky_banded(band)
        return lambda right: cho_solve_banded((factor, False), right)

    contenders = [('splu', lambda: splu(matrix.tocsc()).solve, slice(None)),
                  ('splu, symmetric', lambda: symmetric_factor(matrix).solve, slice(None)),
                  ('cholesky_banded', banded_solver, order)]
    for name, factor, rows in contenders:
        start = time.perf_counter()
        solve = factor()
        factored = time.perf_counter()
        x = solve(load[rows])
        one = time.perf_counter()
        solve(np.tile(load[rows][:, None], (1, loads)))
        yield name, factored - start, one - factored, time.perf_counter() - one, reading[rows] @ x
