"""Load distribution over the pairs of teeth in contact: all loads of both gears as one system.

At each phase the pairs within reach are known, with what each load moves each other contact by (both gears' elastic
bodies) and how each contact deflects under its own load: Hertz's flattening in closed form in the middle of a flank, and
beside a tip corner a contact problem of its own.  Loads press only: they and the rotation are found together.
Their rotation is counted along the line of action; half of it is either gear's.
"""
from dataclasses import dataclass
from itertools import combinations
from math import ceil, floor, log, pi, sqrt

import numpy as np
from scipy.interpolate import PchipInterpolator

from .corner import Corner


@dataclass
class Relief:
    """Linear tip relief of both gears (mm at the tip), from D and B on.

    It is what the flank lacks where the contact would be without it.  A relieved flank is also tilted, and so the contact moves
    by slope/curvature along the flank, where the gap is less by slope^2/(2 curvature): left out.
    """
    amount: float = 0.0

    def at(self, pair, which, s):
        """What the flank lacks where its roll length belongs to s."""
        whole = floor(pair.ratio)
        start, end = (whole, pair.ratio) if which == 0 else (pair.ratio - whole, 0.0)
        return self.amount * min(1.0, max(0.0, (s - start) / (end - start)))

    def both(self, pair, s):
        """What a contact lacks: beyond the path the corner of one, and the mate further up than at A or E."""
        if 0 <= s <= pair.ratio:
            return self.at(pair, 0, s) + self.at(pair, 1, s)
        c = pair.corner(s)
        mate = 1 - c['owner']
        foot = (c['foot'] - pair.start if mate == 0 else pair.path - c['foot'] - pair.start) / pair.base_pitch
        return self.amount + self.at(pair, mate, foot)


@dataclass
class Switches:
    corner: bool = False       # contact before A and behind E
    neighbours: bool = True    # what a load moves the other pairs' contacts by
    own_load: bool = True      # flattening by each pair's own load, not by the whole one


