"""What a case that leaves damping, body and backlash open runs with, and that the screen says so.

A default is right if the case that states it by its keys gives the same bits.
"""

import numpy as np
import pytest

import gearsweep

TEXT = """&case tasks = 'sweep' / &pair module_mm = 2.5 face_width_mm = 28 {pair} / &pinion teeth = 23 profile_shift = 0.3 {pinion} /
&gear teeth = 57 profile_shift = -0.1 {gear} / &load torque_nm = 180 / {more}
&sweep rpm_first = 6000 rpm_last = 9000 rpm_step = 1500 /"""


def run(pair='', pinion='', gear='', more=''):
    return gearsweep.run(gearsweep.Case(TEXT.format(pair=pair, pinion=pinion, gear=gear, more=more)))


def same(one, other):
    return all(np.array_equal(one.sweep[name], other.sweep[name], equal_nan=True) for name in ('dynamic_factor', 'dte_rms_um')) and (
        one.motion.mean_mesh_stiffness_n_um == other.motion.mean_mesh_stiffness_n_um
    )


@pytest.fixture(scope='module')
def usual():
    return run()


WHOLE = "&section teeth = 0 fixed = 'rim' /"
DAMPING = '&dynamics damping_ratio = 0.1 /'


def test_the_default_is_the_whole_gear_at_a_damping_ratio_of_a_tenth(usual):
    assert same(usual, run(more=WHOLE + DAMPING))
    assert not same(usual, run(more='&dynamics damping_ratio = 0.17 /'))
    assert not same(usual, run(more="&section teeth = 3 fixed = 'sides', 'rim' /"))


def test_the_assumed_bore_is_a_third_of_the_reference_diameter(usual):
    # The mass of the solid disc, which a stated bore would lessen, is that of the gear with its shaft.
    masses = {'pinion': f'effective_mass_kg = {usual.motion.pinion_mass_kg!r}', 'gear': f'effective_mass_kg = {usual.motion.gear_mass_kg!r}'}
    bored = run(pinion=f'bore_mm = {2.5 * 23 / 3!r} {masses["pinion"]}', gear=f'bore_mm = {2.5 * 57 / 3!r} {masses["gear"]}')
    assert bored.motion.mean_mesh_stiffness_n_um == pytest.approx(usual.motion.mean_mesh_stiffness_n_um, rel=1e-9)
    assert bored.sweep.dynamic_factor == pytest.approx(usual.sweep.dynamic_factor, rel=1e-7)


def test_the_tasks_of_a_section_keep_three_held_teeth():
    text = """&case tasks = 'static' / &pair module_mm = 3 face_width_mm = 20 / &pinion teeth = 21 / &gear teeth = 34 /
    &load torque_nm = 100 / """
    usual = gearsweep.run(gearsweep.Case(text + WHOLE.replace("teeth = 0 fixed = 'rim'", 'elements_across = 8')))
    held = gearsweep.run(gearsweep.Case(text + "&section teeth = 3 fixed = 'sides', 'rim' elements_across = 8 /"))
    # The root stress differs by the load sharing alone, which the pair stiffness decides.
    assert usual.root_stress.tension_mpa == pytest.approx(held.root_stress.tension_mpa, rel=2e-2)
    assert usual.motion.mean_mesh_stiffness_n_um < 0.9 * held.motion.mean_mesh_stiffness_n_um


def decisive(study):
    lines = study.report().splitlines()
    at = next(i for i, line in enumerate(lines) if line.startswith('Decisive inputs'))
    return ' '.join([lines[at]] + [line for line in lines[at + 1 : at + 2] if line.startswith(' ')]).split()


def words(study):
    return ' '.join(decisive(study)[2:])


def test_the_screen_marks_what_was_assumed(usual):
    assert words(usual) == (
        'damping ratio 0.1 (assumed); whole gears held at bores of 19.17 and 47.5 mm (assumed) '
        'the coast flanks never touch (assumed: no backlash_um and no thickness allowance)'
    )
    stated = run(pair='backlash_um = 60', pinion='bore_mm = 20', gear='bore_mm = 45', more=WHOLE + DAMPING)
    assert words(stated) == 'damping ratio 0.1; whole gears held at bores of 20 and 45 mm backlash 60 um'
    one = run(pinion='bore_mm = 20', more=WHOLE)
    assert 'held at bores of 20 and 47.5 mm (assumed)' in words(one)
    sides = run(more="&section teeth = 5 fixed = 'sides' rim_mm = 5 /")
    assert 'bodies of 5 teeth, held at the sides the' in words(sides)
    thin = run(pinion='thickness_allowance_um = -60')
    backlash = thin.geometry.backlash_um
    assert f'backlash {backlash:.4g} um, as the thickness allowances leave' in words(thin)
    assert ', nominally without backlash' in usual.report() and 'backlash 0 um' not in usual.report()


def test_the_resonance_of_the_standard_stands_beside(usual):
    # n_E1 = 30000/(pi z_1) sqrt(c_gamma/m_red), ISO 6336-1:2006, 6.5.3; c_gamma from the model iso6336, m_red in kg/mm of width.
    iso = run(more="&mesh model = 'iso6336' /")
    reduced = 1 / (1 / usual.motion.pinion_mass_kg + 1 / usual.motion.gear_mass_kg) / 28
    by_hand = 30000 / (np.pi * 23) * np.sqrt(iso.motion.mean_mesh_stiffness_n_um_mm / reduced)
    assert usual.motion.iso_resonance_rpm == pytest.approx(by_hand, rel=1e-6)
    assert f'n_E1 {by_hand:.5g} rpm' in usual.report()
    assert 'iso_resonance_rpm' not in iso.motion
