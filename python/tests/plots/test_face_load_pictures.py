"""Pictures of the load over the face width: they show the table's numbers, and K_H_beta where it is."""

import matplotlib
import numpy as np
import pytest
from matplotlib.figure import Figure

import gearsweep
from gearsweep import Case, plots

CASE = Case('''&case tasks = 'face_load' / &pair module_mm = 3 face_width_mm = 30 / &pinion teeth = 25 crowning_um = 5 / &gear teeth = 40 /
    &load line_load_n_mm = 300 / &relief amount_um = 0, 15 / &section elements_across = 4 / &face misalignment_um = 40 /''')  # fmt: skip


@pytest.fixture(scope='module')
def study():
    return gearsweep.run(CASE)


def pattern_of(ax):
    """Edges over the face and over the diameter, and the pressure of each cell; NaN: white."""
    (mesh,) = ax.collections
    corners = mesh.get_coordinates()
    return corners[0, :, 0], corners[:, 0, 1], mesh.get_array().filled(np.nan)


def test_the_pattern_has_the_pressure_of_each_place(study):
    """Both sides of each cell are rows of the table, in one interval of phases; the radius by the tangent to the base circle."""
    z, diameter, pressure = pattern_of(plots.plot_contact_pattern(study, Figure().subplots(), relief_um=15))
    load = study.face_load
    mine = load.relief_um == 15
    np.testing.assert_allclose((z[1:] + z[:-1]) / 2, np.unique(load.z_mm[mine]), rtol=1e-12)
    assert z[0] == 0 and z[-1] == pytest.approx(30, rel=1e-12)
    base = study.gears.base_diameter_mm[0] / 2
    to_tangent = base * np.tan(np.radians(study.geometry.working_angle_deg)) - study.contact_points.at(point='P').s * study.geometry.base_pitch_mm
    places = to_tangent + load.s[mine] * study.geometry.base_pitch_mm
    of_row = 2 * np.hypot(base, places)
    assert len(diameter) * pressure.shape[1] == mine.sum()
    for low, high, cells in zip(diameter, diameter[1:], pressure):
        if high - low < 1e-6:  # where the number of pairs changes
            continue
        values = [{one: load.pressure_mpa[mine][np.isclose(of_row, at, rtol=1e-12) & (load.z_mm[mine] == one)] for one in np.unique(load.z_mm)}
                  for at in (low, high)]  # fmt: skip
        for cell, z_mm in zip(cells, np.unique(load.z_mm)):
            means = (values[0][z_mm][:, None] + values[1][z_mm]) / 2
            assert np.isclose(0 if np.isnan(cell) else cell, means, rtol=1e-12).any()


def test_flanks_that_do_not_touch_are_white_and_all_others_are_not(study):
    _, _, pressure = pattern_of(plots.plot_contact_pattern(study, Figure().subplots()))
    assert np.isnan(pressure[:, -1]).all() and np.isfinite(pressure[:, 0]).all()  # nearer at z = 0
    ax = plots.plot_contact_pattern(study, Figure().subplots())
    (mesh,) = ax.collections
    least = mesh.cmap(mesh.norm(0.0))
    assert max(least[:3]) - min(least[:3]) > 0.3  # not grey, so not white
    shades = [np.dot(mesh.cmap(place)[:3], (0.2126, 0.7152, 0.0722)) for place in np.linspace(0, 1, 30)]
    assert shades == sorted(shades, reverse=True)  # in grey print the darker the higher


def test_the_pattern_of_the_gear_goes_from_its_root_to_its_tip(study):
    edges = {gear: pattern_of(plots.plot_contact_pattern(study, Figure().subplots(), gear=gear))[1] for gear in ('pinion', 'gear')}
    assert (np.diff(edges['pinion']) > -1e-9).all() and (np.diff(edges['gear']) < 1e-9).all()
    for gear, edge in edges.items():
        assert edge.max() == pytest.approx(study.gears.at(gear=gear).tip_diameter_mm, rel=1e-9)
    with pytest.raises(ValueError, match="gear = 'wheel': must be pinion or gear"):
        plots.plot_contact_pattern(study, gear='wheel')
    with pytest.raises(ValueError, match='relief_um = 7: must be one of 0, 15'):
        plots.plot_contact_pattern(study, relief_um=7)


