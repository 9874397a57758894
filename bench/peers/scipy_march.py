"""Dynamic factors by marching with SciPy's solvers: restarted at every break and, after they are
located, at changes of contact; the peak of the pair loads refined.

The solvers are stepped here, as solve_ivp's events fail where a leg begins on one.

The state is x in static deflections and dx/dt in static deflections times natural frequency;
the time is the mesh phase.
"""
import functools
import itertools
from math import ceil, exp, floor, log, sqrt

import numpy as np
from numpy.polynomial import Polynomial
from scipy.integrate import DOP853, LSODA, Radau
from scipy.optimize import brentq, minimize_scalar

METHODS = {'DOP853': DOP853, 'LSODA': LSODA, 'Radau': Radau}


class Problem:
    """As `dynamics problem` prints it, SI."""

    def __init__(self, text):
        values = iter(map(float, text.split()))
        self.teeth, self.contact_ratio, m1, m2, self.load, self.zeta = (next(values) for _ in range(6))
        self.by_mass = 1 / m1 + 1 / m2
        self.stiffness, self.relief, self.rpm = ([next(values) for _ in range(int(next(values)))] for _ in range(3))
        mean = sum(2 * k / (i + 1) for i, k in enumerate(self.stiffness) if i % 2 == 0) * self.contact_ratio / 2
        self.scale, self.omega = self.load / mean, sqrt(mean * self.by_mass)


class Zone:
    """A stretch of the phase without breaks."""

    def __init__(self, problem, relief, first, last):
        self.problem, self.first, self.last = problem, first, last
        whole, middle = floor(problem.contact_ratio), (first + last) / 2
        rest = problem.contact_ratio - whole
        u = Polynomial([-1, 2 / problem.contact_ratio])
        self.stiffness, self.error = [], []
        for j in range(ceil(problem.contact_ratio - middle)):
            self.stiffness.append(Polynomial(problem.stiffness)(u(Polynomial([j, 1]))))
            error = Polynomial([0])
            if middle + j > whole:
                error = relief / rest * Polynomial([j - whole, 1])
            if middle + j < rest:
                error = relief / rest * Polynomial([rest - j, -1])
            self.error.append(error / problem.scale)

    def motion(self, contact, turn):
        """Right side and its Jacobian while these pairs touch."""
        problem, zero = self.problem, Polynomial([0])
        rate = [k * (problem.by_mass / problem.omega**2) for k in self.stiffness]
        square = horner(sum((rate[j] for j in contact), zero))
        push = horner(sum((rate[j] * self.error[j] for j in contact), zero)
                      + problem.load * problem.by_mass / problem.scale / problem.omega**2)
        drag = 2 * problem.zeta

        def slope(t, z):
            s = square(t)
            return turn * z[1], turn * (push(t) - s * z[0] - drag * sqrt(s) * z[1])

        def jacobian(t, z):
            s = square(t)
            return np.array([[0, turn], [-turn * s, -turn * drag * sqrt(s)]])
        return slope, jacobian

    def gap(self, j, t, z):
        a, b = (*self.error[j].coef, 0.0)[:2]
        return z[0] - a - b * t

    def side(self, sign, j, dense, t):
        """Of the gap at t, on a continuous solution: positive where the contact is as before."""
        return sign * self.gap(j, t, dense(t))

    def change(self, contact, solver, before, t_before, turn):
        """Time and state at the first change of contact in the solver's last step, or None."""
        found, z, t = None, solver.y, solver.t
        dense = None
        for j in range(len(self.error)):
            sign = 1 if j in contact else -1
            a, b = sign * self.gap(j, t_before, before), sign * self.gap(j, t, z)
            until = t
            if b > 0:                              # it may have dipped in between
                slope = (*self.error[j].coef, 0.0)[1]
                da, db = (sign * (t - t_before) * (turn * v - slope) for v in (before[1], z[1]))
                if not (da < 0 < db) or min(a, b) > (db - da) * 4 / 27:
                    continue
                dense = dense or solver.dense_output()
                places = np.linspace(t_before, t, 17)
                gaps = [sign * self.gap(j, place, dense(place)) for place in places]
                if min(gaps) > 0:
                    continue
                until = places[int(np.argmin(gaps))]
            dense = dense or solver.dense_output()
            after = t_before
            if sign * self.gap(j, after, dense(after)) <= 0:       # LSODA's interpolant misses where it began
                after += (until - t_before) / 1e4
            if sign * self.gap(j, after, dense(after)) <= 0:
                until = after
            elif sign * self.gap(j, until, dense(until)) < 0:
                until = beyond(functools.partial(self.side, sign, j, dense), after, until)
            if found is None or until < found[0]:
                found = until, dense(until)
        return found


