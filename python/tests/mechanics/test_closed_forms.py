"""Values against closed forms and identities."""

import gc
import weakref

import numpy as np
import pytest
from conftest import GEARED, PARTIAL, PRESCRIBED, bits, grid_of

import gearsweep
from gearsweep import Case


@pytest.fixture(scope='module')
def study():
    return gearsweep.run(Case(GEARED))


def test_geometry_of_a_standard_pair():
    case = Case('&pair module_mm = 2.5 face_width_mm = 20 / &pinion teeth = 20 / &gear teeth = 50 /')
    study = gearsweep.run(case, 'geometry')
    geometry, gears, points = study.geometry, study.gears, study.contact_points
    alpha, teeth = np.radians(20), np.array([20, 50])
    reference = 1.25 * teeth
    assert geometry.centre_distance_mm == pytest.approx(87.5, rel=1e-14)
    np.testing.assert_allclose(gears.tip_diameter_mm, 2 * (reference + 2.5), rtol=1e-14)
    np.testing.assert_allclose(gears.base_diameter_mm, 2 * reference * np.cos(alpha), rtol=1e-14)
    assert geometry.working_angle_deg == pytest.approx(20, rel=1e-14) == geometry.coast_working_angle_deg
    # ISO 21771: contact ratio from the tip and base circles.
    length = np.sqrt((reference + 2.5) ** 2 - (reference * np.cos(alpha)) ** 2).sum() - 87.5 * np.sin(alpha)
    pitch = np.pi * 2.5 * np.cos(alpha)
    assert geometry.base_pitch_mm == pytest.approx(pitch, rel=1e-14)
    assert geometry.contact_ratio == pytest.approx(length / pitch, rel=1e-13)
    np.testing.assert_allclose(points.s[[0, 1, 3, 4]], np.array([0, length / pitch - 1, 1, length / pitch]), atol=1e-13)
    pitch_point = points.at(point='P')
    np.testing.assert_allclose([pitch_point.pinion_radius_mm, pitch_point.gear_radius_mm], reference, rtol=1e-13)


