"""The motion with inertia at the bores against the chain of four inertias whose turning it replaces by a compliance.

Two equal gears with the bodies and hubs of test/reference/hub.dat, pairs without relief that keep contact, so that the chain is
linear and its steady motion follows from its propagator over one mesh period. The mesh's damper works on what its spring does.
"""

from itertools import pairwise

import numpy as np
import pytest
from conftest import ROOT

import gearsweep

WIDTH, RATIO, LOAD, DAMPING, TEETH = 25.4, 1.6, 7000.0, 0.17, 25
STEPS = 600  # of Runge-Kutta's method in a period
SPEEDS = np.arange(0.2, 1.5001, 0.02)  # over that of the resonance


def gear(bore):
    """Mass on the line of action, kg, and turning under load, m/N, of a gear on this bore, mm."""
    rows = [line.split() for line in (ROOT / 'test/reference/hub.dat').read_text().splitlines() if line[0] != '#']
    row = next(row for row in rows if 2 * float(row[0]) == bore)
    return float(row[2]) * WIDTH, 1e-6 * float(row[6]) / WIDTH


def pair_stiffness(s, shared):
    """Of one pair, N/m, with the compliance that pairs share; 0 off its path."""
    own = 330e6 * (1 - 0.3 * (2 * s / RATIO - 1) ** 2) * (s < RATIO)
    return own / (1 + shared * own)


def library(mass, shared, rpm):
    """Dynamic factors by one degree of freedom, and the natural frequency, Hz."""
    s = np.linspace(0, RATIO, 161)
    u = 2 * s / RATIO - 1
    fit = np.polynomial.polynomial.polyfit(u, 1e-6 * pair_stiffness(s * (1 - 1e-12), shared), 8)
    case = gearsweep.Case(f"""&case tasks = 'sweep' / &pinion teeth = {TEETH} effective_mass_kg = {mass} / &gear effective_mass_kg = {mass} /
&load normal_force_n = {LOAD} / &dynamics damping_ratio = {DAMPING} / &relief amount_um = 0 /
&mesh model = 'polynomial' contact_ratio = {RATIO} shared_compliance_um_n = {1e6 * shared}
      coefficients = {', '.join(map(str, fit))} /
&sweep rpm_first = {rpm[0]} rpm_last = {rpm[-1] + 0.01} rpm_step = {rpm[1] - rpm[0]} /""")
    study = gearsweep.run(case)
    return np.array(study.sweep.dynamic_factor[0]), study.motion.natural_frequency_hz


def chain(body, hub, twist, shared, rpm):
    """Dynamic factors of the chain hub, body, mesh, body, hub: its two halves move alike."""
    period = 60 / (TEETH * rpm)
    n = len(rpm)
    mass = (body + hub) / 2
    flow = np.tile(np.eye(5), (n, 1, 1))
    course = [flow]

    def rate(phase):
        own = [k / (1 - shared * k) for k in (pair_stiffness(np.float64(phase + j), shared) for j in (0, 1))]
        total = sum(own)
        whole = total / (1 + shared * total)
        damper = 2 * DAMPING * np.sqrt(whole * mass) * (total / whole) ** 2
        spring = 1 / (2 * twist)
        a = np.zeros((5, 5))
        a[0, 2] = a[1, 3] = 1
        a[2, :3] = -2 * (total + spring) / body, 2 * spring / body, -2 * damper / body
        a[3, 0], a[3, 1], a[3, 4] = 2 * spring / hub, -2 * spring / hub, 2 * LOAD / hub
        return period[:, None, None] * a, max(own)

    # Steps end where the second pair leaves.
    cuts = np.concatenate([np.linspace(0, RATIO - 1, STEPS + 1), np.linspace(RATIO - 1, 1, STEPS + 1)[1:]])
    largest = [rate(0.0)[1]]
    for a, b in pairwise(cuts):
        h = b - a
        first, middle, last = rate(a)[0], rate((a + b) / 2)[0], rate(b - 1e-13)[0]
        k1 = first @ flow
        k2 = middle @ (flow + h / 2 * k1)
        k3 = middle @ (flow + h / 2 * k2)
        k4 = last @ (flow + h * k3)
        flow = flow + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        course.append(flow)
        largest.append(rate(b - 1e-13)[1])
    start = np.linalg.solve(np.eye(4) - flow[:, :4, :4], flow[:, :4, 4:])
    state = np.concatenate([start, np.ones((n, 1, 1))], axis=1)
    load = [k * (flow @ state)[:, 0, 0] / LOAD for k, flow in zip(largest, course, strict=True)]
    assert np.min(load) > 0
    return np.max(load, axis=0)


# bore, mm; difference of the largest dynamic factors, and of those at any one speed: as doc/dynamics.md says.
@pytest.mark.parametrize(('bore', 'worst', 'anywhere'), [(40, 0.01, 0.02), (20, 0.02, 0.05), (10, 0.12, 0.35)])
def test_dynamic_factors_of_the_chain(bore, worst, anywhere):
    body, twist = gear(bore)
    for over in (0.5, 1.0, 5.0):
        hub = over * body
        shared = 2 * (hub / (body + hub)) ** 2 * twist
        _, hertz = library(body + hub, shared, np.array([1000.0, 2000.0]))
        rpm = SPEEDS * 60 * hertz / TEETH
        ours, _ = library(body + hub, shared, rpm)
        exact = chain(body, hub, twist, shared, rpm)
        assert abs(ours.max() - exact.max()) < worst
        assert abs(ours - exact).max() < anywhere


def test_stiff_bodies_are_one_with_their_hubs():
    body, twist = gear(40)
    rpm = SPEEDS * 60 * 5000 / TEETH
    for over in (0.5, 5.0):
        hub, stiff = over * body, twist / 10
        shared = 2 * (hub / (body + hub)) ** 2 * stiff
        # A tenth of the turning.
        assert abs(library(body + hub, shared, rpm)[0] - chain(body, hub, stiff, shared, rpm)).max() < 4e-3
