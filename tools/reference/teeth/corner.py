"""Contact beside a tip corner: two elastic bodies of true shape, unilateral, found to its own load distribution.

The tooth with the corner deflects as its finite elements say (`corner_bed`), the mate's smooth flank as a half-plane with
the mate's elements behind it.  Pressures are linear between the vertices of the grid on the flank, which come closer
and closer towards the corner, and act along the mate's normal.
"""
from math import pi

import numpy as np


def half_plane(arc, young):
    """Displacements at points of a straight surface by tractions of hat shape between them (gauge length 1 mm)."""
    def first(u):
        return np.where(u == 0, 0.0, u * np.log(np.abs(u) + (u == 0)) - u)

    def second(u):
        return np.where(u == 0, 0.0, u**2 / 2 * np.log(np.abs(u) + (u == 0)) - u**2 / 4)

    n = len(arc)
    out = np.zeros((n, n))
    for k in range(n - 1):
        a, b = arc[k] - arc, arc[k + 1] - arc
        zeroth, moment = first(b) - first(a), second(b) - second(a)
        rising = (moment - a * zeroth) / (arc[k + 1] - arc[k])
        out[:, k] += zeroth - rising
        out[:, k + 1] += rising
    return -2 / (pi * young) * out


class Corner:
    """The pair's contact near a tip corner, at s below 0 or a little above (the gear's tip), or about the contact ratio."""

    def __init__(self, pair, gears, end, depth):
        """`end` 0 for A, 1 for E; `depth` in mm from the corner is how far the contact may reach."""
        self.pair, self.gears, self.end = pair, gears, end
        self.owner = 1 - end
        self.arc, self.rolls, self.whole, self.bed = gears[self.owner].corner_bed(depth)
        self.young = gears[0].material.constants()[0]
        self.kernel = half_plane(self.arc, self.young)

    def gaps(self, s):
        """Gap and tilt at each vertex, and the mate's roll length at its foot."""
        pair, rolled = self.pair, self.rolls[0]
        lowest = self.gears[self.end].lowest
        found = []
        for r in self.rolls:                                   # further in, the mate has no flank to face the tooth
            try:
                found.append(pair.corner(s, rolled - r))
            except ValueError:
                found.append(dict(gap=1.0, tilt=0.0, foot=0.0))
            if found[-1]['foot'] < lowest * (1 - 1e-9):
                found[-1].update(gap=1.0, foot=lowest)
        gap = np.array([c['gap'] for c in found])
        return gap, np.array([c['tilt'] for c in found]), np.array([c['foot'] for c in found])

    def law(self, s, loads):
        """Approaches (mm) along the mate's normal, from no load and no gap, at which the contact carries `loads` (N/mm).

        Returns them, and what belongs to no load: the least gap.
        """
        gap, tilt, foot = self.gaps(s)
        normals = np.array([self.gears[self.owner].place(r)[1] for r in self.rolls])
        c, d = np.cos(tilt), np.sin(tilt)
        inward = -np.column_stack([c * normals[:, 0] - d * normals[:, 1], d * normals[:, 0] + c * normals[:, 1]])
        mate = self.gears[1 - self.owner].own
        matrix = np.einsum('ik,ikjl,jl->ij', inward, self.bed, inward)
        matrix += self.kernel + self.whole[None, :] * mate((foot[:, None] + foot[None, :]) / 2)
        return np.array([self.approach(matrix, gap, load) for load in loads]), self.least(gap)

    def least(self, gap):
        """The least gap, between vertices by a parabola."""
        k = int(np.argmin(gap))
        if k in (0, len(gap) - 1):
            return gap[k]
        x, y = self.arc[k - 1:k + 2] - self.arc[k], gap[k - 1:k + 2] - gap[k]
        square, slope, _ = np.polyfit(x, y, 2)
        lower = -slope**2 / (4 * square) if square > 0 else 0.0
        return gap[k] + (lower if lower > -max(y[0], y[2]) else 0.0)

    def approach(self, matrix, gap, load):
        """The approach at which pressures that only press have this sum: vertices join and leave until all is in order."""
        n = len(gap)
        active = gap <= np.sort(gap)[2]
        for _ in range(200):
            k = np.flatnonzero(active)
            system = np.zeros((len(k) + 1, len(k) + 1))
            system[:-1, :-1] = matrix[np.ix_(k, k)]
            system[:-1, -1], system[-1, :-1] = -1, self.whole[k]
            x = np.linalg.solve(system, np.append(-gap[k], load))
            p, y = np.zeros(n), x[-1]
            p[k] = x[:-1]
            if p[k].min() < 0:
                active[k[p[k] < 0]] = False
                continue
            closed = ~active & (matrix @ p + gap - y < -1e-12)
            if not closed.any():
                self.pressure = p
                if active[-1]:
                    raise ValueError('the contact reaches beyond its bed')
                return y
            # The worst first: neighbours of what is in contact follow by themselves.
            active[np.argmin(np.where(closed, matrix @ p + gap - y, 0))] = True
        raise ValueError('no contact found')