def beyond(gap, first, last):
    """Just after the place where a gap closes, so that its sign is the new one."""
    at, more = brentq(gap, first, last, xtol=1e-15), 1e-16
    while gap(at) >= 0 and at < last:
        at, more = min(at + more, last), 2 * more
    return at


def horner(polynomial):
    """The polynomial as a plain function of a number."""
    terms = 'a0'
    names = [f'a{i}' for i in range(len(polynomial.coef))]
    if len(names) > 1:
        terms = names[-1]
        for name in reversed(names[:-1]):
            terms = f'({terms})*t+{name}'
    return eval(f'lambda t: {terms}', dict(zip(names, map(float, polynomial.coef))))


class March:
    def __init__(self, problem, relief, method, tolerance):
        self.problem, self.tolerance = problem, tolerance
        self.method = METHODS[method]
        self.options = dict(rtol=max(tolerance, 1e-13), atol=tolerance)
        change = problem.contact_ratio % 1
        ends = [0, change, 1] if change > 0 else [0, 1]
        self.zones = [Zone(problem, relief, a, b) for a, b in itertools.pairwise(ends)]

    def dynamic_factor(self, rpm):
        """At a speed (1/min), from rest under the mean load."""
        zeta, turn = self.problem.zeta, self.problem.omega * 60 / (self.problem.teeth * rpm)
        decay = exp(-turn * (zeta - sqrt(max(0, zeta**2 - 1))))
        z = np.array([1.0, 0.0])
        for _ in range(30 + int(2 * log(self.tolerance) / log(decay))):  # errors may keep it from settling
            before = z
            z = self.period(z, turn)
            if np.abs(z - before).max() * decay / (1 - decay) < self.tolerance:
                break
        peaks = []
        self.period(z, turn, peaks)
        return max(peaks) * self.problem.scale / self.problem.load

    def period(self, z, turn, peaks=None):
        for zone in self.zones:
            t = zone.first
            while t < zone.last:
                contact = {j for j in range(len(zone.error)) if zone.gap(j, t, z) > 0}
                t, z = self.leg(zone, contact, t, z, turn, peaks)
        return z

    def solver(self, zone, contact, t, z, until, turn):
        slope, jacobian = zone.motion(contact, turn)
        options = dict(self.options, jac=jacobian) if self.method is Radau else self.options
        return self.method(slope, t, z, until, **options)

    def leg(self, zone, contact, t, z, turn, peaks):
        """To the zone's end or the first change of contact: time, state."""
        solver = self.solver(zone, contact, t, z, zone.last, turn)
        start, first, steps, found = t, z, [], None
        while solver.status == 'running' and not found:
            before, t_before = solver.y, solver.t
            solver.step()
            t, z = solver.t, solver.y
            found = zone.change(contact, solver, before, t_before, turn)
            if found:
                t, z = found
            if peaks is not None and t > t_before:
                steps.append((t_before, t, solver.dense_output()))
        if steps:
            peaks += [self.peak(zone, contact, j, start, first, steps, turn) for j in contact]
        return t, z

    def peak(self, zone, contact, j, start, first, steps, turn):
        """Largest load of pair j over a leg: place by the dense output, value by a run up to there."""
        def load(at):
            dense = next(dense for _, until, dense in steps if at <= until)
            return zone.stiffness[j](at) * (dense(at)[0] - zone.error[j](at))

        places = np.unique(np.concatenate([np.linspace(a, b, 9) for a, b, _ in steps]))
        loads = [load(at) for at in places]
        i = int(np.argmax(loads))
        if i in (0, len(places) - 1):
            return loads[i]
        at = minimize_scalar(lambda at: -load(at), bounds=places[[i - 1, i + 1]], method='bounded',
                             options=dict(xatol=1e-6 * (places[i + 1] - places[i - 1]))).x
        solver = self.solver(zone, contact, start, first, at, turn)
        while solver.status == 'running':
            solver.step()
        return max(loads[0], loads[-1], zone.stiffness[j](at) * (solver.y[0] - zone.error[j](at)))


def dynamic_factors(problem, method, tolerance):
    """Relief by relief."""
    factors = []
    for relief in problem.relief:
        march = March(problem, relief, method, tolerance)
        factors += [march.dynamic_factor(rpm) for rpm in problem.rpm]
    return np.array(factors)
