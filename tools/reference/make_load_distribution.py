"""Write load_distribution.dat: static transmission error and load shares of gear pairs, by finite elements of both gears
whose teeth share their bodies, all contacts solved as one unilateral problem (folder teeth).

    python tools/reference/make_load_distribution.py [CASE ...]      all cases anew, or only these in the old table

needs numpy 2.4 and scipy 1.17, one thread and about ten minutes.  Each case is solved on two grids: the finer one gives
the table, what the coarser one differs by is its header's `grid`.
"""
import sys
import time
from itertools import pairwise
from math import radians
from pathlib import Path

import numpy as np
from teeth.body import Material
from teeth.cases import CASES
from teeth.gears import Gear, Pair
from teeth.loaded_gear import LoadedGear
from teeth.mesh import Mesh, Relief, Switches

TABLE = Path(__file__).parents[2] / 'test/reference/load_distribution.dat'
GRIDS = [(0.06, 0.0005, 0.07), (0.09, 0.001, 0.11)]       # edges on the teeth, at the tip corner (modules), growth from there
PHASES = (np.arange(16) + 0.5) / 16
HEAD = """\
# Static transmission error (STE) and load shares of spur gears by an analysis of their own: tools/reference/teeth.
# Written by tools/reference/make_load_distribution.py; the inputs are in tools/reference/teeth/cases.py.
# How had: exact outline from the rack's motion; six-node triangles over each gear's section or whole gear, held at sides and
# rim or at the bore, plane strain; loads split into Flamant's half-plane and a smooth remainder; Hertz's flattening in
# closed form; beside a tip corner a two-body contact of its own; loads and rotation found together, loads only press.
# In a section each pair in turn is the middle tooth's; its neighbour is the tooth on the side of its drive flank.
# Each block: case, relief [um], corner contact, neighbours (what a load moves the other contacts by), flattening by each pair's
# own load (else by the whole load); contact ratio; peak-to-peak, mean and amplitudes of harmonics 1 to 3 of the STE [um]; first
# path coordinate with load and last less the contact ratio [base pitches]; grid: largest change of the STE [um] (less that
# of its mean) and of a share from the coarser grid to the finer one.
# Then for each phase: STE [um], share of the load of the pairs at s = phase - 1, phase, phase + 1, phase + 2, phase + 3.
"""


def loaded_gears(case, pair, material, grid):
    """Both gears with their bodies; one for both where they are alike."""
    surface, corner, spread = (np.array(grid) * (case.module, case.module, 1.0)).tolist()
    found = {}
    for k, gear in enumerate(pair.gears()):
        inner = case.bore[k] / 2 or gear.root - min(2.5 * (gear.tip - gear.root), 0.9 * gear.root)
        key = gear.teeth, gear.shift, inner
        if key not in found:
            lowest = pair.roll(k, pair.ratio * k) - 0.4 * gear.module     # the mate's tip sinks in beside A and E
            fixed = ('sides', 'rim') if case.section else ('rim',)
            found[key] = LoadedGear(gear, material, inner, case.section, surface, corner, lowest, fixed, spread=spread)
        yield found[key]


def smooth(pair, width=1 / 16, order=4):
    """Phases and weights of a quadrature over the mesh period, between the phases where pairs come and go."""
    x, w = np.polynomial.legendre.leggauss(order)
    cuts = [0.0, pair.ratio % 1.0, 1.0]
    for a, b in pairwise(cuts):
        n = int(np.ceil((b - a) / width))
        for k in range(n):
            lo, hi = a + (b - a) * k / n, a + (b - a) * (k + 1) / n
            yield from zip((lo + hi) / 2 + x * (hi - lo) / 2, w * (hi - lo) / 2)


