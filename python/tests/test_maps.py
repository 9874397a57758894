"""Stability, branches and strobe: closed forms, agreement with the sweep, files, tables and refusals."""

import numpy as np
import pytest
from conftest import PRESCRIBED

import gearsweep
from gearsweep import Case, Code, Error, Status

#: A square wave of stiffness; speeds at which there are two motions.
SQUARE = Case(PRESCRIBED).changed(
    case={'tasks': ('mesh', 'sweep')}, relief={'amount_um': 0}, mesh={'coefficients': 400}, dynamics={'damping_ratio': 0.05},
    sweep={'rpm_first': 10000, 'rpm_last': 12000, 'rpm_step': 250, 'load_rpm': None},
)  # fmt: skip


@pytest.fixture(scope='module')
def both():
    return gearsweep.hysteresis(SQUARE)


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
    rpm, damping = np.linspace(3000, 40000, 38), [0, 0.03, 0.2]
    stability = gearsweep.stability_map(SQUARE, rpm, damping, tongues=0)
    values = np.array([[square_wave(n, zeta) for zeta in damping] for n in rpm])
    np.testing.assert_allclose(stability.modulus, np.abs(values).max(axis=2), atol=1e-9)
    real = np.abs(values[:, 1:].imag).max(axis=2) == 0  # without damping, eigenvalues come to the unit circle in pairs
    np.testing.assert_array_equal(stability.sense[:, 1:] != 0, real)
    assert stability.closing_ratio.size == 0 and stability.edge_rpm.shape == (2, 3, 0)


def test_tongues_bound_what_is_unstable():
    rpm = np.linspace(12000, 36000, 481)
    stability = gearsweep.stability_map(SQUARE, rpm, np.linspace(0.001, 0.1, 12), tongues=2)
    inside = np.zeros(stability.modulus.shape, bool)
    for low, high in stability.edge_rpm.transpose(2, 0, 1):
        inside |= (rpm[:, None] > low) & (rpm[:, None] < high)
    np.testing.assert_array_equal(stability.modulus > 1, inside)
    closed = np.isnan(stability.edge_rpm[0])
    np.testing.assert_array_equal(closed, stability.damping_ratio[:, None] >= stability.closing_ratio)
    assert closed.any() and not closed.all()


def test_load_relief_and_damping_of_the_case_do_not_matter():
    arguments = [8000, 16000], [0.02]
    one = gearsweep.stability_map(SQUARE, *arguments)
    other = gearsweep.stability_map(
        SQUARE.changed(load={'normal_force_n': 50}, relief={'amount_um': 20}, dynamics={'damping_ratio': 0.5}), *arguments
    )
    assert one.modulus.tobytes() == other.modulus.tobytes() and one.edge_rpm.tobytes() == other.edge_rpm.tobytes()


def test_both_branches_are_those_of_the_sweep(both):
    for direction, factor in zip(both.labels['direction'], both.dynamic_factor):
        sweep = gearsweep.sweep(SQUARE.changed(sweep={'direction': direction}))
        np.testing.assert_array_equal(both.rpm, sweep.rpm)
        np.testing.assert_allclose(factor, sweep.dynamic_factor[:, 0], atol=2e-6)
    low, high = both.change_rpm[0]
    assert list(both.change_name) == ['jump'] and 0 < high - low < 2e-6 * high
    apart = np.abs(np.diff(both.dynamic_factor, axis=0)[0]) > 0.1
    np.testing.assert_array_equal(apart, both.rpm < low)
    assert (both.status_name == 'ok').all() and set(both.contact_name[1]) == {'lost'}


def test_strobe_goes_on_from_a_branch(both):
    """A steady motion stays where it is; going back down it is followed."""
    for way in (0, 1):
        start = both.x_um[way, 2], both.v_mm_s[way, 2]
        seen = gearsweep.strobe(SQUARE, both.rpm[2::-1], start=start, settle=200, keep=40)
        np.testing.assert_allclose(seen.x_um, np.tile(both.x_um[way, 2::-1], (40, 1)), rtol=1e-5)
        assert (seen.status == Status.OK).all() and (seen.periods == 1).all()
        np.testing.assert_allclose(seen.exponent, np.log(both.floquet_modulus[way, 2::-1]), atol=0.05)


def test_from_rest_and_undecided():
    seen = gearsweep.strobe(SQUARE.changed(dynamics={'damping_ratio': 0.02}), [7200], keep=40)
    assert seen.status_name == ['aperiodic'] and seen.periods == [0]  # too few periods to be sure
    seen = gearsweep.strobe(SQUARE, [0.01], settle=0, keep=4)
    assert seen.status_name == ['unresolved'] and np.isnan(seen.x_um).all()


