"""Linear elasticity on a section of a gear, and what a load on a flank moves: exact where the load acts.

The displacement under a line load has no limit in finite elements.  So near a load the field is split: Flamant's closed
form for a half-plane, which has the singularity, and a remainder, smooth, which the elements find (singularity
subtraction, as in Szabo and Babuska, Finite Element Analysis, 1991, ch. 10).  Elements near the load carry the remainder,
all others the whole field; where they meet, the closed form is the difference.  Loads and displacements are per mm of
face width, in N/mm and mm.
"""
from dataclasses import dataclass
from itertools import pairwise
from math import pi

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import splu

# Six points of a triangle, exact to the fourth degree (Cowper 1973).
_A, _B = 0.445948490915965, 0.091576213509771
POINTS = np.array([[_A, _A], [1 - 2 * _A, _A], [_A, 1 - 2 * _A], [_B, _B], [1 - 2 * _B, _B], [_B, 1 - 2 * _B]])
WEIGHTS = np.repeat([0.223381589678011, 0.109951743655322], 3) / 2
LINE, LINE_WEIGHTS = np.polynomial.legendre.leggauss(6)


def slopes(r, s):
    """Derivatives of the six shape functions by the two coordinates of the triangle."""
    t = 1 - r - s
    by_r = np.array([1 - 4 * t, 4 * r - 1, 0, 4 * (t - r), 4 * s, -4 * s])
    by_s = np.array([1 - 4 * t, 0, 4 * s - 1, -4 * r, 4 * r, 4 * (t - s)])
    return np.array([by_r, by_s])


def on_edge(x):
    """Shape functions of the ends and the middle at x from -1 to 1."""
    return np.array([x * (x - 1) / 2, x * (x + 1) / 2, 1 - x**2])


@dataclass
class Material:
    young: float = 206e3      # MPa
    poisson: float = 0.3
    plane: str = 'strain'

    def constants(self):
        """Young's modulus and Poisson's ratio of the plane problem as if it were plane stress."""
        if self.plane == 'strain':
            return self.young / (1 - self.poisson**2), self.poisson / (1 - self.poisson)
        return self.young, self.poisson


def flamant(points, at, inward, material):
    """Displacements and stresses (xx, yy, xy) of a unit load in direction `inward` on a half-plane, gauge length 1 mm.

    Timoshenko and Goodier, Theory of Elasticity, art. 36; the surface sinks by -2/(pi E) ln r.
    """
    young, nu = material.constants()
    side = np.array([-inward[1], inward[0]])
    d = points - at
    x, y = d @ inward, d @ side
    r = np.hypot(x, y)
    theta = np.arctan2(y, x)
    c, s, log = np.cos(theta), np.sin(theta), np.log(r)
    k = 1 / (pi * young)
    radial = k * (-2 * c * log - (1 - nu) * theta * s + (1 + nu) * c)
    across = k * (2 * s * log + 2 * nu * s - (1 - nu) * theta * c + (1 - nu) * s - (1 + nu) * s)
    e_r = np.outer(c, inward) + np.outer(s, side)
    e_t = np.outer(-s, inward) + np.outer(c, side)
    moved = radial[:, None] * e_r + across[:, None] * e_t
    stress = -2 * c / (pi * r)
    return moved, stress[:, None] * np.column_stack([e_r[:, 0]**2, e_r[:, 1]**2, e_r[:, 0] * e_r[:, 1]])


