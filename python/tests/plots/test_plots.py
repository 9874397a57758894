"""Pictures: what is drawn is what the result holds, whole and legible. Nothing is compared by pixels."""

import io
import itertools
import pathlib
import re
import subprocess
import sys

import matplotlib
import numpy as np
import pytest
from conftest import GEARED, PARTIAL, PRESCRIBED, ROOT, grid_of
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.legend import Legend
from matplotlib.path import Path
from matplotlib.text import Annotation, Text

import gearsweep
from gearsweep import Case, plots
from gearsweep.core.outline import contact_path
from gearsweep.plots import branches, over_speed
from gearsweep.plots.along_path import contact_points
from gearsweep.plots.reliefs import Reliefs
from gearsweep.plots.sensitivity import NUMBERS
from gearsweep.plots.stress import principal

ALONG_PATH = {'stiffness': 'mesh_stiffness_n_um', 'sharing': 'load_share', 'ste': 'ste_um'}
MAPS = ('stability', 'hysteresis', 'poincare', 'attractors', 'precision')
MANY = {'relief': {'amount_um': list(range(0, 24, 2))}}
ONE_SPEED = {'sweep': {'rpm_first': 7000, 'rpm_last': 7000}}
ASYMMETRIC = {'pair': {'pressure_angle_deg': 25, 'coast_angle_deg': 20}}
MODES = {'case': {'tasks': 'modal'}, 'modal': {'modes': 22}, 'section': {'elements_across': 3, 'teeth': 0, 'fixed': 'rim'}}


@pytest.fixture(scope='module')
def study():
    return gearsweep.run(Case(GEARED))


@pytest.fixture(scope='module')
def prescribed():
    return gearsweep.run(Case(PRESCRIBED))


@pytest.fixture(scope='module')
def partial():
    with pytest.warns(gearsweep.PartialWarning):
        return gearsweep.run(Case(PARTIAL).changed(relief={'amount_um': [0, 5]})).sweep


@pytest.fixture
def ax():
    return Figure().subplots()


@pytest.fixture(scope='module')
def rattling():
    return Case(PRESCRIBED).changed(
        relief={'amount_um': 0}, mesh={'coefficients': 400}, dynamics={'damping_ratio': 0.02},
        sweep={'rpm_first': 4500, 'rpm_last': 12000, 'rpm_step': 250, 'load_rpm': None}, case={'tasks': 'sweep'},
    )  # fmt: skip


@pytest.fixture(scope='module')
def both(rattling):
    return gearsweep.run(rattling, 'hysteresis')


@pytest.fixture(scope='module')
def everything():
    case = Case(GEARED).changed(load={'normal_force_n': None, 'torques_nm': [60, 118]}, section={'teeth': 3}, dynamics={'damping_ratio': 0.17},
                                poincare={'settling_periods': 20, 'kept_periods': 10}, attractors={'starts': 4},
                                branches={'parameter': 'damping_ratio', 'rpm': 9000, 'first': 0.06, 'last': 0.16, 'seeds': 1, 'points': 10,
                                          'most_periods': 1},
                                sensitivity={'rpm': [4000, 6000]}, sweep={'load_torque': True},
                                static={'field_position': 0}, flank={'rpm': [4000, 6000]}, rating={'rpm': [4000, 6000]},
                                transient={'rpm': [4000, 6000], 'modes': 3, 'samples': 20},
                                harmonic={'frequency_hz': [0, 1e5], 'modes': 3},
                                life={'rpm': [4000, 6000], 'duration_h': [10, 20], 'mean_stress': 'none', 'curve_cycles': [1e3, 1e6], 'curve_stress_mpa': [500, 86]},
                                pinion={'bore_mm': 20}, body_modes={'nodal_diameters': 2, 'elements_across': 2, 'shapes': 3},
                                as_built={'waterfall': True}, deviations={'pinion_class': 6, 'draws': 2},
                                precision={'most_steps': 100, 'most_samples': 64, 'most_elements': 4, 'modes': 1})  # fmt: skip
    return gearsweep.run(case, (*case.tasks, *MAPS, 'branches', 'sensitivity', 'flank', 'rating', 'transient', 'harmonic', 'life',
                                'body_modes', 'deflection_relief', 'as_built', 'face_load'))  # fmt: skip


def all_plots():
    return [getattr(plots, name) for name in plots.__all__ if name.startswith('plot_')]


def legend_titles(ax):
    return [legend.get_title().get_text() for legend in ax.findobj(Legend) if legend.get_title().get_text()]


def curves(ax, n):
    """The first n lines of the axes as arrays (2, points)."""
    return [np.array(line.get_data()) for line in ax.lines[:n]]


def test_every_plot_draws_into_given_axes_with_units_and_leaves_the_style_alone(everything):
    before = dict(matplotlib.rcParams)
    for plot in all_plots():
        ax = Figure().subplots()
        assert plot(everything, ax) is ax
        assert ax.has_data()
        if ax.axison:
            for label in (ax.get_xlabel(), ax.get_ylabel()):
                assert label == 'Input' or re.search(r'[A-Za-z].* \((.+)\)$', label), (plot, label)
    assert dict(matplotlib.rcParams) == before


def test_figures_of_their_own_have_the_width_of_a_journal(everything):
    from matplotlib import pyplot

    before = dict(matplotlib.rcParams)
    for plot in all_plots():
        figure = plot(everything).figure
        assert round(figure.get_size_inches()[0] * 25.4, 6) in (85, 175)
        pyplot.close(figure)
    assert dict(matplotlib.rcParams) == before


def test_the_band_of_a_sweep_is_the_estimate_on_either_side(ax):
    rpm, factor, estimate = np.array([1000.0, 2000, 3000]), np.array([[1.2, 1.5, 1.1]]), np.array([[0.1, 0.2, 0.05]])
    ax.set_ylim(1, 2)
    over_speed._error_bands(ax, rpm, factor, estimate, Reliefs(Case(PRESCRIBED).changed(relief={'amount_um': 0})))
    (band,) = ax.collections
    corners = band.get_paths()[0].vertices
    for speed, middle, half in zip(rpm, factor[0], estimate[0]):
        there = corners[corners[:, 0] == speed, 1]
        assert (there.min(), there.max()) == pytest.approx((middle - half, middle + half))


def test_sweep_shows_its_arrays_and_published_points(study, ax):
    sweep = study.sweep
    points = [(4000, 1.3, 10), (6000, 1.1)]
    plots.plot_sweep(sweep, ax, points=points)
    for curve, factor in zip(curves(ax, 2), sweep.dynamic_factor):
        np.testing.assert_array_equal(curve, [sweep.rpm, factor])
    circles = ax.lines[2:4]
    assert [tuple(np.ravel(circle.get_data())) for circle in circles] == [point[:2] for point in points]
    np.testing.assert_array_equal(circles[0].get_markeredgecolor(), ax.lines[1].get_color())
    assert {'0', '10', 'published'} <= {text.get_text() for text in ax.findobj(Text)}


def test_points_without_an_answer_are_gaps_with_crosses(partial, ax):
    missing = partial.status == 'unresolved'
    assert missing.any() and not missing.all()
    plots.plot_sweep(partial, ax)
    for curve, gaps in zip(curves(ax, 2), missing):
        np.testing.assert_array_equal(np.isnan(curve[1]), gaps)
    crosses = [line for line in ax.lines if line.get_marker() == 'x']
    assert len(crosses) == 2
    for line in crosses:  # from the lowest row up: the last relief first
        np.testing.assert_array_equal(line.get_xdata(), partial.rpm[missing[1 - crosses.index(line)]])
        assert line.get_transform() == ax.get_xaxis_transform() and 0 < line.get_ydata()[0] < 0.1
    assert ax.transLimits.transform((0, np.nanmin(partial.dynamic_factor)))[1] > 0.07
    assert any('no answer: unresolved' in text.get_text() for text in ax.findobj(Text))


