"""The case: values in effect, changes that leave the rest alone."""

import json
import re

import numpy as np
import pytest
from conftest import GEARED, PARTIAL, PRESCRIBED, ROOT

import gearsweep
from gearsweep import Case, Code, Error
from gearsweep.core import library
from gearsweep.core.case import formatted

CASES = [Case(GEARED), Case(PRESCRIBED), Case(PARTIAL)] + [
    Case.read(ROOT / 'data' / name) for name in ('case1.nml', 'case2.nml', 'hassan.nml')
]


def test_each_task_stands_in_a_case_of_data():
    page = (ROOT / 'doc/case.md').read_text()
    cases = {path.name: Case.read(path) for path in (ROOT / 'data').glob('*.nml')}
    named = {task for case in cases.values() for task in case.tasks}
    assert named == {task['name'] for task in json.loads(gearsweep.core.library.describe('tasks'))}
    assert [name for name in cases if f'`{name}`' not in page] == []


def test_values_given_and_default():
    case = Case(GEARED)
    assert case.get('pair', 'module_mm') == 3
    assert case.get('relief', 'amount_um') == (0, 10)
    assert case.get('mesh', 'model') == 'fe'
    assert case.get('pair', 'tip_alteration') is False
    # Defaults, as doc/case.md has them.
    assert case.get('dynamics', 'damping_ratio') == 0.1
    assert case.get('pair', 'coast_angle_deg') == 20
    assert case.get('numerics', 'tolerance') == 1e-6
    # None: no default, or nothing that this case could use.
    assert case.get('pair', 'backlash_um') is None
    assert case.get('pinion', 'inertia_kgm2') is None
    assert case.get('section', 'fixed') is None
    assert case.get('mesh', 'contact_ratio') is None
    assert Case(PRESCRIBED).get('section', 'teeth') is None
    assert Case(PRESCRIBED).get('section', 'teeth', 7) == 7
    assert case.get('Pair', 'MODULE_MM') == 3


@pytest.mark.parametrize('case', CASES, ids=range(len(CASES)))
def test_complete_case_is_complete(case):
    complete = case.complete()
    assert complete.complete().text == complete.text
    assert complete.values == case.values
    assert complete.folder == case.folder


def test_defaults_of_the_reference():
    """Every plain default that doc/case.md prints is the one in effect."""
    case = Case(GEARED).changed(pinion={'effective_mass_kg': None, 'bore_mm': 20}, mesh={'model': None})
    # Each with the keys that it cannot do without; a new task that has some wants a line here.
    needed = {task: {'rpm': 3000} for task in ('sensitivity', 'flank', 'rating', 'transient')}
    needed['rating'] |= {'material': 'C45', 'life_h': 1000}
    needed['harmonic'] = {'frequency_hz': [0, 1e5]}
    needed['life'] = {'rpm': 3000, 'duration_h': 1, 'tensile_strength_mpa': 900, 'curve_cycles': [1e3, 1e6], 'curve_stress_mpa': [500, 86]}
    needed['branches'] = {'first': 3000, 'last': 4000}
    needed['deviations'] = {'pinion_class': 6, 'gear_class': 6}
    case = case.changed(case={'tasks': [task['name'] for task in library.declared()['tasks']]}, **needed)
    keys = (ROOT / 'doc/case.md').read_text().split('## Keys')[1].split('## Finite elements')[0]
    found = 0
    for part in keys.split('\n### ')[1:]:
        heading, *lines = part.splitlines()
        group = heading.split()[0]
        rows = [[cell.strip(' `') for cell in line.strip('|').split('|')] for line in lines if line[:3] == '| `']
        for row in rows:
            row[0] = row[0].split('`')[0]
            default = row[1].replace('`', '') if len(row) == 3 else ''
            # A group that is there must have the one; several torques, which the tasks at hand refuse, the other.
            if row[0] in ('amount_um', 'over_torques'):
                continue
            if not re.fullmatch(r"\d[\d.e-]*|'[a-z0-9', ]+'|\.true\.|\.false\.", default):
                continue
            value = case.changed(**{group: {row[0]: None}}).get(group, row[0])
            assert formatted(value) == canonical(default), row
            found += 1
    assert found > 30


def canonical(default):
    """A default as doc/case.md prints it, in the form of `written`."""
    if default[0] in "'.":
        return default
    return formatted(int(float(default)) if float(default) == int(float(default)) else float(default))