def test_chaos_in_a_run_has_its_name():
    case = SQUARE.changed(dynamics={'damping_ratio': 0.02}, pinion={'effective_mass_kg': 0.8}, gear={'effective_mass_kg': 0.8},
                          load={'normal_force_n': 7000})  # fmt: skip
    both = gearsweep.hysteresis(case, [6800, 7100, 7400])
    assert both.status_name[0, 2] == 'chaotic' and np.isnan(both.dynamic_factor[0, 2]) and np.isnan(both.x_um[0, 2])
    assert both.change_name[0] == 'chaotic' and np.isnan(both.change_factor[0, 1])


@pytest.fixture(scope='module')
def results(both):
    stability = gearsweep.stability_map(SQUARE, [9000, 18000, 27000], [0.02, 0.5], tongues=2)
    return both, stability, gearsweep.strobe(SQUARE, [0.01, 9000], settle=5, keep=4)


def test_results_come_back(results, tmp_path):
    for result in results:
        result.save(tmp_path / 'map.npz')
        back = gearsweep.read(tmp_path / 'map.npz')
        assert type(back) is type(result) and back.case == SQUARE
        for name in result.units:
            one, two = getattr(result, name), getattr(back, name)
            assert (one.dtype, one.shape, one.tobytes()) == (two.dtype, two.shape, two.tobytes()), name


def test_results_have_units_words_and_tables(results):
    for result in results:
        for name, unit in result.units.items():
            value = getattr(result, name)
            assert name in type(result).__doc__ and len(result.dims[name]) == value.ndim
            assert not value.flags.writeable
            for ending, expected in (('_um', 'um'), ('_mm_s', 'mm/s'), ('rpm', '1/min')):
                assert not name.endswith(ending) or unit == expected
        np.testing.assert_array_equal(*(found.rpm for found in (result, result.to_xarray())))
    both, stability, seen = results
    assert both.to_pandas().groupby('direction').dynamic_factor.max()['up'] == both.dynamic_factor[0].max()
    assert both.to_xarray().status.sel(direction='down').dims == ('rpm',)
    np.testing.assert_array_equal(stability.to_pandas().modulus, stability.modulus.ravel())
    assert seen.to_pandas().shape == (8, 6) and set(seen.to_pandas().status) == {'unresolved', 'aperiodic'}


def test_the_case_has_the_speeds_where_none_are_given():
    np.testing.assert_array_equal(gearsweep.strobe(SQUARE, settle=0, keep=1).rpm, gearsweep.sweep(SQUARE).rpm)
    with pytest.raises(Error, match='rpm: not given'):
        gearsweep.strobe(SQUARE.changed(case={'tasks': 'mesh'}, sweep={'rpm_first': None, 'rpm_last': None, 'rpm_step': None}))


@pytest.mark.parametrize('call, match', [
    (lambda: gearsweep.stability_map(SQUARE, [2000, 1000]), 'rpm.*out of order'),
    (lambda: gearsweep.stability_map(SQUARE, [np.nan]), 'rpm = NaN'),
    (lambda: gearsweep.stability_map(SQUARE, [1000], [-0.1]), 'damping_ratio = -0.1'),
    (lambda: gearsweep.stability_map(SQUARE, [1000], tongues=101), 'tongues = 101'),
    (lambda: gearsweep.hysteresis(SQUARE, [2000, 1000]), 'rpm: must ascend'),
    (lambda: gearsweep.hysteresis(SQUARE, []), 'speeds = 0'),
    (lambda: gearsweep.hysteresis(SQUARE, relief=1), 'relief = 2'),
    (lambda: gearsweep.hysteresis(SQUARE, jump=0), 'jump = 0'),
    (lambda: gearsweep.hysteresis(SQUARE, closeness=2), 'closeness = 2'),
    (lambda: gearsweep.strobe(SQUARE, [0]), 'rpm = 0'),
    (lambda: gearsweep.strobe(SQUARE, keep=0), 'keep = 0'),
    (lambda: gearsweep.strobe(SQUARE, settle=-1), 'settle = -1'),
    (lambda: gearsweep.strobe(SQUARE, start=(np.inf, 0)), 'start = Inf'),
    (lambda: gearsweep.strobe(SQUARE.changed(mesh={'contact_ratio': 0.5})), 'contact_ratio'),
])  # fmt: skip
def test_refusals(call, match):
    with pytest.raises(Error, match=match) as caught:
        call()
    assert caught.value.code == Code.INPUT