def test_what_was_seen_of_motions_that_do_not_repeat_is_hollow(chaotic):
    sweep = chaotic.sweep
    for draw, column in ((plots.plot_sweep, 'dynamic_factor'), (plots.plot_dte_sweep, 'dte_rms_um')):
        ax = draw(chaotic, Figure().subplots())
        squares = [line for line in ax.lines if line.get_marker() == 's' and len(line.get_xdata())]
        for line, seen, missing in zip(squares, sweep[f'seen_{column}'], sweep.status == 'chaotic', strict=True):
            np.testing.assert_array_equal(line.get_ydata(), seen)
            np.testing.assert_array_equal(np.isfinite(seen), missing)
            assert line.get_markerfacecolor() == 'white' and line.get_linestyle() == 'None'
        assert any(text.get_text() == 'seen, at least' for text in ax.findobj(Text))


def test_points_that_are_not_plainly_ok_are_marked(partial, ax):
    inexact = partial.status == 'inexact'
    assert inexact.any()
    plots.plot_sweep(partial, ax)
    marks = [line for line in ax.lines if line.get_marker() == '^']
    for line, here, factor in zip(marks, inexact, partial.dynamic_factor):
        np.testing.assert_array_equal(line.get_data(), [partial.rpm[here], factor[here]])


def test_a_point_alone_is_seen(ax):
    plots.plot_sweep(gearsweep.run(Case(PRESCRIBED).changed(**ONE_SPEED), 'sweep'), ax)
    assert ax.lines[0].get_markevery() == [0] and ax.lines[0].get_marker() == 'o'


def test_undamped_motion_is_marginal_throughout(ax):
    case = Case(PRESCRIBED).changed(dynamics={'damping_ratio': 0}, sweep={'rpm_first': 19000, 'rpm_last': 24000})
    sweep = gearsweep.run(case, 'sweep').sweep
    assert (sweep.status == 'marginal').all()
    plots.plot_sweep(sweep, ax)
    assert len(ax.lines) == 2 and any(text.get_text() == 'all marginal' for text in ax.findobj(Text))


def test_optimum_shows_its_curve_and_names_the_least(study, ax):
    optimum, tried = study.optimum, study.optimum_curve
    plots.plot_optimum(study, ax, points=[(10, 1.2)])
    bounds = tried.at_least == 1  # from a few speeds: no part of the curve
    assert bounds.any()
    np.testing.assert_array_equal(curves(ax, 1)[0], [tried.relief_um, np.where(bounds, np.nan, tried.worst_dynamic_factor)])
    triangles = next(line for line in ax.lines if line.get_marker() == '^')
    np.testing.assert_array_equal(triangles.get_data(), [tried.relief_um[bounds], tried.worst_dynamic_factor[bounds]])
    best = next(line for line in ax.lines if line.get_marker() == 'D')
    assert tuple(np.ravel(best.get_data())) == (optimum.relief_um, optimum.worst_dynamic_factor)
    assert f'{optimum.relief_um:.4g} µm' in ax.texts[-1].get_text()


@pytest.mark.parametrize('kind, field', ALONG_PATH.items())
def test_mesh_pictures_show_its_arrays(study, ax, kind, field):
    mesh = study.mesh
    getattr(plots, f'plot_{kind}')(mesh, ax)
    for curve, relief in zip(curves(ax, 2), (0, 10)):
        rows = np.isclose(mesh.relief_um, relief)
        np.testing.assert_array_equal(curve, [mesh.s[rows], getattr(mesh, field)[rows]])
    letters = {text.get_text(): text.xy[0] for text in ax.texts if text.get_text() in tuple('ABPDE')}
    assert letters == dict(zip('ABPDE', study.contact_points.s))
    if kind == 'stiffness':
        named = [text.get_text() for legend in ax.findobj(Legend) for text in legend.get_texts()]
        assert 'one pair' in named and not [text for text in ax.texts if text.get_text() == 'one pair']


# Of protanopes, deuteranopes and tritanopes, by Machado, Oliveira and Fernandes 2009, for linear RGB.
SIGHTS = {
    'normal': np.eye(3),
    'protan': [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
    'deutan': [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]],
    'tritan': [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900]],
}


def lab(color, sight='normal'):
    """CIE L*a*b* (D65) of a colour as a sight has it."""
    rgb = np.array(matplotlib.colors.to_rgb(color))
    linear = np.clip(np.array(SIGHTS[sight]) @ np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4), 0, 1)
    xyz = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])
    part = (xyz @ linear) / xyz.sum(axis=1)
    x, y, z = np.where(part > 216 / 24389, np.cbrt(part), (24389 / 27 * part + 16) / 116)
    return np.array([116 * y - 16, 500 * (x - y), 200 * (y - z)])


@pytest.mark.parametrize('sight', SIGHTS)
def test_kinds_are_distinguishable_by_all_eyes(sight):
    """A difference of 2.3 can just be seen (Mahy and others 1994)."""
    from gearsweep.plots.attractors import HUES
    from gearsweep.plots.kinds import KINDS
    from gearsweep.plots.precision import COLOURS

    for colors, least in ((KINDS.values(), 20), (COLOURS, 20), ((*HUES, '#222222', '#c8c8c8'), 10)):
        seen = [lab(color, sight) for color in colors]
        assert min(np.linalg.norm(a - b) for a, b in itertools.combinations(seen, 2)) > least


def test_twelve_reliefs_are_distinguishable_in_grey_print_too(ax):
    """Curves of the same dashes differ in lightness, by 20 of 100."""
    plots.plot_sweep(gearsweep.run(Case(PRESCRIBED).changed(**MANY), 'sweep'), ax)
    looks = [(str(line._dash_pattern), lab(line.get_color())[0]) for line in ax.lines[:12]]
    assert len(set(looks)) == 12 and len({dashes for dashes, _ in looks[:6]}) == 6
    for (dashes, light), (other, weight) in itertools.combinations(looks, 2):
        assert dashes != other or abs(light - weight) > 20


def test_harmonics_are_bars(study, ax):
    harmonics = study.harmonics
    plots.plot_harmonics(harmonics, ax)
    for bars, amplitude in zip(ax.containers, harmonics.amplitude_um[:, 1:], strict=True):
        np.testing.assert_array_equal([bar.get_height() for bar in bars], amplitude)
        np.testing.assert_array_equal(np.round([bar.get_x() + bar.get_width() / 2 for bar in bars]), harmonics.harmonic[1:])


def test_load_shows_the_speed_asked_for(study, ax):
    load = study.load
    plots.plot_load(load, ax, rpm=6000)
    found = [line for line in ax.lines if len(line.get_xdata()) > 2]
    for line, relief in zip(found, (0, 10), strict=True):
        rows = np.isclose(load.relief_um, relief) & np.isclose(load.rpm, 6000)
        np.testing.assert_array_equal(line.get_data(), [load.s[rows], load.pair_load_n[rows]])
    assert '6000 1/min' in ax.get_ylabel()
    with pytest.raises(ValueError, match='rpm = 5000: must be one of 4000, 6000'):
        plots.plot_load(load, ax, rpm=5000)


