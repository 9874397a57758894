"""Write bifurcations.dat: speeds at which periodic motions fold, double their period, or graze, to many digits.

Newton's method with 30 digits on three equations for state and speed: the motion repeats after n mesh periods, and
det(M - 1) = 0 (fold), det(M + 1) = 0 (doubling; M: derivative of the map over the n periods) or the overlap that is
smallest is 0 (grazing).  The maps are closed forms (constant pair stiffness) or Taylor series between located events;
all derivatives are differences of them.  The starts, to six digits, only choose the motion.
"""
from multiprocessing import Pool

import mpmath
from model import Mesh, Row
from propagate import Period, exact_piece, find_root, jacobian, taylor_piece

CURVED = (400.0, 0.0, -110.0)
FLAT = (400.0,)
# Coefficients, mesh periods, kind, start: rpm, x [um], its derivative over the mesh phase [um].
STARTS = [
    (FLAT, 1, "fold", 6874.91, 16.9791, -143.318),
    (FLAT, 1, "fold", 11430.1, 21.6289, -46.3677),
    (FLAT, 1, "doubling", 7410.21, 42.7216, 618.884),
    (FLAT, 1, "doubling", 8249.25, 22.3341, 61.0432),
    (FLAT, 1, "grazing", 9587.76, 18.8600, 18.3248),
    (FLAT, 1, "grazing", 10587.7, 18.9679, -6.85118),
    (FLAT, 2, "doubling", 6681.71, 28.5705, 103.339),
    (FLAT, 2, "grazing", 7149.70, 25.1225, 101.842),
    (FLAT, 3, "fold", 8694.23, 50.6889, 300.622),
    (FLAT, 4, "doubling", 6550.84, 28.9267, 102.618),
    (CURVED, 1, "fold", 6782.60, 19.4065, -135.787),
    (CURVED, 1, "fold", 11600.2, 22.8827, -54.3716),
    (CURVED, 1, "doubling", 5773.93, 63.7361, 976.292),
    (CURVED, 1, "grazing", 11345.5, 20.9855, -35.9437),
]


class Watched(Period):
    """A mesh period with the extrema of x in it, which without relief is every pair's overlap."""

    def __init__(self, *args):
        self.extrema = []
        super().__init__(*args)

    def event(self, at, level, above, h):
        slope = lambda t: at(t)[1]
        if (slope(0 * h) > 0) != (slope(h) > 0):
            self.extrema.append(at(find_root(slope, 0 * h, h, self.eps))[0])
        return super().event(at, level, above, h)


class Place:
    """A start with its equations."""

    def __init__(self, start):
        self.coef, self.n, self.kind, *_ = start
        self.piece = exact_piece if len(self.coef) == 1 else taylor_piece
        self.scale = (mpmath.mpf(1), mpmath.mpf(10), mpmath.mpf(100))

    def mesh(self, rpm):
        return Mesh(Row(coef=self.coef, zeta=0.05, rpm=rpm), mpmath.mp)

    def equations(self, u):
        mesh = self.mesh(u[2])

        def step(y):
            for _ in range(self.n):
                y = Period(mesh, self.piece, y).state
            return y
        y = (u[0], u[1])
        z = step(y)
        if self.kind == "grazing":
            extrema, z = [], y
            for _ in range(self.n):
                run = Watched(mesh, self.piece, z)
                extrema += run.extrema
                z = run.state
            third = min(extrema, key=abs)
        else:
            j = jacobian(step, y, mpmath.mp, self.scale)
            trace, det = j[0][0] + j[1][1], j[0][0] * j[1][1] - j[0][1] * j[1][0]
            third = 1 + det - trace if self.kind == "fold" else 1 + det + trace
        return [z[0] - y[0], z[1] - y[1], third]

    def solve(self, u):
        for _ in range(12):
            g = self.equations(u)
            jac = mpmath.matrix(3, 3)
            for i in range(3):
                h = self.scale[i] * mpmath.mpf(10) ** -9
                moved = list(u)
                moved[i] += h
                other = self.equations(moved)
                for k in range(3):
                    jac[k, i] = (other[k] - g[k]) / h
            du = mpmath.lu_solve(jac, mpmath.matrix(g))
            u = [u[i] - du[i] for i in range(3)]
            if abs(du[2]) < mpmath.mpf(10) ** -12 * u[2]:
                return u
        raise RuntimeError("no convergence")


def solve(start):
    """Speed and dynamic factor at a place."""
    mpmath.mp.dps = 30
    place = Place(start)
    u = place.solve([mpmath.mpf(start[4]), mpmath.mpf(start[5]), mpmath.mpf(start[3])])
    mesh, y, peak = place.mesh(u[2]), (u[0], u[1]), 0
    for _ in range(place.n):
        run = Period(mesh, place.piece, y, False, True)
        peak, y = max(peak, run.peak), run.state
    return u[2], peak / mesh.Fs


if __name__ == "__main__":
    with Pool() as pool:
        found = pool.map(solve, STARTS, chunksize=1)
    with open("bifurcations.dat", "w") as f:
        f.writelines(("# " + line).rstrip() + "\n" for line in (__doc__.strip() + "\nContact ratio 1.6, 25 teeth, 0.8 kg, 7000 N, no relief, zeta 0.05.\n"
                     "coef0 coef1 coef2 [N/um] (pair stiffness, ascending powers of u = 2 s/contact_ratio - 1), mesh periods, kind,\n"
                     "rpm [1/min], DF there [-]").split("\n"))
        for start, (rpm, factor) in zip(STARTS, found):
            coef = ([*list(start[0]), 0.0, 0.0])[:3]
            f.write(f"{coef[0]:g} {coef[1]:g} {coef[2]:g} {start[1]} {start[2]} {mpmath.nstr(rpm, 15)} {mpmath.nstr(factor, 12)}\n")
