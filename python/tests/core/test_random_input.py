"""Random texts, names, values and arguments, the same ones each time: what is not usable is refused with an
`Error` or a `TypeError`, and what is usable comes back as it went in."""

import concurrent.futures
import contextlib
import ctypes
import gc
import math
import statistics
import warnings

import numpy as np
import pytest
from conftest import GEARED, PRESCRIBED, bits
from hypothesis import given, settings
from hypothesis import strategies as st

import gearsweep
from gearsweep import Case, Error

few = settings(derandomize=True, deadline=None, database=None, max_examples=40)
fewer = settings(few, max_examples=15)

#: Cheap to read and to run.
SMALL = PRESCRIBED.replace('rpm_step = 1000', 'rpm_step = 7000')
GROUPS = {
    'pair': ['module_mm', 'face_width_mm', 'backlash_um', 'pressure_angle_deg'],
    'pinion': ['teeth', 'profile_shift', 'effective_mass_kg'],
    'relief': ['amount_um', 'kind'],
    'mesh': ['model', 'contact_ratio', 'coefficients'],
    'dynamics': ['damping_ratio', 'friction'],
}
#: Words that a case is made of, in an order that makes none.
pieces = st.sampled_from(
    ['&pair', '&case', ' /', ' = ', "'", "''", '"', '!', '\n', '\r\n', ',', '&', '3*2', '1d400', 'nan', 'tasks', 'module_mm', '(1)',
     '%', '-1', '.true.', 'é', '\udcff', "'it''s'", '$', '&end']
)  # fmt: skip
texts = st.one_of(
    st.binary(max_size=200).map(lambda b: b.decode('utf-8', 'surrogateescape')),
    st.text(max_size=100),
    st.lists(pieces, max_size=30).map(''.join),
    st.tuples(st.integers(0, len(GEARED)), pieces, st.integers(0, 40)).map(
        lambda cut: GEARED[: cut[0]] + cut[1] + GEARED[cut[0] + cut[2] :]
    ),
)
keys = st.sampled_from([(group, key) for group, names in GROUPS.items() for key in names])
numbers = st.one_of(st.floats(), st.integers(-(10**30), 10**30), st.sampled_from([5e-324, 1e308, -0.0, 2**31, math.nan]))
values = st.one_of(
    numbers, st.booleans(), st.text(max_size=20), st.lists(numbers, max_size=5), st.sampled_from(["it's", "''", "'", '/', '!', '&x'])
)
#: What is no case and no number.
objects = st.one_of(
    st.none(), st.text(max_size=5), st.binary(max_size=5), st.floats(), st.complex_numbers(), st.lists(st.integers(), max_size=3),
    st.dictionaries(st.text(max_size=3), st.integers(), max_size=2), st.just(object()), st.just(np.empty((0, 3))),
)  # fmt: skip


@contextlib.contextmanager
def refusal_allowed():
    """The body may be refused, but not in another way, and not without a word."""
    with warnings.catch_warnings():
        warnings.simplefilter('ignore', gearsweep.PartialWarning)
        try:
            yield
        except Error as error:
            assert str(error).strip() and error.code not in (gearsweep.Code.OK, gearsweep.Code.PARTIAL)


# --- texts -------------------------------------------------------------------


@few
@given(texts)
def test_any_text_is_read_or_refused(text):
    case = Case(text)
    assert str(case) == text
    for call in (lambda case: gearsweep.run(case, 'geometry'), Case.complete, lambda case: case.tasks, lambda case: case.get('pair', 'module_mm')):
        with refusal_allowed():
            call(case)


@few
@given(texts)
def test_a_text_survives_its_file(tmp_path_factory, text):
    path = tmp_path_factory.getbasetemp() / 'any.nml'
    with contextlib.suppress(UnicodeEncodeError):
        Case(text).write(path)
        # A byte that is no UTF-8 is a character of Latin-1, as for the library.
        latin = ''.join(chr(ord(letter) - 0xDC00) if '\udc80' <= letter <= '\udcff' else letter for letter in text)
        assert Case.read(path).text == latin


@few
@given(keys, values)
def test_any_value_is_used_or_refused(name, value):
    group, key = name
    with refusal_allowed():
        case = Case(GEARED).changed(**{group: {key: value}})
        gearsweep.run(case, 'geometry')


@few
@given(st.text(max_size=12), st.text(max_size=12), values)
def test_any_name_is_used_or_refused(group, key, value):
    with refusal_allowed():
        changed = Case(SMALL).changed(**{group: {key: value}})
        changed.complete()


@few
@given(st.floats(0.5, 1e3), st.floats(1e-3, 0.99), st.lists(st.floats(0.05, 300), min_size=1, max_size=6, unique=True))
def test_what_is_changed_can_be_got(width, damping, amounts):
    case = Case(GEARED).changed(pair={'face_width_mm': width}, dynamics={'damping_ratio': damping}, relief={'amount_um': amounts})
    assert (case.get('pair', 'face_width_mm'), case.get('dynamics', 'damping_ratio')) == (width, damping)
    assert np.ravel(case.get('relief', 'amount_um')).tolist() == amounts
    assert case.get('pinion', 'teeth') == 21


