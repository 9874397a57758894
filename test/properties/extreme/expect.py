"""Fill in the expected values of cases.txt that independent methods give: python3 expect.py [title ...]

Needs mpmath and SciPy, for the modes scikit-fem.  Nothing here comes from the library: cases are read as text, and the motion is
the one of ../reference (closed forms and Taylor series with 40 digits).  Rows are known by the first
word in their last column:

series      periodic motion by Newton's method on the period map, from rest at the mean deflection, or
            after a march where that repels; `series multiplier`: its largest Floquet modulus;
            `series from above`: of the motions that starts away from rest lead to, the one that loads
            the teeth most; `series of 2 periods from 20 0.5`: Newton's method from that state, um and um a
            period, over so many periods
slow limit  oscillation about the static load sharing after each jump of stiffness
fast limit  constant deflection whose mean force balances the load; within twice the motion's size
Meissner    closed form of the two-level oscillator
march       closed forms in doubles, the third period from rest
exponent    growth of the distance of two neighbours, marched
geometry, iso, Weber, elements: see bodies.py
"""
import csv
import itertools
import re
import sys
from math import log, pi, radians, sqrt, tan
from pathlib import Path

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE.parents[2] / "tools/reference"))

import bodies
import mpmath
import numpy as np
from model import Mesh, Row, pval
from mpmath import mp
from propagate import Period, exact_piece, jacobian, largest_multiplier, taylor_piece
from scipy.integrate import quad
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq

mp.dps = 40
FIELDS = ["title", "base", "changes", "quantity", "status", "expected", "within", "origin"]


def read_base(name):
    """A case file as {'group key': text}."""
    text = re.sub(r"!.*", "", (HERE / f"{name}.nml").read_text())
    case = {}
    for group, body in re.findall(r"&(\w+)\s(.*?)/", text, re.DOTALL):
        for key, value in re.findall(r"(\w+)\s*=\s*('[^']*'|[^=]*?)(?=\s+\w+\s*=|\s*$)", body, re.DOTALL):
            case[f"{group} {key}"] = value.strip()
    return case


def case_of(row):
    case = read_base(row["base"])
    for change in filter(None, (c.strip() for c in row["changes"].split(";"))):
        key, value = (part.strip() for part in change.split("=", 1))
        for changed in ["sweep rpm_first", "sweep rpm_last"] if key == "rpm" else [key]:
            case[changed] = value
    return case


def number(case, key, default=None):
    return float(case[key]) if case.get(key) else default


def speed(case):
    """The last speed that the sweep comes to."""
    first, last, step = (number(case, f"sweep rpm_{k}") for k in ("first", "last", "step"))
    if "down" in case["sweep direction"]:
        return first
    return first + step * int((last - first) / step + 1e-9)


def motion_row(case):
    """A prescribed mesh as a row of the reference model."""
    amount = number(case, "relief amount_um", 0.0)
    ratio = number(case, "mesh contact_ratio")
    return Row(z1=int(case["pinion teeth"]), z2=int(case.get("gear teeth", 25)), angle=20.0, c=ratio,
               sp=ratio / 2, coef=tuple(float(a) for a in case["mesh coefficients"].split(",")),
               m1=number(case, "pinion effective_mass_kg"), m2=number(case, "gear effective_mass_kg"),
               Fs=number(case, "load normal_force_n"), zeta=number(case, "dynamics damping_ratio"),
               mu=number(case, "dynamics friction", 0.0), backlash=number(case, "pair backlash_um", -1.0),
               cp=amount * number(case, "relief pinion_fraction", 1.0),
               cg=amount * number(case, "relief gear_fraction", 1.0), rpm=speed(case))


# --- periodic motions ---------------------------------------------------------------------------

def mean_deflection(row):
    """x [um] whose mean load over the period is the static one."""
    m = Mesh(row, mpmath.fp)

    def load(x):
        total = 0.0
        for a, b in zip(m.breaks, m.breaks[1:]):
            n = 200
            for i in range(n):
                tau = a + (b - a) * (i + 0.5) / n
                total += (b - a) / n * sum(pval(m.stiffness(tau, j), 0) * max(0.0, x - pval(m.error(tau, j, tau), 0))
                                           for j in m.pairs(tau))
        return total - row.Fs
    return brentq(load, 0.0, 10 * row.Fs / max(row.coef[0], 1e-9) + 2 * max(row.cp, row.cg) + 1e-300, xtol=1e-300, rtol=1e-12)


