"""Many rows of values in one call: each gives what its case gives by itself, to the last bit, whatever the rows beside it do."""

import pickle
import threading

import numpy as np
import pytest
from conftest import GEARED, PARTIAL, PRESCRIBED

import gearsweep
from gearsweep import Case, Code, Error

CASE = Case(GEARED).changed(case={'tasks': 'sweep'}, relief={'amount_um': 10}, sweep={'rpm_step': 2000})
NAMES = ['load.normal_force_n', 'relief.amount_um', 'gear.teeth', 'pair.face_width_mm', 'dynamics.damping_ratio']
TAKE = ['sweep.dynamic_factor', 'geometry.contact_ratio', 'sweep.dte_peak_to_peak_um']
#: Of which the third to fifth and the last are refused.
ROWS = np.array([
    [4000, 10, 34, 20, 0.17],
    [4000.1, 10, 34, 20, 0.17],
    [4000, 10, 3, 20, 0.17],
    [4000, 10, 34.5, 20, 0.17],
    [np.nan, 10, 34, 20, 0.17],
    [4100, 1 / 3, 35, 21.123456789, 0.1],
    [4000, 0, 34, 20, 0.17],
    [4000, 1e5, 34, 20, 0.17],
])  # fmt: skip


def alone(case, names, row, take):
    """The columns of one row, and the error, by a run of its own."""
    groups = {}
    for name, value in zip(names, row):
        group, key = name.split('.')
        groups.setdefault(group, {})[key] = int(value) if value == int(value) else value
    try:
        study = gearsweep.run(case.changed(**groups), 'sweep', threads=1)
    except Error as error:
        return None, error
    return [np.ravel(study[table][column]) for table, column in (name.split('.') for name in take)], None


def test_rows_give_the_bits_of_their_own_runs():
    found = gearsweep.run_rows(CASE, NAMES, ROWS, TAKE)
    assert found.codes.tolist() == [0, 0, 1, 1, 1, 0, 0, 1]
    for i, row in enumerate(ROWS):
        if np.isnan(row).any():
            assert found.messages[i] == '&load normal_force_n = NaN: must be a number'
            continue
        columns, error = alone(CASE, NAMES, row, TAKE)
        assert found.messages[i] == (str(error) if error else '')
        for name, values in zip(TAKE, columns or ()):
            assert found.columns[name][i].tobytes() == values.tobytes()
    for name in TAKE:
        assert np.isnan(found.columns[name][found.codes > 0]).all()
        assert np.isfinite(found.columns[name][found.codes == 0]).all()


def test_order_blocks_and_threads_do_not_matter():
    """Whatever ran before, and is taken over: the same bits."""
    whole = gearsweep.run_rows(CASE, NAMES, ROWS, TAKE[:1])
    back = gearsweep.run_rows(CASE, NAMES, ROWS[::-1], TAKE[:1], threads=2)
    first = gearsweep.run_rows(CASE, NAMES, ROWS[:3], TAKE[:1])
    rest = gearsweep.run_rows(CASE, NAMES, ROWS[3:], TAKE[:1], earlier=first)
    from_study = gearsweep.run_rows(CASE, NAMES, ROWS, TAKE[:1], earlier=gearsweep.run(CASE, 'sweep'))
    expected = whole.columns[TAKE[0]].tobytes()
    assert back.columns[TAKE[0]][::-1].tobytes() == expected
    assert np.concatenate([first.columns[TAKE[0]], rest.columns[TAKE[0]]]).tobytes() == expected
    assert from_study.columns[TAKE[0]].tobytes() == expected
    assert back.messages[::-1] == first.messages + rest.messages == whole.messages


def test_rows_of_a_prescribed_mesh_and_partial_ones():
    case = Case(PRESCRIBED).changed(case={'tasks': 'sweep'}, relief={'amount_um': 15})
    rows = gearsweep.run_rows(case, ['dynamics.damping_ratio'], [[0.1], [0.2]], ['sweep.dynamic_factor'])
    for value, found in zip((0.1, 0.2), rows.columns['sweep.dynamic_factor']):
        sweep = gearsweep.run(case.changed(dynamics={'damping_ratio': value}), 'sweep').sweep
        assert found.tobytes() == np.ravel(sweep.dynamic_factor).tobytes()
    partial = gearsweep.run_rows(Case(PARTIAL), ['load.normal_force_n'], [[6858]], ['sweep.dynamic_factor'])
    assert partial.codes.tolist() == [Code.PARTIAL] and 'have no answer' in partial.messages[0]
    values = partial.columns['sweep.dynamic_factor']
    assert np.isnan(values).any() and not np.isnan(values).all()