def test_a_subharmonic_load_is_a_path_for_each_pair(ax):
    """No line runs back along the path of contact."""
    case = Case(PRESCRIBED).changed(dynamics={'damping_ratio': 0.01}, relief={'amount_um': 2}, sweep={'load_rpm': 12600})
    load = gearsweep.run(case, 'load').load
    assert load.mesh_periods[0] == 2
    plots.plot_load(load, ax)
    paths = [line for line in ax.lines if len(line.get_xdata()) > 2]
    for pair, line in enumerate(paths, 1):
        np.testing.assert_array_equal(line.get_data(), [load.s[load.pair == pair], load.pair_load_n[load.pair == pair]])
        assert (np.diff(line.get_xdata()) > -1e-9).all()  # equal places may differ by rounding
    assert len(paths) == 2


def test_motion_shows_its_transmission_error_and_harmonics(ax):
    case = Case(PRESCRIBED).changed(dynamics={'damping_ratio': 0.01}, relief={'amount_um': [2, 15]}, sweep={'load_rpm': [7000, 12600]})
    study = gearsweep.run(case, 'load')
    load, harmonics = study.load, study.motion_harmonics
    plots.plot_dte(study, ax, rpm=7000)
    found = [line for line in ax.lines if len(line.get_xdata()) > 2]
    for line, relief in zip(found, (2, 15), strict=True):
        rows = (load.relief_um == relief) & (load.rpm == 7000)
        np.testing.assert_array_equal(line.get_data(), [load.s[rows], load.dte_um[rows]])
    ax = plots.plot_motion_harmonics(study, Figure().subplots(), rpm=12600)
    assert 0.5 in harmonics.harmonic[harmonics.rpm == 12600]  # every other mesh period
    for bars, relief in zip(ax.containers, (2, 15), strict=True):
        rows = (harmonics.relief_um == relief) & (harmonics.rpm == 12600) & (harmonics.harmonic > 0)
        np.testing.assert_array_equal([bar.get_height() for bar in bars], harmonics.dte_amplitude_um[rows])
    ends = sorted((bar.get_x(), bar.get_x() + bar.get_width()) for bars in ax.containers for bar in bars)
    assert all(end <= begin for (_, end), (begin, _) in itertools.pairwise(ends))  # no bar hides another
    for plot in (plots.plot_dte, plots.plot_motion_harmonics):
        with pytest.raises(ValueError, match='rpm = 5000: must be one of 7000, 12600'):
            plot(study, rpm=5000)


def test_load_names_reliefs_without_an_answer(ax):
    case = Case(PRESCRIBED).changed(numerics={'steps_per_period': 20}, sweep={'load_rpm': 1})
    with pytest.warns(gearsweep.PartialWarning):
        load = gearsweep.run(case, 'load').load
    assert np.isnan(load.s).all() and list(load.status) == ['unresolved'] * 2
    plots.plot_load(load, ax)
    assert any(text.get_text() == 'no answer: 0, 15 µm' for text in ax.findobj(Text))


def test_static_shows_both_sides_and_its_error(study, ax):
    static = study.static
    plots.plot_static(static, ax)
    expected = [static.sigma_mpa[relief, :, side] for side in (0, 1) for relief in (0, 1)]
    for curve, sigma in zip(curves(ax, 4), expected):
        np.testing.assert_array_equal(curve, [static.s, sigma])
    assert len(ax.collections) == 4  # on this coarse grid the error can be seen


def test_contact_points_of_a_prescribed_mesh():
    """As ISO 21771 defines them: a pair enters where another has one base pitch left to go."""
    assert contact_points(gearsweep.run(Case(PRESCRIBED), 'mesh')) == pytest.approx({'A': 0, 'B': 0.6, 'D': 1, 'E': 1.6})
    high = Case(PRESCRIBED).changed(mesh={'contact_ratio': 2.25, 'pitch_point': 1.2}, relief={'start': 'pitch'})
    assert contact_points(gearsweep.run(high, 'mesh')) == pytest.approx({'A': 0, 'B': 0.25, 'P': 1.2, 'D': 2, 'E': 2.25})


@pytest.mark.parametrize('changes', [{}, ASYMMETRIC, {'gear': {'teeth': 20000}}, {'pair': {'centre_distance_mm': 83.6}}])
def test_gears_touch_on_the_path_and_nowhere_overlap(changes, ax):
    study = gearsweep.run(Case(GEARED).changed(**changes), 'geometry')
    geometry, points = study.geometry, study.contact_points
    path = contact_path(study, points.s)
    centre = np.array([0, geometry.centre_distance_mm])
    np.testing.assert_allclose(np.hypot(*path.T), points.pinion_radius_mm, rtol=1e-9)
    np.testing.assert_allclose(np.hypot(*(path - centre).T), points.gear_radius_mm, rtol=1e-9)

    plots.plot_geometry(study, ax)
    pinion, gear = (patch.get_path() for patch in ax.patches[:2])
    touch = contact_path(study, np.array([geometry.contact_ratio / 2]))[0]
    size = 0.002 * 3  # parts of the module: the chords of the outlines lie off the flanks
    for outline, away in ((pinion, 1), (gear, -1)):
        normal = away * np.array([1, np.tan(np.radians(geometry.working_angle_deg))])
        assert outline.contains_point(touch - size * normal) and not outline.contains_point(touch + size * normal)
    assert depth(pinion.vertices, gear.vertices) < size and depth(gear.vertices, pinion.vertices) < size


def depth(points, outline):
    """How deep any of the points lies inside the outline; 0 where none does."""
    inside = points[Path(outline).contains_points(points)]
    start, side = outline[:-1], np.diff(outline, axis=0)
    start, side = start[(side != 0).any(axis=1)], side[(side != 0).any(axis=1)]
    part = ((inside[:, None] - start) * side).sum(axis=-1) / (side**2).sum(axis=-1)
    foot = start + np.clip(part, 0, 1)[..., None] * side
    return np.linalg.norm(inside[:, None] - foot, axis=-1).min(axis=1, initial=np.inf).max(initial=0)


def test_modes_show_the_shape(study, ax):
    modal = study.modal
    plots.plot_modal(modal, ax, mode=2)
    rest, _, moved = (np.concatenate(lines.get_segments()) for lines in ax.findobj(LineCollection))
    nodes, _ = grid_of(study)
    place = [np.flatnonzero((nodes == point).all(axis=1)) for point in rest[::5]]  # ends of the curves are corners
    shape = np.column_stack([study.mode_shapes[axis][1, np.concatenate(place)] for axis in ('shape_x', 'shape_y')])
    shown = (moved - rest)[::5]
    scale = np.vdot(shown, shape) / np.vdot(shape, shape)
    np.testing.assert_allclose(shown, scale * shape, atol=1e-12 * np.abs(nodes).max())
    assert f'{modal.frequency_hz[1] / 1000:.4g} kHz' in ax.get_title() and '±' not in ax.get_title()
    with pytest.raises(ValueError, match='mode = 4: must be from 1 to 3'):
        plots.plot_modal(modal, ax, mode=4)


def test_section_shows_every_edge_once(study, ax):
    """Euler: corners - edges + elements = 1 for a grid without holes."""
    _, element = grid_of(study)
    plots.plot_section(study, ax)
    edges = len(ax.collections[0].get_segments())
    assert len(np.unique(element[:, :4])) - edges + len(element) == 1