class ShortRelief(Mesh):
    """Relief of the pinion over its last `length` base pitches."""

    def __init__(self, row, ctx, length):
        super().__init__(row, ctx)
        self.length = ctx.mpf(length)
        self.breaks = sorted([*self.breaks, self.B - self.length])

    def error(self, tau, j, mid):
        start = self.c - self.length
        return [self.cp * (tau + j - start) / self.length, self.cp / self.length] if mid + j > start else [self.B * 0]


class Motion:
    """Period map of a row in one number context, over several periods."""

    def __init__(self, row, ctx, length=None):
        exact = len(row.coef) == 1 and row.mu == 0 and row.zeta != 1
        self.row, self.ctx = row, ctx
        self.mesh = ShortRelief(row, ctx, length) if length else Mesh(row, ctx)
        self.piece = exact_piece if exact else taylor_piece
        self.unit = ctx.sqrt(self.mesh.gain * (self.mesh.m1 + self.mesh.m2) * max(map(abs, self.mesh.coef)))
        self.size = ctx.mpf(mean_deflection(row))

    def period(self, y, **options):
        return Period(self.mesh, self.piece, y, **options)

    def run(self, y, periods, bonded=False):
        for _ in range(periods):
            y = self.period(y, bonded=bonded).state
        return y

    def distance(self, a, b):
        return max(abs(a[0] - b[0]), abs(a[1] - b[1]) / self.unit) / self.size

    def closed(self, y, periods=1, bonded=False, tight=None):
        """Newton's method from y; the periodic state and its map, or None."""
        tight = tight or (1e-11 if self.ctx is mpmath.fp else mp.mpf(10) ** -25)

        def step(state):
            return self.run(state, periods, bonded)

        scale = (self.size * (1e-6 if self.ctx is mpmath.fp else 1), self.unit * self.size * (1e-6 if self.ctx is mpmath.fp else 1))
        for _ in range(20):
            z = step(y)
            J = jacobian(step, y, self.ctx, scale)
            a, b, c, d = J[0][0] - 1, J[0][1], J[1][0], J[1][1] - 1
            r = [z[0] - y[0], z[1] - y[1]]
            det = a * d - b * c
            move = (-(d * r[0] - b * r[1]) / det, -(a * r[1] - c * r[0]) / det)
            if self.distance(move, (0, 0)) < tight:
                return y, J
            y = (y[0] + move[0], y[1] + move[1])
        return None

    def march(self, y, limit=3000, most=8, tight=1e-9):
        """The state and the periods after which it repeats, or None."""
        past = [y]
        for _ in range(limit):
            past.append(self.run(past[-1], 1))
            for k in range(1, min(most, len(past) - 1) + 1):
                if self.distance(past[-1], past[-1 - k]) < tight:
                    return past[-1], k
        return None


def series(row, wanted="df", start=None, periods=None, length=None):
    motion = Motion(row, mp, length)
    rest = (mp.mpf(motion.size), mp.mpf(0))
    if periods:
        state, J = motion.closed(tuple(map(mp.mpf, start)), periods)
    else:
        state, J, periods = (start is None and (all_carry(motion, rest) or from_rest(motion, rest))) or led_to(motion, start or rest)
    peak, y = 0, state
    for _ in range(periods):
        run = motion.period(y, peaks=True)
        peak, y = max(peak, run.peak), run.state
    print(f"    {periods} periods, {len(run.events)} changes in the last, multiplier", mp.nstr(largest_multiplier(mp, J), 12))
    if motion.distance(y, state) > mp.mpf(10)**-15:
        raise RuntimeError("does not repeat")
    return (largest_multiplier(mp, J) if wanted == "multiplier" else peak / motion.mesh.Fs), 1e-12


def attracts(J):
    return largest_multiplier(mp, J) < 1 + mp.mpf(10)**-12


