"""The prescribed-mesh model: one row of inputs, its equation of motion, its table.

The functions take a number context `ctx`: mpmath.mp (many digits) or mpmath.fp
(ordinary doubles).  The unknown is x [um]; time is the mesh phase tau, so that
derivatives are per mesh period T = 60/(z1 rpm).  A polynomial is the list of its
ascending coefficients.
"""
from dataclasses import astuple, dataclass

COLUMNS = ["id", "z1", "z2", "pressure_angle_deg", "contact_ratio", "pitch_point",
           "n_coef", "coef0", "coef1", "coef2", "coef3", "coef4", "m1", "m2", "Fs",
           "zeta", "mu", "backlash_um", "relief_pinion_um", "relief_gear_um", "shape",
           "rpm"]
UNITS = """\
id (row number), z1 z2 (teeth), pressure_angle_deg [deg], contact_ratio [base pitches],
pitch_point [base pitches from start of contact A], n_coef (stiffness coefficients used),
coef0..coef4 [N/um] (pair stiffness, ascending powers of u = 2 s/contact_ratio - 1),
m1 m2 [kg], Fs [N], zeta [-], mu (friction) [-], backlash_um [um] (-1: no back side),
relief_pinion_um relief_gear_um [um], shape (1 linear, 2 parabolic), rpm [1/min] of pinion,
DF = max over pairs and phase of K_j max(0, x - e_j)/Fs [-],
mu_max = largest modulus of the Floquet multipliers of the period map [-];
further columns, not needed to run the row:
x0_um [um] and v0_m_per_s [m/s]: x and dx/dt of the periodic solution at phase 0
(a new pair is just entering at A), loss: 0 every pair in possible contact is loaded at all
phases, 1 some pair separates, 2 all pairs separate (free flight), 3 back-side contact too"""


@dataclass
class Row:
    """Inputs of one table row, in table order (relief in um, K in N/um, rest SI)."""
    z1: int = 25
    z2: int = 25
    angle: float = 20.0
    c: float = 1.6
    sp: float = 0.8
    coef: tuple = (400.0,)
    m1: float = 0.8
    m2: float = 0.8
    Fs: float = 7000.0
    zeta: float = 0.05
    mu: float = 0.0
    backlash: float = -1.0
    cp: float = 0.0
    cg: float = 0.0
    shape: int = 1
    rpm: float = 5000.0

    def fields(self):
        """Values in the order of COLUMNS, without the id."""
        f = list(astuple(self))
        coef = list(self.coef)
        return f[:5] + [len(coef)] + coef + [0.0] * (5 - len(coef)) + f[6:]


def padd(p, q):
    n = max(len(p), len(q))
    return [(p[i] if i < len(p) else 0) + (q[i] if i < len(q) else 0) for i in range(n)]


def pmul(p, q):
    r = [0] * (len(p) + len(q) - 1)
    for i, a in enumerate(p):
        for k, b in enumerate(q):
            r[i + k] = r[i + k] + a * b
    return r


def pval(p, t):
    r = 0
    for a in reversed(p):
        r = r * t + a
    return r


def pder(p):
    return [i * a for i, a in enumerate(p)][1:] or [0]


