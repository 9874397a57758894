"""Values against closed forms and identities."""

import numpy as np
import pytest
from conftest import GEARED, PARTIAL, PRESCRIBED

import gearsweep
from gearsweep import Case


@pytest.fixture(scope='module')
def study():
    return gearsweep.run(Case(GEARED))


def test_geometry_of_a_standard_pair():
    geometry = gearsweep.geometry(
        Case('&pair module_mm = 2.5 face_width_mm = 20 / &pinion teeth = 20 / &gear teeth = 50 /')
    )
    alpha, teeth = np.radians(20), np.array([20, 50])
    reference = 1.25 * teeth
    assert geometry.distance_mm == pytest.approx(87.5, rel=1e-14)
    np.testing.assert_allclose(geometry.radius_mm[0], reference + 2.5, rtol=1e-14)
    np.testing.assert_allclose(geometry.radius_mm[2], reference * np.cos(alpha), rtol=1e-14)
    np.testing.assert_allclose(geometry.working_angle_deg, 20, rtol=1e-14)
    # ISO 21771: contact ratio from the tip and base circles.
    length = np.sqrt((reference + 2.5) ** 2 - (reference * np.cos(alpha)) ** 2).sum() - 87.5 * np.sin(alpha)
    pitch = np.pi * 2.5 * np.cos(alpha)
    assert geometry.base_pitch_mm == pytest.approx(pitch, rel=1e-14)
    assert geometry.contact_ratio == pytest.approx(length / pitch, rel=1e-13)
    np.testing.assert_allclose(
        geometry.point[[0, 1, 3, 4]], np.array([0, length / pitch - 1, 1, length / pitch]), atol=1e-13
    )
    np.testing.assert_allclose(geometry.point_radius_mm[2], reference, rtol=1e-13)


