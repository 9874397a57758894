"""Stability, branches and Poincare section: closed forms, agreement with the sweep, and refusals."""

import numpy as np
import pytest
from conftest import PRESCRIBED

import gearsweep
from gearsweep import Case, Code, Error

#: A square wave of stiffness; speeds at which there are two motions.
SQUARE = Case(PRESCRIBED).changed(
    case={'tasks': ('mesh', 'sweep')}, relief={'amount_um': 0}, mesh={'coefficients': 400}, dynamics={'damping_ratio': 0.05},
    sweep={'rpm_first': 10000, 'rpm_last': 12000, 'rpm_step': 250, 'load_rpm': None},
)  # fmt: skip


def stability(case=SQUARE, **keys):
    return gearsweep.run(case.changed(stability=keys), 'stability')


def poincare(case=SQUARE, **keys):
    return gearsweep.run(case.changed(poincare=keys), 'poincare')


@pytest.fixture(scope='module')
def both():
    return gearsweep.run(SQUARE, 'hysteresis')


def square_wave(rpm, zeta):
    """Eigenvalues of the map of Meissner's equation over a period: two pairs for 0.6 of it, then one."""
    whole = np.eye(2)
    for pairs, part in ((2, 0.6), (1, 0.4)):
        w = np.sqrt(pairs * 400e6 * (1 / 0.8 + 1 / 0.9))
        root = np.sqrt(1 - zeta**2)
        a = w * part * 60 / (25 * rpm)
        c, s, r = np.cos(root * a), np.sin(root * a) / root, zeta
        whole = np.exp(-zeta * a) * np.array([[c + r * s, s / w], [-w * s, c - r * s]]) @ whole
    return np.linalg.eigvals(whole)


def test_multipliers_of_a_square_wave():
    study = stability(rpm=np.linspace(3000, 40000, 38), damping_last=0.2, damping_count=3, tongues=0)
    found = study.stability
    assert found.damping_ratio.tolist() == [0, 0.1, 0.2]
    values = np.array([[square_wave(n, zeta) for zeta in found.damping_ratio] for n in found.rpm])
    np.testing.assert_allclose(found.floquet_modulus, np.abs(values).max(axis=2), atol=1e-9)
    real = np.abs(values[:, 1:].imag).max(axis=2) == 0  # without damping, eigenvalues come to the unit circle in pairs
    np.testing.assert_array_equal(found.sense[:, 1:] != 0, real)


def test_tongues_bound_what_is_unstable():
    rpm = np.linspace(12000, 36000, 481)
    study = stability(rpm=rpm, damping_first=0.001, damping_last=0.1, damping_count=12, tongues=2)
    edges = study.tongue_edges
    inside = np.zeros(study.stability.floquet_modulus.shape, bool)
    for low, high in zip(edges.lower_rpm, edges.upper_rpm):
        inside |= (rpm[:, None] > low) & (rpm[:, None] < high)
    np.testing.assert_array_equal(study.stability.floquet_modulus > 1, inside)
    closed = np.isnan(edges.lower_rpm)
    np.testing.assert_array_equal(closed, edges.damping_ratio >= study.tongues.closing_damping_ratio[:, None])
    assert closed.any() and not closed.all()


def test_load_relief_and_damping_of_the_case_do_not_matter():
    keys = {'rpm': [8000, 16000], 'damping_last': 0.02, 'damping_count': 2}
    other = SQUARE.changed(load={'normal_force_n': 50}, relief={'amount_um': 20}, dynamics={'damping_ratio': 0.5})
    one, two = stability(**keys), stability(other, **keys)
    for table, column in (('stability', 'floquet_modulus'), ('tongue_edges', 'lower_rpm'), ('tongue_edges', 'upper_rpm')):
        assert one[table][column].tobytes() == two[table][column].tobytes()


def test_both_branches_are_those_of_the_sweep(both):
    runs, changes = both.hysteresis, both.hysteresis_changes
    for direction in runs.direction:
        sweep = gearsweep.run(SQUARE.changed(sweep={'direction': direction}), 'sweep').sweep
        np.testing.assert_array_equal(runs.rpm, sweep.rpm)
        np.testing.assert_allclose(runs.at(direction=direction).dynamic_factor, sweep.dynamic_factor, atol=2e-6)
    low, high = changes.rpm_before[0], changes.rpm_after[0]
    assert list(changes.kind) == ['jump'] and 0 < high - low < 2e-6 * high
    apart = np.abs(np.diff(runs.dynamic_factor[0], axis=0)[0]) > 0.1
    np.testing.assert_array_equal(apart, runs.rpm < low)
    assert (runs.status == 'ok').all() and set(runs.at(direction='down').contact.ravel()) == {'lost'}


