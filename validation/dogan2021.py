"""Dogan, Kalay, Karpat 2021: dynamic factors (DF) and resonances of data/case1.nml and case2.nml.

Arguments: a case's name; speeds in 1/min; reliefs in um, as the case lists them; resonance 1 or 2.
"""

import functools

import numpy as np

from . import ledger
from .cases import case, result, run


def factor(name, rpm, relief):
    """DF at a speed."""
    return _at(name, rpm)[_index(name, relief)]


def best_at(name, rpm):
    """Listed relief with the least DF at a speed."""
    return result('sweep', name).relief_um[np.argmin(_at(name, rpm))]


def rises(name, rpm, relief, further):
    """DF at a speed is larger at the further relief."""
    return factor(name, rpm, further) > factor(name, rpm, relief)


def best_listed(name):
    """Listed relief with the least worst DF over all speeds."""
    return result('sweep', name).relief_um[np.argmin(_worst(name))]


def reduction():
    """Printed fall of DF from no relief to 15 um at 1600 rpm, per cent of the static load."""
    without, relieved = (ledger.find('dogan2021', id).value for id in ('df_1', 'df_15'))
    return 100 * (without - relieved)


def worst_reduction(name, relief):
    """Fall of the worst DF over all speeds from no relief to this one, per cent."""
    worst = _worst(name)
    return 100 * (1 - worst[_index(name, relief)] / worst[_index(name, 0)])


def falls(name, relief):
    """The worst DF falls from each listed relief to the next, up to this one."""
    return bool(np.all(np.diff(_worst(name)[:_index(name, relief) + 1]) < 0))


def v_form(name):
    """Over the relief, the worst DF falls to its least value and rises behind it."""
    curve = result('optimum_curve', name)
    least = np.nanargmin(curve.worst_dynamic_factor)
    down, up = np.split(curve.worst_dynamic_factor, [least + 1])
    return bool(len(down) > 2 and len(up) > 1 and np.all(np.diff(down) < 0) and np.all(np.diff(up) > 0))


def best_relief(name):
    """Relief of the least worst DF, not only among the listed."""
    return result('optimum', name).relief_um


def peak_rpm(name, resonance):
    """Speed of the first or second of the two largest resonances without relief."""
    return _resonances(name)[resonance - 1]


def peak_factor(name, resonance, relief):
    """Largest DF within 15 % of a resonance."""
    sweep = result('sweep', name)
    near = np.abs(sweep.rpm / peak_rpm(name, resonance) - 1) <= 0.15
    return sweep.dynamic_factor[_index(name, relief), near].max()


def peak_rises(name, resonance, relief, further):
    """DF in a resonance is larger at the further relief."""
    return peak_factor(name, resonance, further) > peak_factor(name, resonance, relief)


def second_worse(name):
    """DF without relief is larger in the second resonance."""
    return peak_factor(name, 2, 0) > peak_factor(name, 1, 0)


def _index(name, relief):
    return int(np.flatnonzero(np.isclose(result('sweep', name).relief_um, relief))[0])


@functools.cache
def _at(name, rpm):
    """DF of all listed reliefs at one speed."""
    at_rpm = case(name).changed(sweep={'rpm_first': rpm, 'rpm_last': rpm})
    return run(at_rpm, 'sweep').sweep.dynamic_factor[:, 0]


def _worst(name):
    """Largest DF over all speeds, for each listed relief."""
    return result('sweep', name).dynamic_factor.max(axis=1)


def _resonances(name):
    """Speeds of the last two resonances without relief: half the natural frequency, and the whole."""
    return result('resonances', name).resonance_rpm[-2:]
