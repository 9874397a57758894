"""Write jumps.dat: speeds at which a steady motion that loses contact ends.

The motion is followed over the speed by Newton's method on the period map, from a motion marched
to, by steps that are halved where it fails, where a Floquet multiplier passes 1 or -1, or where the
state leaps.  The end lies within the last step, which the table tells: a fold where the multiplier
comes near 1, a flip where it comes near -1.  The maps are closed forms (constant pair stiffness) or
Taylor series between located events.
"""
from multiprocessing import Pool

import mpmath
from model import Mesh, Row, static_deflection
from propagate import Period, exact_piece, jacobian, march, taylor_piece

CTX = mpmath.fp
LAST_STEP = 1e-3
CURVED = (400.0, 0.0, -110.0)
# Row, from where it is followed, and in which direction.
CASES = [
    (Row(zeta=0.05, rpm=6000), +1),
    (Row(zeta=0.05, rpm=10000), +1),
    (Row(zeta=0.05, rpm=14000), -1),
    (Row(coef=CURVED, zeta=0.05, rpm=6500), +1),
    (Row(coef=CURVED, zeta=0.05, rpm=11000), +1),
    (Row(coef=CURVED, zeta=0.05, rpm=13000), -1),
]


class Map:
    """The map of a mesh period at a speed, and what follows from it."""

    def __init__(self, row, rpm):
        self.mesh = Mesh(Row(**{**row.__dict__, "rpm": rpm}), CTX)
        self.scale = (1.0, CTX.sqrt(self.mesh.gain * (self.mesh.m1 + self.mesh.m2) * self.mesh.coef[0]))
        self.piece = exact_piece if len(row.coef) == 1 else taylor_piece

    def step(self, y):
        return Period(self.mesh, self.piece, y).state

    def jacobian(self, y):
        return jacobian(self.step, y, CTX, self.scale)

    def periodic(self, y):
        """The periodic state near y, or None."""
        for _ in range(8):
            z, j = self.step(y), self.jacobian(y)
            r = [z[i] - y[i] for i in range(2)]
            a, b, c, d = j[0][0] - 1, j[0][1], j[1][0], j[1][1] - 1
            det = a * d - b * c
            dy = ((d * r[0] - b * r[1]) / det, (a * r[1] - c * r[0]) / det)
            if abs(dy[0]) + abs(dy[1]) / self.scale[1] > 2:
                return None
            y = (y[0] - dy[0], y[1] - dy[1])
            if abs(dy[0]) + abs(dy[1]) / self.scale[1] < 1e-9:
                return y
        return None

    def margins(self, y):
        """How far the multipliers are from 1 and from -1."""
        j = self.jacobian(y)
        trace, det = j[0][0] + j[1][1], j[0][0] * j[1][1] - j[0][1] * j[1][0]
        return 1 - trace + det, 1 + trace + det

    def factor(self, y):
        return Period(self.mesh, self.piece, y, peaks=True).peak / self.mesh.Fs


def follow(case):
    """Speed, kind and dynamic factor at the end of a motion."""
    row, direction = case
    there = Map(row, row.rpm)
    y = there.periodic(march(row, there.piece, limit=4000)[0])
    rpm, step = float(row.rpm), 100.0 * direction
    while abs(step) > LAST_STEP:
        there = Map(row, rpm + step)
        z = there.periodic(y)
        if z and min(there.margins(z)) > 0 and abs(z[0] - y[0]) < 0.05 * static_deflection(row):
            rpm, y = rpm + step, z
        else:
            step /= 2
    there = Map(row, rpm)
    fold, flip = there.margins(y)
    return rpm, 1 if fold < flip else -1, there.factor(y), abs(step)


if __name__ == "__main__":
    with Pool() as pool:
        found = pool.map(follow, CASES, chunksize=1)
    with open("jumps.dat", "w") as f:
        f.writelines(("# " + line).rstrip() + "\n" for line in (__doc__.strip() + "\nContact ratio 1.6, 25 teeth, 0.8 kg, 7000 N, no relief.\n"
                     "coef0 coef1 coef2 [N/um] (pair stiffness, ascending powers of u = 2 s/contact_ratio - 1), zeta [-],\n"
                     "rpm [1/min] from where it is followed, direction, rpm_end, kind (1 fold, -1 flip), DF there [-],\n"
                     "last step [1/min]").split("\n"))
        for (row, direction), (rpm, kind, factor, step) in zip(CASES, found):
            coef = ([*list(row.coef), 0.0, 0.0])[:3]
            f.write(f"{coef[0]:g} {coef[1]:g} {coef[2]:g} {row.zeta:g} {row.rpm:g} {direction} {rpm:.5f} {kind} {factor:.6f} {step:.1g}\n")
