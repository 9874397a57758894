"""Which maxima of a curve of dynamic factors are resonances: by the definition, for each relief."""

import dataclasses

import numpy as np
import pytest
from conftest import PRESCRIBED

import gearsweep
from gearsweep import Case

PROMINENCE, MOST = 0.01, 5


def places(y):
    """Maxima with a place lower by the prominence on either side, and nothing higher than the maximum before it."""

    def falls(top, side):
        higher = np.flatnonzero(side > top)
        return (side[: higher[0] if len(higher) else None] <= top - PROMINENCE).any()

    inner = range(1, len(y) - 1)
    tops = [i for i in inner if y[i - 1] < y[i] >= y[i + 1]]
    return [i for i in tops if falls(y[i], y[:i][::-1]) and falls(y[i], y[i + 1 :])]


@pytest.fixture(scope='module')
def sweep():
    return gearsweep.sweep(
        Case(PRESCRIBED).changed(
            relief={'amount_um': [0, 6, 15]}, dynamics={'damping_ratio': 0.05}, sweep={'rpm_step': 100}
        )
    )


def test_of_a_sweep_by_relief(sweep):
    counts = []
    for relief in range(3):
        y = sweep.dynamic_factor[:, relief]
        expected = sorted(sorted(places(y), key=lambda i: -y[i])[:MOST])
        rpm, factor = sweep.resonances(relief)
        assert len(rpm) == len(factor) == len(expected)
        # The parabola's vertex lies within half a step, and above the middle point by at most an eighth of the
        # larger fall to a neighbour.
        expected = np.array(expected)
        np.testing.assert_allclose(rpm, sweep.rpm[expected], rtol=0, atol=50)
        over = factor - y[expected]
        assert (over >= 0).all() and (over <= (y[expected] - np.minimum(y[expected - 1], y[expected + 1])) / 8).all()
        counts.append(len(rpm))
    assert max(counts) > 0
    # Without an index: the first relief; from the end as in all Python.
    np.testing.assert_array_equal(sweep.resonances(), sweep.resonances(0))
    np.testing.assert_array_equal(sweep.resonances(-1), sweep.resonances(2))
    with pytest.raises(IndexError):
        sweep.resonances(3)


def test_of_given_curves(sweep):
    """Each relief has maxima of its own: triangles, whose parabola has its vertex at the tip."""
    rpm = np.arange(1000.0, 5000.0, 100.0)
    tips = [[2000], [1500, 3000], [1600, 2500, 4200]]
    curves = [1 + sum(np.maximum(0, 0.3 - abs(rpm - tip) / 1000) for tip in each) for each in tips]
    # A shoulder of a fall, a shoulder of a rise and a hump of 0.009: none stands out.
    shoulder = 2 - (rpm - 1000) / 8000
    shoulder[10] = shoulder[9] + 0.005
    tips.append([]), curves.append(shoulder)
    tips.append([]), curves.append(shoulder[::-1].copy())
    tips.append([]), curves.append(1 + 0.009 * (rpm == 2000))
    # Seven of different heights: the five highest.
    seven = [1200, 1700, 2200, 2700, 3200, 3700, 4200]
    heights = [0.30, 0.10, 0.25, 0.15, 0.20, 0.12, 0.35]
    tips.append([1200, 2200, 2700, 3200, 4200])
    curves.append(1 + sum(np.maximum(0, h - abs(rpm - tip) / 1000) for tip, h in zip(seven, heights)))
    given = dataclasses.replace(
        sweep, rpm=rpm, dynamic_factor=np.stack(curves, axis=1), relief_um=np.arange(float(len(curves)))
    )
    for relief, expected in enumerate(tips):
        at, factor = given.resonances(relief)
        np.testing.assert_allclose(at, expected, rtol=1e-12)
        np.testing.assert_allclose(factor, curves[relief][np.searchsorted(rpm, expected)], rtol=1e-12)


def test_random_curves_against_the_definition(sweep):
    """Whole multiples of 1/1024, of which none lies at the prominence: nothing hangs on rounding."""
    random = np.random.default_rng(2)
    rpm = 100.0 * np.arange(1, 31)
    curves = 1 + np.floor(random.random((30, 200)) * np.geomspace(5, 200, 200)) / 1024
    given = dataclasses.replace(sweep, rpm=rpm, dynamic_factor=curves, relief_um=np.arange(200.0))
    found = [len(given.resonances(relief)[0]) for relief in range(200)]
    assert found == [min(MOST, len(places(curves[:, relief]))) for relief in range(200)]
    assert max(found) == MOST and min(found) < 2
