"""Write meissner.dat: stability boundaries of the two-level (Meissner) oscillator.

Constant pair stiffness K, contact ratio c in (1, 2), no relief: mesh stiffness 2K for
phase < c - 1 and K for the rest.  Undamped: the speeds at which |trace of the period
map| = 2, from the closed form.  Damped (damping 2 zeta w x' with the w of the moment):
the least zeta at which the tongue is closed, and the speed at which it closes.
Each boundary is confirmed by integrating the period map with scipy DOP853.
"""
import numpy as np
from mpmath import mp, mpf
from scipy.integrate import solve_ivp

mp.dps = 40
CASES = [  # z1, c, K [N/um], m1, m2 [kg]
    (25, "1.6", 400, "0.8", "0.8"),
    (25, "1.2", 400, "0.8", "0.8"),
    (31, "1.75", 350, "1.3", "0.55"),
    (20, "1.45", 520, "0.6", "2.1"),
    (25, "1.9", 400, "0.8", "0.8"),
]


def segments(case, rpm):
    z1, c, K, m1, m2 = case
    c, m1, m2, T = mpf(c), mpf(m1), mpf(m2), 60 / (z1 * mpf(rpm))
    k = mpf(K) * 10**6 * (m1 + m2) / (m1 * m2)
    return [(mp.sqrt(2 * k), (c - 1) * T), (mp.sqrt(k), (2 - c) * T)]


def trace(case, rpm):
    """Closed form, undamped."""
    (wa, ta), (wb, tb) = segments(case, rpm)
    a, b = wa * ta, wb * tb
    return 2 * mp.cos(a) * mp.cos(b) - (wa / wb + wb / wa) * mp.sin(a) * mp.sin(b)


def damped(case, rpm, zeta):
    """Trace and determinant of the damped period map."""
    M, q = mp.eye(2), mp.sqrt(1 - zeta**2)
    for w, t in segments(case, rpm):
        c, s, e = mp.cos(w * q * t), mp.sin(w * q * t) / q, mp.exp(-zeta * w * t)
        M = e * mp.matrix([[c + zeta * s, s / w], [-w * s, c - zeta * s]]) * M
    return M[0, 0] + M[1, 1], mp.det(M)


def tongue(case, n):
    """Lower and upper speed of tongue n, where (-1)^n trace = 2."""
    sign = (-1) ** n
    f = lambda rpm: sign * trace(case, rpm) - 2
    centre = sum(w * t for w, t in segments(case, 1)) / (n * mp.pi)   # w T = n pi
    grid = [centre * (1 + mpf(i) / 2000) for i in range(-600, 601)]
    inside = [f(r) > 0 for r in grid]
    edges = [i for i in range(1200) if inside[i] != inside[i + 1]]
    near = sorted(sorted(edges, key=lambda i: abs(i - 600))[:2])
    if len(near) < 2:
        return None
    root = lambda i: mp.findroot(f, (grid[i], grid[i + 1]), solver="anderson",
                                 tol=mpf(10) ** -60, verify=False)
    return [root(i) for i in near]


def closing(case, n, lo, hi):
    """Least zeta, and the speed, at which the damped tongue n just touches |mu| = 1."""
    sign = (-1) ** n
    def g(rpm, zeta):
        tr, det = damped(case, rpm, zeta)
        return sign * tr - 1 - det
    F = lambda r, z: [g(r * lo, z), mp.diff(lambda q: g(q * lo, z), r)]
    # start: best speed on a grid, zeta by bisection there
    top = lambda z: max((g(lo + (hi - lo) * i / 40, z), i) for i in range(41))
    a, b = mpf(0), mpf(1) / 2
    for _ in range(20):
        m = (a + b) / 2
        a, b = (m, b) if top(m)[0] > 0 else (a, m)
    i = top(a)[1]
    r, z = mp.findroot(F, ((lo + (hi - lo) * i / 40) / lo, a), tol=mpf(10) ** -50)
    worst = max(g(lo + (hi - lo) * i / 400, z) for i in range(401))
    if worst > mpf(10) ** -12:
        raise ValueError("tongue still open elsewhere")
    return z, r * lo


def integrated_trace(case, rpm):
    """Trace of the undamped map by DOP853."""
    M = np.eye(2)
    for w, t in ([float(one) for one in segment] for segment in segments(case, rpm)):
        P = np.empty((2, 2))
        for i in range(2):
            P[:, i] = solve_ivp(lambda q, y: [w * y[1], -w * y[0]], (0, t), np.eye(2)[i],
                                method="DOP853", rtol=1e-13, atol=1e-15).y[:, -1]
        D = np.diag([1, w])                       # state (x, x'/w) -> (x, x')
        M = D @ P @ np.linalg.inv(D) @ M
    return np.trace(M)


def main():
    lines, worst = [], 0.0
    for case in CASES:
        for n in (1, 2, 3):
            edges = tongue(case, n)
            if edges is None:
                print("no open tongue", case, n)
                continue
            z, at = closing(case, n, *edges)
            for r in edges:
                worst = max(worst, abs(abs(integrated_trace(case, r)) - 2))
                lines.append(" ".join(map(str, case[:3])) + f" {case[3]} {case[4]} "
                             f"{mp.nstr(r, 20)} {n} {mp.nstr(z, 20)} {mp.nstr(at, 20)}")
    head = f"""\
Stability boundaries of the undamped prescribed mesh with constant pair stiffness.
Contact ratio in (1,2), no relief, no friction: mesh stiffness 2K for phase < c - 1, then K.
Two rows per tongue: lower and upper speed at which |trace of the period map| = 2
(trace = -2 for tongues 1 and 3, +2 for tongue 2); between them the motion is unstable.
Tongue n lies about mesh frequency = 2/n times the mean natural frequency.
How had: closed form in cos and sin, root found with 40 digits.
How confirmed: period map at the boundary by scipy DOP853 (rtol 1e-13),
largest difference of |trace| from 2: {worst:.1e}.  zeta_closing: two equations solved with
40 digits (largest multiplier 1, stationary in speed), checked at 401 speeds in the tongue.
zeta_closing: least damping ratio (damping 2 zeta w x', w that of the moment) at which the
whole tongue is stable (largest multiplier modulus just 1), reached at rpm_closing.
Columns:
z1 (pinion teeth), contact_ratio [base pitches], coef0 = K [N/um], m1 m2 [kg],
rpm_boundary [1/min], tongue_index, zeta_closing [-], rpm_closing [1/min]
z1 contact_ratio coef0 m1 m2 rpm_boundary tongue_index zeta_closing rpm_closing"""
    with open("meissner.dat", "w") as f:
        f.write("".join("# " + line + "\n" for line in head.split("\n")) + "\n".join(lines) + "\n")
    print(len(lines), "rows, |trace| confirmed to", worst)


if __name__ == "__main__":
    main()