class Mesh:
    """The row with its numbers converted to the context, and what follows from it."""

    def __init__(self, row, ctx):
        num = lambda v: ctx.mpf(str(v)) if ctx.__class__.__name__ == "MPContext" else float(v)
        self.ctx, self.row = ctx, row
        for name in ("c", "sp", "m1", "m2", "Fs", "zeta", "mu", "backlash", "cp", "cg", "rpm"):
            setattr(self, name, num(getattr(row, name)))
        self.coef = [num(a) for a in row.coef]
        self.tan = ctx.tan(num(row.angle) * ctx.pi / 180)
        self.period = 60 / (row.z1 * self.rpm)
        # acceleration [um per period^2] of unit force * mass / (m1 m2)
        self.gain = 10**6 * self.period**2 / (self.m1 * self.m2)
        self.whole = int(row.c)                    # pairs always in possible contact
        self.B = self.c - self.whole               # inner end of the relief at A
        zero = num(0)
        breaks = {zero, self.B, num(1)}
        if row.mu != 0:
            breaks.add(self.sp - int(row.sp))
        self.breaks = sorted(breaks)

    def pairs(self, mid):
        """Pairs in possible contact in the phase interval with this midpoint."""
        return [j for j in range(self.whole + 1) if mid + j < self.c]

    def stiffness(self, tau, j):
        """K_j as a polynomial in the time t after phase tau."""
        if len(self.coef) == 1:
            return list(self.coef)
        u = [2 * (tau + j) / self.c - 1, 2 / self.c]
        p = [self.coef[-1]]
        for a in reversed(self.coef[:-1]):
            p = padd(pmul(p, u), [a])
        return p

    def error(self, tau, j, mid):
        """e_j as a polynomial in t; mid tells on which side of B and D the pair is."""
        s, smid = tau + j, mid + j
        if smid > self.whole and self.cp != 0:
            amount, lin = self.cp, [(s - self.whole) / self.B, 1 / self.B]
        elif smid < self.B and self.cg != 0:
            amount, lin = self.cg, [(self.B - s) / self.B, -1 / self.B]
        else:
            return [self.B * 0]
        return [amount * a for a in (lin if self.row.shape == 1 else pmul(lin, lin))]

    def weight(self, tau, j, mid):
        """f1 m2 + f2 m1 of a pair, a polynomial in t."""
        if self.mu == 0:
            return [self.m1 + self.m2]
        sign = -1 if mid + j < self.sp else 1
        d, pi2 = tau + j - self.sp, 2 * self.ctx.pi
        f1 = [1 + sign * self.mu * (self.tan + d * pi2 / self.row.z1),
              sign * self.mu * pi2 / self.row.z1]
        f2 = [1 + sign * self.mu * (self.tan - d * pi2 / self.row.z2),
              -sign * self.mu * pi2 / self.row.z2]
        return padd([self.m2 * a for a in f1], [self.m1 * a for a in f2])

    def equation(self, tau, mid, contact, back):
        """Polynomials W, R in t: x'' + 2 zeta sqrt(W) x' + W x = R."""
        zero = self.B * 0
        W, R = [zero], [(self.m1 + self.m2) * self.Fs * self.gain]
        for j in (self.pairs(mid) if back else contact):
            K = [self.gain * a for a in self.stiffness(tau, j)]
            if back:
                k = [(self.m1 + self.m2) * a for a in K]
                W, R = padd(W, k), padd(R, [-self.backlash * a for a in k])
            else:
                k = pmul(K, self.weight(tau, j, mid))
                W, R = padd(W, k), padd(R, pmul(k, self.error(tau, j, mid)))
        return W, R


def static_deflection(row):
    """x [um] at rest under Fs at phase 0, friction ignored (start of a march)."""
    import mpmath
    m = Mesh(row, mpmath.fp)
    mid = 1e-9
    load = lambda x: sum(pval(m.stiffness(0.0, j), 0) *
                         max(0.0, x - pval(m.error(0.0, j, mid), 0)) for j in m.pairs(mid))
    lo, hi = 0.0, 1e4
    for _ in range(200):
        x = (lo + hi) / 2
        lo, hi = (x, hi) if load(x) < row.Fs else (lo, x)
    return x


def write_table(path, title, rows, results, extra=()):
    """Write the table; results are tuples (DF, mu_max, x0, v0, loss) of strings."""
    names = [*COLUMNS, "DF", "mu_max", "x0_um", "v0_m_per_s", "loss", *list(extra)]
    with open(path, "w") as f:
        f.writelines(("# " + line).rstrip() + "\n" for line in (title.strip() + "\nColumns:\n" + UNITS).split("\n"))
        f.write("# " + " ".join(names) + "\n")
        f.writelines(" ".join([str(i)] + [str(v) for v in row.fields()] + list(res)) + "\n" for i, (row, res) in enumerate(zip(rows, results), 1))