def test_a_section_goes_on_from_a_branch(both):
    """A steady motion stays where it is; going back down it is followed."""
    for way in ('up', 'down'):
        branch = both.hysteresis.at(direction=way, relief_um=0)
        study = poincare(rpm=branch.rpm[2::-1], start_um=branch.dte_um[2], start_mm_s=branch.dte_rate_mm_s[2],
                         settling_periods=200, kept_periods=40)  # fmt: skip
        seen, motion = study.poincare.at(relief_um=0), study.lyapunov.at(relief_um=0)
        np.testing.assert_allclose(seen.dte_um, np.tile(branch.dte_um[2::-1, None], 40), rtol=1e-5)
        assert (motion.status == 'ok').all() and (motion.mesh_periods == 1).all()
        np.testing.assert_allclose(motion.lyapunov_exponent, np.log(branch.floquet_modulus[2::-1]), atol=0.05)


def test_from_rest_and_undecided():
    motion = poincare(SQUARE.changed(dynamics={'damping_ratio': 0.02}), rpm=7200, kept_periods=40).lyapunov
    assert motion.status == ['transient'] and motion.mesh_periods == [0]  # too few periods to be sure
    with pytest.warns(gearsweep.PartialWarning):
        study = poincare(rpm=0.01, settling_periods=0, kept_periods=4)
    assert study.lyapunov.status == ['unresolved'] and np.isnan(study.poincare.dte_um).all()


def test_chaos_in_a_run_has_its_name():
    case = SQUARE.changed(dynamics={'damping_ratio': 0.02}, pinion={'effective_mass_kg': 0.8}, gear={'effective_mass_kg': 0.8},
                          load={'normal_force_n': 7000}, hysteresis={'rpm': [6800, 7100, 7400]})  # fmt: skip
    with pytest.warns(gearsweep.PartialWarning):
        both = gearsweep.run(case, 'hysteresis')
    last = both.hysteresis.at(direction='up', rpm=7400, relief_um=0)
    assert last.status == 'chaotic' and np.isnan(last.dynamic_factor) and np.isnan(last.dte_um)
    assert both.hysteresis_changes.kind[0] == 'chaotic' and np.isnan(both.hysteresis_changes.dynamic_factor_after[0])


def test_the_speeds_are_those_of_the_sweep_where_none_are_given():
    case = SQUARE.changed(poincare={'settling_periods': 0, 'kept_periods': 1})
    study = gearsweep.run(case, ('poincare', 'sweep'))
    np.testing.assert_array_equal(study.poincare.rpm, study.sweep.rpm)
    with pytest.raises(Error, match='rpm_first'):
        gearsweep.run(case.changed(sweep={'rpm_first': None, 'rpm_last': None, 'rpm_step': None}), 'poincare')


@pytest.mark.parametrize('task, keys, match', [
    ('stability', {'rpm': [2000, 1000]}, 'rpm: must ascend'),
    ('stability', {'rpm': 1000, 'damping_first': -0.1}, 'damping_first = -0.1'),
    ('stability', {'rpm': 1000, 'tongues': 101}, 'tongues = 101'),
    ('hysteresis', {'rpm': [2000, 1000]}, 'rpm: must ascend'),
    ('hysteresis', {'relief_um': 1}, 'relief_um = 1'),
    ('hysteresis', {'jump': 0}, 'jump = 0'),
    ('hysteresis', {'closeness': 2}, 'closeness = 2'),
    ('poincare', {'rpm': 0}, 'rpm = 0'),
    ('poincare', {'kept_periods': 0}, 'kept_periods = 0'),
    ('poincare', {'settling_periods': -1}, 'settling_periods = -1'),
    ('poincare', {'start_um': 1e99, 'start_mm_s': 0}, 'start_um = 1'),
    ('poincare', {'start_um': 1}, 'start_mm_s'),
])  # fmt: skip
def test_refusals(task, keys, match):
    with pytest.raises(Error, match=match) as caught:
        gearsweep.run(SQUARE.changed(**{task: keys}), task)
    assert caught.value.code == Code.INPUT