@pytest.mark.parametrize('gear', ['pinion', 'gear'])
@pytest.mark.parametrize('teeth', [1, 2, 3, 4, 0])
def test_the_load_arrow_ends_on_the_loaded_flank(teeth, gear, ax):
    """On the boundary of the grid, from outside, along the tangent to the base circle; and there the stress is largest."""
    section = {'teeth': teeth, 'gear': gear, 'fixed': ['rim'] if teeth == 0 else ['sides', 'rim']}
    case = Case(GEARED).changed(mesh={'model': 'weber'}, section=section, static={'field_position': 2}, relief={'amount_um': 0})
    study = gearsweep.run(case, 'static')
    plots.plot_stress(study, ax)
    arrow = next(text for text in ax.texts if text.arrow_patch)
    foot, tail = np.array(arrow.xy), np.array(arrow.xyann)
    nodes, element = grid_of(study)
    assert np.hypot(*foot) == pytest.approx(study.stress_load.radius_mm, rel=1e-6)
    along = -tail / np.hypot(*tail)  # which way the load points
    base = study.gears.at(gear=gear).base_diameter_mm / 2
    assert abs(foot[0] * along[1] - foot[1] * along[0]) == pytest.approx(base, rel=1e-4)

    def is_inside(point):
        return any(Path(nodes[corners[[0, 4, 1, 5, 2, 6, 3, 7]]]).contains_point(point) for corners in element)

    assert is_inside(foot + 0.05 * along) and not is_inside(foot - 0.05 * along)
    stress = study.stress
    value = np.abs(principal(stress.sigma_x_mpa, stress.sigma_y_mpa, stress.tau_xy_mpa))
    value[np.hypot(*nodes.T) < study.gears.at(gear=gear).form_diameter_mm / 2] = 0  # without the fillets
    assert np.hypot(*(nodes[value.argmax()] - foot)) < 0.7  # nodes are as far from each other


def test_principal_stress():
    rng = np.random.default_rng(4)
    x, y, xy = rng.normal(size=(3, 50))
    values = np.linalg.eigvalsh(np.array([[x, xy], [xy, y]]).T)
    larger = values[np.arange(50), np.abs(values).argmax(axis=1)]
    np.testing.assert_allclose(principal(x, y, xy), larger, rtol=1e-12)


def test_stability_shows_its_map_and_tongues(rattling, ax):
    case = rattling.changed(stability={'rpm': np.linspace(8000, 36000, 57), 'damping_last': 0.12, 'damping_count': 13, 'tongues': 3})
    study = gearsweep.run(case, 'stability')
    plots.plot_stability(study, ax)
    seen = ax.collections[0].get_array()
    assert min(seen.shape) >= 100  # fine, however few were computed, which are among them as they are
    np.testing.assert_array_equal(seen[::13, ::3], study.stability.floquet_modulus.T)
    tongues, edges = study.tongues, study.tongue_edges
    for n in range(3):
        rpm, damping = ax.lines[n].get_data()
        top = damping.argmax()
        assert (rpm[top], damping[top]) == (tongues.closing_rpm[n], tongues.closing_damping_ratio[n])
        open_ = np.isfinite(edges.lower_rpm[n])
        np.testing.assert_array_equal(rpm[:top], edges.lower_rpm[n, open_])
        np.testing.assert_array_equal(rpm[:top:-1], edges.upper_rpm[n, open_])
        np.testing.assert_array_equal(damping[:top], edges.damping_ratio[open_])
    words = {text.get_text() for text in ax.findobj(Text)}
    assert f'{tongues.closing_damping_ratio[0]:.3g}' in words


def test_stability_where_nothing_is_known(rattling, ax):
    study = gearsweep.run(rattling.changed(stability={'rpm': [0.001, 0.002], 'tongues': 0}), 'stability')
    assert np.isnan(study.stability.floquet_modulus).all()
    plots.plot_stability(study, ax)


def test_hysteresis_shows_both_branches_cut_at_jumps(both, ax):
    plots.plot_hysteresis(both, ax)
    runs, changes = both.hysteresis, both.hysteresis_changes
    rpm_ends = np.column_stack((changes.rpm_before, changes.rpm_after))
    factor_ends = np.column_stack((changes.dynamic_factor_before, changes.dynamic_factor_after))
    before, after = factor_ends.T
    jumps = (changes.kind == 'jump') | (np.abs(after - before) > 0.02 * np.nanmax(runs.dynamic_factor))
    assert jumps.any() and not jumps.all() and (jumps & (changes.kind == 'doubling')).any()
    for (rpm, factor), way in zip(curves(ax, 2), ('up', 'down')):
        assert (np.diff(rpm) > 0).all()
        found = np.isin(rpm, runs.rpm)
        np.testing.assert_array_equal(factor[found], runs.at(direction=way, relief_um=0).dynamic_factor)
        of_way = changes.direction == way
        assert set(rpm[~found & np.isfinite(factor)]) <= set(rpm_ends[of_way].ravel())
        for low, high in np.sort(rpm_ends[of_way & jumps]):
            assert np.isnan(factor[(rpm > low) & (rpm < high)]).all()
    arrows = [(text.xyann, text.xy) for text in ax.texts if text.arrow_patch]
    expected = [tuple(zip((rpm[0], rpm[0]), factor)) for rpm, factor in zip(rpm_ends[jumps], factor_ends[jumps])]
    assert sorted(arrows) == sorted(expected)
    assert legend_titles(ax) == ['Tip relief 0 µm']
    largest = changes.rpm_before[np.nanargmax(np.abs(after - before))]
    assert f'{largest:.0f}' in {text.get_text() for text in ax.texts}


def test_hysteresis_shows_runs_at_a_finite_rate(rattling, ax):
    study = gearsweep.run(rattling.changed(hysteresis={'rpm': np.arange(9000, 12001, 100), 'ramp_rpm_s': 2000}), 'hysteresis')
    plots.plot_hysteresis(study, ax)
    dotted = [line for line in ax.lines if line.get_linestyle() == ':']
    for line, way in zip(dotted, ('up', 'down'), strict=True):
        np.testing.assert_array_equal(line.get_ydata(), study.hysteresis_ramps.at(relief_um=0, direction=way).dynamic_factor)
    assert 'at 2000 1/min a second' in [text.get_text() for text in ax.findobj(Text)]


def test_poincare_shows_each_motion_in_its_colour(both, ax):
    start = both.hysteresis.at(rpm=7000, direction='down', relief_um=0)
    section = {'rpm': np.arange(7000, 4500, -25), 'start_um': start.dte_um, 'start_mm_s': start.dte_rate_mm_s}
    study = gearsweep.run(both.case.changed(poincare=section), 'poincare')
    seen, motion = study.poincare.at(relief_um=0), study.lyapunov.at(relief_um=0)
    plots.plot_poincare(study, ax)
    kinds = {'repeats with the mesh': motion.mesh_periods == 1, 'after 2 periods': motion.mesh_periods == 2,
             'chaotic': motion.status == 'chaotic'}  # fmt: skip
    labels = [text.get_text() for text in ax.get_legend().get_texts()]
    for line, label in zip(ax.lines, labels, strict=True):
        # At 300 dots an inch a point is four of them wide.
        assert line.get_marker() == 'o' and line.get_markersize() * 300 / 72 >= 4
        if label in kinds:
            np.testing.assert_array_equal(line.get_ydata(), seen.dte_um[kinds[label]].ravel())
    assert labels[:2] == list(kinds)[:2] and sum(len(line.get_xdata()) for line in ax.lines) == seen.dte_um.size