def test_outline_lies_between_root_and_tip():
    geometry = gearsweep.geometry(Case(GEARED))
    for member, (points, teeth) in enumerate([(geometry.pinion_outline_mm, 21), (geometry.gear_outline_mm, 34)]):
        radius = np.hypot(*points.T)
        assert radius.max() == pytest.approx(geometry.radius_mm[0, member], rel=1e-13)
        assert radius.min() == pytest.approx(geometry.radius_mm[4, member], rel=1e-13)
        # The same after a turn by one tooth.
        turn = 2 * np.pi / teeth
        turned = points @ np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
        np.testing.assert_allclose(turned, np.roll(points, -len(points) // teeth, axis=0), atol=1e-11)


def test_motion():
    case = Case(GEARED).changed(load={'normal_force_n': None, 'torque_nm': 100}, pinion={'effective_mass_kg': None})
    motion = gearsweep.motion(case)
    base = 0.5 * 3 * 21 * np.cos(np.radians(20))
    assert motion.load_n == pytest.approx(100 / (base / 1000), rel=1e-13)
    # A solid disc of steel as large as the reference circle, on the line of action.
    disc = np.pi / 2 * 7850 * 0.020 * 0.0315**4 / (base / 1000) ** 2
    np.testing.assert_allclose(motion.mass_kg, [disc, 0.9], rtol=1e-13)
    reduced = 1 / np.sum(1 / motion.mass_kg)
    assert motion.frequency_hz == pytest.approx(np.sqrt(1e6 * motion.stiffness_n_um / reduced) / (2 * np.pi), rel=1e-13)


def test_whole_gears_turn_about_their_bores():
    """Once for all pairs: what one pair alone adds up, and two pairs with half of what each has alone, if that is equal."""
    case = Case(GEARED).changed(
        mesh={'model': 'fe'}, section={'teeth': 0, 'fixed': 'rim', 'elements_across': 4}, relief={'amount_um': 0},
        pinion={'teeth': 24, 'bore_mm': 8}, gear={'teeth': 24, 'bore_mm': 8},
    )  # fmt: skip
    work = gearsweep.prepare(case)
    motion, mesh = gearsweep.motion(case, work=work), gearsweep.mesh(case, work=work)
    assert motion.turn_um > 5 * motion.shared_um > 0
    one = mesh.share == 1
    np.testing.assert_allclose(mesh.ste_um[one], motion.load_n / mesh.pair_n_um[one] + motion.turn_um, rtol=1e-12)
    # Equal gears, half the load each: the two pairs mirror each other.
    half = np.argmin(np.abs(mesh.share - 0.5))
    alone = motion.load_n / mesh.pair_n_um[half] - motion.shared_um
    assert mesh.ste_um[half] == pytest.approx(alone / 2 + motion.shared_um + motion.turn_um, rel=1e-3)
    np.testing.assert_allclose(mesh.mesh_n_um * mesh.ste_um, motion.load_n, rtol=1e-12)
    np.testing.assert_array_equal(gearsweep.mesh(case).ste_um, mesh.ste_um)


def test_reliefs_are_those_of_the_case():
    """To the last bit, so that they can be looked up."""
    reliefs = [0, 0.1, 0.7, 2.675, 15, 17.3, 33.33]
    case = Case(PRESCRIBED).changed(relief={'amount_um': reliefs})
    assert list(gearsweep.sweep(case).relief_um) == reliefs
    assert list(np.unique(gearsweep.mesh(case).relief_um)) == reliefs
    assert list(np.unique(gearsweep.load(case).relief_um)) == reliefs


def test_static_identities():
    mesh = gearsweep.mesh(Case(PRESCRIBED))
    unrelieved = mesh.relief_um == 0
    u = 2 * mesh.s / 1.6 - 1
    np.testing.assert_allclose(mesh.pair_n_um, 400 - 120 * u**2, rtol=1e-13)
    np.testing.assert_allclose(mesh.ste_um[unrelieved] * mesh.mesh_n_um[unrelieved], 6858, rtol=1e-12)
    np.testing.assert_allclose(
        mesh.share * 6858, mesh.pair_n_um * np.maximum(0, mesh.ste_um - mesh.error_um), atol=1e-8
    )
    assert not mesh.error_um[unrelieved].any()


def test_harmonics_of_the_static_transmission_error():
    """Parseval: the mean square of the deviation is half the sum of the squared amplitudes."""
    case = Case(PRESCRIBED).changed(mesh={'ste_harmonics': 1000})
    ste, mesh = gearsweep.harmonics(case), gearsweep.mesh(case)
    # The error jumps where pairs come and go, so that amplitudes fall as 1/k: what is left out, as 1/1000.
    np.testing.assert_allclose(0.5 * np.sum(ste.amplitude_um**2, axis=0), ste.rms_um**2, rtol=2e-3)
    for i, relief in enumerate(ste.relief_um):
        values = mesh.ste_um[mesh.relief_um == relief]
        assert ste.peak_to_peak_um[i] == pytest.approx(np.ptp(values), rel=1e-4)
    assert (ste.estimate_um < 1e-9).all() and list(ste.harmonic[:3]) == [1, 2, 3]


def test_constant_mesh_has_no_dynamics():
    """Two equal pairs at any time carry half the load each."""
    case = Case(PRESCRIBED).changed(
        mesh={'contact_ratio': 2, 'coefficients': 300}, relief={'amount_um': 0}, dynamics={'damping_ratio': 0.17}
    )
    sweep = gearsweep.sweep(case)
    np.testing.assert_allclose(sweep.dynamic_factor, 0.5, rtol=1e-6)
    assert sweep.is_complete and (sweep.status_name == 'ok').all() and (sweep.contact_name == 'full').all()


def test_sweep_and_load_agree(study):
    """The largest load on the path is the dynamic factor, up to the refinement of the peak between rows."""
    load, sweep = study.load, study.sweep
    for rpm in (4000, 6000):
        for i, relief in enumerate(sweep.relief_um):
            largest = load.pair_load_n[(load.rpm == rpm) & (load.relief_um == relief)].max() / study.motion.load_n
            factor = sweep.dynamic_factor[sweep.rpm == rpm, i]
            assert factor == pytest.approx(largest, rel=1e-3)


@pytest.mark.filterwarnings('ignore::gearsweep.PartialWarning')
def test_one_point_one_answer():
    """Several motions exist here: load and sweep follow the same, whichever function is asked."""
    for direction in ('each', 'up', 'down'):
        case = Case(PRESCRIBED).changed(
            case={'tasks': ['load', 'sweep']},
            dynamics={'damping_ratio': 0.01},
            relief={'amount_um': [2, 15]},
            sweep={'rpm_step': 100, 'load_rpm': [5900, 6800, 11000], 'direction': direction},
        )
        study = gearsweep.run(case)
        load, sweep = study.load, study.sweep
        assert (gearsweep.load(case).dte_um == load.dte_um).all()
        for rpm in (5900, 6800, 11000):
            for i, relief in enumerate(sweep.relief_um):
                here = (load.rpm == rpm) & (load.relief_um == relief)
                at = np.flatnonzero(sweep.rpm == rpm)[0]
                assert set(load.status[here]) == {sweep.status[at, i]}
                assert set(load.periods[here]) == {sweep.periods[at, i]}
                assert set(load.pair[here]) == set(range(1, sweep.periods[at, i] + 1))
                largest = load.pair_load_n[here].max() / study.motion.load_n
                assert sweep.dynamic_factor[at, i] == pytest.approx(largest, rel=1e-3)


def test_load_without_an_answer():
    """One row, which says why, as the sweep does."""
    case = Case(PARTIAL).changed(case={'tasks': ['load', 'sweep']}, sweep={'load_rpm': [1, 6001]})
    with pytest.warns(gearsweep.PartialWarning, match='^1 operating points'):
        load = gearsweep.load(case)
    assert load.status_name[0] == 'unresolved' and np.isnan(load.pair_load_n[0]) and load.pair[0] == 0
    assert set(load.status_name[1:]) == {'inexact'} and not np.isnan(load.pair_load_n[1:]).any()
    assert list(load.to_pandas().status[:2]) == ['unresolved', 'inexact']


def test_optimum(study):
    optimum = study.optimum
    assert optimum.best_factor == np.nanmin(optimum.worst_factor)
    assert optimum.best_um == optimum.relief_um[np.nanargmin(optimum.worst_factor)]
    # The listed reliefs are no better.
    assert (np.nanmax(study.sweep.dynamic_factor, axis=0) >= optimum.best_factor - 1e-5).all()
    # Sweeping the best relief gives its worst factor again, to the search's tolerance.
    again = gearsweep.sweep(study.case.changed(relief={'amount_um': optimum.best_um}))
    assert again.dynamic_factor.max() == pytest.approx(optimum.best_factor, abs=2e-5)


def test_section_is_a_grid(study):
    section = study.section
    x, y = section.x_mm[section.element], section.y_mm[section.element]
    # Anticlockwise corners, with the middles of the sides behind them.
    area = 0.5 * np.sum(x[:, :4] * np.roll(y[:, :4], -1, 1) - y[:, :4] * np.roll(x[:, :4], -1, 1), axis=1)
    assert (area > 0).all()
    middle = 0.5 * (x[:, :4] + np.roll(x[:, :4], -1, 1))
    assert np.abs(middle - x[:, 4:]).max() < 0.1 * 3
    assert set(np.unique(section.element)) == set(range(len(section.x_mm)))
    assert set(section.tooth) == {0, 1, 2, 3}
    assert np.hypot(section.x_mm, section.y_mm).max() == pytest.approx(study.geometry.radius_mm[0, 0], rel=1e-12)


def test_modes(study):
    modal = study.modal
    assert (np.diff(modal.frequency_hz) > 0).all() and (modal.residual < 1e-6).all()
    np.testing.assert_array_equal(modal.element, study.section.element)
    # The inner edge is held.
    radius = np.hypot(modal.x_mm, modal.y_mm)
    assert not modal.shape[:, radius < radius.min() * (1 + 1e-9), :].any()
    assert modal.shape.any(axis=(0, 1)).all()


def test_root_stress(study):
    """Stress along a free surface in components: its trace is the stress, its determinant 0."""
    static = study.static
    x, y, xy = static.parts_mpa
    np.testing.assert_allclose(x + y, static.sigma_mpa, rtol=1e-12)
    np.testing.assert_allclose(x * y, xy**2, rtol=1e-9)
    assert (static.sigma_mpa[0] > 0).all() and (static.sigma_mpa[1] < 0).all()
    assert (static.tension_mpa >= static.sigma_mpa.max(axis=(0, 1)) * (1 - 1e-12)).all()


def test_stress_on_the_section():
    """Its trace at the fillet is the root stress, found there in another way; the closer, the finer the grid."""
    deviation = []
    for elements in (6, 12, 24):
        case = Case(GEARED).changed(section={'elements_across': elements})
        work = gearsweep.prepare(case)
        static = gearsweep.static(case, work=work)
        worst = static.sigma_mpa[0, :, 1].argmax()
        stress = gearsweep.stress(case, worst, 1, work=work)
        assert (stress.s, stress.radius_mm, stress.share) == (
            static.s[worst], static.radius_mm[worst], static.share[worst, 1]
        )  # fmt: skip
        assert stress.relief_um == 10 and stress.to_pandas().shape == (len(stress.x_mm), 2)
        loaded = np.unique(stress.element[stress.tooth == 2])
        fillet = loaded[(stress.x_mm[loaded] > 0) & (np.hypot(stress.x_mm, stress.y_mm)[loaded] < 30)]
        trace = (stress.sigma_mpa[0] + stress.sigma_mpa[1])[fillet]
        deviation.append(abs(trace.max() / static.tension_mpa[1] - 1))
    # Values at nodes are of first order at a surface, or better.
    assert deviation[1] < deviation[0] / 1.8 and deviation[2] < deviation[1] / 1.8


def test_run_leaves_out_what_is_not_asked_for():
    with pytest.warns(gearsweep.UnusedWarning, match='for load: &sweep load_rpm'):
        study = gearsweep.run(Case(PRESCRIBED).changed(case={'tasks': 'mesh'}))
    assert study.geometry is study.sweep is study.modal is None
    assert study.mesh is not None and study.motion is not None
    with pytest.warns(gearsweep.UnusedWarning, match='for modal: &modal modes'):
        study = gearsweep.run(Case(GEARED).changed(case={'tasks': 'geometry'}, load={'normal_force_n': None}))
    assert study.motion is study.mesh is None and study.geometry is not None


def test_a_task_need_not_be_named():
    case = Case(GEARED).changed(case={'tasks': ['mesh']})
    assert gearsweep.sweep(case).dynamic_factor.shape == (13, 2)
    assert gearsweep.sweep(case).case == case
    assert gearsweep.modal(case).frequency_hz.shape == (3,)
    # Without tasks it is that task alone: a pair without load has a geometry.
    bare = Case('&pair module_mm = 3 face_width_mm = 20 / &pinion teeth = 21 / &gear teeth = 34 /')
    assert gearsweep.section(bare).tooth.max() == 3


def test_arrays_are_read_only(study):
    for part in (study.sweep, study.modal, study.static):
        for name in part.units:
            value = getattr(part, name)
            if isinstance(value, np.ndarray):
                with pytest.raises(ValueError):
                    value[...] = 0


def test_every_field_has_unit_and_words(study):
    for part in vars(study).values():
        if not isinstance(part, gearsweep.Result):
            continue
        words = ' '.join(kind.__doc__ for kind in type(part).__mro__ if kind.__doc__)
        for name, unit in part.units.items():
            assert name in words
            assert len(part.dims[name]) == np.ndim(getattr(part, name)), name
            for ending, expected in (('_mm', 'mm'), ('_um', 'um'), ('_mpa', 'MPa'), ('_hz', 'Hz'), ('_n', 'N')):
                if name.endswith(ending) and not name.endswith('n_um'):
                    assert unit == expected, name
