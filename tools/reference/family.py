"""Compute one family of rows, confirm each row by the other routes, write its table."""
from multiprocessing import Pool

import mpmath
from confirm import confirm
from model import Mesh, static_deflection, write_table
from mpmath import mp
from propagate import march, solve, taylor_piece

mp.dps = 40
STARTS = 12


def starts(row):
    """Starts in (x, x'): the first is at rest at the static deflection."""
    m = Mesh(row, mpmath.fp)
    x = static_deflection(row)
    w = mpmath.fp.sqrt(m.gain * (m.m1 + m.m2) * m.coef[0])
    return [(x * f, 2 * x * w * g) for g in (0, -1, 1) for f in (1, 0.5, 2, 4)]


def same_starts(row, piece, state):
    """How many of the starts end in the given periodic motion (-1: undamped)."""
    if row.zeta == 0:
        return -1
    n = 0
    for s in starts(row):
        end = march(row, piece, s, limit=3000)
        n += end is not None and abs(end[0][0] - state[0]) < 1e-5
    return n


def compute(job):
    row, piece, lossy = job
    guess = march(row, piece)[0] if lossy else None
    r = solve(row, piece, mp, guess)
    if piece is taylor_piece:
        series = 0.0
    else:
        q = solve(row, taylor_piece, mp, (r["x0"], r["v0"] * Mesh(row, mp).period * 10**6)
                  if lossy else None)
        series = float(abs(q["DF"] / r["DF"] - 1))
    d = confirm(row, float(r["x0"]), float(r["v0"]))
    return dict(r, series=series, direct=float(abs(d[0] / r["DF"] - 1)),
                direct_mu=float(abs(d[1] - r["mu_max"])), same=same_starts(row, piece, (r["x0"], 0)))


def family(path, title, piece, jobs):
    """jobs: list of (row, lossy); lossy rows are marched before Newton."""
    with Pool() as pool:
        res = pool.map(compute, [(row, piece, lossy) for row, lossy in jobs], chunksize=1)
    for i, ((row, _), r) in enumerate(zip(jobs, res), 1):
        if r["mu_max"] > 1 + mp.mpf(10) ** -20:
            raise ValueError(f"row {i} unstable")
        print(f"{i:3d} c {row.c} zeta {row.zeta} rpm {row.rpm} DF {mp.nstr(r['DF'], 12)} "
              f"mu_max {mp.nstr(r['mu_max'], 10)} trace {mp.nstr(r['trace'], 4)} loss {r['loss']} "
              f"events {r['events']} same {r['same']} series {r['series']:.0e} "
              f"direct {r['direct']:.0e} direct mu {r['direct_mu']:.0e}")
    worst = {k: max(r[k] for r in res) for k in ("series", "direct", "direct_mu")}
    agree = f"\nLargest relative difference of DF from scipy DOP853: {worst['direct']:.1e}; "
    agree += f"largest difference of mu_max (finite\ndifference of that map): {worst['direct_mu']:.1e}."
    if piece is not taylor_piece:
        agree += (f"\nLargest relative difference of DF from a 34-term Taylor series with "
                  f"{mp.dps} digits: {worst['series']:.1e}.")
    agree += f"""
Printed to 20 digits.  The last column, same_starts, says how many of {STARTS} starts (x = 0.5, 1,
2, 4 times static; x' = 0 and both signs) marched in time end in the row's motion; the
first of them, at rest at the static deflection, does in every row with separation.
Less than {STARTS}: other motions coexist
(or are reached very slowly).  -1: undamped, not tried."""
    s = lambda v: mp.nstr(v, 20, min_fixed=-6)
    write_table(path, title.strip() + agree, [row for row, _ in jobs],
                [(s(r["DF"]), s(r["mu_max"]), s(r["x0"]), s(r["v0"]), str(r["loss"]), str(r["same"]))
                 for r in res], ["same_starts"])
    print(path, len(jobs), "rows", worst)
