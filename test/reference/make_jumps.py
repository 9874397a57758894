"""Write jumps.dat: speeds at which a steady motion that loses contact ends.

The motion is followed over the speed by Newton's method on the period map, from a motion marched
to, by steps that are halved where it fails.  Where it ends, a Floquet multiplier reaches 1 (fold)
or -1 (flip): two equations for periodicity and one for the multiplier, trace = +-(1 + determinant),
are solved together for the state and the speed, with 20 digits.  The maps are closed forms
(constant pair stiffness) or Taylor series between located events.
"""
from multiprocessing import Pool

import mpmath
from mpmath import mp

from model import COLUMNS, UNITS, Mesh, Row, static_deflection
from propagate import Period, exact_piece, jacobian, march, taylor_piece

mp.dps = 20
# Row, from where it is followed, in which direction, mesh periods until it repeats.
CASES = [
    (Row(zeta=0.05, rpm=6000), +1, 1),
    (Row(zeta=0.05, rpm=10000), +1, 1),
    (Row(zeta=0.05, rpm=14000), -1, 1),
    (Row(coef=(400.0, 0.0, -110.0), zeta=0.05, rpm=6500), +1, 1),
    (Row(coef=(400.0, 0.0, -110.0), zeta=0.05, rpm=11000), +1, 1),
    (Row(coef=(400.0, 0.0, -110.0), zeta=0.05, rpm=13000), -1, 1),
]


def piece_of(row):
    return exact_piece if len(row.coef) == 1 else taylor_piece


class Map:
    """The map of `count` mesh periods at a speed, and what follows from it."""

    def __init__(self, row, rpm, count, ctx):
        self.ctx, self.count = ctx, count
        self.mesh = Mesh(Row(**{**row.__dict__, "rpm": rpm}), ctx)
        self.scale = (ctx.mpf(1), ctx.sqrt(self.mesh.gain * (self.mesh.m1 + self.mesh.m2) * self.mesh.coef[0]))
        self.piece = piece_of(row)

    def step(self, y):
        for _ in range(self.count):
            y = Period(self.mesh, self.piece, y).state
        return y

    def newton(self, y):
        """The periodic state near y and the map's derivative, or None."""
        for _ in range(8):
            z, j = self.step(y), jacobian(self.step, y, self.ctx, self.scale)
            r = [z[i] - y[i] for i in range(2)]
            a, b, c, d = j[0][0] - 1, j[0][1], j[1][0], j[1][1] - 1
            det = a * d - b * c
            dy = ((d * r[0] - b * r[1]) / det, (a * r[1] - c * r[0]) / det)
            if abs(dy[0]) + abs(dy[1]) / self.scale[1] > 2:
                return None
            y = (y[0] - dy[0], y[1] - dy[1])
            if abs(dy[0]) + abs(dy[1]) / self.scale[1] < 1e-9:
                return y, jacobian(self.step, y, self.ctx, self.scale)
        return None


def margins(j):
    """How far the multipliers are from 1 and from -1."""
    trace, det = j[0][0] + j[1][1], j[0][0] * j[1][1] - j[0][1] * j[1][0]
    return 1 - trace + det, 1 + trace + det


def follow(row, direction, count):
    """State and speed close to the end of the motion, and of which kind the end is."""
    y = march(row, piece_of(row), limit=4000)[0]
    rpm, step = float(row.rpm), 100.0 * direction
    y, j = Map(row, rpm, count, mpmath.fp).newton(y)
    while abs(step) > 0.02:
        found = Map(row, rpm + step, count, mpmath.fp).newton(y)
        good = found and min(margins(found[1])) > 0 and abs(found[0][0] - y[0]) < 0.05 * static_deflection(row)
        if good:
            rpm, (y, j) = rpm + step, found
        else:
            step /= 2
    fold, flip = margins(j)
    return y, rpm, 1 if fold < flip else -1


def solve(job):
    row, direction, count = job
    y, rpm, kind = follow(row, direction, count)

    def defects(x, v, speed):
        m = Map(row, speed, count, mp)
        z, j = m.step((x, v)), jacobian(m.step, (x, v), mp, m.scale)
        return [z[0] - x, z[1] - v, margins(j)[0 if kind == 1 else 1]]
    x, v, speed = mp.findroot(defects, (y[0], y[1], rpm), tol=mpmath.mpf(10) ** -18, maxsteps=30)
    m = Map(row, speed, count, mp)
    run = Period(m.mesh, m.piece, (x, v), peaks=True)
    return speed, kind, run.peak / m.mesh.Fs, x, v / m.mesh.period / 10**6, run.loss, rpm


if __name__ == "__main__":
    with Pool() as pool:
        found = pool.map(solve, CASES, chunksize=1)
    title = (__doc__.strip() + "\nColumns as in the other tables, rpm: from where the motion is followed; then direction\n"
             "(1 up, -1 down), rpm_end [1/min], kind (1 fold, -1 flip), DF_end [-]:\n" + UNITS)
    with open("jumps.dat", "w") as f:
        for line in title.split("\n"):
            f.write(("# " + line).rstrip() + "\n")
        f.write("# " + " ".join(COLUMNS + ["direction", "rpm_end", "kind", "DF_end"]) + "\n")
        for i, ((row, direction, count), (speed, kind, factor, *rest)) in enumerate(zip(CASES, found), 1):
            print(i, row.zeta, row.rpm, direction, speed, kind, factor, rest)
            f.write(" ".join([str(i)] + [str(v) for v in row.fields()] + [str(direction), mp.nstr(speed, 17), str(kind),
                                                                        mp.nstr(factor, 14)]) + "\n")