def test_precision_shows_errors_and_estimates_over_run_times(ax):
    keys = {'rpm': [5000, 7000], 'relief_um': 15, 'most_steps': 200, 'most_samples': 64, 'harmonics': 2}
    study = gearsweep.run(Case(PRESCRIBED).changed(precision=keys), 'precision')
    shown = study.precision
    plots.plot_precision(study, ax)
    curves = {line.get_label(): line for line in ax.lines if line.get_linestyle() == '-'}
    for method in ('collocation', 'rk4', 'rk4_equal', 'constant'):
        mine = (shown.quantity == 'dynamic_factor') & (shown.method == method)
        error = shown.error[mine].reshape(2, -1)  # a row for each speed
        np.testing.assert_array_equal(curves[method].get_ydata(), error.max(0))
        np.testing.assert_allclose(curves[method].get_xdata(), shown.run_time_s[mine].reshape(2, -1).mean(0), rtol=1e-12)
    estimates = [line for line in ax.lines if line.get_linestyle() == '--']
    assert len(estimates) == 2  # the others have none
    for line, method in zip(estimates, ('collocation', 'rk4'), strict=True):
        mine = (shown.quantity == 'dynamic_factor') & (shown.method == method)
        np.testing.assert_array_equal(line.get_ydata(), shown.error_estimate[mine].reshape(2, -1).max(0))
    assert ax.get_xscale() == ax.get_yscale() == 'log'
    assert [name for name, _ in plots.figures(study)] == ['precision']


def test_flank_shows_the_columns_of_its_table_at_one_speed():
    study = gearsweep.run(Case(GEARED).changed(mesh={'model': 'weber'}, flank={'rpm': [4000, 6000]}), 'flank')
    shown = study.flank
    for quantity in plots.flank.QUANTITIES:
        ax = plots.plot_flank(study, Figure().subplots(), quantity=quantity, rpm=6000)
        drawn = np.concatenate([line.get_ydata() for line in ax.lines if np.size(line.get_xdata()) > 2])
        columns = [quantity] if quantity in shown.units else ['pinion_specific_sliding', 'gear_specific_sliding']
        for column in columns:
            assert np.nanmax(shown[column][shown.rpm == 6000]) in drawn
    labels = [text.get_text() for legend in ax.findobj(Legend) for text in legend.get_texts()]
    assert {'motion', 'static load', '0', '10'} == set(labels)
    with pytest.raises(ValueError, match='rpm = 5000: must be one of 4000, 6000'):
        plots.plot_flank(study, rpm=5000)
    with pytest.raises(ValueError, match="quantity = 'heat': must be one of pressure_mpa"):
        plots.plot_flank(study, quantity='heat')


def test_body_modes_turn_round_the_gear(everything):
    """A rotation about the axis moves all alike; a mode of n nodal diameters is the same after a whole turn, and opposite
    after half a wave."""
    from gearsweep.plots.body_modes import whole_gear

    modes = everything.body_modes
    nodes, element, moved = whole_gear(everything, 1)
    teeth = everything.case.get('pinion', 'teeth')
    assert len(nodes) == teeth * everything.body_nodes.rows
    assert element.max() == len(nodes) - 1
    assert np.isfinite(moved).all()
    for mode in range(1, 4):
        moved = whole_gear(everything, mode)[2].reshape(teeth, -1, 3)
        if modes.nodal_diameter[mode - 1] == 0:
            assert np.allclose(moved[:, :, 2], moved[0, :, 2])
        else:
            assert np.allclose(moved[:, :, 2].sum(axis=0), 0, atol=1e-9 * np.abs(moved).max())
    ax = plots.plot_body_modes(everything, Figure().subplots(), mode=2)
    assert modes.mode_name[1] in ax.get_title()
    with pytest.raises(ValueError, match='mode = 4: must be from 1 to 3'):
        plots.plot_body_modes(everything, mode=4)


def test_rating_shows_the_dynamic_factor_by_both_methods():
    study = gearsweep.run(Case(GEARED).changed(mesh={'model': 'weber'}, rating={'rpm': [3000, 4000, 6000]}), 'rating')
    ax = plots.plot_rating(study, Figure().subplots())
    drawn = {tuple(line.get_ydata()) for line in ax.lines}
    for relief in range(2):
        assert tuple(study.dynamic_factors.dynamic_factor_a[relief]) in drawn
        assert tuple(study.dynamic_factors.dynamic_factor_b[relief]) in drawn
    labels = [text.get_text() for legend in ax.findobj(Legend) for text in legend.get_texts()]
    assert {'Method A: motion', 'Method B', '0', '10'} == set(labels)
    study = gearsweep.run(Case(GEARED).changed(mesh={'model': 'weber'}, rating={'rpm': 4000}), 'rating')
    ax = plots.plot_rating(study, Figure().subplots())  # one speed: bars over the reliefs
    factors = study.dynamic_factors
    heights = [[bar.get_height() for bar in bars] for bars in ax.containers if hasattr(bars, 'patches')]
    assert heights == [list(factors.dynamic_factor_a[:, 0]), list(factors.dynamic_factor_b[:, 0])]
    assert '4000 1/min' in ax.get_xlabel() and [text.get_text() for text in ax.get_xticklabels()] == ['0', '10']


def test_transient_shows_both_fillets_over_time_and_their_largest_stress_over_speed():
    case = Case(GEARED).changed(mesh={'model': 'weber'}, section={'elements_across': 3},
                                transient={'rpm': [6000, 4000], 'tangent_deg': [20, 30], 'modes': 3, 'samples': 20})  # fmt: skip
    study = gearsweep.run(case, 'transient')
    table = study.transient
    ax = plots.plot_transient(study, Figure().subplots(), rpm=4000, tangent_deg=30)
    drawn = {tuple(line.get_ydata()) for line in ax.lines}
    for relief in (0, 10):
        for side in ('drive', 'coast'):
            here = (table.relief_um == relief) & (table.rpm == 4000) & (table.side == side) & np.isclose(table.tangent_deg, 30)
            assert here.sum() == 21
            assert tuple(table.sigma_mpa[here]) in drawn and tuple(table.static_mpa[here]) in drawn
    ax = plots.plot_transient_peaks(study, Figure().subplots())
    drawn = {tuple(line.get_ydata()) for line in ax.lines}
    peaks = study.transient_peaks
    assert list(peaks.rpm) == [6000, 4000]
    for relief in range(2):
        assert tuple(peaks.tension_mpa[relief][::-1]) in drawn and tuple(peaks.static_tension_mpa[relief][::-1]) in drawn
    with pytest.raises(ValueError, match='rpm = 5000: must be one of 6000, 4000'):
        plots.plot_transient(study, rpm=5000)
    with pytest.raises(ValueError, match='tangent_deg = 25: must be one of 20, 30'):
        plots.plot_transient(study, tangent_deg=25)


def test_frequency_response_shows_both_fillets_and_campbell_where_harmonics_meet_frequencies():
    case = Case(GEARED).changed(mesh={'model': 'weber'}, section={'elements_across': 3, 'gear': 'gear'}, gear={'bore_mm': 30},
                                body_modes={'nodal_diameters': 2, 'elements_across': 2, 'modes': 1},
                                harmonic={'frequency_hz': [0, 1e5], 'tangent_deg': [20, 30], 'modes': 2, 's': [0.5, 0.9],
                                          'harmonics': 3})  # fmt: skip
    study = gearsweep.run(case, ('harmonic', 'body_modes'))
    table = study.harmonic
    ax = plots.plot_frequency_response(study, Figure().subplots(), tangent_deg=30)
    drawn = {tuple(line.get_ydata()) for line in ax.lines}
    assert list(table.s) == [0.5, 0.9] and list(table.side) == ['drive', 'coast'] and np.isclose(table.tangent_deg, [20, 30]).all()
    for place in range(2):
        for side in range(2):
            assert tuple(table.stress_mpa[place, 1, side]) in drawn
    with pytest.raises(ValueError, match='tangent_deg = 25: must be one of 20, 30'):
        plots.plot_frequency_response(study, tangent_deg=25)
    ax = plots.plot_campbell(study, Figure().subplots())
    speeds, last = study.campbell, case.get('sweep', 'rpm_last')
    assert ax.get_xlim() == (0, last / 1000)  # the case's speeds alone
    gears = speeds.system == 'gears'
    assert dots(ax) == {(rpm / 1000, hz / 1000) for rpm, hz in zip(speeds.rpm[gears], speeds.frequency_hz[gears])}
    words = {text.get_text() for text in ax.findobj(Text)}
    section = speeds.frequency_hz[~gears].min() / 1000
    assert {'1x', '2x', '3x', f'gears on the mesh, {speeds.frequency_hz[gears][0] / 1000:.4g} kHz',
            f'Above: 2 more, from section, mode 1, {section:.4g} kHz'} <= words  # fmt: skip


