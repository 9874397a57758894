"""Write constant_stiffness.dat and constant_stiffness_contact_loss.dat.

Constant pair stiffness, no friction: every piece between two events has a closed-form
solution (two exponentials and a polynomial), evaluated with 40 digits.
"""
from family import family
from model import Row
from propagate import exact_piece

HEAVY = dict(z1=20, z2=47, m1=0.6, m2=2.1, coef=(520.0,), Fs=9000.0)
LIGHT = dict(z1=31, z2=19, m1=1.3, m2=0.55, coef=(350.0,), Fs=5000.0, angle=22.5)


def row(c, zeta, rpm, cp=0.0, cg=0.0, shape=1, **kw):
    return Row(c=c, sp=c / 2 if c < 2 else 1.125, zeta=zeta, rpm=float(rpm), cp=float(cp),
               cg=float(cg), shape=shape, **kw)


LOADED = [
    row(1.05, 0.0, 2000), row(1.05, 0.0, 10000, 3), row(1.05, 0.0, 17000, 3, 3),
    row(1.05, 0.0, 36000),
    row(1.6, 0.0, 4200, 3, 3), row(1.6, 0.0, 6500), row(1.6, 0.0, 6500, 3),
    row(1.6, 0.0, 6500, 3, 3), row(1.6, 0.0, 22000), row(1.6, 0.0, 22000, 3),
    row(2.3, 0.0, 4200), row(2.3, 0.0, 8000, 3), row(2.3, 0.0, 10000, 3, 3),
    row(2.3, 0.0, 22000, 3, 3, 2), row(2.3, 0.0, 27000),
    row(1.45, 0.0, 23000, 4, 2, **HEAVY),
    row(1.05, 0.17, 6000), row(1.05, 0.17, 12000, 2), row(1.05, 0.17, 26000, 3, 3),
    row(1.6, 0.17, 3000, 3), row(1.6, 0.17, 7000), row(1.6, 0.17, 11500, 2, 2),
    row(1.6, 0.17, 17000), row(1.6, 0.17, 26000, 4, 3, 2),
    row(2.3, 0.17, 5000, 3, 3), row(2.3, 0.17, 18000), row(2.3, 0.17, 25000, 3),
    row(1.75, 0.17, 11500, 2, 3, 2, **LIGHT), row(1.45, 0.17, 14500, 3, 0, **HEAVY),
    row(1.05, 2.0, 10000, 3), row(1.6, 2.0, 14000), row(1.6, 2.0, 30000, 3, 3),
    row(2.3, 2.0, 20000, 4, 4, 2), row(1.45, 2.0, 25000, 3, 5, **HEAVY),
]

LOSSY = [
    row(1.6, 0.1, 7500, 20), row(1.6, 0.1, 13500, 20), row(1.6, 0.1, 24000, 20),
    row(1.6, 0.1, 4500, 18, 22, 2), row(1.6, 0.1, 15000, 18, 22, 2),
    row(1.6, 0.03, 12000), row(1.6, 0.03, 15000),
    row(1.3, 0.02, 13500, 20, 20), row(1.3, 0.02, 7500, 20, 20),
    row(2.3, 0.05, 9000, 15, 15), row(2.3, 0.05, 18000, 15, 15),
    row(1.6, 0.02, 12000, backlash=2.0), row(1.6, 0.02, 13500, backlash=2.0),
    row(1.6, 0.02, 3000, backlash=2.0),
    row(1.4, 0.02, 13500, 25, 25, backlash=5.0),
    row(1.45, 0.05, 17500, 22, 10, **HEAVY), row(1.75, 0.08, 11500, 18, 18, 2, **LIGHT),
]

if __name__ == "__main__":
    family("constant_stiffness.dat", """\
Prescribed mesh, constant pair stiffness, no friction, all pairs stay loaded.
How had: closed-form propagation with 40 digits, periodic solution by a linear solve, load
peaks by root finding on the closed form.  Rows with zeta = 0 are speeds at which the
undamped map is stable (|trace| < 2), so that mu_max = 1.
How confirmed: scipy DOP853 (rtol 1e-13) restarted at every break, own Newton
iteration started 1 % off in x.""",
           exact_piece, [(r, False) for r in LOADED])
    family("constant_stiffness_contact_loss.dat", """\
Prescribed mesh, constant pair stiffness, no friction, pairs separate: deep relief, free
flight, back-side contact.  Stable motions of one mesh period only.
How had: marched from rest at the static deflection until periodic, then Newton on the
period map; closed-form propagation with 40 digits, events and load peaks by root finding
on the closed form; mu_max from central differences of that map (step 1e-13).
How confirmed: scipy DOP853 (rtol 1e-13) with located events, own Newton
iteration started 1 % off in x.""",
           exact_piece, [(r, True) for r in LOSSY])
