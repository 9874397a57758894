"""Confirmation by direct integration: scipy DOP853 in SI units, one leg per contact set.

Written from the equation of motion, sharing only the input row with the other route.
"""
import itertools
from math import floor, pi, radians, sqrt, tan

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq


class Direct:
    def __init__(self, row, rtol=1e-13):
        self.r, self.rtol = row, rtol
        self.T = 60.0 / (row.z1 * row.rpm)
        self.N = floor(row.c)

    def K(self, s):
        u = 2 * s / self.r.c - 1
        return 1e6 * sum(a * u**i for i, a in enumerate(self.r.coef))

    def e(self, s, smid):
        r, B = self.r, self.r.c - self.N
        if smid > self.N:
            return 1e-6 * r.cp * ((s - self.N) / B) ** r.shape
        if smid < B:
            return 1e-6 * r.cg * ((B - s) / B) ** r.shape
        return 0.0 * s

    def f(self, s, smid):
        r, sign = self.r, (-1 if smid < self.r.sp else 1)
        rho1 = (r.z1 * tan(radians(r.angle)) / (2 * pi) + s - r.sp) * 2 * pi / r.z1
        rho2 = (r.z2 * tan(radians(r.angle)) / (2 * pi) - (s - r.sp)) * 2 * pi / r.z2
        return 1 + sign * r.mu * rho1, 1 + sign * r.mu * rho2

    def rhs(self, mid, contact, back):
        r, T = self.r, self.T
        me = r.m1 * r.m2 / (r.m1 + r.m2)
        nominal = [j for j in range(self.N + 1) if mid + j < r.c]

        def fun(t, y):
            tau = t / T
            if back:
                k = sum(self.K(tau + j) for j in nominal)
                return [y[1], r.Fs / me - k * (y[0] + 1e-6 * r.backlash) / me
                        - 2 * r.zeta * sqrt(k / me) * y[1]]
            w2, p = 0.0, (r.m1 + r.m2) * r.Fs / (r.m1 * r.m2)
            for j in contact:
                s = tau + j
                f1, f2 = self.f(s, mid + j)
                k = self.K(s) * (f1 * r.m2 + f2 * r.m1) / (r.m1 * r.m2)
                w2 += k
                p += k * self.e(s, mid + j)
            return [y[1], p - w2 * y[0] - 2 * r.zeta * sqrt(w2) * y[1]]
        return fun

    def run(self, fun, t0, t1, y, **kw):
        return solve_ivp(fun, (t0, t1), y, method="DOP853", rtol=self.rtol,
                         atol=[1e-20, 1e-16], **kw)

    def leg(self, t, t1, y, mid, contact, back, nominal):
        """Integrate to the first change of the contact set or to t1."""
        fun, r = self.rhs(mid, contact, back), self.r
        def level(j):
            return lambda q: -1e-6 * r.backlash if j == "back" else self.e(q / self.T + j, mid + j)
        marks = list(nominal) + (["back"] if r.backlash >= 0 else [])
        events = []
        for j in marks:
            line = level(j)
            ev = lambda q, z, line=line: z[0] - line(q)
            above = (j in contact) if j != "back" else not back
            ev.terminal, ev.direction = True, (-1 if above else 1)
            events.append(ev)
        fast = sqrt(2 * self.K(r.c / 2) * (r.m1 + r.m2) / (r.m1 * r.m2))
        sol = self.run(fun, t, t1, y, events=events, dense_output=True, max_step=0.2 / fast)
        te, who = sol.t[-1], None
        if sol.status == 1:
            who = next(j for j, te_ in zip(marks, sol.t_events) if len(te_))
            for _ in range(3):                     # sharpen the located time
                ye = self.run(fun, t, te, y).y[:, -1]
                line, d = level(who), 1e-6 * self.T
                te -= (ye[0] - line(te)) / (ye[1] - (line(te + d) - line(te - d)) / (2 * d))
        ye = self.run(fun, t, te, y).y[:, -1]
        self.largest(fun, sol.sol, t, te, y, mid, contact)
        return te, ye, who

    def largest(self, fun, dense, t, te, y, mid, contact):
        if not self.peaks or te <= t:
            return
        for j in contact:
            F = lambda q: self.K(q / self.T + j) * (dense(q)[0] - self.e(q / self.T + j, mid + j))
            n = 400
            q = np.linspace(t, te, n + 1)
            i = int(np.argmax([F(a) for a in q]))
            best = q[i]
            if 0 < i < n:
                d = 1e-6 * self.T
                def slope(a):
                    s = a / self.T + j
                    dK = (self.K((a + d) / self.T + j) - self.K((a - d) / self.T + j)) / (2 * d)
                    de = (self.e((a + d) / self.T + j, mid + j)
                          - self.e((a - d) / self.T + j, mid + j)) / (2 * d)
                    z = dense(a)
                    return dK * (z[0] - self.e(s, mid + j)) + self.K(s) * (z[1] - de)
                if slope(q[i - 1]) * slope(q[i + 1]) < 0:
                    best = brentq(slope, q[i - 1], q[i + 1], xtol=1e-22, rtol=1e-15)
            x = self.run(fun, t, best, y).y[0, -1] if best > t else y[0]
            s = best / self.T + j
            self.peak = max(self.peak, self.K(s) * (x - self.e(s, mid + j)))

    def period(self, y, peaks=False):
        r, T = self.r, self.T
        self.peaks, self.peak = peaks, 0.0
        marks = {0.0, r.c - self.N, 1.0} | ({r.sp - floor(r.sp)} if r.mu else set())
        marks = sorted(marks)
        for a, b in itertools.pairwise(marks):
            mid = (a + b) / 2
            nominal = [j for j in range(self.N + 1) if mid + j < r.c]
            contact = [j for j in nominal if y[0] > self.e(a + j, mid + j)]
            back = r.backlash >= 0 and y[0] < -1e-6 * r.backlash
            t, t1, who = a * T, b * T, 0
            while who is not None:
                t, y, who = self.leg(t, t1, y, mid, contact, back, nominal)
                if who == "back":
                    back = not back
                elif who is not None:              # pairs of equal error change together
                    at = lambda j: (self.e(t / T + j, mid + j), self.e(mid + j, mid + j))
                    same = {j for j in nominal if at(j) == at(who)
                            and (j in contact) == (who in contact)}
                    contact = sorted(set(contact) ^ same)
        return np.array(y)


def confirm(row, x0_um, v0):
    """Fixed point of the period map by Newton from a start 1 % off; returns DF, mu_max, x0."""
    d = Direct(row)
    scale = np.array([1e-6, 1e-6 * sqrt(1e6 * row.coef[0] * (row.m1 + row.m2) / (row.m1 * row.m2))])
    y = np.array([1e-6 * x0_um * 1.01, v0])
    h = 3e-4
    for _ in range(8):
        r = d.period(y) - y
        J = np.empty((2, 2))
        for i in range(2):
            q = np.zeros(2)
            q[i] = h * scale[i]
            J[:, i] = (d.period(y + q) - d.period(y - q)) / (2 * q[i])
        if np.max(np.abs(r / scale)) < 1e-11:
            break
        y = y - np.linalg.solve(J - np.eye(2), r)
    d.period(y, peaks=True)
    return d.peak / row.Fs, max(abs(np.linalg.eigvals(J))), y[0]
