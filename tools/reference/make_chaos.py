"""Write chaos.dat: mean logarithmic growth of a disturbance over a mesh period (largest Lyapunov exponent).

Rows with constant pair stiffness that lose contact, by closed forms between located events.
A disturbance is the difference of two motions, 1e-7 static deflections at first, scaled back
to that after every mesh period (Benettin's method).  Periodic rows beside the chaotic ones
show the sign: there the exponent is the logarithm of the largest multiplier over its periods.
"""
from math import hypot, log, sqrt
from multiprocessing import Pool

import mpmath
from model import Mesh, Row, static_deflection
from propagate import Period, exact_piece

BEFORE, BLOCKS, LENGTH = 2000, 40, 500
CASES = [
    Row(zeta=0.02, rpm=7200),   # chaotic
    Row(zeta=0.02, rpm=7000),
    Row(zeta=0.01, rpm=2950),
    Row(zeta=0.02, rpm=12000),  # periodic, with and without loss of contact; no other motion there
    Row(zeta=0.10, rpm=7200),
]


def exponent(row):
    """Mean over blocks, and its standard error."""
    mesh = Mesh(row, mpmath.fp)
    unit = mesh.period * sqrt(1.6e6 * (row.m1 + row.m2) / (row.m1 * row.m2) * row.coef[0])
    small = 1e-7 * static_deflection(row)
    y, d, blocks = (static_deflection(row), 0.0), (small, 0.0), []
    for block in range(BLOCKS + BEFORE // LENGTH):
        growth = 0.0
        for _ in range(LENGTH):
            z = Period(mesh, exact_piece, (y[0] + d[0], y[1] + d[1])).state
            y = Period(mesh, exact_piece, y).state
            d = z[0] - y[0], z[1] - y[1]
            size = hypot(d[0], d[1] / unit)
            growth += log(size / small)
            d = d[0] * small / size, d[1] * small / size
        if block >= BEFORE // LENGTH:
            blocks.append(growth / LENGTH)
    mean = sum(blocks) / BLOCKS
    return mean, sqrt(sum((b - mean) ** 2 for b in blocks) / (BLOCKS - 1) / BLOCKS)


if __name__ == "__main__":
    with Pool() as pool:
        found = pool.map(exponent, CASES)
    with open("chaos.dat", "w") as f:
        f.writelines(("# " + line).rstrip() + "\n" for line in (__doc__.strip() + "\nContact ratio 1.6, pair stiffness 400 N/um, 25 teeth, 0.8 kg, 7000 N, no relief.\n"
                     f"Means over {BLOCKS} blocks of {LENGTH} mesh periods after {BEFORE}; error: standard error of the mean.\n"
                     "zeta [-], rpm [1/min] of pinion, exponent [1/mesh period], error").split("\n"))
        f.writelines(f"{row.zeta} {row.rpm} {mean:.5f} {error:.5f}\n" for row, (mean, error) in zip(CASES, found))