def all_carry(motion, rest):
    """The motion in which no pair parts, if there is one."""
    state, J = motion.closed(rest, bonded=True)
    run = motion.period(state, peaks=True)
    return None if run.events or run.loss or not attracts(J) else (state, J, 1)


def from_rest(motion, rest):
    """What Newton's method comes to from rest, if it attracts and is not far."""
    try:
        found = motion.closed(rest)
    except (ZeroDivisionError, RuntimeError, OverflowError):
        return None
    return (*found, 1) if found and attracts(found[1]) and motion.distance(found[0], rest) < 0.5 else None


def led_to(motion, start):
    """What a march comes to."""
    found = Motion(motion.row, mpmath.fp).march(tuple(map(float, start)))
    if not found:
        raise RuntimeError("the march comes to nothing that repeats")
    return *motion.closed(tuple(map(mp.mpf, found[0])), found[1]), found[1]


def from_above(row):
    m = Motion(row, mpmath.fp)
    return max(series(row, start=(f * m.size, g * m.size * m.unit)) for f in (0.5, 2, 4) for g in (0, 2, -2))


# --- limits -------------------------------------------------------------------------------------

def slow_limit(case):
    row = motion_row(case)
    assert len(row.coef) == 1 and 1 < row.c < 2 and row.mu == 0 and row.cp == 0
    T, w = 60 / (row.z1 * row.rpm), sqrt(row.coef[0] * 1e6 * (1 / row.m1 + 1 / row.m2))
    # From half the load on each pair to all of it on one, as if at rest before.
    rest = np.exp(-row.zeta * w * T * min(row.c - 1, 2 - row.c))
    return 1 + 0.5 * np.exp(-row.zeta * pi / sqrt(1 - row.zeta**2)), max(2 * rest, 1e-12)


def pair_curves(case):
    """Stiffness [N/m] and weight of one pair over s, for the mean force."""
    ratio = number(case, "mesh contact_ratio")
    if "table" in case["mesh model"]:
        rows = [r for r in csv.reader((HERE / case["mesh file"].strip("'")).read_text().splitlines()) if not r[0].startswith("#")]
        s, k = np.array(rows, float).T
        curve = CubicSpline(s, k, bc_type="not-a-knot")
        return ratio, lambda x: float(curve(x))
    coef = [float(a) for a in case["mesh coefficients"].split(",")]
    return ratio, lambda x: sum(a * (2 * x / ratio - 1)**i for i, a in enumerate(coef))


def fast_limit(case):
    ratio, K = pair_curves(case)
    row = motion_row(dict(case, **{"mesh coefficients": case["mesh coefficients"] or "1"}))
    whole, B = int(ratio), ratio - int(ratio)

    def e(s):
        return row.cp * (s - whole) / B if s > whole and row.cp else row.cg * (B - s) / B if s < B and row.cg else 0.0

    def f(s):
        """What a unit of force gives to the relative acceleration, over that without friction."""
        if not row.mu:
            return 1.0
        sign, d = (-1 if s < row.sp else 1), (s - row.sp) * 2 * pi
        f1 = 1 + sign * row.mu * (tan(radians(row.angle)) + d / row.z1)
        f2 = 1 + sign * row.mu * (tan(radians(row.angle)) - d / row.z2)
        return (f1 * row.m2 + f2 * row.m1) / (row.m1 + row.m2)

    def load(x):
        """Mean force over the period: the integral over the path, cut where it has kinks."""
        cuts = {0.0, ratio, float(row.sp)}
        for start, tip, amount in ((whole, ratio, row.cp), (B, 0.0, row.cg)):
            cuts |= {float(start)} | ({start + (tip - start) * x / amount} if amount > x else set())
        cuts = sorted(c for c in cuts if 0 <= c <= ratio)
        return sum(quad(lambda s: f(s) * K(s) * max(0.0, x - e(s)), a, b, epsabs=0, epsrel=1e-12, limit=500)[0]
                   for a, b in itertools.pairwise(cuts) if b > a)

    mean = load(1.0) if not row.cp and not row.cg else row.Fs
    x = row.Fs / mean if not row.cp and not row.cg else brentq(lambda q: load(q) - row.Fs, 1e-12, 1e7, rtol=1e-14)
    grid = np.unique(np.r_[np.linspace(0, ratio, 20001), whole, B])
    largest = max(K(s) * (x - e(s)) for s in grid)
    # The motion about the mean: force of the order of F, for a period T, but no more than the mass allows.
    T, stiffest = 60 / (row.z1 * row.rpm), max(K(s) for s in grid) * 1e6
    move = row.Fs * T**2 * (1 / row.m1 + 1 / row.m2) / 8 * stiffest / row.Fs
    return largest / row.Fs, 2 * move * max(1.0, largest / row.Fs) / (largest / row.Fs) + 1e-9


