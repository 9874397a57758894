"""Tip relief from deflection: against the formula by hand, the closed form of a mesh of constant stiffness, and printed numbers."""

import math

import numpy as np
import pytest
from conftest import ROOT
from matplotlib.figure import Figure

import gearsweep
from gearsweep import plots

# Unlike gears, each with a profile shift and a material of its own.
TEETH, SHIFT, MODULE, WIDTH, LOAD = (21, 34), (0.2, -0.1), 3.0, 20.0, 4000.0
YOUNG, POISSON = (206e9, 110e9), (0.3, 0.26)
STIFFNESS = 400e6
CASE = f"""
&case tasks = 'deflection_relief' / &pair module_mm = {MODULE} face_width_mm = {WIDTH} /
&pinion teeth = {TEETH[0]} profile_shift = {SHIFT[0]} effective_mass_kg = 0.6 young_gpa = {YOUNG[0] / 1e9} poisson = {POISSON[0]} /
&gear teeth = {TEETH[1]} profile_shift = {SHIFT[1]} effective_mass_kg = 1.1 young_gpa = {YOUNG[1] / 1e9} poisson = {POISSON[1]} /
&load normal_force_n = {LOAD} / &mesh model = 'polynomial' coefficients = {STIFFNESS / 1e6} /
&dynamics damping_ratio = 0.05 / &sweep rpm_first = 4000 rpm_last = 20000 rpm_step = 500 /
"""


def involute(angle):
    return math.tan(angle) - angle


def geometry():
    """Base, tip and root radii, base pitch, and both radii of curvature at A and at E (mm): ISO 21771."""
    alpha = math.radians(20)
    reference = np.array(TEETH) * MODULE / 2
    base, shift = reference * math.cos(alpha), np.array(SHIFT)
    tip, root = reference + MODULE * (1 + shift), reference - MODULE * (1.25 - shift)
    wanted = involute(alpha) + 2 * sum(SHIFT) / sum(TEETH) * math.tan(alpha)
    working = alpha
    for _ in range(50):
        working -= (involute(working) - wanted) / math.tan(working) ** 2
    line = base.sum() * math.tan(working)
    reach = np.sqrt(tip**2 - base**2)
    return base, tip, root, MODULE * math.pi * math.cos(alpha), (line - reach[1], reach[1]), (reach[0], line - reach[0])


def by_hand(gear, point):
    """Bending and flattening of a tooth (um) by the formula, loaded at its tip or at its outer point of single contact."""
    base, _, root, pitch, at_a, at_e = geometry()
    curvature = np.array(at_e if gear == 0 else at_a)
    if point == 'hpstc':
        # One base pitch in from where its tip is a pair's last contact there is but one.
        curvature = np.add(at_a, (pitch, -pitch)) if gear == 0 else np.add(at_e, (-pitch, pitch))
    modulus = 1 / sum((1 - nu**2) / e for e, nu in zip(YOUNG, POISSON))
    line_load = LOAD / (WIDTH * 1e-3)
    half_width = 1e3 * math.sqrt(4 * line_load * 1e-3 * curvature.prod() / curvature.sum() / (math.pi * modulus))
    yielding = 1e6 * line_load * (1 - POISSON[gear] ** 2) / YOUNG[gear]
    z, x = TEETH[gear], SHIFT[gear]
    radius = math.hypot(base[gear], curvature[gear])
    # Eqs. 8 to 13 as corrected.
    alpha = math.radians(20)
    alpha_b = math.atan(curvature[gear] / base[gear])
    phi = (math.pi + 4 * x * math.tan(alpha)) / (2 * z) + involute(alpha)
    height = radius * math.cos(alpha_b - (curvature[gear] / base[gear] - phi)) - root[gear]
    a = -1.05 + 153 * math.exp(-8.1 * x) * z ** -(1.75 - 1.6 * x)
    b, c, d = 0.63 + (7.35 - 0.924 * x) / z, 1.28 - (2.88 + 3.68 * x) / z, -1.06 + 0.638 * math.log(MODULE * z)
    bending = yielding * (a + b * math.exp(c * height / MODULE) + d)
    return bending, 2 / math.pi * yielding * (1.27 + 0.781 * math.log(MODULE / half_width))


