"""Periodic solutions to many digits: piecewise propagation with located events.

Two kinds of piece: `exact_piece` (closed form, constant stiffness, polynomial
forcing) and `taylor_piece` (Taylor series of high order, any polynomial stiffness).
"""
from model import Mesh, pder, pval, static_deflection


def exact_piece(ctx, W, R, zeta, x, v):
    """Closed-form solution; returns t -> (x, x')."""
    if any(a != 0 for a in W[1:]):
        raise ValueError("stiffness not constant")
    if W[0] == 0:
        return lambda t: (x + v * t + R[0] * t * t / 2, v + R[0] * t)
    W, r = W[0], ([*R, 0, 0])[:3]
    d = 2 * zeta * ctx.sqrt(W)
    p2 = r[2] / W
    p1 = (r[1] - 2 * d * p2) / W
    p0 = (r[0] - 2 * p2 - d * p1) / W
    root = ctx.sqrt(ctx.mpc(d * d / 4 - W))
    l1, l2 = -d / 2 + root, -d / 2 - root
    a1 = ((v - p1) - l2 * (x - p0)) / (l1 - l2)
    a2 = (x - p0) - a1

    def at(t):
        e1, e2 = a1 * ctx.exp(l1 * t), a2 * ctx.exp(l2 * t)
        return ((e1 + e2).real + p0 + t * (p1 + t * p2),
                (l1 * e1 + l2 * e2).real + p1 + 2 * p2 * t)
    return at


def taylor_piece(ctx, W, R, zeta, x, v):
    """Taylor series about the start of the piece; returns t -> (x, x')."""
    n = 14 if ctx.__class__.__name__ == "FPContext" else 34
    W, R = W + [0] * (n - len(W)), R + [0] * (n - len(R))
    d = [0 * x] * n                                   # series of 2 zeta sqrt(W)
    if W[0] != 0 and zeta != 0:
        w = [ctx.sqrt(W[0])]
        for i in range(1, n):
            w.append((W[i] - sum(w[k] * w[i - k] for k in range(1, i))) / (2 * w[0]))
        d = [2 * zeta * a for a in w]
    deg = max(i for i in range(n) if W[i] != 0 or i == 0)
    a, b = [x, v], [v]                                # series of x and x'
    for i in range(n - 2):
        r = R[i] - sum(W[k] * a[i - k] for k in range(min(i, deg) + 1)) \
                 - sum(d[k] * b[i - k] for k in range(i + 1))
        b.append(r / (i + 1))
        a.append(b[-1] / (i + 2))
    return lambda t: (pval(a, t), pval(b, t))


def find_root(f, a, b, eps):
    """Root of f in [a, b] by the Illinois method."""
    fa, fb, last = f(a), f(b), None
    for _ in range(400):
        if fa == fb:
            return a
        t = (a * fb - b * fa) / (fb - fa)
        ft = f(t)
        if ft == 0 or (last is not None and abs(t - last) <= eps):
            return t
        if (ft > 0) == (fb > 0):
            fa = fa / 2
        else:
            a, fa = b, fb
        b, fb, last = t, ft, t
    raise RuntimeError("no convergence")