def test_read_and_write(tmp_path):
    text = '! Zahnrad mit \u00dc und einem Byte \u00ff\r\n&pair module_mm = 3 /\n'
    Case(text.replace('\u00ff', '\udcff')).write(tmp_path / 'a.nml')  # written as it is, read as Latin-1
    case = Case.read(tmp_path / 'a.nml')
    assert case.text == text
    assert case.folder == str(tmp_path)
    assert case == Case(text, tmp_path) and hash(case) == hash(Case(text, tmp_path)) and case != Case(text)
    with pytest.raises(Error, match='No such file') as caught:
        Case.read(tmp_path / 'b.nml')
    assert caught.value.code == Code.FILE


def test_a_case_never_changes():
    case = Case(GEARED)
    with pytest.raises(AttributeError):
        case.text = ''
    case.changed(pair={'module_mm': 4})
    assert case.text == GEARED


@pytest.mark.parametrize(
    'text, group, key, value, expected',
    [
        ('&gear teeth = 1 /', 'gear', 'teeth', 2, '&gear teeth = 2 /'),
        ('&GEAR TEETH=1/', 'gear', 'teeth', 2, '&GEAR TEETH=2/'),
        ('&gear teeth = 1, 2, ! two\n 3 bore_mm = 4 /', 'gear', 'teeth', [5, 6], '&gear teeth = 5, 6 bore_mm = 4 /'),
        ("&gear teeth = 'x/y&z', bore_mm = 1 /", 'gear', 'teeth', "it's", "&gear teeth = 'it''s', bore_mm = 1 /"),
        ('&gear teeth = 3*1.5 bore_mm = 4 &end', 'gear', 'teeth', 0.1, '&gear teeth = 0.1 bore_mm = 4 &end'),
        ('&gear teeth = 1 /', 'gear', 'bore_mm', True, '&gear teeth = 1 bore_mm = .true. /'),
        ('&gear teeth = 1/', 'gear', 'bore_mm', True, '&gear teeth = 1 bore_mm = .true. /'),
        ('&gear\n  teeth = 1 ! one\n/\n', 'gear', 'bore_mm', 2, '&gear\n  teeth = 1 ! one\n  bore_mm = 2\n/\n'),
        ('&gear\n  teeth = \n/\n', 'gear', 'teeth', 2, '&gear\n  teeth = \n  teeth = 2\n/\n'),
        ('&gear teeth = 1 /', 'load', 'torque_nm', 2, '&gear teeth = 1 /\n&load torque_nm = 2 /\n'),
        ('', 'load', 'torque_nm', 2, '&load torque_nm = 2 /\n'),
        ('&gear teeth = 1, bore_mm = 2 /', 'gear', 'teeth', None, '&gear  bore_mm = 2 /'),
        ('&gear teeth = 1\n bore_mm = 2 /', 'gear', 'bore_mm', None, '&gear teeth = 1\n  /'),
        ('&gear teeth = 1 /', 'gear', 'bore_mm', None, '&gear teeth = 1 /'),
        ('&gear teeth = 1 / ! &gear teeth = 2', 'gear', 'teeth', 3, '&gear teeth = 3 / ! &gear teeth = 2'),
    ],
)
def test_changed(text, group, key, value, expected):
    assert Case(text).changed(**{group: {key: value}}).text == expected


@pytest.mark.parametrize(
    'group, key, text',
    [('a', 'b', '1 / &c d = 2'), ('a', 'b', '1 c = 2'), ('a', 'b', '1 ! x'), ('a b', 'c', '1'), ('a', 'b = 1 c', '2'),
     ('', 'b', '1'), ('a', '', '1'), ('a', 'b', "'"), ('a', 'b', '\n/\n&c'), ('a', 'b', '\x01'), ('a', 'b', '\0')],
)  # fmt: skip
def test_one_key_and_no_more(group, key, text):
    with pytest.raises(Error) as caught:
        library.edit('change', '&a b = 1 /', group, key, text)
    assert caught.value.code == Code.INPUT


def test_a_misspelt_key_is_an_error_at_once():
    case = Case(GEARED)
    uses = [
        case.get,
        lambda group, key: case.get(group, key, 7),
        lambda group, key: case.changed(**{group: {key: 1}}),
        lambda group, key: case.changed(**{group: {key: None}}),
        lambda group, key: Case.build(**{group: {key: 1}}),
    ]
    for use in uses:
        with pytest.raises(Error, match=r'^&pair modul_mm: unknown key \(did you mean module_mm\?\)') as caught:
            use('pair', 'modul_mm')
        assert caught.value.code == Code.INPUT
        with pytest.raises(Error, match=r'^&relef: unknown group \(did you mean &relief\?\)'):
            use('relef', 'amount_um')
        with pytest.raises(Error, match=r'^&gear module_mm: unknown key; it belongs to &pair'):
            use('gear', 'module_mm')
    # A text that has one is mended by taking it out.
    assert Case('&pair modul_mm = 3 /').changed(pair={'modul_mm': None}).text == '&pair  /'