class Body:
    """A grid with its stiffness factored, held at `sides` and/or `rim`."""

    def __init__(self, grid, material, fixed, pitch):
        self.grid, self.material, self.pitch = grid, material, pitch
        young, nu = material.constants()
        law = young / (1 - nu**2) * np.array([[1, nu, 0], [nu, 1, 0], [0, 0, (1 - nu) / 2]])
        p, tri = grid.points, grid.triangles
        xy = p[tri]
        stiffness = np.zeros((len(tri), 12, 12))
        for (r, s), w in zip(POINTS, WEIGHTS):
            by = slopes(r, s)
            jac = np.einsum('ki,eij->ekj', by, xy)
            det = np.linalg.det(jac)
            if det.min() <= 0:
                raise ValueError('a folded triangle')
            g = np.linalg.solve(jac, np.broadcast_to(by, (len(tri), 2, 6)))
            strain = np.zeros((len(tri), 3, 12))
            strain[:, 0, 0::2] = strain[:, 2, 1::2] = g[:, 0]
            strain[:, 1, 1::2] = strain[:, 2, 0::2] = g[:, 1]
            stiffness += (w * det)[:, None, None] * (strain.transpose(0, 2, 1) @ law @ strain)
        self.element = stiffness
        self.dofs = np.stack([2 * tri, 2 * tri + 1], axis=2).reshape(len(tri), 12)
        n = 2 * len(p)
        rows = np.repeat(self.dofs, 12, axis=1).ravel()
        columns = np.tile(self.dofs, (1, 12)).ravel()
        matrix = coo_matrix((stiffness.ravel(), (rows, columns)), shape=(n, n)).tocsc()
        held = np.concatenate([getattr(grid, what) for what in fixed]).astype(int)
        free = np.ones(n, bool)
        free[2 * held] = free[2 * held + 1] = False
        self.free = np.flatnonzero(free)
        self.factor = splu(matrix[self.free][:, self.free], permc_spec='MMD_AT_PLUS_A', options=dict(SymmetricMode=True),
                           diag_pivot_thresh=0.0)
        self.centroids = xy[:, :3].mean(axis=1)
        self.table = {(e[3], e[4]): [] for e in grid.edges}
        for e in grid.edges:
            self.table[e[3], e[4]].append(e)

    def solve(self, load):
        """Displacements (nodes, 2, ...) under nodal loads (nodes * 2, ...)."""
        out = np.zeros_like(load)
        out[self.free] = self.factor.solve(np.ascontiguousarray(load[self.free]))
        return out

    def turn(self, tooth):
        """Matrix that turns the middle tooth's vectors into those of another tooth."""
        a = -tooth * self.pitch
        return np.array([[np.cos(a), -np.sin(a)], [np.sin(a), np.cos(a)]])

    def surface(self, tooth, piece, t):
        """Nodes and shape functions of the point of a piece of a tooth's outline."""
        for e in self.table[piece, tooth]:
            if min(e[5], e[6]) - 1e-12 <= t <= max(e[5], e[6]) + 1e-12:
                return np.array(e[:3]), on_edge(2 * (t - e[5]) / (e[6] - e[5]) - 1)
        raise ValueError('not on the outline')

    def near_field(self, at, inward, radius):
        """Nodal loads of the remainder for a unit load, and the elements that carry it."""
        grid, tri = self.grid, self.grid.triangles
        near = np.hypot(*(grid.points[tri] - at).transpose(2, 0, 1)).min(axis=1) < radius
        chosen = np.flatnonzero(near)
        load = np.zeros(2 * len(grid.points))
        # Edges that one chosen element has alone bound their region.
        count = {}
        for e in chosen:
            t = tri[e]
            for a, b, m in ((t[0], t[1], t[3]), (t[1], t[2], t[4]), (t[2], t[0], t[5])):
                count.setdefault((min(a, b), max(a, b)), []).append((a, b, m))
        outline = {(min(e[0], e[1]), max(e[0], e[1])): e for e in grid.edges}
        between = set()
        for key, sides in count.items():
            if len(sides) > 1:
                continue
            a, b, m = sides[0]
            if key not in outline:
                between.update((a, b, m))
            self._traction(load, (a, b, m), outline.get(key), at, inward)
        between = np.array(sorted(between))
        moved = flamant(grid.points[between], at, inward, self.material)[0]
        field = np.zeros(2 * len(grid.points))
        field[2 * between], field[2 * between + 1] = moved[:, 0], moved[:, 1]
        add = np.einsum('eij,ej->ei', self.element[chosen], field[self.dofs[chosen]])
        np.add.at(load, self.dofs[chosen].ravel(), add.ravel())
        return load

    def _traction(self, load, nodes, outline, at, inward):
        """Takes the closed form's tractions off the region's edge; on the true curve where the edge is the outline's."""
        a, b, m = nodes
        p = self.grid.points
        parts = [(-1.0, 1.0)]
        gap = min(np.hypot(*(p[v] - at)) for v in nodes)
        if outline is not None and gap < 4 * np.hypot(*(p[a] - p[b])):
            cuts = np.linspace(-1, 1, 9)
            parts = list(pairwise(cuts))
        for lo, hi in parts:
            x = (lo + hi) / 2 + LINE * (hi - lo) / 2
            w = LINE_WEIGHTS * (hi - lo) / 2
            n = on_edge(x)
            if outline is None:
                pos = n.T @ p[[a, b, m]]
                by = np.array([x - 0.5, x + 0.5, -2 * x]).T @ p[[a, b, m]]
            else:
                e = outline
                flip = 1 if e[0] == a else -1
                t = (e[5] + e[6]) / 2 + flip * x * (e[6] - e[5]) / 2
                turn = self.turn(e[4])
                pos = np.array([turn @ e[7].point(v) for v in t])
                step = 1e-5 * (e[6] - e[5])
                by = np.array([turn @ (e[7].point(v + step) - e[7].point(v - step)) for v in t])
                by *= flip * (e[6] - e[5]) / (4 * step)
            stress = flamant(pos, at, inward, self.material)[1]
            normal = np.column_stack([by[:, 1], -by[:, 0]])            # outward, as triangles run counter-clockwise
            pull = np.column_stack([stress[:, 0] * normal[:, 0] + stress[:, 2] * normal[:, 1],
                                    stress[:, 2] * normal[:, 0] + stress[:, 1] * normal[:, 1]])
            share = (n * w) @ pull
            for v, f in zip((a, b, m), share):
                load[2 * v] -= f[0]
                load[2 * v + 1] -= f[1]