@pytest.mark.parametrize('relief', [0, 15])
def test_bars_over_the_face_are_the_factors_times_the_mean(study, relief):
    ax = plots.plot_face_load(study, Figure().subplots(), relief_um=relief)
    summary = study.face_load_summary.at(relief_um=relief)
    bars = [line for line in ax.lines if line.get_linewidth() == 2.5 and len(line.get_xdata())]
    for bar, curve, name in zip(bars, ax.patches, ('worst_face_load_factor', 'face_load_factor'), strict=True):
        x, y = bar.get_data()
        assert x[1] - x[0] == pytest.approx(3, rel=1e-12)
        np.testing.assert_allclose(y, 300 * summary[name], rtol=1e-12)
        loads, bounds, _ = curve.get_data()
        assert np.dot(loads, np.diff(bounds)) == pytest.approx(9000, rel=1e-9)
    words = [text.get_text() for text in ax.get_legend().get_texts()]
    assert words[0].endswith(f'= {summary.worst_face_load_factor:.3f}') and words[1].startswith('single contact')
    assert words[-1] == 'mean: 300 N/mm'


def test_factors_over_misalignment_are_those_of_the_studies(study):
    studies = [gearsweep.run(CASE.changed(face={'misalignment_um': f})) for f in (30, 0)]
    ax = plots.compare_face_loads([study, *studies], Figure().subplots(), relief_um=15)
    columns = ('worst_face_load_factor', 'face_load_factor', 'root_face_load_factor', 'iso_face_load_factor')
    for line, column in zip(ax.lines, columns, strict=True):
        np.testing.assert_array_equal(line.get_xdata(), [0, 30, 40])
        np.testing.assert_array_equal(line.get_ydata(), [one.face_load_summary[column][1] for one in (*studies[::-1], study)])
    assert plots.compare_face_loads(study, Figure().subplots()).has_data()


def test_factors_over_a_list_of_misalignments_are_those_of_its_table():
    """In the order of the misalignments, a panel for each relief; the page of all pictures has it."""
    study = gearsweep.run(CASE.changed(face_load={'misalignment_um': [30, -20, 0]}))
    table = study.face_misalignments
    panels = next(figure for name, figure in plots.figures(study) if name == 'face_misalignments').axes
    assert len(panels) == 2
    for ax, relief in zip(panels, (0, 15), strict=True):
        rows = [table.at(relief_um=relief, misalignment_um=one) for one in (-20, 0, 30)]
        for line, column in zip(ax.lines, ('worst_face_load_factor', 'face_load_factor', 'root_face_load_factor', 'iso_face_load_factor'), strict=True):
            np.testing.assert_array_equal(line.get_data(), [[-20, 0, 30], [row[column] for row in rows]])
        assert ax.get_xlabel() == 'Misalignment (µm)'


@pytest.mark.parametrize('picture', ['face_load', 'contact_pattern'])
def test_panels_of_several_reliefs_have_one_scale(picture, study):
    figure = next(figure for name, figure in plots.figures(study) if name == picture)
    panels = [ax for ax in figure.axes if ax.get_xlabel().startswith('Place z')]
    assert len(panels) == len(set(study.face_load.relief_um)) > 1
    assert len({ax.get_ylim() for ax in panels}) == 1


def test_both_pictures_are_drawn_of_a_study_as_files(study, tmp_path):
    names = [name for name, _ in plots.figures(study)]
    assert names == ['contact_pattern', 'face_load']
    figure = next(figure for name, figure in plots.figures(study, 'contact_pattern'))
    meshes = [ax.collections[0] for ax in figure.axes if ax.get_ylabel() == 'Diameter of the pinion (mm)']
    assert len(meshes) == 2 and len({mesh.norm.vmax for mesh in meshes}) == 1  # one scale
    assert matplotlib.rcParams['font.size'] == matplotlib.rcParamsDefault['font.size']
    assert len(plots.draw_all(study, tmp_path, formats=['svg'])) == 2
