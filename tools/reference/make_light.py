"""Periodic motions of a mesh with constant pair stiffness and no relief under light damping, in closed form.

Without relief all pairs part and meet together, where x = 0, so that between two changes the motion is that of a linear
oscillator with constant coefficients. Its zeros are bracketed by samples, a fiftieth of a cycle apart, and found by Brent's
method; the period map is closed by Newton's method with differences for its derivative.
Prints speed, damping ratio, start, dynamic factor and largest Floquet multiplier.
"""
from math import pi

import numpy as np
from scipy.optimize import brentq

STIFFNESS, LOAD, MASS, TEETH, RATIO = 300e6, 3000.0, 0.5, 25, 1.6  # N/m, N, kg (two of 1 kg), -, -
MEAN = STIFFNESS * RATIO
STATIC, NATURAL = LOAD / MEAN, np.sqrt(MEAN / MASS)


def piece(state, stiffness, zeta):
    """x and v over the time from `state` on, with this stiffness; 0: the flanks are apart."""
    x0, v0 = state
    if not stiffness:
        a = LOAD / MASS
        return lambda t: (x0 + v0 * t + a * t * t / 2, v0 + a * t)
    w = np.sqrt(stiffness / MASS)
    rest, d, wd = LOAD / stiffness, zeta * w, w * np.sqrt(1 - zeta * zeta)
    c, s = x0 - rest, (v0 + d * (x0 - rest)) / wd

    def motion(t):
        decay, cos, sin = np.exp(-d * t), np.cos(wd * t), np.sin(wd * t)
        x = decay * (c * cos + s * sin)
        return rest + x, decay * wd * (s * cos - c * sin) - d * x
    return motion


def period(state, duration, zeta, peaks=None):
    """The state after one mesh period; `peaks` takes the largest deflections."""
    for pairs, until in ((2, (RATIO - 1) * duration), (1, (2 - RATIO) * duration)):
        left = until
        while left > 0:
            closed = state[0] > 0 or (state[0] == 0 and state[1] > 0)
            motion = piece(state, pairs * STIFFNESS if closed else 0.0, zeta)
            t = np.linspace(0, left, 3 + int(50 * NATURAL * np.sqrt(2) * left / (2 * pi)))
            x = motion(t)[0]
            beyond = np.flatnonzero((x < 0) if closed else (x > 0))
            beyond = beyond[beyond > 0]
            end = left
            if len(beyond):
                i = beyond[0]
                low = t[i - 1] if i > 1 or state[0] != 0 else t[1] * 1e-9
                end = brentq(lambda q: motion(q)[0], low, t[i], xtol=1e-22, rtol=1e-15)
            if peaks is not None:
                fine = np.linspace(0, end, 20000)
                peaks.append(motion(fine)[0].max() if closed else 0.0)
            state = np.array(motion(end))
            if end < left:
                state[0] = 0.0
            left -= end
    return state


def jacobian(state, duration, zeta):
    scale = np.array([STATIC, STATIC * NATURAL])
    columns = [(period(state + h, duration, zeta) - period(state - h, duration, zeta)) / 2e-6 / scale[i]
               for i, h in enumerate(1e-6 * np.diag(scale))]
    return np.array(columns).T


def closed(state, duration, zeta):
    for _ in range(40):
        step = np.linalg.solve(np.eye(2) - jacobian(state, duration, zeta), period(state, duration, zeta) - state)
        state = state + step
        if abs(step[0]) < 1e-13 * STATIC:
            break
    return state


def linear(duration, zeta):
    """The motion that stays in contact, whether it pulls or not."""
    states = []
    for start in ((0.0, 0.0), (1.0, 0.0), (0.0, 1.0)):
        state = np.array(start)
        for pairs, span in ((2, RATIO - 1), (1, 2 - RATIO)):
            state = np.array(piece(state, pairs * STIFFNESS, zeta)(span * duration))
        states.append(state)
    matrix = np.array([states[1] - states[0], states[2] - states[0]]).T
    return np.linalg.solve(np.eye(2) - matrix, states[0])


def show(rpm, zeta, start=None):
    duration = 60 / (TEETH * rpm)
    state = linear(duration, zeta) if start is None else np.array(start)
    state = closed(state, duration, zeta)
    peaks = []
    period(state, duration, zeta, peaks)
    multiplier = max(abs(np.linalg.eigvals(jacobian(state, duration, zeta))))
    print(rpm, zeta, state, 'DF', max(peaks) * STIFFNESS / LOAD, 'multiplier', multiplier)


if __name__ == '__main__':
    show(8000.0, 1e-3)
    show(8000.0, 0.0)
    half = NATURAL * 60 / (2 * pi * TEETH) / 2
    # Found by Newton's method from 150 random starts, which lead to three motions: the other two repel.
    show(half, 0.01, (1.66595669 * STATIC, 4.84971444 * STATIC * NATURAL))
