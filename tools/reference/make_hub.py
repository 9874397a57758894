"""Write hub.dat: natural frequencies of a gear with inertia at its bore, by finite elements of the whole gear.

    python tools/reference/make_hub.py

needs numpy 2.4 and scipy 1.17, one thread and half a minute.  The gear's bore turns as a rigid ring with the inertia of hub and shaft;
two neighbouring teeth push with half of the load each against a spring to the ground, the other half of a pair of equal
gears that vibrate against each other.  The grid is that of the folder teeth, the mass consistent.
"""
from math import hypot, pi, radians, sqrt
from pathlib import Path

import numpy as np
from scipy.sparse import coo_matrix, csc_matrix
from scipy.sparse.linalg import eigsh
from teeth.body import POINTS, WEIGHTS, Body, Material, slopes
from teeth.gears import Gear
from teeth.grid import section

TEETH, MODULE, DENSITY = 25, 3.18, 7.85e-9                    # t/mm^3
BORES = {20.0: 20.3e3, 10.0: 18.3e3, 5.0: 17.4e3}             # radius, mm: mean mesh stiffness per mm of face width, MPa
RATIOS = 0.0, 0.5, 1.0, 5.0                                   # inertia at the bore over that of the gear
HEAD = f"""\
# Natural frequencies of a gear with inertia at its bore, by finite elements of the whole gear: tools/reference/make_hub.py.
# Gear: {TEETH} teeth of {MODULE} mm, rack 1.25 and 0.25, steel (206 GPa, 0.3, 7850 kg/m3), plane strain.
# Radius of the bore [mm]; mean stiffness of the mesh of two such gears, without their turning [N/(mm um)]; effective
# mass of the gear on the line of action [kg per mm of width]; its inertia at the bore over its own; natural frequency of the
# whole model; the same with all inertia in one rigid body [Hz]; turn about the held bore under a load on one tooth, half a
# base pitch before the pitch point [um mm/N].
"""


def assembled(body, grid):
    """Stiffness and consistent mass of the grid, nothing held."""
    tri = grid.triangles
    corners = grid.points[tri]
    mass = np.zeros((len(tri), 12, 12))
    for (r, s), w in zip(POINTS, WEIGHTS):
        t = 1 - r - s
        shape = np.array([t * (2 * t - 1), r * (2 * r - 1), s * (2 * s - 1), 4 * t * r, 4 * r * s, 4 * s * t])
        jac = np.einsum('ki,eij->ekj', slopes(r, s), corners)
        mass += (DENSITY * w * np.linalg.det(jac))[:, None, None] * np.kron(np.outer(shape, shape), np.eye(2))
    where = np.repeat(body.dofs, 12, axis=1).ravel(), np.tile(body.dofs, (1, 12)).ravel()
    n = 2 * len(grid.points)
    return [coo_matrix((part.ravel(), where), shape=(n, n)).tocsc() for part in (body.element, mass)]


def push(body, gear, n):
    """Half of a unit load on each of two neighbouring teeth, a base pitch apart on the line of action; a column for each."""
    base = gear.base[0]
    low, high = (sqrt(r**2 - base**2) for r in (gear.form[0], gear.tip))
    middle = gear.reference * np.sin(radians(20))
    load = np.zeros((n, 2))
    for tooth, away in ((0, -0.5), (1, 0.5)):
        for roll in (middle + away * base * gear.pitch, middle - away * base * gear.pitch):
            if low < roll < high:
                radius = hypot(base, roll)
                point = gear.flank(0, radius)
                polar = np.arctan2(point[1], point[0]) + np.arccos(base / radius)
                normal = body.turn(tooth) @ np.array([np.sin(polar), -np.cos(polar)])
                nodes, shape = body.surface(tooth, 'flank', 1 - (roll - low) / (high - low))
                for v, f in zip(nodes, shape):
                    load[2 * v:2 * v + 2, tooth] -= f / 2 * normal
                break
    return load


def frequencies(bore, mesh):
    """Rows of the table for one bore."""
    gear = Gear(TEETH, MODULE, (radians(20),) * 2)
    grid = section(gear, bore, 0, 0.25 * MODULE, 0.1 * MODULE, 0.25)
    body = Body(grid, Material(), ('rim',), gear.pitch)
    stiffness, mass = assembled(body, grid)
    n = stiffness.shape[0]
    loads = push(body, gear, n)
    load = loads.sum(axis=1)
    turned = np.zeros(n)
    turned[0::2], turned[1::2] = -grid.points[:, 1], grid.points[:, 0]
    turned /= load @ turned                                   # moves the load's line by 1
    own = turned @ (mass @ turned)
    moved = body.solve(loads).T
    turns = 2 * moved @ (mass @ turned) / own                 # the mean over the mass, bore held
    beyond = 0.5 / mesh - (moved.sum(axis=0) @ load - turns.mean())     # compliance of the spring: the rest of half a mesh
    # Unknowns: the free ones, and the bore's turning.
    rim = np.setdiff1d(np.arange(n), body.free)
    m = len(body.free)
    onto = coo_matrix((np.r_[np.ones(m), turned[rim]], (np.r_[body.free, rim], np.r_[np.arange(m), np.full(len(rim), m)])),
                      shape=(n, m + 1)).tocsc()
    against = csc_matrix(onto.T @ load[:, None])
    for ratio in RATIOS:
        hub = csc_matrix(([ratio * own], ([m], [m])), shape=(m + 1, m + 1))
        rigid = sqrt(2 * mesh / (own * (1 + ratio)))
        found = eigsh((onto.T @ stiffness @ onto + against @ against.T / beyond).tocsc(), 3, (onto.T @ mass @ onto + hub).tocsc(),
                      sigma=0.8 * rigid**2, return_eigenvectors=False)
        yield bore, mesh * 1e-3, own * 1e3, ratio, sqrt(found.min()) / (2 * pi), rigid / (2 * pi), turns[0] * 1e3, beyond


def main():
    with (Path(__file__).parents[2] / 'test/reference/hub.dat').open('w') as file:
        file.write(HEAD)
        for bore, mesh in BORES.items():
            for row in frequencies(bore, mesh):
                assert row[-1] > 0
                file.write('{:g} {:.4g} {:.6e} {:g} {:.2f} {:.2f} {:.6e}\n'.format(*row[:-1]))
                print(*row, flush=True)


if __name__ == '__main__':
    main()
