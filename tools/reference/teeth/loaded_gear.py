"""One gear of a pair: what loads on the flanks of its teeth move, and how its tip corner deflects.

A place on the working flank is known by its roll length (of the tangent to the base circle); the tip corner by the
longest one.  Loads press into the tooth, displacements are counted along the load.
"""
from math import acos, atan2, cos, hypot, pi, sin, sqrt

import numpy as np
from scipy.interpolate import CubicSpline, RectBivariateSpline

from .body import LINE, LINE_WEIGHTS, Body, on_edge
from .grid import section


class LoadedGear:
    """A gear's section of `teeth` teeth down to the radius `inner`, its grid `surface` (mm) fine on the teeth and
    `corner` at the tip corner, its flank loaded from the roll length `lowest` on."""

    def __init__(self, gear, material, inner, teeth, surface, corner, lowest, fixed=('sides', 'rim'), places=33, spread=0.15):
        self.gear, self.material = gear, material
        self.body = Body(section(gear, inner, teeth, surface, corner, spread), material, fixed, gear.pitch)
        self.surface = surface
        base = gear.base[0]
        self.rolls = sqrt(gear.form[0]**2 - base**2), sqrt(gear.tip**2 - base**2)
        self._solve(max(lowest, self.rolls[0]), places)

    def place(self, roll):
        """Point of the working flank, its outward normal, and the parameter of the outline's piece."""
        gear = self.gear
        radius = hypot(gear.base[0], roll)
        point = gear.flank(0, radius)
        polar = atan2(point[1], point[0]) + acos(gear.base[0] / radius)
        normal = np.array([sin(polar), -cos(polar)])
        t = 1 - (roll - self.rolls[0]) / (self.rolls[1] - self.rolls[0])
        return point, normal, min(1.0, max(0.0, t))

    def _read(self, moved, tooth, roll):
        """Displacements of a tooth's flank, in the tooth's own frame: (2, loads)."""
        nodes, shape = self.body.surface(tooth, 'flank', self.place(roll)[2])
        here = np.tensordot(shape, moved[nodes], axes=1)
        return self.body.turn(tooth).T @ here

    def _solve(self, lowest, places):
        """Solves for unit loads at places of the middle tooth's flank and at its corner, and keeps as splines what they
        move: `own` at the load itself, less Flamant's field; `cross` other teeth, by the roll lengths of load and
        reading; `from_corner` and `to_corner` the same in x and y of the corner's own tooth."""
        body, top = self.body, self.rolls[1]
        x = (1 - np.cos(pi * np.arange(places) / (places - 1))) / 2
        rolls = lowest + (top - lowest) * x
        loads, split = [], []
        for i, roll in enumerate(rolls[:-1]):
            point, normal, t = self.place(roll)
            away = hypot(*(point - self.place(top)[0]))
            nodes, shape = body.surface(0, 'flank', t)
            edge = hypot(*(body.grid.points[nodes[0]] - body.grid.points[nodes[1]]))
            if 0.6 * away > 2 * edge:
                split.append(i)
                loads.append(body.near_field(point, -normal, min(5 * self.surface, 0.6 * away)))
            else:                                              # so near the corner: for other teeth only
                loads.append(np.zeros(2 * len(body.grid.points)))
                for v, n in zip(nodes, shape):
                    loads[-1][2 * v:2 * v + 2] = -n * normal
        corner = np.zeros((len(loads[0]), 2))
        node = min(body.table['flank', 0], key=lambda e: e[5])[0]
        corner[2 * node, 0] = corner[2 * node + 1, 1] = 1
        moved = body.solve(np.column_stack([np.array(loads).T, corner])).reshape(-1, 2, len(loads) + 2)
        normals = np.array([self.place(r)[1] for r in rolls])
        self.own = CubicSpline(rolls[split], [-normals[i] @ self._read(moved, 0, rolls[i])[:, i] for i in split])
        self.lowest, self.highest = lowest, rolls[split[-1]]
        self.cross, self.from_corner, self.to_corner = {}, {}, {}
        for tooth in range(-3, 4):
            if tooth == 0 or ('flank', tooth) not in body.table:
                continue
            read = np.array([self._read(moved, tooth, r) for r in rolls])               # (reading, 2, load)
            along = -np.einsum('rkl,rk->lr', read, normals)                             # (load, reading)
            table = np.vstack([along[:-2], -normals[-1] @ along[-2:]])
            self.cross[tooth] = RectBivariateSpline(rolls, rolls, table, s=0)
            self.from_corner[tooth] = CubicSpline(rolls, along[-2:].T)
            self.to_corner[tooth] = CubicSpline(rolls[:-1], read[-1][:, :-2].T)

    def spot(self, roll, tilt=None):
        """A place, and at the corner the direction of the load there: turned by `tilt` out of the flank's normal."""
        if tilt is None:
            return roll, None
        normal = self.place(self.rolls[1])[1]
        c, s = cos(tilt), sin(tilt)
        return self.rolls[1], -np.array([c * normal[0] - s * normal[1], s * normal[0] + c * normal[1]])

    def moves(self, tooth, load, read):
        """What a unit load at a spot of the middle tooth moves a spot of another tooth by; nothing outside the section."""
        if tooth not in self.cross:
            return 0.0
        if load[1] is not None:
            return float(load[1] @ self.from_corner[tooth](read[0]))
        if read[1] is not None:
            return float(read[1] @ self.to_corner[tooth](load[0]))
        return float(self.cross[tooth](load[0], read[0])[0, 0])

    def shared(self, tooth, one, two):
        """What a load on one tooth moves another by, `tooth` teeth further to the right.

        In a whole gear it is the same which of both has the load.  In a section, where a tooth beside the held side would
        stand stiffer, it is the middle one, and the other one stands on its right, where it pushes.
        """
        return self.moves(tooth, one, two) if tooth > 0 else self.moves(-tooth, two, one)

    def corner_bed(self, depth):
        """How the flank beside the tip corner deflects: vertices up to `depth` (mm) from the corner with their arc lengths,
        roll lengths, loads of tractions of hat shape and height 1 N/mm^2, and displacements (vertex, 2, vertex, 2) by
        these tractions in x and y."""
        body = self.body
        chain, arc, rolls, used = [], [0.0], [self.rolls[1]], []
        for e in sorted(body.table['flank', 0], key=lambda e: e[5]):
            t = e[5] + (LINE + 1) / 2 * (e[6] - e[5])
            speed = np.array([np.hypot(*(e[7].point(v + 1e-6) - e[7].point(v - 1e-6))) / 2e-6 for v in t])
            weight = LINE_WEIGHTS * speed * (e[6] - e[5]) / 2
            if not chain:
                chain.append(e[0])
            chain.append(e[1])
            used.append((e, weight))
            arc.append(arc[-1] + weight.sum())
            rolls.append(self.rolls[1] - e[6] * (self.rolls[1] - self.rolls[0]))
            if arc[-1] > depth:
                break
        n = len(chain)
        load, whole = np.zeros((2 * len(body.grid.points), n, 2)), np.zeros(n)
        for k, (e, weight) in enumerate(used):
            for j, hat in ((k, (1 - LINE) / 2), (k + 1, (1 + LINE) / 2)):
                whole[j] += np.sum(weight * hat)
                for v, f in zip(e[:3], on_edge(LINE) @ (weight * hat)):
                    load[2 * v, j, 0] += f
                    load[2 * v + 1, j, 1] += f
        moved = body.solve(load.reshape(len(load), -1)).reshape(-1, 2, n, 2)
        return np.array(arc), np.array(rolls), whole, moved[chain]