@pytest.fixture(scope='module')
def study():
    return gearsweep.run(gearsweep.Case(CASE))


def row(study, method):
    return study.deflection_relief.at(method=method)


@pytest.mark.parametrize('point', ['tip', 'hpstc'])
def test_deflections_are_those_of_the_formula(point):
    study = gearsweep.run(gearsweep.Case(CASE).changed(deflection_relief={'point': point}))
    for gear in (0, 1):
        bending, flattening = by_hand(gear, point)
        assert study.relief_deflection.bending_um[gear] == pytest.approx(bending, rel=1e-9)
        assert study.relief_deflection.flattening_um[gear] == pytest.approx(flattening, rel=1e-9)
        name = ('pinion_relief_um', 'gear_relief_um')[gear]
        assert row(study, 'markovic_vrcan')[name] == pytest.approx(bending + flattening / 2, rel=1e-9)
        assert row(study, 'whole_flattening')[name] == pytest.approx(bending + flattening, rel=1e-9)


def test_a_constant_stiffness_has_a_relief_without_transmission_error(study):
    """Two pairs with linear relief C from B and D on yield x = (F/K + C)/2, one pair F/K: with C = F/K the gears run as rigid
    ones do, and DF is 1. Without relief x jumps between F/2K and F/K."""
    deflection = 1e6 * LOAD / STIFFNESS
    assert row(study, 'none')['ste_range_um'] == pytest.approx(deflection / 2, rel=1e-9)
    for method in ('transmission_error', 'dynamic_factor'):
        found = row(study, method)
        assert 0 < found['within_um'] < 0.03
        assert found['pinion_relief_um'] == found['gear_relief_um'] == pytest.approx(deflection, abs=found['within_um'])
    assert row(study, 'transmission_error')['ste_range_um'] <= row(study, 'transmission_error')['within_um'] / 2 + 1e-9
    assert row(study, 'dynamic_factor')['worst_dynamic_factor'] == pytest.approx(1, abs=2e-3)
    curve = study.relief_curve
    below = curve.relief_um < deflection
    assert curve.ste_range_um[below] == pytest.approx((deflection - curve.relief_um[below]) / 2, abs=1e-9)


def test_what_a_method_does_is_what_mesh_and_sweep_say(study):
    for method in ('markovic_vrcan', 'whole_flattening'):
        found = row(study, method)
        pinion, gear = found['pinion_relief_um'], found['gear_relief_um']
        elastic = {'young_gpa': None, 'poisson': None}
        case = study.case.changed(case={'tasks': ['mesh', 'sweep']}, relief={'amount_um': pinion, 'gear_fraction': gear / pinion},
                                  pinion=elastic, gear=elastic)  # fmt: skip
        other = gearsweep.run(case)
        assert found['ste_range_um'] == pytest.approx(np.ptp(other.mesh.ste_um), rel=2e-3)
        assert found['worst_dynamic_factor'] == pytest.approx(np.nanmax(other.sweep.dynamic_factor), abs=1e-5)