def test_another_number_of_results_is_reported_of_its_row():
    rows = gearsweep.run_rows(CASE, ['sweep.rpm_step'], [[2000], [1000], [2000]], ['sweep.dynamic_factor'])
    assert rows.codes.tolist() == [0, 1, 0] and rows.messages[1].startswith('sweep: has 7 rows, and 4 with the first')
    assert rows.columns['sweep.dynamic_factor'].shape == (3, 4)


def test_what_is_wrong_with_the_call():
    def fails(match, names=('gear.teeth',), values=((34,),), take=('geometry.contact_ratio',), case=CASE):
        with pytest.raises(Error, match=match) as caught:
            gearsweep.run_rows(case, names, values, take)
        assert caught.value.code == Code.INPUT

    fails('did you mean teeth', names=['gear.teet'])
    fails('did you mean &gear', names=['gearr.teeth'])
    fails('two names with a point', names=['teeth'])
    fails('is given twice', names=['gear.teeth', 'gear.Teeth'], values=[[34, 34]])
    fails('each pair once', names=['gear.teeth', 'gear.teeth'], values=[[34, 34]])
    fails('did you mean contact_ratio', take=['geometry.contact_rati'])
    fails('did you mean geometry', take=['geometri.contact_ratio'])
    fails('has words', take=['sweep.status'])
    fails('values: must have a column', values=[[34, 35]])
    fails('rows = 0', values=np.empty((0, 1)))
    fails('there is no group', case=Case(''), names=[], values=[[]])
    with pytest.raises(TypeError, match='case'):
        gearsweep.run_rows('&pair /', [], [[]], [])
    with pytest.raises(TypeError, match='earlier'):
        gearsweep.run_rows(CASE, [], [[]], [], earlier=CASE)


def test_numbers_that_no_row_has():
    """Of an array nothing is lost: imaginary parts and masks are refused, not left out."""
    masked = np.ma.array([[34.0], [35.0]], mask=[[False], [True]])
    assert gearsweep.run_rows(CASE, ['gear.teeth'], masked, TAKE[1:2]).codes.tolist() == [0, 1]
    for values in ([[1j]], [['34 / &x']], [[None]]):
        with pytest.raises((TypeError, ValueError)):
            gearsweep.run_rows(CASE, ['gear.teeth'], np.array(values), TAKE[1:2])


def test_whole_numbers_leave_room_for_none():
    rows = gearsweep.run_rows(CASE, ['gear.teeth'], [[34], [1], [35]], ['gears.teeth'])
    np.testing.assert_array_equal(rows.columns['gears.teeth'], [[21, 34], [np.nan, np.nan], [21, 35]])


def test_no_row_runs():
    rows = gearsweep.run_rows(CASE, ['gear.teeth'], [[1], [2]], ['geometry.contact_ratio'])
    assert rows.codes.tolist() == [1, 1] and rows.columns['geometry.contact_ratio'].shape == (2, 0)
    again = gearsweep.run_rows(CASE, ['gear.teeth'], [[34]], ['geometry.contact_ratio'], earlier=rows)
    assert again.codes.tolist() == [0]


def test_rows_can_be_sent():
    rows = gearsweep.run_rows(CASE, ['gear.teeth'], [[34], [1]], ['geometry.contact_ratio'])
    sent = pickle.loads(pickle.dumps(rows))
    assert sent.columns[TAKE[1]].tobytes() == rows.columns[TAKE[1]].tobytes()
    assert sent.codes.tolist() == [0, 1] and sent.messages == rows.messages
    with pytest.raises(Error, match='another process'):
        gearsweep.run_rows(CASE, ['gear.teeth'], [[34]], ['geometry.contact_ratio'], earlier=sent)


def test_rows_can_be_stopped_and_watched():
    told = []
    values = np.linspace(0.1, 0.2, 200)[:, np.newaxis]
    gearsweep.run_rows(CASE, ['dynamics.damping_ratio'], values, TAKE[:1], progress=lambda *count: told.append(count))
    assert told == sorted(told) and told[-1] == (200, 200)
    stop = threading.Event()
    stop.set()
    rows = gearsweep.run_rows(CASE, ['dynamics.damping_ratio'], values, TAKE[:1], stop=stop)
    assert rows.codes[-1] == Code.INTERRUPTED and 'interrupted' in rows.messages[-1]
    with pytest.raises(KeyError):
        gearsweep.run_rows(CASE, ['dynamics.damping_ratio'], values, TAKE[:1], progress=lambda *_: {}['no'])