def dots(ax):
    return {(x, y) for line in ax.lines if line.get_marker() == 'o' for x, y in zip(*line.get_data())}


@pytest.fixture(scope='module')
def thin():
    """A thin-rimmed gear whose modes of few nodal diameters lie among the speeds."""
    return gearsweep.run(Case("""&case title = 'A thin rim' tasks = 'body_modes', 'sweep' / &pair module_mm = 2 face_width_mm = 20 / &pinion teeth = 20 /
        &gear teeth = 40 bore_mm = 20 rim_thickness_mm = 3 web_thickness_mm = 2 / &load torque_nm = 50 / &mesh model = 'weber' /
        &relief amount_um = 0 / &section gear = 'gear' / &sweep rpm_first = 1000 rpm_last = 9000 rpm_step = 4000 /
        &body_modes nodal_diameters = 3 elements_across = 2 modes = 1 shapes = 2 harmonics = 2 /"""))


def test_the_load_that_a_gear_turns_past_excites_its_waves_so_often_in_a_turn(thin):
    """The Fourier series of cos(k z p) cos(n p), what harmonic k of the mesh frequency does on n waves over a turn by 2 pi."""
    table, teeth, turn = thin.body_campbell, 40, 2 * np.pi * np.arange(1024) / 1024
    found = {}
    for mode, n, k, per_turn in zip(table.mode, table.nodal_diameter, table.harmonic, table.per_turn):
        found.setdefault((mode, n, k), set()).add(per_turn)
    for mode, n in zip(thin.body_modes.mode, thin.body_modes.nodal_diameter):
        for k in range(3):
            series = np.abs(np.fft.rfft(np.cos(k * teeth * turn) * np.cos(n * turn)))
            assert found.get((mode, n, k), set()) == set(np.flatnonzero(series > 1)) - {0}
    # A gear of 40 teeth turns once for two turns of a pinion of 20.
    np.testing.assert_allclose(table.rpm / 60 / 2 * table.per_turn, table.frequency_hz, rtol=1e-12)


def test_modes_of_a_body_have_a_campbell_diagram_with_names_and_orders(thin, ax):
    plots.plot_body_campbell(thin, ax)
    table, modes = thin.body_campbell, thin.body_modes
    reach = ax.get_ylim()[1]
    here = table.frequency_hz / 1000 < reach
    assert 0 < here.sum() < table.rows or here.all()
    assert dots(ax) == {(rpm / 1000, hz / 1000) for rpm, hz in zip(table.rpm[here], table.frequency_hz[here])}
    assert ax.get_xlim() == (0, 9)
    words = {text.get_text() for text in ax.findobj(Text)}
    assert {'1x', '2x'} | {f'{name}, {hz / 1000:.4g} kHz' for name, hz in zip(modes.mode_name, modes.frequency_hz) if hz / 1000 < reach} <= words
    assert [name for name, _ in plots.figures(thin, 'body_campbell')] == ['body_campbell']


def test_body_modes_say_what_their_colours_are(thin):
    ax = plots.plot_body_modes(thin, Figure().subplots(), mode=1)
    bar = ax.figure.axes[1]
    assert re.fullmatch(r'Displacement (along the axis|in the plane) \(of the largest\)', bar.get_ylabel())


def test_each_picture_says_whose_it_is(thin, prescribed):
    assert {figure.get_suptitle() for _, figure in plots.figures(thin, 'sweep', 'body_campbell')} == {'A thin rim'}
    bare = gearsweep.run(Case(PRESCRIBED).changed(case={'title': None, 'tasks': 'mesh'}))
    assert {figure.get_suptitle() for _, figure in plots.figures(bare, stem='pair')} == {'pair'}


def test_one_speed_is_one_tick(ax):
    plots.plot_sweep(gearsweep.run(Case(PRESCRIBED).changed(**ONE_SPEED), 'sweep'), ax)
    assert list(ax.get_xticks()) == [7000] and ax.get_xlim() == (5600, 8400)


def test_gears_are_named_within_their_teeth_and_turn_into_the_contact(study, ax):
    """Both flanks move to the right where they touch; the circle and the line have names."""
    plots.plot_geometry(study, ax)
    assert [text.get_text() for text in ax.get_legend().get_texts()] == ['line of action', 'working pitch circles']
    names = {text.get_text(): text for text in ax.texts}
    for name, patch in zip(('pinion', 'gear'), ax.patches):
        place = ax.transAxes.transform(names[name].xy)
        assert patch.get_path().contains_point(ax.transData.inverted().transform(place))
    arrows = [(text.xyann, text.xy) for text in ax.texts if text.arrow_patch]
    assert len(arrows) == 2 and all(end[0] > begin[0] for begin, end in arrows)


def test_what_was_found_along_the_curve_of_reliefs_lies_on_it():
    study = gearsweep.run(Case(GEARED).changed(mesh={'model': 'weber'}), 'deflection_relief')
    methods = study.deflection_relief
    for quantity in plots.deflection_relief.LABELS:
        line = plots.plot_deflection_relief(study, Figure().subplots(), quantity=quantity).lines[0]
        for name in ('transmission_error', 'dynamic_factor'):
            found = methods.at(method=name)
            assert (found.pinion_relief_um, found[quantity]) in set(zip(*line.get_data()))
        assert (np.diff(line.get_xdata()) >= 0).all()
    assert len(plots.plot_deflection_relief(study, Figure().subplots()).lines[0].get_xdata()) == study.relief_curve.rows + 2


def test_places_between_two_lie_on_straight_lines():
    from gearsweep.plots.stability import between

    np.testing.assert_allclose(between(np.array([1.0, 3, 7]), 2), [1, 2, 3, 5, 7])
    np.testing.assert_array_equal(between(np.array([[1.0, 2], [3, np.nan]]), 2), [[1, 2], [2, np.nan], [3, np.nan]])
    np.testing.assert_array_equal(between(np.array([5.0]), 9), [5])


def test_life_shows_the_parts_beside_the_curve():
    spectrum = {'rpm': [3000, 4000, 6000], 'duration_h': [1, 20, 300], 'load_factor': [1.5, 1, 0.5]}
    material = {'material': 'case_hardened'}
    study = gearsweep.run(Case(GEARED).changed(mesh={'model': 'weber'}, life=spectrum, rating=material), 'life')
    ax = plots.plot_life(study, Figure().subplots())
    drawn = {(tuple(line.get_xdata()), tuple(line.get_ydata())) for line in ax.lines}
    parts, curve = study.life_parts, study.life_curve
    assert (tuple(curve.failure_cycles), tuple(curve.stress_mpa)) in drawn
    for relief in range(2):
        for gear in range(2):
            shown = parts.engagements[relief, :, gear], parts.equivalent_amplitude_mpa[relief, :, gear]
            assert tuple(map(tuple, shown)) in drawn
    labels = [text.get_text() for legend in ax.findobj(Legend) for text in legend.get_texts()]
    assert {'S-N curve: case hardened', 'pinion', 'gear', '0', '10'} == set(labels)