class Mesh:
    """Both gears of a pair with their elastic bodies; `force` is the load on the line of action, N/mm."""

    def __init__(self, pair, gears, force, before=0.25):
        self.pair, self.gears, self.force, self.before = pair, gears, force, before
        self.young = gears[0].material.constants()[0]
        self.ends = []
        for end in (0, 1):
            width = sqrt(8 * force * pair.curvature_radius(pair.ratio * end) / (pi * self.young))
            self.ends.append(Corner(pair, gears, end, 12 * width))
        # Up to so many half-widths of the contact from the tip corner the contact is solved by itself; up to twice as many,
        # part by part Hertz's.
        self.near = 3.0
        self.laws = {}

    def away(self, end, s):
        """Distance of the contact from the tip corner along its flank, in half-widths of the contact at full load."""
        pair, owner = self.pair, 1 - end
        base = pair.gears()[owner].base[0]
        tip, here = pair.roll(owner, pair.ratio * end), pair.roll(owner, s)
        width = sqrt(8 * self.force * pair.curvature_radius(min(pair.ratio, max(0.0, s))) / (pi * self.young))
        return (tip**2 - here**2) / (2 * base) / width

    def flattening(self, s, load):
        """Surface sinks under Hertz's pressure, both together, less the gauge length of Flamant's field; per load."""
        radius = self.pair.curvature_radius(s)
        half = sqrt(8 * load * radius / (pi * self.young))
        return -4 / (pi * self.young) * (log(half / 2) - 0.5)

    def hertz(self, s, load):
        return sum(m.own(self.pair.roll(k, s)) for k, m in enumerate(self.gears)) + self.flattening(s, load)

    def law(self, s):
        """Gap, and own compliance by the load; near a corner as its own contact says."""
        key = round(s, 9)
        if key not in self.laws:
            loads = self.force * np.array([0.06, 0.1, 0.16, 0.25, 0.35, 0.5, 0.75, 1.0, 1.3])
            far = [self.away(end, s) for end in (0, 1)]
            end = 0 if far[0] < far[1] else 1
            if min(far) < 2 * self.near:
                y, gap = self.ends[end].law(s, loads)
                own = (y - gap) / loads
                blend = min(1.0, max(0.0, min(far) / self.near - 1))
                if blend > 0:
                    smooth = np.array([self.hertz(s, p) for p in loads])
                    own = blend * smooth + (1 - blend) * own
                if 0 <= s <= self.pair.ratio:
                    gap = 0.0
            else:
                own, gap = np.array([self.hertz(s, p) for p in loads]), 0.0
            # Below the least of these loads as Hertz's flattening goes on.
            few = loads[0] * np.array([1e-4, 1e-3, 1e-2, 1e-1])
            own = [*(own[0] - 2 / (pi * self.young) * np.log(few / loads[0])), *own]
            self.laws[key] = gap, PchipInterpolator(np.log([*few, *loads]), own)
        gap, own = self.laws[key]
        return gap, lambda load: float(own(log(min(1.3, max(1e-5, load / self.force)) * self.force)))

    def spots(self, s):
        """The contact's spot on either gear, and by how much of their rotation along the line of action they approach there.

        At a corner the normal passes its own gear's centre at less than the base radius.  Half of the rotation is either
        gear's: otherwise the phase would be that of the one which stands still, and not the mean.
        """
        pair = self.pair
        if 0 <= s <= pair.ratio:
            return [m.spot(pair.roll(k, s)) for k, m in enumerate(self.gears)], 1.0
        c = pair.corner(s)
        owner = c['owner']
        spots = [None, None]
        spots[owner] = self.gears[owner].spot(None, c['tilt'])
        spots[1 - owner] = self.gears[1 - owner].spot(c['foot'])
        return spots, (1 + c['arm'] / pair.gears()[owner].base[0]) / 2

    def touching(self, phase, beyond, side):
        """Path coordinates of the pairs that may touch at a phase; where one enters or leaves there, as `side` says."""
        ratio, tiny = self.pair.ratio, 1e-9
        s = phase + np.arange(-ceil(beyond) - 1, ceil(ratio + beyond) + 1)
        s = s[(s >= -beyond - tiny) & (s <= ratio + beyond + tiny)]
        if beyond == 0:
            s = s[~((side < 0) & (s < tiny)) & ~((side > 0) & (s > ratio - tiny))]
            s = np.clip(s, 0.0, ratio)
        return s

    def influence(self, s, spots):
        """What a load on each contact moves the others by."""
        shared = np.zeros((len(s), len(s)))
        for i in range(len(s)):
            for j in range(len(s)):
                if i != j:
                    ahead = round(s[j] - s[i])                # on the pinion to the right, on the gear to the left
                    shared[i, j] = sum(m.shared(way * ahead, spots[i][k], spots[j][k])
                                       for k, (m, way) in enumerate(zip(self.gears, (1, -1))))
        return shared

    def solve(self, phase, relief, switches, side=0):
        """Static transmission error (mm), path coordinates of the pairs that may touch, and their loads (N/mm).

        `side` -1 or 1 is the limit from before or behind where a pair enters or leaves at this phase.
        """
        s = self.touching(phase, self.before if switches.corner else 0.0, side)
        laws = [self.law(v) for v in s]
        gap = np.array([law[0] + relief.both(self.pair, v) for law, v in zip(laws, s)])
        spots, arms = zip(*(self.spots(v) for v in s))
        arm = np.array(arms)
        shared = self.influence(s, spots) if switches.neighbours else np.zeros((len(s), len(s)))
        load = np.full(len(s), self.force / len(s))
        for step in range(200):
            own = [law[1](f if switches.own_load else self.force) for law, f in zip(laws, load)]
            new, moved = press(shared + np.diag(own), arm, gap, self.force)
            if np.abs(new - load).max() < 1e-9 * self.force:
                return moved, s, new
            load = new if step < 10 else (load + new) / 2     # a pair about to part may come and go
        raise ValueError('loads do not converge')


def press(matrix, arm, gap, force):
    """Loads that only press, and the rotation: matrix load = arm x - gap where they press, at most that elsewhere."""
    n = len(gap)
    scale = np.abs(matrix).max()
    for size in range(n, 0, -1):
        for chosen in combinations(range(n), size):
            k = list(chosen)
            system = np.zeros((size + 1, size + 1))
            system[:-1, :-1] = matrix[np.ix_(k, k)] / scale
            system[:-1, -1], system[-1, :-1] = -arm[k], arm[k]
            x = np.linalg.solve(system, np.append(-gap[k] / scale, force))
            load = np.zeros(n)
            load[k] = x[:-1]
            moved = x[-1] * scale
            open_ = matrix @ load + gap - arm * moved
            if load.min() >= 0 and all(open_[i] >= -1e-12 for i in range(n) if i not in chosen):
                return load, moved
    raise ValueError('no contact')