def meissner(case):
    from make_meissner import damped
    row = motion_row(case)
    trace, det = damped((row.z1, str(row.c), row.coef[0], str(row.m1), str(row.m2)), mp.mpf(repr(row.rpm)), mp.mpf(repr(row.zeta)))
    root = mp.sqrt(mp.mpc(trace**2 / 4 - det))
    return max(abs(trace / 2 + root), abs(trace / 2 - root)), 1e-9


def march(case):
    """The peak of the third period from rest, where two forget all that was before."""
    motion = Motion(motion_row(case), mpmath.fp)
    run = motion.period(motion.run((motion.size, 0.0), 2), peaks=True)
    return run.peak / motion.row.Fs, 1e-9


def exponent(case):
    motion = Motion(motion_row(case), mpmath.fp)
    y, total, count, size = (motion.size, 0.0), 0.0, 0, 1e-7
    d = (size, 0.0)
    for n in range(4000):
        z = motion.run(y, 1)
        q = motion.run((y[0] + d[0] * motion.size, y[1] + d[1] * motion.size * motion.unit), 1)
        d = ((q[0] - z[0]) / motion.size, (q[1] - z[1]) / motion.size / motion.unit)
        grown = sqrt(d[0]**2 + d[1]**2)
        d = (d[0] * size / grown, d[1] * size / grown)
        if n >= 100:
            total, count = total + log(grown / size), count + 1
        y = z
    return np.exp(total / count), 0.15


# --- the table ----------------------------------------------------------------------------------

def read_row(line):
    return dict(zip(FIELDS, (f.strip() for f in line.split("|")))) if line and line[0] not in "#=" else None


def expected(row):
    case = case_of(row)
    words = row["origin"].split()
    if words[0] == "series":
        motion = motion_row(case)
        if "above" in words:
            return from_above(motion)
        if "periods" in words:
            periods, x, v = (float(word.strip(",")) for word in (words[2], words[5], words[6]))
            return series(motion, start=(x, v), periods=int(periods))
        length = mp.mpf(case["relief length_mm"]) / mp.mpf(case["mesh base_pitch_mm"]) if "relief length_mm" in case else None
        return series(motion, "multiplier" if "multiplier" in words else "df", length=length)
    return METHODS[words[0]](case)


METHODS = {"slow": slow_limit, "fast": fast_limit, "Meissner": meissner, "exponent": exponent, "march": march,
           "geometry": bodies.contact_ratio, "iso": bodies.iso, "Weber": bodies.weber, "elements": bodies.elements}


def main(titles):
    path = HERE / "cases.txt"
    for row in filter(None, map(read_row, path.read_text().splitlines())):
        if not row["expected"] or row["origin"].split()[0] not in ("series", *METHODS):
            continue
        if row["title"] not in titles and (titles or row["expected"] != "?"):
            continue
        print(row["title"], flush=True)
        try:
            value, within = expected(row)
        except (ArithmeticError, AssertionError, RuntimeError, TypeError, ValueError) as error:
            print("    no value:", repr(error), flush=True)
            continue
        row["expected"], row["within"] = mp.nstr(mp.mpf(value), 15), f"{float(within):.1e}"
        print("   ", row["expected"], row["within"], flush=True)
        lines = [" | ".join(row[f] for f in FIELDS) if (read_row(line) or {}).get("title") == row["title"] else line
                 for line in path.read_text().splitlines()]
        path.write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main(sys.argv[1:])