@pytest.mark.parametrize('speeds, dots', [([3000, 9000], 2), (np.linspace(3000, 9000, 20).tolist(), 0)])
def test_few_speeds_have_their_dots(ax, speeds, dots):
    """A line between two computed speeds would promise what lies between them. Method B is one line where no relief changes it."""
    study = gearsweep.run(Case(GEARED).changed(mesh={'model': 'weber'}, rating={'rpm': speeds, 'accuracy_grade': 6}), 'rating')
    factors = study.dynamic_factors
    plots.plot_rating(study, ax)
    same = (factors.dynamic_factor_b == factors.dynamic_factor_b[0]).all()
    assert len(ax.lines) == 2 + (1 if same else 2)
    assert all(len(line.get_markevery()) == dots for line in ax.lines)


def test_compare_draws_a_column_of_several_studies(ax):
    cases = {f'zeta {zeta}': Case(PRESCRIBED).changed(dynamics={'damping_ratio': zeta}) for zeta in (0.1, 0.2)}
    studies = {name: gearsweep.run(case, ('sweep', 'mesh')) for name, case in cases.items()}
    plots.compare(studies, 'sweep', 'dynamic_factor', ax, relief_um=15)
    for line, (name, study) in zip(ax.lines, studies.items(), strict=True):
        assert line.get_label() == name
        np.testing.assert_array_equal(line.get_data(), [study.sweep.rpm, study.sweep.dynamic_factor[1]])
    assert (ax.get_xlabel(), ax.get_ylabel()) == ('Speed of the pinion (1/min)', 'Dynamic factor (–)')
    ax = plots.compare(studies, 'harmonics', 'amplitude_um', Figure().subplots(), relief_um=0)
    for bars, study in zip(ax.containers, studies.values(), strict=True):
        np.testing.assert_array_equal([bar.get_height() for bar in bars], study.harmonics.amplitude_um[0, 1:])
    assert (ax.get_xlabel(), ax.get_ylabel()) == ('Harmonic (–)', 'Amplitude (µm)')
    with pytest.raises(ValueError, match=r'sweep of zeta 0\.1: one index column must vary, not 2; say a value of all but one of relief_um, rpm'):
        plots.compare(studies, 'sweep', 'dynamic_factor', ax)
    with pytest.raises(TypeError, match='no index column speed'):
        plots.compare(studies, 'sweep', 'dynamic_factor', ax, speed=1)


def test_the_page_lists_every_picture_with_its_caption():
    rows = re.findall(r'^\| (`plot.*?) \| .*? \| `(\w+)` \| (.*) \|$', (ROOT / 'doc/pictures.md').read_text(), re.MULTILINE)
    assert {name for _, name, _ in rows} == set(plots.PICTURES)
    for _, name, shown in rows:
        assert shown.lower() == plots.PICTURES[name].caption.lower()
    assert {name for names, _, _ in rows for name in re.findall(r'plot_\w+', names)} == {plot.__name__ for plot in all_plots()}


@pytest.fixture(scope='module')
def wide():
    """Branches with backlash and little damping, from small motions to very large ones."""
    case = Case(PRESCRIBED).changed(pair={'backlash_um': 60}, dynamics={'damping_ratio': 0.02}, relief={'amount_um': 0},
                                    branches={'first': 6000, 'last': 16000, 'seeds': 4, 'most_periods': 1})  # fmt: skip
    return gearsweep.run(case, 'branches')


@pytest.mark.parametrize('quantity', branches.QUANTITIES)
@pytest.mark.parametrize(('across', 'per'), [('rpm', lambda study: 1), ('mesh_frequency_hz', lambda study: 25 / 60), ('frequency_ratio', lambda study: 25 / 60 / study.motion.natural_frequency_hz)])
def test_branches_are_drawn_over_speed_or_frequency(wide, quantity, across, per):
    """All points, and what changes at them; 25 teeth mesh 25 times in a turn."""
    ax = plots.plot_branches(wide, Figure().subplots(), quantity=quantity, across=across)
    drawn = np.unique(np.concatenate([np.column_stack(line.get_data()) for line in ax.lines]), axis=0)
    points, changes = wide.branch_points, wide.branch_changes
    expected = np.unique(np.concatenate([np.column_stack([per(wide) * table.rpm, table[quantity]]) for table in (points, changes)]), axis=0)
    np.testing.assert_allclose(drawn, expected, rtol=1e-12)
    assert (ax.get_xlabel(), ax.get_ylabel()) == (branches.ACROSS[across], branches.QUANTITIES[quantity])
    assert ax.get_yscale() == ('log' if points[quantity].max() > 10 * points[quantity].min() else 'linear')


def test_a_bifurcation_diagram_shows_the_transmission_error_and_has_limits(wide):
    assert plots.plot_branches(wide, Figure().subplots()).get_ylabel() == 'DTE, rms (µm)'
    ax = plots.plot_branches(wide, Figure().subplots(), quantity='dynamic_factor', limits=(0, 5))
    assert ax.get_ylim() == (0, 5) and ax.get_yscale() == 'linear' and wide.branch_points.dynamic_factor.max() > 5
    with pytest.raises(ValueError, match=r"quantity = 'rpm': must be one of dte_rms_um, dte_peak_to_peak_um, dynamic_factor"):
        plots.plot_branches(wide, Figure().subplots(), quantity='rpm')
    with pytest.raises(ValueError, match=r"across = 'hz': must be one of rpm, mesh_frequency_hz, frequency_ratio with rpm as the parameter"):
        plots.plot_branches(wide, Figure().subplots(), across='hz')


def test_sensitivity_shows_a_bar_for_each_number(everything):
    table = everything.sensitivity
    ax = plots.plot_sensitivity(everything, Figure().subplots(), rpm=6000, relief_um=table.relief_um[-1])
    rows = (table.rpm == 6000) & (table.relief_um == table.relief_um[-1]) & np.isfinite(table.relative_slope)
    widths = {label.get_text(): bar.get_width() for label, bar in zip(ax.get_yticklabels(), ax.patches)}
    assert widths == {NUMBERS[name]: slope for name, slope in zip(table.number[rows], table.relative_slope[rows])}
    assert ax.get_xlabel() == 'Change of DF for 1 % more (%)'
    _, figure = next(plots.figures(everything, 'sensitivity'))
    assert len({panel.get_xlim() for panel in figure.axes}) == 1 < len(figure.axes)  # to one scale
    assert len(widths) > 5 and list(np.abs(list(widths.values()))) == sorted(np.abs(list(widths.values())))


@pytest.mark.parametrize('quantity', ['dte_rms_um', 'dte_peak_to_peak_um'])
def test_transmission_error_over_speed_has_a_curve_for_each_relief(everything, quantity):
    ax = plots.plot_dte_sweep(everything, Figure().subplots(), quantity=quantity)
    curves = [line.get_ydata() for line in ax.lines if len(line.get_xdata()) == len(everything.sweep.rpm)]
    assert all(np.array_equal(one, other, equal_nan=True) for one, other in zip(curves, everything.sweep[quantity], strict=True))


