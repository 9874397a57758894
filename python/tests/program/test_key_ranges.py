"""The ranges that help and messages state are those that the library keeps: the bounds belong to them where the text says
so, a value outside is refused by name."""

import re

import pytest

import gearsweep
from gearsweep.core import library

DECLARED = library.declared()
# Keys that a group cannot do without.
GROUPS = {group['name']: {} for group in DECLARED['groups']} | {
    'case': {'tasks': ', '.join(f"'{task['name']}'" for task in DECLARED['tasks'])},
    'pair': {'module_mm': 3, 'face_width_mm': 20},
    'pinion': {'teeth': 21, 'effective_mass_kg': 0.5, 'bore_mm': 20},
    'gear': {'teeth': 34, 'effective_mass_kg': 0.9},
    'load': {'normal_force_n': 4000},
    'relief': {'amount_um': 0},
    'mesh': {'model': "'fe'"},
    'section': {'elements_across': 3},
    'sweep': {'rpm_first': 3000, 'rpm_last': 9000, 'rpm_step': 3000, 'load_rpm': 3000},
    'branches': {'first': 3000, 'last': 4000},
    'sensitivity': {'rpm': 3000},
    'flank': {'rpm': 3000},
    'rating': {'rpm': 3000},
    'transient': {'rpm': 3000, 'modes': 5},
    'harmonic': {'frequency_hz': '0, 1e5', 'modes': 5},
    'life': {'rpm': 3000, 'duration_h': 1, 'tensile_strength_mpa': 900, 'curve_cycles': '1e3, 1e6', 'curve_stress_mpa': '500, 86'},
}
PRESCRIBED = {
    'case': {'tasks': "'sweep'"},
    'pair': {},
    'pinion': {'teeth': 21, 'effective_mass_kg': 0.5},
    'gear': {'effective_mass_kg': 0.9},
    'load': {'normal_force_n': 4000},
    'relief': {'amount_um': 0},
    'mesh': {'model': "'polynomial'", 'coefficients': 400, 'contact_ratio': 1.6},
    'sweep': {'rpm_first': 3000, 'rpm_last': 9000, 'rpm_step': 3000},
}
# What a key needs beside it: removed keys are None.
BESIDE = {
    'torque_nm': {'load': {'normal_force_n': None}},
    # The narrowest face belongs to the smallest module.
    'face_width_mm': {'pair': {'module_mm': 0.05}},
    'line_load_n_mm': {'load': {'normal_force_n': None}},
    'length_mm': {'relief': {'start': "'length'", 'amount_um': 5}},
    'pinion_roll_deg': {'relief': {'start': "'roll'", 'amount_um': 5, 'gear_roll_deg': 20}},
    'gear_roll_deg': {'relief': {'start': "'roll'", 'amount_um': 5, 'pinion_roll_deg': 20}},
    'jump_at': {'transient': {'spacing': "'flank'"}},
    'passage_periods': {'transient': {'spacing': "'flank'"}},
    'inertia_kgm2': {'pinion': {'effective_mass_kg': None}},
    'density_kgm3': {'pinion': {'effective_mass_kg': None}},
    'base_pitch_mm': {'load': {'normal_force_n': None, 'torque_nm': 100}},
    'pitch_point': {'relief': {'start': "'pitch'"}},
    'ste_harmonics': {'case': {'tasks': "'mesh'"}},
    'motion_harmonics': {'case': {'tasks': "'load'"}},
    # It thins the tooth, and so is at most the profile shift.
    'generating_shift': {'pinion': {'profile_shift': 4.9999999}},
    'first': {'branches': {'parameter': "'damping_ratio'", 'rpm': 3000, 'last': 1e9}},
    'last': {'branches': {'parameter': "'damping_ratio'", 'rpm': 3000, 'first': 0}},
    'torque_shares': {'case': {'tasks': "'optimum'"}, 'load': {'normal_force_n': None, 'torques_nm': 100}, 'optimum': {'over_torques': "'weighted'"}},
    'pinion_coast_pitch_um': {'pair': {'backlash_um': 50}},
    'gear_coast_pitch_um': {'pair': {'backlash_um': 50}},
    'life_h': {'rating': {'material': "'C45'"}},
    'long_life_factor': {'rating': {'material': "'C45'", 'life_h': 8000}},
    'yield_strength_mpa': {'life': {'mean_stress': "'soderberg'", 'tensile_strength_mpa': None}},
    'start_um': {'poincare': {'start_mm_s': 0}},
    'start_mm_s': {'poincare': {'start_um': 0}},
}
PRESCRIBED_KEYS = ('contact_ratio', 'base_pitch_mm', 'pitch_point', 'coefficients', 'shared_compliance_um_n', 'amount_um')
NUMBER = r'(-?[\d.]+(?:e-?\d+)?)'


def ranges():
    """(group, key, bound, belongs, side, is whole), from what the library says is allowed; the gears have the same keys."""
    for declared in DECLARED['keys']:
        group, key, allowed = (declared[name] for name in ('group', 'name', 'allowed'))
        if group == 'gear' or declared['words']:
            continue
        whole = declared['kind'] == 'integer'
        if found := re.search(rf'(?<![\w.-]){NUMBER} to {NUMBER}', allowed):
            yield group, key, float(found[1]), True, -1, whole
            yield group, key, float(found[2]), True, 1, whole
            continue
        for words, side, belongs in (('at least', -1, True), ('above', -1, False), ('at most', 1, True), ('below', 1, False)):
            if found := re.search(rf'\b{words} {NUMBER}', allowed):
                yield group, key, float(found[1]), belongs, side, whole


def case_with(group, key, value):
    groups = PRESCRIBED if key in PRESCRIBED_KEYS else GROUPS
    groups = {name: dict(keys) for name, keys in groups.items()}
    for name, keys in BESIDE.get(key, {}).items():
        groups.setdefault(name, {}).update(keys)
    said = f'{value:.15g}' if isinstance(value, float) else str(value)
    # A list of at least two, or four.
    groups.setdefault(group, {})[key] = said + ', 0.5' * (3 if group == 'transient' else 1) if key == 'shares' else said
    return '\n'.join(
        f'&{name} ' + ' '.join(f'{key} = {value}' for key, value in keys.items() if value is not None) + ' /'
        for name, keys in groups.items() if any(value is not None for value in keys.values())
    )  # fmt: skip


def refusal(text):
    try:
        gearsweep.Case(text).complete()
    except gearsweep.Error as error:
        return str(error)
    return ''


FOUND = list(ranges())


def test_many_ranges_are_reported():
    assert len(FOUND) > 60
    assert {'teeth', 'module_mm', 'damping_ratio', 'young_gpa', 'tolerance', 'torque_nm'} <= {key for _, key, *_ in FOUND}


@pytest.mark.parametrize(('group', 'key', 'bound', 'belongs', 'side', 'whole'), FOUND)
def test_a_bound_is_where_it_is_reported(group, key, bound, belongs, side, whole):
    little = 1 if whole else max(abs(bound), 1e-6 if bound == 0 else 0) * 1e-6
    beyond, inside = bound + side * little, bound - side * little
    if belongs:
        inside = bound
    else:
        beyond = bound
    if whole:
        beyond, inside = int(beyond), int(inside)
    said = refusal(case_with(group, key, beyond))
    assert key in said and 'must be' in said, said or f'{beyond} is accepted'
    # Other reasons, such as what suits the rest of the case, may stand against a value in its range.
    said = refusal(case_with(group, key, inside))
    assert f'{key} = ' not in said or 'must be' not in said, said