def test_outline_lies_between_root_and_tip():
    study = gearsweep.run(Case(GEARED), 'geometry')
    for which, teeth in (('pinion', 21), ('gear', 34)):
        gear, outline = study.gears.at(gear=which), study.outline.at(gear=which)
        points = np.column_stack((outline.x_mm, outline.y_mm))
        radius = np.hypot(*points.T)
        assert 2 * radius.max() == pytest.approx(gear.tip_diameter_mm, rel=1e-13)
        assert 2 * radius.min() == pytest.approx(gear.root_diameter_mm, rel=1e-13)
        # The same after a turn by one tooth.
        turn = 2 * np.pi / teeth
        turned = points @ np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
        np.testing.assert_allclose(turned, np.roll(points, -len(points) // teeth, axis=0), atol=1e-11)


def test_motion():
    case = Case(GEARED).changed(load={'normal_force_n': None, 'torque_nm': 100}, pinion={'effective_mass_kg': None})
    motion = gearsweep.run(case, 'mesh').motion
    base = 0.5 * 3 * 21 * np.cos(np.radians(20))
    assert motion.load_n == pytest.approx(100 / (base / 1000), rel=1e-13)
    # A solid disc of steel as large as the reference circle, on the line of action.
    disc = np.pi / 2 * 7850 * 0.020 * 0.0315**4 / (base / 1000) ** 2
    np.testing.assert_allclose([motion.pinion_mass_kg, motion.gear_mass_kg], [disc, 0.9], rtol=1e-13)
    reduced = 1 / (1 / motion.pinion_mass_kg + 1 / motion.gear_mass_kg)
    assert motion.natural_frequency_hz == pytest.approx(np.sqrt(1e6 * motion.mean_mesh_stiffness_n_um / reduced) / (2 * np.pi), rel=1e-13)


def test_whole_gears_turn_about_their_bores():
    """Once for all pairs: what one pair alone adds up, and two pairs with half of what each has alone, if that is equal."""
    case = Case(GEARED).changed(
        mesh={'model': 'fe', 'corner_contact': False, 'nonlinear_contact': False},
        section={'teeth': 0, 'fixed': 'rim', 'elements_across': 4}, relief={'amount_um': 0},
        pinion={'teeth': 24, 'bore_mm': 8}, gear={'teeth': 24, 'bore_mm': 8},
    )  # fmt: skip
    study = gearsweep.run(case, 'mesh')
    motion, mesh = study.motion, study.mesh
    assert motion.body_rotation_um > 5 * motion.body_coupling_um > 0
    one = mesh.load_share == 1
    alone = motion.load_n / mesh.pair_stiffness_n_um
    np.testing.assert_allclose(mesh.ste_um[one], alone[one] + motion.body_rotation_um, rtol=1e-12)
    # Equal gears, half the load each: the two pairs mirror each other.
    half = np.argmin(np.abs(mesh.load_share - 0.5))
    alone = alone[half] - motion.body_coupling_um
    assert mesh.ste_um[half] == pytest.approx(alone / 2 + motion.body_coupling_um + motion.body_rotation_um, rel=1e-3)
    np.testing.assert_allclose(mesh.mesh_stiffness_n_um * mesh.ste_um, motion.load_n, rtol=1e-12)


def test_reliefs_are_those_of_the_case():
    """To the last bit, so that they can be looked up."""
    reliefs = [0, 0.1, 0.7, 2.675, 15, 17.3, 33.33]
    case = Case(PRESCRIBED).changed(relief={'amount_um': reliefs})
    study = gearsweep.run(case)
    assert list(study.sweep.relief_um) == reliefs
    assert list(np.unique(study.mesh.relief_um)) == reliefs
    assert list(np.unique(study.load.relief_um)) == reliefs


def test_static_identities():
    mesh = gearsweep.run(Case(PRESCRIBED), 'mesh').mesh
    unrelieved = mesh.at(relief_um=0)
    u = 2 * mesh.s / 1.6 - 1
    np.testing.assert_allclose(mesh.pair_stiffness_n_um, 400 - 120 * u**2, rtol=1e-13)
    np.testing.assert_allclose(unrelieved.ste_um * unrelieved.mesh_stiffness_n_um, 6858, rtol=1e-12)
    np.testing.assert_allclose(
        mesh.load_share * 6858, mesh.pair_stiffness_n_um * np.maximum(0, mesh.ste_um - mesh.profile_error_um), atol=1e-8
    )
    assert not unrelieved.profile_error_um.any()


def test_harmonics_of_the_static_transmission_error():
    """Parseval: the mean square of the deviation is half the sum of the squared amplitudes."""
    case = Case(PRESCRIBED).changed(mesh={'ste_harmonics': 1000})
    study = gearsweep.run(case, 'mesh')
    series, whole, mesh = study.harmonics, study.transmission_error, study.mesh
    # The error jumps where pairs come and go, so that amplitudes fall as 1/k: what is left out, as 1/1000.
    np.testing.assert_allclose(0.5 * np.sum(series.amplitude_um[:, 1:] ** 2, axis=1), whole.rms_um**2, rtol=2e-3)
    np.testing.assert_array_equal(series.at(harmonic=0).amplitude_um, whole.mean_um)
    for i, relief in enumerate(whole.relief_um):
        assert whole.peak_to_peak_um[i] == pytest.approx(np.ptp(mesh.at(relief_um=relief).ste_um), rel=1e-4)
    assert (whole.error_estimate_um < 1e-9).all() and list(series.harmonic[:3]) == [0, 1, 2]


def test_constant_mesh_has_no_dynamics():
    """Two equal pairs at any time carry half the load each."""
    case = Case(PRESCRIBED).changed(
        mesh={'contact_ratio': 2, 'coefficients': 300}, relief={'amount_um': 0}, dynamics={'damping_ratio': 0.17}
    )
    study = gearsweep.run(case, 'sweep')
    np.testing.assert_allclose(study.sweep.dynamic_factor, 0.5, rtol=1e-6)
    assert study.is_complete and (study.sweep.status == 'ok').all() and (study.sweep.contact == 'full').all()


def test_sweep_and_load_agree(study):
    """The largest load on the path is the dynamic factor, up to the refinement of the peak between rows."""
    load, sweep = study.load, study.sweep
    for rpm in (4000, 6000):
        for i, relief in enumerate(sweep.relief_um):
            largest = load.at(rpm=rpm, relief_um=relief).pair_load_n.max() / study.motion.load_n
            assert sweep.dynamic_factor[i, sweep.rpm == rpm] == pytest.approx(largest, rel=1e-3)


@pytest.mark.filterwarnings('ignore::gearsweep.PartialWarning')
def test_one_point_one_answer():
    """Several motions exist here: `load` gives the same whatever the sweep beside it follows."""
    speeds = {'rpm_step': 100, 'load_rpm': [5900, 6800, 11000]}
    case = Case(PRESCRIBED).changed(dynamics={'damping_ratio': 0.01}, relief={'amount_um': [2, 15]}, sweep=speeds)
    alone = gearsweep.run(case.changed(case={'tasks': 'load'}))
    for direction in ('each', 'up', 'down'):
        beside = gearsweep.run(case.changed(case={'tasks': ['load', 'sweep']}, sweep={'direction': direction}))
        np.testing.assert_array_equal(beside.load.pair_load_n, alone.load.pair_load_n)
        for point in range(6):
            relief, rpm = np.unravel_index(point, (2, 3))
            where = {'rpm': float(alone.load_points.rpm[rpm]), 'relief_um': float(alone.load_points.relief_um[relief])}
            here, told = alone.load.at(**where), alone.load_points.at(**where)
            assert set(here.status) == {told.status} and set(here.pair) == set(range(1, told.mesh_periods + 1))
            assert here.pair_load_n.max() / alone.motion.load_n == pytest.approx(told.dynamic_factor, rel=1e-3)


def test_load_without_an_answer():
    """One row, which says why, as the sweep does."""
    case = Case(PARTIAL).changed(case={'tasks': ['load', 'sweep']}, sweep={'load_rpm': [1, 6001]})
    with pytest.warns(gearsweep.PartialWarning, match='^1 operating points'):
        load = gearsweep.run(case, 'load').load
    assert load.status[0] == 'unresolved' and np.isnan(load.pair_load_n[0]) and load.pair[0] == 0
    assert set(load.status[1:]) == {'inexact'} and not np.isnan(load.pair_load_n[1:]).any()
    assert list(load.to_pandas().status[:2]) == ['unresolved', 'inexact']


def test_optimum(study):
    optimum, curve = study.optimum, study.optimum_curve
    assert optimum.worst_dynamic_factor == np.nanmin(curve.worst_dynamic_factor)
    assert optimum.relief_um == curve.relief_um[np.nanargmin(curve.worst_dynamic_factor)]
    # The listed reliefs are no better.
    assert (np.nanmax(study.sweep.dynamic_factor, axis=1) >= optimum.worst_dynamic_factor - 1e-5).all()
    # Sweeping the best relief gives its worst factor again, to the search's tolerance.
    again = gearsweep.run(study.case.changed(relief={'amount_um': optimum.relief_um}), 'sweep', earlier=study)
    assert again.sweep.dynamic_factor.max() == pytest.approx(optimum.worst_dynamic_factor, abs=2e-5)


def test_section_is_a_grid(study):
    nodes, element = grid_of(study)
    x, y = nodes[element].transpose(2, 0, 1)
    # Anticlockwise corners, with the middles of the sides behind them.
    area = 0.5 * np.sum(x[:, :4] * np.roll(y[:, :4], -1, 1) - y[:, :4] * np.roll(x[:, :4], -1, 1), axis=1)
    assert (area > 0).all()
    middle = 0.5 * (x[:, :4] + np.roll(x[:, :4], -1, 1))
    assert np.abs(middle - x[:, 4:]).max() < 0.1 * 3
    assert set(np.unique(element)) == set(range(len(nodes)))
    assert (study.section.elements, study.section.nodes) == (len(element), len(nodes))
    assert study.section.area_mm2 == pytest.approx(area.sum(), rel=0.01)  # sides between corners are not quite straight
    assert set(study.elements.tooth) == {0, 1, 2, 3}
    assert 2 * np.hypot(*nodes.T).max() == pytest.approx(study.gears.tip_diameter_mm[0], rel=1e-12)


def test_modes(study):
    modal = study.modal
    assert (np.diff(modal.frequency_hz) > 0).all() and (modal.residual < 1e-6).all()
    # The inner edge is held.
    shape = np.stack([study.mode_shapes.shape_x, study.mode_shapes.shape_y])
    radius = np.hypot(study.nodes.x_mm, study.nodes.y_mm)
    assert not shape[:, :, radius < radius.min() * (1 + 1e-9)].any()
    assert shape.any(axis=(0, 2)).all()
    np.testing.assert_allclose(study.mode_energy.energy_share.sum(axis=1), 1, rtol=1e-12)
    np.testing.assert_array_equal(study.mode_energy.at(tooth=0).energy_share, modal.rim_share)


def test_root_stress(study):
    """Stress along a free surface in components: its trace is the stress, its determinant 0."""
    static = study.static
    x, y, xy = static.sigma_x_mpa, static.sigma_y_mpa, static.tau_xy_mpa
    np.testing.assert_allclose(x + y, static.sigma_mpa, rtol=1e-12)
    np.testing.assert_allclose(x * y, xy**2, rtol=1e-9)
    assert (static.at(side='drive').sigma_mpa > 0).all() and (static.at(side='coast').sigma_mpa < 0).all()
    assert (study.root_stress.tension_mpa >= static.sigma_mpa.max(axis=(1, 2)) * (1 - 1e-12)).all()


def test_stress_on_the_section():
    """Its trace at the fillet is the root stress, found there in another way; the closer, the finer the grid."""
    deviation = []
    for elements in (6, 12, 24):
        case = Case(GEARED).changed(section={'elements_across': elements}, static={'field_position': 0})
        study = gearsweep.run(case, 'static')
        static, load, stress = study.static.at(side='drive'), study.stress_load, study.stress
        nodes, element = grid_of(study)
        # Where the tension is largest along the whole fillet; the table has that at one tangent.
        relief, worst = list(static.relief_um).index(load.relief_um), int(load.position) - 1
        assert load.s == static.s[worst] and static.sigma_mpa[relief, worst] > 0.99 * static.sigma_mpa.max()
        assert study.root_stress.tension_mpa[relief] == study.root_stress.tension_mpa.max()
        assert (load.radius_mm, load.load_share) == (static.radius_mm[relief, worst], static.load_share[relief, worst])
        loaded = np.unique(element[study.elements.tooth == 2])
        fillet = loaded[(nodes[loaded, 0] > 0) & (np.hypot(*nodes[loaded].T) < 30)]
        trace = (stress.sigma_x_mpa + stress.sigma_y_mpa)[fillet]
        deviation.append(abs(trace.max() / study.root_stress.tension_mpa[relief] - 1))
    # Values at nodes are of first order at a surface, or better.
    assert deviation[1] < deviation[0] / 1.8 and deviation[2] < deviation[1] / 1.8


def test_run_leaves_out_what_is_not_asked_for():
    with pytest.warns(gearsweep.UnusedWarning, match='for load: &sweep load_rpm'):
        study = gearsweep.run(Case(PRESCRIBED).changed(case={'tasks': 'mesh'}))
    assert {'geometry', 'sweep', 'modal'}.isdisjoint(study.tables) and {'mesh', 'motion'} <= set(study.tables)
    with pytest.warns(gearsweep.UnusedWarning, match='for modal: &modal modes'):
        study = gearsweep.run(Case(GEARED).changed(case={'tasks': 'geometry'}, load={'normal_force_n': None}))
    assert 'geometry' in study and 'motion' not in study
    with pytest.raises(AttributeError, match=r'has no table mehs; .*; the case asks for geometry'):
        _ = study.mehs


def test_a_task_need_not_be_named():
    """Tasks that are given count as the case's: nothing is unused, and nothing else is computed."""
    study = gearsweep.run(Case(GEARED).changed(case={'tasks': ['mesh']}), ['sweep', 'modal'])
    assert study.sweep.dynamic_factor.shape == (2, 13) and study.modal.frequency_hz.shape == (3,)
    assert 'mesh' not in study and study.case.tasks == ('sweep', 'modal')
    # Without tasks it is that task alone: a pair without load has a geometry.
    bare = Case('&pair module_mm = 3 face_width_mm = 20 / &pinion teeth = 21 / &gear teeth = 34 /')
    assert gearsweep.run(bare, 'modal').elements.tooth.max() == 3


def test_arrays_are_read_only(study):
    for table in study:
        for name in table:
            value = table[name]
            if isinstance(value, np.ndarray) and value.size:
                with pytest.raises(ValueError):
                    value[...] = value


def test_every_column_has_unit_and_words(study):
    """And no name of the class stands before one of a column."""
    own = {name for name in dir(gearsweep.Table) if not name.startswith('_')}
    for table in study:
        assert table.meaning and not own & set(table)
        for name, unit in table.units.items():
            assert table.meanings[name]
            assert len(table.dims[name]) == np.ndim(table[name]), name
            for ending, expected in (('_mm', 'mm'), ('_um', 'um'), ('_mpa', 'MPa'), ('_hz', 'Hz'), ('_n', 'N'), ('rpm', '1/min')):
                if name.endswith(ending) and not name.endswith(('_n_um', '_n_mm', '_n_um_mm', '_um_n')):
                    assert unit == expected, name
    assert not {name for name in dir(gearsweep.Study) if not name.startswith('_')} & set(study.tables)


def test_earlier_studies_cost_nothing_and_change_nothing(study):
    """Other reliefs, speeds and damping need no other stiffness; other gears do."""
    changes = {'relief': {'amount_um': 5}, 'dynamics': {'damping_ratio': 0.1}, 'sweep': {'rpm_step': 1000}}
    changed = study.case.changed(**changes)
    for case, is_same in ((changed, True), (changed.changed(pinion={'teeth': 22}), False)):
        fresh, other = gearsweep.run(case), gearsweep.run(case, earlier=study)
        assert bits(fresh) == bits(other)
        assert ('taken over' in other.log) == is_same and 'taken over' not in fresh.log
    with pytest.raises(TypeError, match='earlier'):
        gearsweep.run(changed, earlier=changed)


def test_a_study_outlives_what_it_came_from():
    """A table keeps its study's memory, and a study that is gone gives it back."""
    sweep = gearsweep.run(Case(PRESCRIBED), 'sweep').sweep
    gc.collect()
    assert sweep.dynamic_factor.shape == (2, 15)
    handle = weakref.ref(sweep.study._source)
    del sweep
    gc.collect()
    assert handle() is None