def test_the_flank_has_its_relief_over_the_roll_angle():
    base, _, _, pitch, at_a, at_e = geometry()
    for shape, power in (('linear', 1), ('parabolic', 2)):
        study = gearsweep.run(gearsweep.Case(CASE).changed(relief={'amount_um': 0, 'shape': shape}))
        flank = study.relief_flank
        for gear, name in enumerate(('pinion', 'gear')):
            here = (flank.method == 'markovic_vrcan') & (flank.gear == name)
            first = (at_a[0], at_e[1])[gear] + pitch
            roll = np.degrees(np.linspace(first, (at_e[0], at_a[1])[gear], 10) / base[gear])
            assert flank.roll_deg[here] == pytest.approx(roll, rel=1e-9)
            assert flank.diameter_mm[here] == pytest.approx(2 * np.hypot(base[gear], base[gear] * np.radians(roll)), rel=1e-9)
            whole = row(study, 'markovic_vrcan')[f'{name}_relief_um']
            assert flank.relief_um[here] == pytest.approx(whole * np.linspace(0, 1, 10) ** power, abs=1e-9)


def test_the_paper_s_flank_table_is_linear_in_the_diameter():
    """Thamba et al. 2020, Table 4, in parts of its relief at the tip."""
    case = gearsweep.Case.read(ROOT / 'data/deflection_relief.nml').changed(
        relief={'amount_um': 0, 'start': 'pitch'}, mesh={'model': 'weber'}, section=dict.fromkeys(('teeth', 'rim_mm', 'fixed', 'plane')),
        sweep={'rpm_first': 6000})  # fmt: skip
    case = case.changed(mesh=dict.fromkeys(('tooth_coupling', 'corner_contact', 'nonlinear_contact')))
    study = gearsweep.run(case)
    printed = np.array([0, 0.0900, 0.2143, 0.3417, 0.4724, 0.6061, 0.7430, 0.8829, 1.0258, 1.1159])
    flank = study.relief_flank
    for gear in ('pinion', 'gear'):
        here = (flank.method == 'markovic_vrcan') & (flank.gear == gear)
        ours = flank.relief_by_diameter_um[here] / row(study, 'markovic_vrcan')[f'{gear}_relief_um']
        assert printed[-1] * ours == pytest.approx(printed, abs=1e-4)
    # What the independent prototype has for the corrected formulas, and no more than a hundredth of what is printed.
    assert row(study, 'markovic_vrcan')['pinion_relief_um'] == pytest.approx(8.40, abs=0.005)
    assert row(study, 'whole_flattening')['gear_relief_um'] == pytest.approx(9.09, abs=0.005)


def test_a_gear_without_relief_stays_without(study):
    alone = gearsweep.run(study.case.changed(relief={'amount_um': 0, 'gear_fraction': 0}))
    assert (alone.deflection_relief.gear_relief_um == 0).all()
    assert (alone.deflection_relief.pinion_relief_um[1:3] > 0).all()


@pytest.mark.parametrize('gear, diameter', [('pinion', 40), ('pinion', 80), ('gear', 90)])
def test_diameters_lie_on_the_involute(gear, diameter):
    case = gearsweep.Case(CASE).changed(deflection_relief={f'{gear}_diameter_mm': diameter})
    with pytest.raises(gearsweep.Error, match=f'{gear}_diameter_mm = {diameter}: must lie on the involute, from'):
        gearsweep.run(case)


def test_pictures_hold_each_method(study):
    table = study.deflection_relief
    for quantity in ('ste_range_um', 'worst_dynamic_factor'):
        ax = plots.plot_deflection_relief(study, Figure().subplots(), quantity=quantity)
        marks = [line.get_data() for line in ax.lines[1:]]
        assert np.ravel(marks).tolist() == np.column_stack([table.pinion_relief_um, table[quantity]]).ravel().tolist()
    for gear in ('pinion', 'gear'):
        ax = plots.plot_relief_flank(study, Figure().subplots(), gear=gear)
        for line, method in zip(ax.lines, table.method[1:], strict=True):
            assert line.get_ydata()[-1] == pytest.approx(row(study, method)[f'{gear}_relief_um'])
    with pytest.raises(ValueError, match='quantity'):
        plots.plot_deflection_relief(study, quantity='stiffness')
    with pytest.raises(ValueError, match='gear'):
        plots.plot_relief_flank(study, gear='wheel')