def reached(mesh, relief, on, solved):
    """The first path coordinate with load, and the last one less the contact ratio, by halving."""
    ratio = mesh.pair.ratio
    known = sorted((v, f > 0) for _, s, load in solved for v, f in zip(s, load))
    out = []
    for outside, places, end in ((-mesh.before, known, 0.0), (ratio + mesh.before, known[::-1], ratio)):
        within = next(v for v, touches in places if touches)
        outside = next((v for v, touches in reversed(places) if not touches and abs(v - ratio / 2) > abs(within - ratio / 2)
                        and (v - within) * (outside - within) > 0), outside if on.corner else end)
        for _ in range(12):
            middle = (within + outside) / 2
            _, s, load = mesh.solve(middle % 1.0, relief, on)
            touches = any(abs(v - middle) < 1e-9 and f > 0 for v, f in zip(s, load))
            within, outside = (middle, outside) if touches else (within, middle)
        out.append(within - end)
    return out


def analyse(mesh, case):
    """For each relief and set of switches: figures, and rows of STE and shares."""
    pair = mesh.pair
    nodes, weights = np.array(list(smooth(pair))).T
    for amount in case.reliefs:
        relief = Relief(amount * 1e-3)
        for switches in case.switches:
            on = Switches(*map(bool, switches))
            solved = [mesh.solve(p, relief, on) for p in nodes]
            ste = np.array([1e3 * x for x, _, _ in solved])
            limits = [1e3 * mesh.solve(p, relief, on, side)[0] for p in (0.0, pair.ratio % 1.0) for side in (-1, 1)]
            rows = []
            for p in PHASES:
                x, s, load = mesh.solve(p, relief, on)
                solved.append((x, s, load))
                share = dict(zip(np.rint(s - p).astype(int).tolist(), load / case.load))
                rows.append([1e3 * x] + [share.get(j, 0.0) for j in range(-1, 4)])
            reach = reached(mesh, relief, on, solved)
            wave = [2 * abs(np.sum(weights * ste * np.exp(-2j * np.pi * n * nodes))) for n in (1, 2, 3)]
            figures = [np.ptp([*ste, *limits, *(r[0] for r in rows)]), np.sum(weights * ste), *wave, *reach]
            yield amount, switches, figures, np.array(rows)


def blocks(case):
    """The case's part of the table."""
    gears = [Gear(case.teeth[k], case.module, tuple(map(radians, case.angle)), case.shift[k], case.addendum, case.dedendum,
                  case.tip_radius) for k in (0, 1)]
    pair = Pair(*gears)
    fine, coarse = (list(analyse(Mesh(pair, tuple(loaded_gears(case, pair, Material(), grid)), case.load), case)) for grid in GRIDS)
    for (amount, switches, figures, rows), (*_, other) in zip(fine, coarse):
        change = rows - other
        grid = np.abs(change[:, 0] - change[:, 0].mean()).max(), np.abs(change[:, 1:]).max()
        yield '= {} relief {:g} corner {} neighbours {} own_load {} ratio {:.6f}'.format(case.name, amount, *switches, pair.ratio)
        yield '  peak_to_peak {:.4f} mean {:.4f} harmonics {:.4f} {:.4f} {:.4f} begin {:.4f} end {:.4f}'.format(*figures) + \
            ' grid {:.4f} {:.5f}'.format(*grid)
        for p, row in zip(PHASES, rows):
            yield f'{p:.5f} {row[0]:.4f} ' + ' '.join(f'{v:.4f}' if v else '0' for v in row[1:])


def main():
    wanted = sys.argv[1:] or [c.name for c in CASES]
    old = {}
    if sys.argv[1:] and TABLE.exists():
        for line in TABLE.read_text().splitlines():
            if line.startswith('= '):
                name = line.split()[1]
            if not line.startswith('#'):
                old.setdefault(name, []).append(line)
    for case in CASES:
        if case.name in wanted:
            began = time.time()
            old[case.name] = list(blocks(case))
            print(f'{case.name}: {time.time() - began:.0f} s', *(line for line in old[case.name] if not line[0].isdigit()), sep='\n', flush=True)
            with TABLE.open('w') as file:
                file.write(HEAD)
                file.writelines(f'{line}\n' for c in CASES for line in old.get(c.name, []))


if __name__ == '__main__':
    main()
