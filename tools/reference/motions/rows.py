"""Random rows of a prescribed mesh, in the columns of ../model.py from id to rpm.

    python3 rows.py all|light COUNT [SEED]

`all`: contact ratio 1.05 to 2.9, damping ratio 1e-4 to 1, mesh frequency 0.05 to 3 natural frequencies, relief of 0 to 2 static
deflections, in some backlash, friction, stiffness that varies along the path. `light`: damping ratio 1e-4 to 1e-2.
"""

import math
import random
import sys


def row(number, light, draw):
    """One row as a list of numbers; each is drawn whether it is used or not."""
    between = lambda a, b: a * (b / a) ** draw.random()  # as many in each decade
    ratio = draw.uniform(1.05, 2.9)
    ratio = round(ratio if abs(ratio - 2) > 0.02 else ratio + 0.05, 4)
    curved = draw.random() < 0.5
    coef = [300.0, round(draw.uniform(-60, 60), 1), round(draw.uniform(-150, 30), 1)]
    coef = coef if curved else [300.0, 0.0, 0.0]
    masses = [round(between(0.3, 3), 3) for _ in range(2)]
    load = round(between(1000, 10000), 0)
    mean = ratio * (coef[0] + coef[2] / 3)  # N/um
    deflection = load / mean
    zeta = float(f'{between(1e-4, 1e-2 if light else 1):.3g}')
    friction = round(draw.uniform(0.02, 0.1), 3) if draw.random() < 0.25 else 0.0
    backlash = round(draw.uniform(0, 4) * deflection, 2) if draw.random() < 0.4 else -1.0
    relief = round(draw.uniform(0, 2) * deflection, 2) if draw.random() < 0.7 else 0.0
    shape = draw.choice((1, 2))
    natural = math.sqrt(1e6 * mean * sum(1 / m for m in masses))
    teeth = 25, 40
    rpm = round(60 * between(0.05, 3) * natural / (2 * math.pi * teeth[0]), 2)
    return [number, *teeth, 20.0, ratio, round(ratio / 2, 4), 3 if curved else 1, *coef, 0.0, 0.0, *masses, load, zeta, friction,
            backlash, relief, relief, shape, rpm]  # fmt: skip


def frequency_ratio(row):
    """Mesh frequency over the natural frequency of the mean mesh stiffness."""
    (_, z1, _, _, ratio, _, _, *coef, m1, m2, _, _, _, _, _, _, _, rpm) = row
    natural = math.sqrt(1e6 * ratio * (coef[0] + coef[2] / 3) * (1 / m1 + 1 / m2))
    return 2 * math.pi * z1 * rpm / 60 / natural


def rows(kind, count, seed=1):
    draw = random.Random(f'{kind} {seed}')
    return [row(i, kind == 'light', draw) for i in range(1, count + 1)]


if __name__ == '__main__':
    for one in rows(sys.argv[1], int(sys.argv[2]), *map(int, sys.argv[3:4])):
        print(*one)
