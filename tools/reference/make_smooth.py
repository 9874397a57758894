"""Write smooth_stiffness.dat: polynomial pair stiffness, friction, shallow and deep relief.

First route: Taylor series of 34 terms with 40 digits, events and load peaks found on the
series.  Second route: scipy DOP853 with located events (confirm.py).
"""
from family import family
from model import Row
from propagate import taylor_piece

EVEN = (400.0, 0.0, -112.0)
SKEW = (400.0, 30.0, -100.0, -12.0, 8.0)
CUBIC = (400.0, -25.0, -90.0, 20.0)
HEAVY = dict(z1=20, z2=47, m1=0.6, m2=2.1, Fs=9000.0)
LIGHT = dict(z1=31, z2=19, m1=1.3, m2=0.55, Fs=5000.0, angle=22.5)


def row(coef, c, sp, zeta, mu, rpm, cp=0.0, cg=0.0, shape=1, **kw):
    return Row(coef=coef, c=c, sp=sp, zeta=zeta, mu=mu, rpm=float(rpm), cp=float(cp),
               cg=float(cg), shape=shape, **kw)


LOADED = [
    row(EVEN, 1.6, 0.8, 0.05, 0.0, 4000),
    row(EVEN, 1.6, 0.8, 0.05, 0.08, 4000),
    row(EVEN, 1.6, 0.8, 0.17, 0.08, 8500, 4, 4),
    row(EVEN, 1.6, 0.74, 0.1, 0.08, 19000, 6, 3, 2),
    row(SKEW, 1.6, 0.8, 0.17, 0.0, 11000),
    row(SKEW, 1.6, 0.7, 0.17, 0.08, 7000, 5),
    row(EVEN, 2.3, 1.125, 0.1, 0.08, 9000, 3, 3, 2),
    row(SKEW, 2.3, 1.25, 0.5, 0.0, 20000),
    row(CUBIC, 2.3, 1.1, 0.07, 0.08, 28000, 2),
    row(CUBIC, 1.05, 0.5, 0.2, 0.08, 10000, 2, 2),
    row(EVEN, 1.6, 0.8, 0.1, 0.08, 28000),
    row(SKEW, 1.6, 0.85, 0.05, 0.08, 1500, 4, 4),
    row(CUBIC, 1.45, 0.62, 0.3, 0.08, 14000, 6, 4, 2, **HEAVY),
    row(SKEW, 1.75, 0.95, 0.25, 0.08, 15000, 0, 4, 1, **LIGHT),
]

LOSSY = [
    row(EVEN, 1.6, 0.8, 0.05, 0.0, 13000, 22, 22),
    row(SKEW, 1.6, 0.75, 0.06, 0.08, 12500),
    row(CUBIC, 1.45, 0.62, 0.08, 0.08, 16000, 25, 10, 2, **HEAVY),
    row(EVEN, 2.3, 1.125, 0.08, 0.08, 9500, 16, 16),
    row(EVEN, 1.6, 0.8, 0.05, 0.08, 12500, backlash=2.0),
]

if __name__ == "__main__":
    family("smooth_stiffness.dat", """\
Prescribed mesh, polynomial pair stiffness, with and without friction.
With friction the factors f1, f2 of a pair, and so the frequency and the damping, jump when
the pair passes the pitch point: this phase is a break in both routes.
How had: Taylor series of 34 terms with 40 digits, restarted at every break and event; events
and load peaks by root finding on the series; linear solve (no separation) or march from
rest at the static deflection and Newton on the period map; mu_max from central
differences of that map (step 1e-13).
How confirmed: scipy DOP853 (rtol 1e-13) with located events, own Newton
iteration started 1 % off in x.""",
           taylor_piece, [(r, False) for r in LOADED] + [(r, True) for r in LOSSY])
