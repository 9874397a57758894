"""Karpat et al. 2012: the few numbers of the text. It gives no gear: Dogan's first case stands in."""

import math

import numpy as np

from .cases import case, result, run

STAND_IN = 'case1'


def approach_sign():
    """Sign of mu in a friction factor before the pitch point, from a slow mesh: a smaller factor means more load."""
    return _friction_sign(1, 2)


def recess_sign():
    """The same behind the pitch point."""
    return _friction_sign(2, 3)


def mesh_period():
    """Path from A to D, base pitches."""
    return result('contact_points', STAND_IN).at(point='D').s


def accurate(steps):
    """A number of steps in a mesh period changes DF without relief by less than 1e-3 at all speeds."""
    few = case(STAND_IN).changed(numerics={'steps_per_period': steps}, relief={'amount_um': 0})
    error = run(few, 'sweep').sweep.dynamic_factor - result('sweep', STAND_IN).dynamic_factor[:1]
    return bool(np.abs(error).max() < 1e-3)


def hertz_width(poisson):
    """Full contact width of cylinders of one material over sqrt(F d1 d2 / (E (d1 + d2)))."""
    return 4 * math.sqrt((1 - poisson**2) / math.pi)


def _friction_sign(first, second):
    """From the mean load of a pair between two of the points A, B, P, D, E, with and without friction."""
    ends = result('contact_points', STAND_IN).s[[first, second]]
    means = []
    for friction in (0, 0.1):
        slow = case(STAND_IN).changed(dynamics={'friction': friction}, relief={'amount_um': 0}, sweep={'load_rpm': 400})
        path = run(slow, 'load').load
        inside = (path.s > ends[0]) & (path.s < ends[1])
        means.append(np.trapezoid(path.pair_load_n[inside], path.s[inside]))
    return -np.sign(means[1] - means[0])