class Period:
    """Run one mesh period from (x, x') at phase 0; keeps peak load and events."""

    def __init__(self, mesh, piece, state, bonded=False, peaks=False):
        self.m, self.piece, self.bonded, self.peaks = mesh, piece, bonded, peaks
        self.peak, self.loss, self.events = 0, 0, []
        self.eps = mesh.ctx.eps * 16
        self.x, self.v = state
        for a, b in zip(mesh.breaks, mesh.breaks[1:]):
            self.interval(a, b)
        self.state = (self.x, self.v)

    def interval(self, a, b):
        """Between two breaks of the phase; the set of nominal pairs is fixed."""
        m, mid = self.m, (a + b) / 2
        pairs = m.pairs(mid)
        contact = {j for j in pairs
                   if self.bonded or self.x > pval(m.error(a, j, mid), 0)}
        back = m.row.backlash >= 0 and not self.bonded and self.x < -m.backlash
        tau = a
        while tau < b:
            W, R = m.equation(tau, mid, contact, back)
            h = 1 / m.ctx.mpf(48)
            if W[0] > 0:
                h = min(h, m.ctx.mpf(2) / 5 / m.ctx.sqrt(W[0]))
            last = b - tau <= h
            h = b - tau if last else h
            at = self.piece(m.ctx, W, R, m.zeta, self.x, self.v)
            err = {j: m.error(tau, j, mid) for j in pairs}
            te, who = h, None
            if not self.bonded:
                levels = [(j, err[j], j in contact) for j in pairs]
                if m.row.backlash >= 0:
                    levels.append(("back", [-m.backlash], not back))
                for j, level, above in levels:
                    t = self.event(at, level, above, h)
                    if t is not None and t < te:
                        te, who = t, j
            self.loss = max(self.loss, 3 if back else 2 if not contact
                            else 1 if len(contact) < len(pairs) else 0)
            if self.peaks:
                for j in contact:
                    self.load_peak(at, m.stiffness(tau, j), err[j], te)
            self.x, self.v = at(te)
            tau = b if last and who is None else tau + te
            if who == "back":
                back = not back
            elif who is not None:             # pairs of equal error change together
                contact ^= {j for j in pairs if err[j] == err[who]
                            and (j in contact) == (who in contact)}
            if who is not None:
                self.events.append((tau, who))

    def extremum(self, slope, h):
        """Time in (0, h) at which the slope changes sign, or None."""
        if (slope(0 * h) > 0) != (slope(h) > 0):
            return find_root(slope, 0 * h, h, self.eps)
        return None

    def event(self, at, level, above, h):
        """First time at which x - level leaves its side (above or below)."""
        dl = pder(level)
        g = lambda t: at(t)[0] - pval(level, t)
        side = 1 if above else -1
        t0 = self.extremum(lambda t: at(t)[1] - pval(dl, t), h)
        if t0 is not None and side * g(t0) < 0:
            return find_root(g, 0 * h, t0, self.eps)
        if side * g(h) < 0:
            return find_root(g, 0 * h if t0 is None else t0, h, self.eps)
        return None

    def load_peak(self, at, K, e, h):
        dK, de = pder(K), pder(e)
        force = lambda t: pval(K, t) * (at(t)[0] - pval(e, t))

        def slope(t):
            x, v = at(t)
            return pval(dK, t) * (x - pval(e, t)) + pval(K, t) * (v - pval(de, t))
        t0 = self.extremum(slope, h)
        for t in (0 * h, h, t0):
            if t is not None:
                self.peak = max(self.peak, force(t))


def jacobian(step, y, ctx, scale):
    """Central differences of the period map."""
    h = 1e-4 if ctx.__class__.__name__ == "FPContext" else ctx.mpf(10) ** (-ctx.dps // 3)
    cols = []
    for i in range(2):
        hi, lo = list(y), list(y)
        hi[i] += h * scale[i]
        lo[i] -= h * scale[i]
        a, b = step(hi), step(lo)
        cols.append([(a[k] - b[k]) / (2 * h * scale[i]) for k in range(2)])
    return [[cols[k][i] for k in range(2)] for i in range(2)]


def largest_multiplier(ctx, J):
    tr, det = J[0][0] + J[1][1], J[0][0] * J[1][1] - J[0][1] * J[1][0]
    disc = tr * tr / 4 - det
    return ctx.sqrt(det) if disc < 0 else abs(tr) / 2 + ctx.sqrt(disc)


def march(row, piece, start=None, limit=20000):
    """March in doubles from `start` (default: at rest, static) until periodic.

    Returns (state, number of periods) or None when no period-one motion is reached.
    """
    import mpmath
    m = Mesh(row, mpmath.fp)
    y = start or (static_deflection(row), 0.0)
    for n in range(limit):
        z = Period(m, piece, y).state
        if abs(z[0] - y[0]) + 0.1 * abs(z[1] - y[1]) < 1e-9:
            return z, n
        y = z
    return None


def solve(row, piece, ctx, guess=None):
    """Periodic solution and its reference values, as a dict.

    Without a guess all pairs are taken to stay loaded (linear problem, then checked).
    """
    m = Mesh(row, ctx)
    x = ctx.mpf(static_deflection(row))
    w = ctx.sqrt(m.gain * (m.m1 + m.m2) * m.coef[0])
    y, bonded = ((x, 0 * x), True) if guess is None else (tuple(map(ctx.mpf, guess)), False)
    step = lambda s: Period(m, piece, s, bonded).state
    scale = (ctx.mpf(1), w)
    for n in range(12):
        z = step(y)
        r = [z[i] - y[i] for i in range(2)]
        size = abs(r[0]) + abs(r[1]) / w
        if n > 0 and size < ctx.mpf(10) ** (6 - ctx.dps) * x:
            break
        J = jacobian(step, y, ctx, scale)
        a, b, c, d = J[0][0] - 1, J[0][1], J[1][0], J[1][1] - 1
        det = a * d - b * c
        y = (y[0] - (d * r[0] - b * r[1]) / det, y[1] - (a * r[1] - c * r[0]) / det)
    else:
        raise RuntimeError("Newton did not converge")
    run = Period(m, piece, y, peaks=True)
    if guess is None and (run.events or run.loss):
        raise ValueError("a pair separates")
    return dict(DF=run.peak / m.Fs, mu_max=largest_multiplier(ctx, jacobian(step, y, ctx, scale)),
                trace=J[0][0] + J[1][1], x0=y[0], v0=y[1] / m.period / 10**6, loss=run.loss,
                events=len(run.events))
