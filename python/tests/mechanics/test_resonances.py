"""Which maxima of a curve of dynamic factors are resonances: by the definition."""

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


@pytest.mark.parametrize('changes', [{}, {'mesh': {'coefficients': 400}}, {'dynamics': {'damping_ratio': 0.17}}])
def test_of_the_least_relief(changes):
    case = Case(PRESCRIBED).changed(relief={'amount_um': [15, 0, 6]}, dynamics={'damping_ratio': 0.05}, sweep={'rpm_step': 100})
    study = gearsweep.run(case.changed(**changes), 'sweep')
    sweep, found = study.sweep, study.resonances
    y = sweep.at(relief_um=0).dynamic_factor
    expected = np.array(sorted(sorted(places(y), key=lambda i: -y[i])[:MOST]))
    assert len(found.resonance_rpm) == len(expected) > 0
    # The parabola's vertex lies within half a step.
    np.testing.assert_allclose(found.resonance_rpm, sweep.rpm[expected], rtol=0, atol=50)
    for relief, factor in zip(sweep.relief_um, sweep.dynamic_factor):
        peaks = found.resonance_rpm
        half = [0, *(peaks[1:] + peaks[:-1]) / 2, np.inf]  # no window reaches beyond half-way to the next
        for rpm, begin, end in zip(peaks, half, half[1:]):
            near = (np.abs(sweep.rpm / rpm - 1) <= 0.15) & (begin < sweep.rpm) & (sweep.rpm <= end)
            assert found.at(relief_um=relief, resonance_rpm=rpm).dynamic_factor == factor[near].max()
            assert found.at(relief_um=relief, resonance_rpm=rpm).rpm == sweep.rpm[near][factor[near].argmax()]