def test_every_key_of_the_reference_is_known():
    keys = (ROOT / 'doc/case.md').read_text().split('## Keys')[1].split('## Finite elements')[0]
    found = 0
    for part in keys.split('\n### ')[1:]:
        heading, *lines = part.splitlines()
        groups = heading.split(' and ')
        table = next(number for number, line in enumerate(lines) if line.startswith('| key'))
        for line in lines[table + 2 :]:
            if not line.startswith('| `'):
                break
            for key in re.findall('`([a-z0-9_]+)`', line.split('|')[1]):
                for group in groups:
                    assert Case('').changed(**{group: {key: 1}}).text == f'&{group} {key} = 1 /\n'
                    found += 1
    assert found > 60


def test_build():
    case = Case.build(
        case={'title': "it's \u00fc", 'tasks': ['mesh']},
        pair={'module_mm': np.float64(0.1) + 0.2, 'face_width_mm': np.int64(20), 'tip_alteration': np.True_},
        pinion={'teeth': 21, 'profile_shift': None},
        gear={'teeth': 34},
        load={'torque_nm': 100},
        relief={'amount_um': np.linspace(1, 2, 200)},
    )
    assert case.get('case', 'title') == "it's \u00fc"
    assert case.get('pair', 'module_mm') == 0.1 + 0.2  # to the last bit
    assert case.get('pair', 'tip_alteration') is True
    assert case.get('relief', 'amount_um') == tuple(np.linspace(1, 2, 200))
    assert 'profile_shift' not in case.text
    assert case.tasks == ('mesh',)


def test_keys_for_other_tasks():
    """They change nothing, are named, and count again where their task is asked for."""
    case = Case(GEARED)
    assert case.unused == []
    rest = case.changed(case={'tasks': ['geometry', 'modal']})
    assert 'static: &static positions' in rest.unused and 'load: &sweep load_rpm' in rest.unused
    one, other = (gearsweep.run(of, ('geometry', 'static')) for of in (rest, case))
    assert one.geometry.contact_ratio == other.geometry.contact_ratio and one.static.rows == other.static.rows
    # Without a value that is given, they have none in effect.
    assert rest.get('static', 'positions') == 5 and rest.get('static', 'spacing') is None
    assert 'spacing' not in rest.complete().text
    assert rest.complete().unused == rest.unused
    # They are checked all the same.
    with pytest.raises(Error, match='&static positions = 1: must be at least 2'):
        gearsweep.run(rest.changed(static={'positions': 1}), 'geometry')


@pytest.mark.parametrize('value', [object(), {'a': 1}, b'x', 1j, [object()]])
def test_no_value_of_a_case(value):
    with pytest.raises(TypeError, match='a case has no values such as'):
        Case('').changed(pair={'module_mm': value})


@pytest.mark.parametrize('value', [float('nan'), float('inf')])
def test_what_the_library_refuses(value):
    with pytest.raises(Error, match='module_mm') as caught:
        Case(GEARED).changed(pair={'module_mm': value}).complete()
    assert caught.value.code == Code.INPUT


def test_text_must_be_text():
    with pytest.raises(TypeError):
        Case(b'&pair /')
    with pytest.raises(Error, match='NUL'):
        Case('&pair \0 /').complete()
    with pytest.raises(Error, match='surrogates'):
        Case('&pair \ud800 /').complete()


def test_allowed_words_are_described_as_a_case_has_them():
    """Names with capitals, digits and hyphens too, such as 18CrNiMo7-6: each is accepted."""
    words = next(key['words'] for key in library.declared()['keys'] if (key['group'], key['name']) == ('rating', 'material'))
    assert {'case_hardened', 'C45', '18CrNiMo7-6'} <= set(words) and len(words) == len(set(words))
    for word in words:
        assert Case(GEARED).changed(rating={'rpm': 3000, 'material': word}, case={'tasks': 'rating'}).complete()


def test_a_key_without_a_default_has_none():
    """A value that nothing but the program sees is no default, and what another key may do instead is not required."""
    keys = {(key['group'], key['name']): key for key in library.declared()['keys']}
    for key in keys.values():
        if key['otherwise'].startswith(('none', 'as ')):
            assert key['default'] is None, key
    for name in ('gear_runout_phase_deg', 'pinion_tooth'):
        assert keys['deviations', name]['otherwise'].startswith('none; required with')
    assert keys['load', 'application_factor']['default'] == '1' and keys['relief', 'start']['default'] == "'hpstc'"
    # A class of the gear, or a run-out, does as well; the number of teeth has no substitute.
    assert not keys['deviations', 'pinion_class']['required'] and keys['pinion', 'teeth']['required']
