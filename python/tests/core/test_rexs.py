"""Cases from REXS files: a public example (its source is in the file), and changes of it. Expected values are in the file, or follow
from it in closed form.
"""

import math
from pathlib import Path

import pytest

import gearsweep
from gearsweep import Error, read_rexs

EXAMPLE = Path(__file__).parent / 'rexs' / 'two_stages.rexs'
SWEEP = {'case': {'tasks': 'sweep'}, 'sweep': {'rpm_first': 1000, 'rpm_last': 3000, 'rpm_step': 1000}}


def values(case):
    return {(group, key): value for group, keys in case.values.items() for key, value in keys.items()}


@pytest.fixture
def changed(tmp_path):
    """A file with other words in it."""

    def write(*changes, name='changed.rexs'):
        text = EXAMPLE.read_text()
        for old, new in changes:
            assert old in text, old
            text = text.replace(old, new)
        path = tmp_path / name
        path.write_text(text)
        return path

    return write


def attribute(name, value):
    return f'<attribute id="{name}" unit="">{value}</attribute>'


def test_geometry_is_that_of_the_file():
    case = read_rexs(EXAMPLE, stage='19')
    found = values(case)
    expected = {('pair', 'module_mm'): 4.5, ('pair', 'face_width_mm'): 50, ('pair', 'pressure_angle_deg'): 20, ('pair', 'helix_angle_deg'): 21,
                ('pair', 'centre_distance_mm'): 190, ('pinion', 'teeth'): 27, ('gear', 'teeth'): 51, ('pinion', 'profile_shift'): 0.231415,
                ('gear', 'profile_shift'): 0.231415, ('case', 'tasks'): 'geometry'}  # fmt: skip
    assert {place: found[place] for place in expected} == expected
    assert case.text.startswith('! Stage 19 of two_stages.rexs\n') and not case.unused


def test_shifts_and_centre_distance_of_the_file_agree():
    """The centre distance without backlash by the involute function (ISO 21771), which the file prints to a micrometre."""
    study = gearsweep.run(read_rexs(EXAMPLE, stage='19'))
    normal, helix = math.radians(20), math.radians(21)
    transverse = math.atan(math.tan(normal) / math.cos(helix))
    wanted = math.tan(transverse) - transverse + 2 * (2 * 0.231415) / (27 + 51) * math.tan(normal)
    working = transverse
    for _ in range(50):
        working -= (math.tan(working) - working - wanted) / math.tan(working) ** 2
    assert 4.5 / math.cos(helix) * (27 + 51) / 2 * math.cos(transverse) / math.cos(working) == pytest.approx(190, abs=1e-5)
    assert math.degrees(working) == pytest.approx(float(study.geometry.working_angle_deg), abs=1e-4)


@pytest.mark.parametrize('load_case, torque, rpm', [('1', 567, 543), ('2', 345, 3456), ('3', 456, 1234), ('4', 789, 789)])
def test_a_load_case_gives_torque_and_speed(load_case, torque, rpm):
    found = values(read_rexs(EXAMPLE, '19', load_case, case={'tasks': 'rating'}))
    assert (found['load', 'torque_nm'], found['rating', 'rpm']) == (torque, rpm)
    assert [found[gear, key] for gear in ('pinion', 'gear') for key in ('young_gpa', 'poisson', 'density_kgm3')] == [210, 0.3, 7850] * 2


def test_it_runs_with_what_the_file_lacks():
    study = gearsweep.run(read_rexs(EXAMPLE, '19', '1', **SWEEP, section={'elements_across': 4}))
    assert study.is_complete and study.sweep.rpm.tolist() == [1000, 2000, 3000]


def test_the_hand_is_that_of_the_first_gear():
    assert read_rexs(EXAMPLE, '19').get('pair', 'pinion_hand') == 'right'
    assert read_rexs(EXAMPLE, '20', pinion={'tip_diameter_mm': None}).get('pair', 'pinion_hand') == 'left'


def test_a_number_that_no_gear_can_have_is_refused_by_its_key():
    """The file has a tip diameter of 1 mm."""
    with pytest.raises(Error, match='&pinion tip_diameter_mm = 1'):
        gearsweep.run(read_rexs(EXAMPLE, '20'))


@pytest.mark.parametrize('words, said', [
    ({}, 'has 2 stages: state one as stage=; there are 19 .*, 20'),
    ({'stage': '15'}, 'has no stage 15; there are 19'),
    ({'stage': '19', 'load_case': '5', 'case': {'tasks': 'rating'}}, 'has no load case 5; there are 1, 2, 3, 4'),
    ({'stage': '19', 'case': {'tasks': 'rating'}}, 'has 4 load cases: state one as load_case=; there are 1, 2, 3, 4'),
    ({'stage': '20', 'load_case': '1', 'case': {'tasks': 'rating'}}, r"stage 20 has no torque: state it as load=\{'torque_nm': ...\}"),
])  # fmt: skip
def test_what_is_not_said_is_asked_for(words, said):
    with pytest.raises(Error, match=said):
        read_rexs(EXAMPLE, **words)