def test_draw_all_writes_what_there_is(everything, prescribed, tmp_path):
    names = ('outline', 'section', 'mesh', 'harmonics', 'static', 'stress', 'modal', 'contact_pattern', 'face_load', 'load', 'motion_harmonics', 'torque',
             'torque_harmonics',
             'sweep', 'dte_sweep', 'optimum_curve', 'optimum_map', 'relief_curve', 'relief_flank', 'stability', 'hysteresis', 'poincare', 'attractors', 'basins',
             'branches', 'sensitivity',
             'precision', 'flank',
             'dynamic_factors', 'transient', 'transient_peaks', 'harmonic', 'campbell', 'life_parts', 'body_modes', 'body_campbell',
             'as_built', 'as_built_worst', 'as_built_turn', 'as_built_orders', 'as_built_waterfall')  # fmt: skip
    found = plots.draw_all(everything, tmp_path / 'new', 'pair', formats=['svg'])
    assert found == [str(tmp_path / 'new' / f'pair.{name}.svg') for name in names]
    assert sorted(path.name for path in (tmp_path / 'new').iterdir()) == sorted(path.rpartition('/')[2] for path in found)
    few = plots.draw_all(prescribed, tmp_path)
    assert few == [str(tmp_path / f'gearsweep.{name}.{ending}') for name in ('mesh', 'harmonics', 'load', 'motion_harmonics', 'sweep', 'dte_sweep', 'optimum_curve')
                   for ending in ('png', 'svg')]  # fmt: skip


def test_the_same_picture_has_the_same_bytes(prescribed, tmp_path):
    endings = ('png', 'svg', 'pdf')
    first, second = (plots.draw_all(prescribed, tmp_path / folder, formats=endings) for folder in 'ab')
    for one, other in zip(first, second, strict=True):
        assert pathlib.Path(one).read_bytes() == pathlib.Path(other).read_bytes()


@pytest.mark.parametrize('text, changes', [
    (GEARED, {}),
    (GEARED, ASYMMETRIC),
    (GEARED, MODES),
    (GEARED, {'pair': {'module_mm': 0.3}, 'load': {'normal_force_n': 40}, 'relief': {'amount_um': [0, 0.5, 1.25]}}),
    (PRESCRIBED, {}),
    (PRESCRIBED, MANY),
    (PRESCRIBED, {'relief': {'amount_um': 12.5}}),
    (PRESCRIBED, ONE_SPEED),
    (PRESCRIBED, {'mesh': {'contact_ratio': 1.02}}),
    (PARTIAL, MANY),
])  # fmt: skip
@pytest.mark.filterwarnings('ignore::gearsweep.PartialWarning', 'ignore::gearsweep.UnusedWarning')
def test_all_text_is_large_enough_whole_and_free(text, changes, monkeypatch):
    check_text(plots.figures(gearsweep.run(Case(text).changed(**changes))), monkeypatch)


def test_text_of_the_maps_is_large_enough_whole_and_free(rattling, monkeypatch):
    case = rattling.changed(stability={'tongues': 12}, poincare={'kept_periods': 20})
    check_text(plots.figures(gearsweep.run(case, MAPS)), monkeypatch)


@pytest.mark.parametrize('rpm', [4000, [4000, 6000, 8000]])
def test_text_of_flanks_is_large_enough_whole_and_free(rpm, monkeypatch):
    study = gearsweep.run(Case(GEARED).changed(mesh={'model': 'weber'}, flank={'rpm': rpm}), 'flank')
    check_text(plots.figures(study, 'flank'), monkeypatch)


def test_text_of_sensitivities_and_frequencies_is_large_enough_whole_and_free(monkeypatch):
    case = Case(GEARED).changed(mesh={'model': 'weber'}, sensitivity={'rpm': [4000, 6000]},
                                harmonic={'frequency_hz': [0, 1e5], 'modes': 3})  # fmt: skip
    check_text(plots.figures(gearsweep.run(case, ('sensitivity', 'harmonic'))), monkeypatch)


def check_text(figures, monkeypatch):
    drawn = {}
    draw = Text.draw

    def drawn_and_noted(words, renderer):
        draw(words, renderer)
        if words.get_text() and words.get_visible():
            drawn[words] = words.get_window_extent(renderer), words.get_figure().bbox.frozen()  # at last, laid out

    monkeypatch.setattr(Text, 'draw', drawn_and_noted)
    for name, figure in figures:
        drawn.clear()
        plots.save(figure, io.BytesIO(), 'png')
        assert drawn
        arrows = [text for text in figure.findobj(Annotation) if text.arrow_patch and not text.get_text()]
        for i, (words, (box, page)) in enumerate(drawn.items()):
            assert words.get_fontsize() >= 7
            assert page.x0 <= box.x0 and page.y0 <= box.y0 and box.x1 <= page.x1 and box.y1 <= page.y1, (name, words)
            over = [other for other, (taken, _) in list(drawn.items())[:i] if taken.overlaps(box)]
            assert not over, (name, words, over)
            scale = page.width / figure.bbox.width  # files have more dots than the figure
            shafts = [Path(scale * one.axes.transData.transform([one.xy, one.xyann])) for one in arrows if one.anncoords == 'data']
            assert not any(shaft.intersects_bbox(box, filled=False) for shaft in shafts), (name, words)


def test_without_a_display_and_without_pyplot(tmp_path):
    program = f"""
import sys, gearsweep
assert 'matplotlib' not in sys.modules
study = gearsweep.run(gearsweep.Case({PRESCRIBED!r}))
print(len(gearsweep.plots.draw_all(study, {str(tmp_path)!r})))
assert 'matplotlib.pyplot' not in sys.modules
print(gearsweep.plot_sweep(study.sweep).get_ylabel())
"""
    done = subprocess.run([sys.executable, '-c', program], capture_output=True, text=True, env={}, cwd=tmp_path, check=False)
    assert done.stdout == '14\nDynamic factor (–)\n', done.stderr


def test_without_matplotlib_the_message_says_what_to_install(tmp_path):
    program = "import sys; sys.modules['matplotlib'] = None\nimport gearsweep\ngearsweep.plot_sweep"
    done = subprocess.run([sys.executable, '-c', program], capture_output=True, text=True, check=False)
    assert "ImportError: gearsweep's pictures need matplotlib, which is not installed: pip install matplotlib" in done.stderr


TORQUES = """&case tasks = 'optimum' / &pinion teeth = 25 effective_mass_kg = 0.8 / &gear effective_mass_kg = 1.1 /
  &mesh model = 'polynomial' contact_ratio = 1.6 coefficients = 400, 0, -110 base_pitch_mm = 10 /
  &load torques_nm = 300, 150, 220 / &optimum judged = 'ste_peak_to_peak' /"""


def test_reliefs_over_torque_show_the_map_and_the_best(ax):
    study = gearsweep.run(Case(TORQUES))
    table, best = study.optimum_map, study.optimum.relief_um
    order = np.argsort(table.torque_nm)
    plots.plot_torques(study, ax)
    wide = max(ax.lines, key=lambda line: line.get_linewidth())
    np.testing.assert_array_equal(wide.get_data(), [table.torque_nm[order], table.ste_peak_to_peak_um[table.relief_um == best][0][order]])
    ax = plots.plot_optimum_map(table, Figure().subplots(), quantity='mesh_harmonic')
    dots = next(line for line in ax.lines if line.get_marker() == 'o')
    np.testing.assert_array_equal(dots.get_data(), [table.torque_nm[order], table.relief_um[table.mesh_harmonic_um.argmin(axis=0)][order]])
    with pytest.raises(ValueError, match='must be one of ste_peak_to_peak, mesh_harmonic'):
        plots.plot_torques(study, quantity='dynamic_factor')
    assert [name for name, _ in plots.figures(study)] == ['optimum_curve', 'optimum_map']