@few
@given(st.text(st.characters(max_codepoint=0x2FF, exclude_categories=['Cc']), max_size=60))
def test_a_title_can_be_got(title):
    """Quotes and all that ends a group elsewhere stand for themselves in a text."""
    assert Case(GEARED).changed(case={'title': title}).get('case', 'title', '').rstrip() == title.rstrip()


@pytest.mark.parametrize('code', [*range(1, 9), 11, 12, *range(14, 32), 127, *range(128, 160)])
def test_control_characters_in_a_title_are_refused(code):
    with pytest.raises(gearsweep.Error, match=rf'&case title = .*control character \(code {code}\)'):
        Case(GEARED).changed(case={'title': f'a{chr(code)}b'})


# --- arguments ----------------------------------------------------------------

@fewer
@given(thing=objects)
def test_no_case(thing):
    for arguments in ((thing,), (thing, 'sweep')):
        with pytest.raises(TypeError, match='case'):
            gearsweep.run(*arguments)


@fewer
@given(objects.filter(lambda thing: not isinstance(thing, str)))
def test_no_text(thing):
    with pytest.raises(TypeError):
        Case(thing)


@few
@given(st.one_of(objects, st.text(max_size=9), st.lists(st.text(max_size=9), max_size=3)))
def test_any_tasks_are_run_or_refused(tasks):
    with contextlib.suppress(TypeError), refusal_allowed():
        gearsweep.run(Case(SMALL), tasks)


@fewer
@given(st.text(max_size=12), st.text(max_size=12), st.dictionaries(st.text(max_size=6), values, max_size=2))
def test_any_name_of_a_table_or_column_is_found_or_refused(study, table, column, where):
    with contextlib.suppress(AttributeError):
        getattr(study, table)
    with contextlib.suppress(AttributeError):
        getattr(study.sweep, column)
    with contextlib.suppress(TypeError, ValueError):
        study.sweep.at(**where)


@pytest.fixture(scope='module')
def study():
    return gearsweep.run(Case(SMALL))


# --- results ------------------------------------------------------------------


@fewer
@given(st.lists(st.floats(0, 40), min_size=1, max_size=3, unique=True), st.floats(1000, 20000))
def test_a_result_survives_its_file(tmp_path_factory, amounts, rpm):
    path = tmp_path_factory.getbasetemp() / 'any.npz'
    case = Case(SMALL).changed(relief={'amount_um': amounts}, sweep={'load_rpm': rpm}, case={'tasks': ('mesh', 'load', 'sweep')})
    with refusal_allowed():
        study = gearsweep.run(case)
        study.save(path)
        again = gearsweep.read(path)
        assert again.case == study.case and bits(again) == bits(study)


@few
@given(st.binary(max_size=300))
def test_a_file_of_another_kind(tmp_path_factory, content):
    path = tmp_path_factory.getbasetemp() / 'other.npz'
    path.write_bytes(content)
    with pytest.raises(Error, match='cannot read'):
        gearsweep.read(path)


# --- many calls ----------------------------------------------------------------


@pytest.mark.filterwarnings('ignore::gearsweep.UnusedWarning')
def test_good_and_bad_calls_at_once():
    """Each caller gets its own answer, and its own message."""
    good = [Case(SMALL).changed(case={'tasks': ('mesh', 'sweep')}, relief={'amount_um': amount}) for amount in range(4)]
    bad = [Case(SMALL + f'&colour{number} red = 1 /') for number in range(4)]

    def answer(case):
        try:
            return bits(gearsweep.run(case, threads=1))
        except Error as error:
            return str(error)

    alone = [answer(case) for case in good + bad]
    assert all(f'colour{number}' in alone[4 + number] for number in range(4))
    with concurrent.futures.ThreadPoolExecutor(8) as pool:
        assert list(pool.map(answer, (good + bad) * 4)) == alone * 4


class _Heap(ctypes.Structure):
    """What the C library tells of its memory."""

    _fields_ = [(name, ctypes.c_size_t) for name in ['arena', 'ordblks', 'smblks', 'hblks', 'hblkhd', 'usmblks', 'fsmblks', 'uordblks', 'fordblks', 'keepcost']]


def heap_in_use() -> int:
    """Bytes that are allocated and not freed, all arenas together."""
    try:
        tell = ctypes.CDLL(None).mallinfo2
    except (AttributeError, TypeError):
        pytest.skip('this C library does not tell what is in use')
    tell.restype = _Heap
    heap = tell()
    return heap.uordblks + heap.hblkhd


def test_no_leak(study):
    """Good and refused calls leave nothing behind; 1 kB a call would show, as it does where it is kept. What stays for
    good comes with the first calls, or once with a later one; other things are freed now and then: a leak is what shows
    most times."""
    good = Case(SMALL).changed(case={'tasks': 'mesh'})
    bad = good.changed(pinion={'teeth': -1})

    def growth(call, times=10):
        gc.collect()
        before = heap_in_use()
        for _ in range(times):
            call()
        gc.collect()
        return (heap_in_use() - before) / times

    def calls():
        assert gearsweep.run(good, earlier=study).mesh.s.size
        with pytest.raises(Error):
            gearsweep.run(bad)

    kept = []
    growth(calls)
    assert growth(lambda: kept.append(np.zeros(128))) >= 1024
    assert statistics.median(growth(calls) for _ in range(5)) < 1024
