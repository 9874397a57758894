"""Spur gears cut by a basic rack, and two of them in mesh (ISO 21771), from the rack's own motion.

Lengths in mm, angles in rad.  A gear stands with its centre in the origin and the axis of the tooth that counts as
number 0 along +y; its working flank lies on the right.  The mate is the same picture turned by half a turn.
"""
from dataclasses import dataclass
from math import acos, asin, cos, hypot, pi, sin, sqrt, tan

import numpy as np
from scipy.optimize import brentq


def involute(angle):
    return tan(angle) - angle


@dataclass
class Gear:
    """What the rack and the blank decide; factors in modules."""
    teeth: int
    module: float
    angle: tuple              # pressure angle of the rack on the working and on the other flank
    shift: float = 0.0
    addendum: float = 1.0
    dedendum: float = 1.25
    tip_radius: float = 0.25  # of the rack

    def __post_init__(self):
        m = self.module
        self.reference = m * self.teeth / 2
        self.root = self.reference + m * (self.shift - self.dedendum)
        self.tip = self.reference + m * (self.shift + self.addendum)
        self.base = [self.reference * cos(a) for a in self.angle]
        self.pitch = 2 * pi / self.teeth
        # Half the tooth on the reference circle, to either side of the axis that halves the rack's space there.
        self.half = [m * (pi / 4 + self.shift * tan(a)) / self.reference for a in self.angle]
        self.form = [hypot(*self.fillet(side, self.angle[side])) for side in (0, 1)]

    def flank_angle(self, side, radius):
        """From the tooth's axis to the flank on this side (0 working, 1 other), both counted positive."""
        return self.half[side] + involute(self.angle[side]) - involute(acos(min(1.0, self.base[side] / radius)))

    def flank(self, side, radius):
        """Point of an involute; the working flank on the right."""
        angle = self.flank_angle(side, radius)
        return np.array([(1 - 2 * side) * radius * sin(angle), radius * cos(angle)])

    def fillet(self, side, normal):
        """Point that the rack's rounded tip leaves where its normal has this angle to the reference line.

        The normal of rack and gear in a point that both share passes through the pitch point: that says how far the
        rack has moved.  `normal` goes from the pressure angle, where the flank begins, to pi/2 at the root.
        """
        m, a, rho = self.module, self.angle[side], self.tip_radius * self.module
        depth = self.dedendum * m - rho                      # of the rounding's centre below the rack's reference line
        px = m * pi / 4 + depth * tan(a) + rho / cos(a) - rho * cos(normal)
        py = self.shift * m - depth - rho * sin(normal)
        moved = px - py / tan(normal)
        turn = moved / self.reference
        x, y = px - moved, self.reference + py
        return np.array([(1 - 2 * side) * (x * cos(turn) + y * sin(turn)), y * cos(turn) - x * sin(turn)])

    def fillet_end(self, side):
        """Angle from the axis at which the fillet meets the root circle."""
        x, y = self.fillet(side, pi / 2)
        return asin(abs(x) / hypot(x, y))

    def flank_at(self, side, t):
        """Flank from its form circle (t = 0) to its tip (t = 1), in equal steps of the roll angle's square root."""
        low, high = (sqrt(max(0.0, r**2 - self.base[side]**2)) for r in (self.form[side], self.tip))
        return self.flank(side, hypot(self.base[side], low + t * (high - low)))


@dataclass
class Pair:
    pinion: Gear
    gear: Gear

    def __post_init__(self):
        one, two = self.pinion, self.gear
        total = one.reference + two.reference

        def backlash(factor):
            """Teeth on both pitch circles less the pitch, with pitch radii that are `factor` times the reference radii."""
            width = 0.0
            for g in (one, two):
                radius = factor * g.reference
                width += radius * (g.flank_angle(0, radius) + g.flank_angle(1, radius))
            return width - factor * one.reference * one.pitch

        low = max(max(g.base[s] / g.reference for g in (one, two) for s in (0, 1)) + 1e-12, 0.8)
        factor = 1.0 if abs(backlash(1.0)) < 1e-13 else brentq(backlash, low, 1.5, xtol=1e-15)
        self.distance = factor * total
        self.working = acos(one.base[0] / (factor * one.reference))
        self.base_pitch = one.module * pi * cos(one.angle[0])
        self.path = self.distance * sin(self.working)            # between the two base circles
        ends = [sqrt(g.tip**2 - g.base[0]**2) for g in (one, two)]
        self.start = self.path - ends[1]                         # of contact (A), from the pinion's base circle
        self.ratio = (ends[0] - self.start) / self.base_pitch
        self.pitch_point = (one.base[0] * tan(self.working) - self.start) / self.base_pitch

    def gears(self):
        return self.pinion, self.gear

    def roll(self, which, s):
        """Length of the involute's tangent at the contact s base pitches behind A."""
        length = self.start + s * self.base_pitch
        return length if which == 0 else self.path - length

    def radius(self, which, s):
        return hypot(self.gears()[which].base[0], self.roll(which, s))

    def curvature_radius(self, s):
        one, two = self.roll(0, s), self.roll(1, s)
        return one * two / (one + two)

    def corner(self, s, inward=0.0):
        """Tip corner against the mate, unloaded, at s below 0 (the gear's corner) or above the ratio (the pinion's).

        Both gears turn together without load; `inward` takes, instead of the corner, the point of the same flank whose
        roll length is less by this.  Returns the `gap` along the mate's normal through the point, the roll length of
        this normal's `foot` on the mate, the `arm` of the normal about the centre of the corner's own gear and the
        `tilt`, by which the normal of the corner's flank is turned out of it, and `radius` and gear (`owner`) of the point.
        """
        owner = 1 if s < self.ratio / 2 else 0
        own, mate = self.gears()[owner], self.gears()[1 - owner]
        rolled = sqrt(own.tip**2 - own.base[0]**2) - inward
        # The line of action is +y; it touches the owner's base circle, whose centre is the origin, in (base, 0).  The
        # owner's flank, prolonged, meets it at `height`; its point in question comes there after the angle `turn`.
        height = self.roll(owner, s)
        turn = (height - rolled) / own.base[0]
        point = np.array([own.base[0] * cos(turn) - rolled * sin(turn), own.base[0] * sin(turn) + rolled * cos(turn)])
        # Half a turn gives the same picture of the mate.
        centre = np.array([own.base[0] + mate.base[0], self.path])
        seen = centre - point
        far = hypot(*seen)
        at = np.arctan2(seen[1], seen[0]) - acos(mate.base[0] / far)      # where the normal touches the base circle
        foot = self.path - height - at * mate.base[0]
        normal = np.array([-sin(at), cos(at)])
        arm = abs(point[0] * normal[1] - point[1] * normal[0])
        return dict(gap=sqrt(far**2 - mate.base[0]**2) - foot, foot=foot, arm=arm, tilt=turn - at,
                    radius=hypot(own.base[0], rolled), owner=owner)