LACKING = {
    'number_of_teeth': ('pinion', 'teeth', 27), 'normal_module': ('pair', 'module_mm', 4.5), 'face_width': ('pair', 'face_width_mm', 50),
    'normal_pressure_angle': ('pair', 'pressure_angle_deg', 20), 'addendum_modification_coefficient': ('pinion', 'profile_shift', 0.2),
}  # fmt: skip


@pytest.mark.parametrize('name', LACKING)
def test_what_the_file_lacks_is_asked_for_by_its_key(name, changed):
    path = changed((f'<attribute id="{name}"', '<attribute id="custom"'))
    group, key, value = LACKING[name]
    with pytest.raises(Error, match=rf"has no {name}: state it as {group}=\{{'{key}': ...\}}"):
        read_rexs(path, '19')
    given = {group: {key: value}, **({'gear': {key: value}} if group == 'pinion' else {})}
    assert read_rexs(path, '19', **given).get(group, key) == value


@pytest.mark.parametrize('changes, said', [
    ([('>4.5<', '>4,5<')], 'cylindrical_gear 15: normal_module = 4,5: must be a number'),
    ([('>-21<', '>21<')], 'helix_angle_reference_diameter must be opposite, not 21 and 21'),
    ([('id="17" name="Cylindrical gear [28]" type="cylindrical_gear"', 'id="17" name="ring" type="ring_gear"')], 'must have external gears, two of cylindrical_gear'),
    ([('role="gear_2"', 'role="gear_3"')], 'must have external gears, two of cylindrical_gear'),
    ([('<model', '<models'), ('</model>', '</models>')], 'begins with models'),
    ([('</model>', '')], 'is not XML'),
    ([('type="cylindrical_stage"', 'type="bevel_stage"')], 'has no stage 19$'),
    ([('<', '{')], 'not .rexsj and .rexsz'),
])  # fmt: skip
def test_a_file_that_is_not_right_is_refused(changes, said, changed):
    with pytest.raises(Error, match=said):
        read_rexs(changed(*changes), '19')


def test_what_no_case_can_have_is_refused_before_the_file_is_read(tmp_path):
    with pytest.raises(TypeError, match='pair: must be a dictionary of keys, not int'):
        read_rexs(tmp_path / 'none.rexs', pair=3)
    with pytest.raises(Error, match='&pair modul: unknown key'):
        read_rexs(tmp_path / 'none.rexs', pair={'modul': 3})


def test_a_file_without_a_stage_says_so(changed):
    with pytest.raises(Error, match=r'changed\.rexs: has no stage$'):
        read_rexs(changed(('type="cylindrical_stage"', 'type="bevel_stage"')))


def test_flanks_of_two_pressure_angles_are_refused(changed):
    first = '(left flank)" type="cylindrical_gear_flank">\n      ' + attribute('normal_pressure_angle', 20).replace('unit=""', 'unit="deg"')
    with pytest.raises(Error, match=r'normal_pressure_angle must be the same, not 20 of .*, 25 of'):
        read_rexs(changed((first, first.replace('>20<', '>25<'))), '19')


def test_a_tool_gives_the_rack_and_modifications_are_named(changed):
    added = ('<component id="70" type="rack_shaped_tool">' + attribute('addendum_coefficient_reference_profile', 1.4)
             + attribute('tip_radius_factor', 0.39) + '</component><component id="71" type="tip_relief"/></components>')  # fmt: skip
    related = ('<relation id="70" type="manufacturing_step"><ref id="48" role="workpiece"/><ref id="70" role="tool"/></relation>'
               '<relation id="71" type="reference"><ref id="48" role="origin"/><ref id="71" role="referenced"/></relation></relations>')  # fmt: skip
    case = read_rexs(changed(('</components>', added), ('</relations>', related)), '19')
    assert [case.get('pinion', key) for key in ('dedendum', 'rack_tip_radius')] == [1.4, 0.39]
    assert [case.get('gear', key) for key in ('dedendum', 'rack_tip_radius')] == [1.25, 0.25]
    assert case.text.startswith('! Stage 19 of changed.rexs; not read: tip_relief\n')


def test_the_torque_of_the_gear_serves_through_the_ratio(changed):
    path = changed(('torque_around_u_axis', 'custom'),
                   ('name="Cylindrical stage [24] data Cylindrical gear [28]" type="cylindrical_stage_gear_data" />',
                    'type="cylindrical_stage_gear_data">' + attribute('torque', -102) + '</component>'))  # fmt: skip
    assert read_rexs(path, '19', '1', **SWEEP).get('load', 'torque_nm') == pytest.approx(102 * 27 / 51)


def test_the_torque_of_a_shaft_is_not_that_of_each_of_several_stages(changed):
    related = '<relation id="70" type="stage"><ref id="19" role="other"/><ref id="15" role="gear_1"/></relation></relations>'
    with pytest.raises(Error, match='stage 19 has no torque'):
        read_rexs(changed(('</relations>', related)), '19', '1', **SWEEP)
