"""Write slow_motions.dat: motions far below resonance in which reliefs part pairs, by the solver of motions.cpp.

A line has the columns of ../model.py from id to rpm, then DF and loss (as in ../model.py).  Relief of 0.3 to 4
static deflections, damping ratio 3e-3 to 1, 2 to 200 rpm, in some backlash and friction.
"""

import random

from campaign import solve, solver

COUNT = 40


def row(number, draw):
    between = lambda a, b: a * (b / a) ** draw.random()  # as many in each decade
    ratio = round(draw.uniform(1.1, 1.9) + draw.choice((0, 1)), 4)
    coef = [300.0, round(draw.uniform(-60, 60), 1), round(draw.uniform(-150, 30), 1)]
    load = 3000.0
    deflection = load / (ratio * (coef[0] + coef[2] / 3))
    relief = round(draw.uniform(0.3, 4) * deflection, 2)
    backlash = round(draw.uniform(0, 3) * deflection, 2) if draw.random() < 0.3 else -1.0
    friction = round(draw.uniform(0.02, 0.1), 3) if draw.random() < 0.4 else 0.0
    zeta, rpm = float(f'{between(3e-3, 1):.3g}'), float(f'{between(2, 200):.4g}')
    return [number, 25, 40, 20.0, ratio, round(ratio / 2, 4), 3, *coef, 0.0, 0.0, 1.0, 1.0, load, zeta, friction, backlash,
            relief, relief, draw.choice((1, 2)), rpm]  # fmt: skip


if __name__ == '__main__':
    draw = random.Random(7)
    points = [row(i, draw) for i in range(1, COUNT + 1)]
    found = solve(solver(), 1, 50, [' '.join(map(str, point)) for point in points])
    with open('slow_motions.dat', 'w') as file:
        file.writelines(('# ' + line).rstrip() + '\n' for line in __doc__.strip().split('\n'))
        for point in points:
            (periods, factor, _, _, _, loss, _), *others = [orbit for orbit in found[point[0]] if orbit[0] > 0]
            assert periods == 1 and not others
            print(*point, f'{factor:.10f}', int(loss), file=file)
