"""Plans, their rows, runs and stores: `gearsweep.many` where nothing goes wrong."""

import concurrent.futures
import functools
import gc
import hashlib
import re
import subprocess
import sys
import threading
import tracemalloc
import warnings

import numpy as np
import pytest
from conftest import PRESCRIBED

import gearsweep
from gearsweep import Case, Code, Error

many = pytest.importorskip('gearsweep.many')
from scipy.stats import norm, qmc, randint, truncnorm, uniform  # noqa: E402
from worker_faults import LIMIT, fails  # noqa: E402

CASE = Case(PRESCRIBED).changed(case={'tasks': 'sweep'}, relief={'amount_um': 10}, sweep={'load_rpm': None})
GROUPS = dict(load={'normal_force_n': norm(7000, 300)}, relief={'amount_um': truncnorm(-3, 3, 15, 1.5)},
              dynamics={'damping_ratio': uniform(0.1, 0.14)})  # fmt: skip
TAKE = ['sweep_worst.worst_dynamic_factor', 'sweep.dynamic_factor']
GEARS = Case("&case tasks = 'geometry' / &pair module_mm = 3 face_width_mm = 20 / &pinion teeth = 21 / &gear teeth = 34 /")


def plan_of(n=96, seed=3, **groups):
    return many.Plan.random(CASE, n, seed, **(groups or GROUPS))


def digest(data):
    """Of all numbers, whatever their order in files."""
    found = hashlib.sha256()
    for name in sorted(map(str, data.variables)):
        found.update(name.encode() + np.ascontiguousarray(data[name].values).tobytes())
    return found.hexdigest()


def fails_with(match, call, *arguments, code=Code.INPUT, **options):
    with pytest.raises(Error, match=match) as caught:
        call(*arguments, **options)
    assert caught.value.code == code


# Plans and their rows.

PLANS = {
    'random': plan_of(96),
    'sobol': many.Plan.sobol(CASE, 128, 3, **GROUPS),
    'four scrambles': many.Plan.sobol(CASE, 128, 3, scrambles=4, **GROUPS),
    'lhs': many.Plan.lhs(CASE, 96, 3, **GROUPS),
    'saltelli': many.Plan.saltelli(CASE, 16, 3, **GROUPS),
    'grid': many.Plan.grid(CASE, relief={'amount_um': [0, 5, 10]}, dynamics={'damping_ratio': [0.1, 0.2]}),
    'table': many.Plan.table(CASE, {'relief.amount_um': [1.0, 2.0, 4.0], 'sweep.direction': ['up', 'down', 'up']}),
}


@pytest.mark.parametrize('plan', PLANS.values(), ids=PLANS)
def test_rows_are_the_same_for_any_blocks(plan):
    whole = plan.rows()
    assert whole.shape == (plan.n, len(plan.names)) and np.isfinite(whole).all()
    for size in (1, 7, 40):
        parts = [plan.rows(first, min(first + size, plan.n)) for first in range(0, plan.n, size)]
        np.testing.assert_array_equal(np.concatenate(parts), whole)
    # Backwards, as a run that goes on asks for what is missing.
    np.testing.assert_array_equal(plan.rows(1, 3), whole[1:3])


@pytest.mark.parametrize('kind', ['random', 'sobol'])
def test_the_first_rows_stay_where_there_are_more(kind):
    less, more = (getattr(many.Plan, kind)(CASE, n, 5, **GROUPS) for n in (64, 256))
    np.testing.assert_array_equal(less.rows(), more.rows(0, 64))


def test_points_of_each_scramble_are_scipys():
    """At the middle of SciPy's cells of 2^-30, of which it gives the lower corner."""
    plan = many.Plan.sobol(CASE, 64, 11, scrambles=4, relief={'amount_um': uniform(0, 1)}, dynamics={'friction': uniform(0, 1)})
    for one in range(4):
        rng = np.random.default_rng(np.random.SeedSequence(11, spawn_key=(one,)))
        expected = qmc.Sobol(2, scramble=True, rng=rng).random(16) + 2.0**-31
        np.testing.assert_array_equal(plan.rows()[one::4], expected)


def test_a_latin_hypercube_has_one_point_in_each_interval():
    plan = many.Plan.lhs(CASE, 50, 1, relief={'amount_um': uniform(0, 1)}, dynamics={'friction': uniform(0, 1)})
    for column in plan.rows().T:
        assert sorted((column * 50).astype(int)) == list(range(50))


def test_saltellis_rows_are_in_salibs_order():
    """A, A with each column of B, B: columns of B stand in the last row of a base point, all else is A's."""
    rows = PLANS['saltelli'].rows().reshape(16, 5, 3)
    for one in range(3):
        np.testing.assert_array_equal(rows[:, 1 + one, one], rows[:, 4, one])
        rest = [at for at in range(3) if at != one]
        np.testing.assert_array_equal(rows[:, 1 + one, rest], rows[:, 0, rest])
    assert (rows[:, 0] != rows[:, 4]).all()


def test_distributions_are_those_that_are_reported():
    """The mean and the standard deviation of 4096 independent points, within 4 of their standard errors."""
    rows = plan_of(4096).rows()
    assert abs(rows[:, 0].mean() - 7000) < 4 * 300 / 64 and abs(rows[:, 0].std() - 300) < 4 * 300 / 90
    assert rows[:, 2].min() > 0.1 and rows[:, 2].max() < 0.24


def test_whole_numbers_are_written_as_such():
    plan = many.Plan.random(GEARS, 20, 1, gear={'teeth': randint(30, 40)}, pair={'module_mm': [3, 4]})
    for at in range(20):
        case = plan.case(at)
        teeth, module = plan.rows(at, at + 1)[0]
        assert f'teeth = {int(teeth)} ' in case.text + ' ' and 30 <= teeth < 40 and module in (3, 4)
        assert (case.get('gear', 'teeth'), case.get('pair', 'module_mm')) == (teeth, module)


def test_lists_hold_words_and_lists():
    plan = many.Plan.grid(CASE, relief={'amount_um': [[0, 5], [0, 10]]}, sweep={'direction': ['up', 'down', 'both']})
    assert plan.n == 6 and plan.rows().tolist() == [[0, 0], [0, 1], [0, 2], [1, 0], [1, 1], [1, 2]]
    assert plan.case(5).get('relief', 'amount_um') == (0, 10) and plan.case(5).get('sweep', 'direction') == 'both'


def test_a_table_gives_its_own_rows():
    import pandas

    frame = pandas.DataFrame({'relief.amount_um': [3.5, 1.25], 'sweep.direction': ['down', 'up'], 'pinion.teeth': [25, 27]})
    plan = many.Plan.table(CASE, frame)
    assert plan.case(1).get('relief', 'amount_um') == 1.25 and plan.case(0).get('sweep', 'direction') == 'down'
    assert plan.case(1).get('pinion', 'teeth') == 27 and 'teeth = 27' in plan.case(1).text


@pytest.mark.parametrize(('match', 'make'), [
    ('did you mean amount_um', lambda: plan_of(relief={'amont_um': norm(1, 1)})),
    ('varies no key', lambda: many.Plan.random(CASE, 4, 1)),
    (r'&relief amount_um = 3: must be a distribution .* or a list', lambda: plan_of(relief={'amount_um': 3})),
    (r'&gear teeth: must be whole numbers: use a discrete', lambda: plan_of(gear={'teeth': norm(30, 2)})),
    (r'&gear teeth: must be whole numbers', lambda: plan_of(gear={'teeth': [30, 30.5]})),
    (r'&mesh model: is text, which has no distribution', lambda: plan_of(mesh={'model': norm(0, 1)})),
    (r'&relief amount_um: a grid needs a list', lambda: many.Plan.grid(CASE, relief={'amount_um': norm(0, 1)})),
    ('the list is empty', lambda: plan_of(relief={'amount_um': []})),
    ('must be finite', lambda: plan_of(relief={'amount_um': [1, np.inf]})),
    (r'n = 100: must be 8 \(scrambles\) times a power of 2, such as 64 or 128', lambda: many.Plan.sobol(CASE, 100, 1, **GROUPS)),
    (r'n = 3: must be 8 \(scrambles\) times a power of 2, such as 8 or 16', lambda: many.Plan.sobol(CASE, 3, 1, **GROUPS)),
    (r'n = 36: must be 6 \(scrambles\) times a power of 2, such as 24 or 48', lambda: many.Plan.sobol(CASE, 36, 1, scrambles=6, **GROUPS)),
    (r'scrambles = 3: must be a whole number from 4 to 1000', lambda: many.Plan.sobol(CASE, 96, 1, scrambles=3, **GROUPS)),
    (r'n = 12: must be a power of 2', lambda: many.Plan.saltelli(CASE, 12, 1, **GROUPS)),
    (r'n = 0: must be a whole number of at least 1', lambda: plan_of(0)),
    (r'seed = -1: must be a whole number of at least 0', lambda: plan_of(4, -1)),
    ("column teeth: must be called 'group.key'", lambda: many.Plan.table(CASE, {'teeth': [25]})),
    ('same number of rows', lambda: many.Plan.table(CASE, {'relief.amount_um': [1], 'pinion.teeth': [1, 2]})),
    ('not finite', lambda: plan_of(relief={'amount_um': norm(1, -1)}).rows()),
    ('rows 5 to 3', lambda: plan_of().rows(5, 3)),
    ('variant 96: must be from 0 to 95', lambda: plan_of().case(96)),
])  # fmt: skip
def test_what_no_plan_can_have_is_reported(match, make):
    fails_with(match, make)


def test_the_mark_is_of_all_that_numbers_depend_on(monkeypatch, tmp_path):
    (tmp_path / 'flanks.csv').write_text('tooth,flank,roll_mm,deviation_um\n')
    filed = Case(CASE.changed(deviations={'pinion_flanks_file': 'flanks.csv'}).text, str(tmp_path))
    plans = [plan_of(), plan_of(97), plan_of(seed=4), plan_of(relief={'amount_um': norm(15, 1.5)}), plan_of(relief={'amount_um': norm(15, 1.6)}),
             plan_of(relief={'amount_um': [15, 16]}), plan_of(relief={'amount_um': [15, 16.5]}), PLANS['lhs'], PLANS['table'],
             many.Plan.table(CASE, {'relief.amount_um': [1.0, 2.0, 5.0], 'sweep.direction': ['up', 'down', 'up']}),
             many.Plan.random(CASE.changed(sweep={'rpm_step': 500}), 96, 3, **GROUPS), many.Plan.random(filed, 96, 3, **GROUPS)]  # fmt: skip
    marks = [plan.mark() for plan in plans]
    assert len(set(marks)) == len(marks) and plan_of().mark() == marks[0]
    (tmp_path / 'flanks.csv').write_text('tooth,flank,roll_mm,deviation_um\n1,left,7.2,0.4\n')
    assert plans[-1].mark() != marks[-1]
    named = Case(CASE.changed(deviations={'pinion_flanks_file': "op's.csv"}).text, str(tmp_path))
    (tmp_path / "op's.csv").write_text('tooth,flank,roll_mm,deviation_um\n')
    mark = many.Plan.random(named, 96, 3, **GROUPS).mark()
    (tmp_path / "op's.csv").write_text('tooth,flank,roll_mm,deviation_um\n1,left,7.2,0.4\n')
    assert many.Plan.random(named, 96, 3, **GROUPS).mark() != mark
    for name in ('gearsweep.core.library.version', 'gearsweep.many.plan.kernel'):
        with monkeypatch.context() as patched:
            patched.setattr(name, lambda: 'another')
            assert plan_of().mark() != marks[0]


# Runs.


@pytest.fixture(scope='module')
def data():
    return many.run(plan_of(), TAKE)


def test_each_variant_is_what_its_case_gives_alone(data):
    """Bit for bit, by `gearsweep.run` of the case of each."""
    plan = plan_of()
    assert many.counts(data) == {'ok': 96}
    for at in range(0, 96, 5):
        study = gearsweep.run(plan.case(at))
        np.testing.assert_array_equal(data['sweep.dynamic_factor'].values[at], study.sweep.dynamic_factor[0])
        assert data['sweep_worst.worst_dynamic_factor'].values[at] == study.sweep_worst.worst_dynamic_factor[0]
    np.testing.assert_array_equal(np.column_stack([data[name] for name in plan.names]), plan.rows())


def test_an_index_column_that_is_varied_is_no_coordinate(data):
    """Of the amount of relief there is one in each variant, so that the base's would be wrong for all."""
    assert data['sweep.dynamic_factor'].dims == ('variant', 'rpm') and set(data.coords) == {'rpm', 'relief.amount_um', 'dynamics.damping_ratio', 'load.normal_force_n'}
    assert data.rpm.values.tolist() == list(range(2000, 16001, 1000))
    taken = many.run(plan_of(4), 'sweep_worst.relief_um')
    np.testing.assert_allclose(taken['sweep_worst.relief_um'], taken['relief.amount_um'], rtol=1e-14)
    assert data['load.normal_force_n'].attrs['units'] == 'N' and data['sweep.dynamic_factor'].attrs['points'] == 'random' and data.rpm.attrs['units'] == '1/min'


def large(study):
    return {'large': np.random.default_rng(0).random(100_000)}  # which no store can compress


@pytest.mark.parametrize('workers', [0, 2])
def test_memory_does_not_grow_with_blocks(workers, tmp_path):
    """Each block has 0.8 MB. Between the 10th and the 50th what Python holds grows by less than four of them: so many may be under way."""
    held = {}

    def note(done, *_):
        if done in (10, 50):
            gc.collect()
            held[done] = tracemalloc.get_traced_memory()[0]

    with concurrent.futures.ThreadPoolExecutor(max(1, workers)) as threads:
        tracemalloc.start()
        try:
            many.run(many.Plan.grid(GEARS, gear={'teeth': range(30, 80)}), executor=threads if workers else None, store=tmp_path / 'x.zarr', size=1, window=2,
                     reduce=large, progress=note)  # fmt: skip
        finally:
            tracemalloc.stop()
    assert held[50] - held[10] < 4 * 0.8e6


def test_the_same_bits_by_any_executor(data, tmp_path):
    expected = digest(data)
    for size in (30, 7):
        assert digest(many.run(plan_of(), TAKE, size=size)) == expected
    with concurrent.futures.ThreadPoolExecutor(2) as threads:
        assert digest(many.run(plan_of(), TAKE, executor=threads, store=tmp_path / 'threads.zarr', size=5)) == expected
    assert digest(many.run(plan_of(), TAKE, executor=2, store=tmp_path / 'two.zarr', size=11)) == expected
    assert digest(many.open(tmp_path / 'two.zarr')) == expected


def test_a_task_runs_on_one_thread(monkeypatch):
    """Several processes with all threads each would stand in each other's way."""
    asked = []
    attempt = many.rows.attempt
    monkeypatch.setattr(many.rows, 'attempt', lambda case, threads, *rest, **more: (asked.append(threads), attempt(case, threads, *rest, **more))[1])
    many.run(plan_of(4), TAKE)
    assert set(asked) == {1}


def test_a_run_goes_on_where_it_was_left(data, tmp_path):
    """What is done is not computed again: its files are those of before."""
    import zarr

    store = tmp_path / 'x.zarr'
    many.run(plan_of(), TAKE, store=store, size=10)
    group = zarr.open_group(store, mode='r+')
    group['status'][20:30] = 0
    group['sweep_worst.worst_dynamic_factor'][20:30] = -1
    chunks = [store / 'sweep_worst.worst_dynamic_factor/c' / str(at) for at in range(10)]
    before, seen = [chunk.stat().st_ino for chunk in chunks], []
    again = many.run(plan_of(), TAKE, store=store, progress=lambda *one: seen.append(one))
    worst, expected = again['sweep_worst.worst_dynamic_factor'].values, data['sweep_worst.worst_dynamic_factor'].values
    np.testing.assert_array_equal(worst, expected)
    assert [chunk.stat().st_ino != was for chunk, was in zip(chunks, before)] == [at == 2 for at in range(10)] and seen == [(86, 96, 0), (96, 96, 0)]


@pytest.mark.parametrize('again', ['failed', many.FAILED, ['late', many.FAILED], ('failed',)])
def test_what_is_asked_for_again_is_computed_again(again, tmp_path):
    """By its status or its word, and nothing else: each block is a variant, so that as many are told as fail, and one more at first."""
    store, bad = tmp_path / 'x.zarr', plan_of(24).rows()[:, 2] > LIMIT
    many.run(plan_of(24), reduce=fails, store=store, size=1)
    seen = []
    many.run(plan_of(24), reduce=fails, store=store, progress=lambda *one: seen.append(one), again='late')
    assert seen == [(24, 24, bad.sum())]
    many.run(plan_of(24), reduce=fails, store=store, progress=lambda *one: seen.append(one), again=again)
    assert len(seen) == 2 + bad.sum() and seen[1] == (24 - bad.sum(), 24, 0)


#: Two modules whose function has one name, and the changes of it that matter.
BODY = """
import functools, math
FACTOR = 2

def helper(x):
    return x + 1

class Times:
    def __init__(self, k):
        self.k = k

    def __call__(self, study):
        return {'x': self.k * 1.0}

def made(k):
    def within(study):
        return {'x': k * 1.0}
    return within

def f(study, k=1, more=()):
    # as it is
    return {'x': k * FACTOR + helper(len(more)) + math.pi}

reduce = f
"""


def function_of(text):
    space = {'__name__': 'my_module'}
    exec(text, space)
    return space['reduce']


@pytest.mark.parametrize(('one', 'other', 'is_same'), [
    ('= f\n', '= f\n', True), ('# as it is', '# said otherwise\n\n', True), ('k * FACTOR', 'k / FACTOR', False), ('FACTOR = 2', 'FACTOR = 3', False),
    ('x + 1', 'x + 2', False), ('k=1', 'k=3', False), ('math.pi', 'math.e', False), ('= f\n', '= functools.partial(f, k=1)\n', False),
    ('= f\n', '= functools.partial(f, k=2)\n', False), ('= f\n', '= made(1)\n', False), ('= f\n', '= Times(2)\n', False),
])  # fmt: skip
def test_a_function_is_known_again_by_what_it_does(one, other, is_same):
    """Not by its comments, or by where it lies."""
    from gearsweep.many.outputs import reduce_digest

    assert (reduce_digest(function_of(BODY)) == reduce_digest(function_of(BODY.replace(one, other)))) == is_same


@pytest.mark.parametrize('kind', ['functools.partial(f, k={})', 'functools.partial(f, more=[{{1: {}}}])', 'made({})', 'Times({})', 'functools.partial(Times({}).__call__)'])
def test_what_a_function_is_given_is_part_of_it(kind):
    from gearsweep.many.outputs import reduce_digest

    one, again, two = (reduce_digest(function_of(BODY.replace('= f\n', f'= {kind.format(value)}\n'))) for value in (1, 1, 2))
    assert one == again != two


def test_a_store_is_of_one_reduce(tmp_path):
    """Not of two functions of one name, of which the second has another argument."""
    store, plan = tmp_path / 'x.zarr', plan_of(8)
    many.run(plan, reduce=functools.partial(scaled, k=1), store=store, size=2, part=(1, 2))
    with pytest.raises(Error, match=r'x\.zarr: was begun with another reduce of the name test_many\.scaled: its code, a constant or an argument of it was changed'):
        many.run(plan, reduce=functools.partial(scaled, k=2), store=store, part=(2, 2))
    data = many.run(plan, reduce=functools.partial(scaled, k=1), store=store, part=(2, 2))
    assert (data['k'].values == 1).all()


def scaled(study, k):
    return {'k': k}


def test_keys_that_are_varied_are_coordinates(data, tmp_path):
    """Of a store too; and the status says what its numbers mean."""
    kept = many.run(plan_of(8), TAKE, store=tmp_path / 'x.zarr')
    for found in (data, kept):
        assert set(plan_of().names) < set(found.coords) and {*TAKE, 'status'} == set(found.data_vars)
        words = dict(zip(found.status.attrs['flag_values'], found.status.attrs['flag_meanings'].split()))
        assert words == {int(one): one.name.lower() for one in many.Status}
    assert kept[TAKE[0]].to_dataframe().columns.tolist() == [*plan_of().names, TAKE[0]]


def test_a_plan_prints_what_it_varies():
    shown = str(plan_of(96))
    assert shown.splitlines()[0] == '<gearsweep.many.Plan random: 96 variants, seed 3'
    assert '\n  load.normal_force_n     norm(7000, 300)\n' in shown and ' object at 0x' not in shown
    grid = many.Plan.grid(CASE, sweep={'direction': ['up', 'down']}, relief={'amount_um': [0.0, 5.0]})
    assert str(grid) == '<gearsweep.many.Plan grid: 4 variants\n  sweep.direction   up, down\n  relief.amount_um  0, 5>'


def test_parts_share_a_store(data, tmp_path):
    store = tmp_path / 'x.zarr'
    first = many.run(plan_of(), TAKE, store=store, size=7, part=(1, 3))
    assert many.counts(first) == {'pending': 61, 'ok': 35}
    for k in (3, 2):
        whole = many.run(plan_of(), TAKE, store=store, part=(k, 3))
    assert digest(whole) == digest(data)
    fails_with('part 4/3', many.run, plan_of(), TAKE, store=store, part=(4, 3))


def test_a_part_may_have_no_block(capsys):
    """Two blocks for three parts."""
    assert many.counts(many.run(plan_of(2), TAKE, part=(3, 3), progress=True)) == {'pending': 2}
    assert 'variants' not in capsys.readouterr().err


@pytest.mark.parametrize(('match', 'options'), [
    ('size = 0: must be a whole number of at least 1', {'size': 0}), ('size = 0.5: must be a whole', {'size': 0.5}),
    ('size = 1.5: must be a whole', {'size': 1.5}), ('window = -1: must be a whole number', {'window': -1, 'executor': 1}),
    ("again = 'OK': must be a Status or its word, of pending, ok, partial, refused, failed, crashed, late", {'again': 'OK'}),
    ('again = 99: must be a Status', {'again': [many.LATE, 99]}), ('again = 6: must be a Status', {'again': 6}),
    ('window = 0: must be a whole number', {'window': 0}), ('part 1.0/2', {'part': (1.0, 2)}), ('seconds = 0: must be a number of seconds above 0', {'seconds': 0}), ('wait = -1: must be', {'wait': -1}), ("seconds = '3': must be", {'seconds': '3'}),
])  # fmt: skip
def test_what_no_run_can_have_is_reported(match, options):
    fails_with(match, many.run, plan_of(4), TAKE, **options)


def named(study, name):
    return {name: 1.0}


@pytest.mark.parametrize('name', ['status', 'message', 'variant', 'relief.amount_um', 'rpm', TAKE[0]])
def test_a_name_stands_for_one_thing_in_a_store(name, tmp_path):
    """Nothing of a store that cannot be made is left."""
    fails_with(f'{name}: another array of the store has this name', many.run, plan_of(4), TAKE, reduce=functools.partial(named, name=name),
               store=tmp_path / 'x.zarr')  # fmt: skip
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize('name', ['a/b', 'a\\b', '../b', '.', '', '__a', 'zarr.json', 'a\0', 1, None])
def test_a_name_that_no_array_can_have_is_reported(name, tmp_path):
    fails_with(f'reduce: {re.escape(repr(name))}: cannot name an array', many.run, plan_of(4), reduce=functools.partial(named, name=name),
               store=tmp_path / 'x.zarr')  # fmt: skip
    assert not list(tmp_path.iterdir())


def test_sizes_may_be_those_of_numpy(tmp_path):
    """As sums of arrays are: blocks are of two variants, and the second run finds them."""
    for _ in range(2):
        data = many.run(plan_of(np.int64(4)), TAKE, store=tmp_path / 'x.zarr', size=np.int64(2), window=np.int64(1), part=(np.int64(1), np.int64(1)))
    assert digest(data) == digest(many.run(plan_of(4), TAKE)) and len(list((tmp_path / 'x.zarr/status/c').iterdir())) == 2


def test_a_store_of_something_else_is_refused(tmp_path, monkeypatch):
    store = tmp_path / 'x.zarr'
    many.run(plan_of(8), TAKE, store=store)
    before = digest(many.open(store))
    for plan, match in ((plan_of(8, 4), 'is of another plan: seed is 3, here 4'), (plan_of(16), 'n is 8, here 16'),
                        (many.Plan.lhs(CASE, 8, 3, **GROUPS), 'kind is random, here lhs'),
                        (many.Plan.random(CASE.changed(sweep={'rpm_step': 500}), 8, 3, **GROUPS), 'case is another, here another')):  # fmt: skip
        fails_with(match, many.run, plan, TAKE, store=store, code=Code.FILE)
    fails_with('take asks for sweep.dynamic_factor', many.run, plan_of(8), 'sweep.dynamic_factor', store=store, code=Code.FILE)
    for name, match in (('gearsweep.core.library.version', 'version is 0'), ('gearsweep.many.plan.kernel', 'kernel is .*, here another; set OPENBLAS_CORETYPE')):
        with monkeypatch.context() as patched:
            patched.setattr(name, lambda: 'another')
            fails_with(match, many.run, plan_of(8), TAKE, store=store, code=Code.FILE)
    assert digest(many.open(store)) == before
    fails_with('No such file', many.open, tmp_path / 'none', code=Code.FILE)
    (tmp_path / 'other').mkdir()
    fails_with('is no store of gearsweep.many', many.open, tmp_path / 'other', code=Code.FILE)
    fails_with('is no store of gearsweep.many', many.run, plan_of(8), TAKE, store=tmp_path / 'other', code=Code.FILE)


def other(study):
    return {'worst': 0.0}


def test_a_store_of_another_function_is_refused(tmp_path):
    """With none, or another of the same names, statuses and numbers would be those of both."""
    for begun, here in ((fails, None), (None, fails), (other, fails)):
        store = tmp_path / str(begun)
        many.run(plan_of(8), TAKE, store=store, reduce=begun)
        name, there = (f'{one.__module__}.{one.__name__}' if one else 'None' for one in (here, begun))
        fails_with(f'was begun with reduce = {there}, here {name}$', many.run, plan_of(8), TAKE, store=store, reduce=here, code=Code.FILE)
        assert many.counts(many.run(plan_of(8), TAKE, store=store, reduce=begun)) == {'ok': 8}


def test_two_runs_do_not_write_into_one_store(tmp_path):
    """The second is refused from a callback of the first."""
    store, seen = tmp_path / 'x.zarr', []

    def progress(done, total, failed):
        if done and not seen:
            seen.append(done)
            fails_with('another run writes into it', many.run, plan_of(8), TAKE, store=store, code=Code.FILE)

    many.run(plan_of(8), TAKE, store=store, size=4, progress=progress)
    assert seen == [4]


@pytest.mark.parametrize(('match', 'take'), [
    ('has no table sweeep.*did you mean sweep', 'sweeep.dynamic_factor'), ('has no column dynamic_facto', 'sweep.dynamic_facto'),
    ('has words', 'sweep.status'), ('names a column twice', ['sweep.rpm', 'sweep.rpm']),
    ('names no column', []),
])  # fmt: skip
def test_columns_that_cannot_be_taken_are_reported(match, take):
    fails_with(match, many.run, plan_of(4), take)


def test_tables_of_as_many_rows_as_come_out_are_reported():
    plan = many.Plan.grid(GEARS.changed(case={'tasks': 'mesh'}, mesh={'model': 'iso6336'}), load={'torque_nm': [100, 110]})
    fails_with('another number of rows for each variant; use reduce', many.run, plan, 'mesh.mesh_stiffness_n_um')


def test_words_of_an_index_column_are_coordinates(tmp_path):
    plan = many.Plan.grid(GEARS, gear={'teeth': [34, 35]})
    data = many.run(plan, 'gears.tip_diameter_mm', store=tmp_path / 'x.zarr')
    assert data.gear.values.tolist() == ['pinion', 'gear']
    for at in range(2):
        np.testing.assert_array_equal(data['gears.tip_diameter_mm'][at], gearsweep.run(plan.case(at)).gears.tip_diameter_mm)
    assert digest(many.run(plan, 'gears.tip_diameter_mm', store=tmp_path / 'x.zarr')) == digest(data)


def test_variants_that_fail_leave_the_others_alone(tmp_path):
    """Refused, with other speeds than the others, in part, by the caller's function: each by its status and message."""
    store = tmp_path / 'x.zarr'
    plan = many.Plan.table(CASE, {'dynamics.damping_ratio': [0.1, 0.1, -1, 0.1, 0.1], 'sweep.rpm_step': [1000, 1000, 1000, 500, 1000.0],
                                  'mesh.contact_ratio': [1.6, 1.6, 1.6, 1.6, 30]})  # fmt: skip
    data = many.run(plan, TAKE, store=store)
    assert data.status.values.tolist() == [many.OK, many.OK, many.REFUSED, many.REFUSED, many.REFUSED]
    told = many.failures(store)
    assert told.variant.tolist() == [2, 3, 4] and set(told.status) == {'refused'}
    assert 'damping_ratio = -1' in told.message[0] and 'values of rpm are not those of the other variants' in told.message[1]
    assert 'contact_ratio = 30' in told.message[2] and told['mesh.contact_ratio'][2] == 30
    np.testing.assert_array_equal(np.isnan(data[TAKE[0]]), [False, False, True, True, True])
    assert data[TAKE[0]][0] == gearsweep.run(plan.case(0)).sweep_worst.worst_dynamic_factor[0] and many.case_of(store, 3) == plan.case(3)
    fails_with('variant 5 is not there', many.case_of, store, 5)
    for one in (True, 1.5, '1', None):
        fails_with(f'variant {one!r}: must be a whole number', many.case_of, store, one)
    assert many.case_of(store, np.int64(3)) == plan.case(3)


def test_a_variant_of_other_speeds_refuses_itself_alone_in_any_block():
    """The third and the fifth have other speeds than the first, wherever a block begins."""
    plan = many.Plan.table(CASE, {'sweep.rpm_step': [1000, 1000, 2000, 1000, 2000, 1000, 1000, 1000]})
    expected = gearsweep.run(plan.case(0)).sweep.dynamic_factor[0]
    for size in (1, 2, 3, 4, 8):
        data = many.run(plan, 'sweep.dynamic_factor', size=size)
        assert data.status.values.tolist() == [1, 1, 3, 1, 3, 1, 1, 1]
        np.testing.assert_array_equal(data['sweep.dynamic_factor'][[0, 1, 3, 5, 6, 7]], np.tile(expected, (6, 1)))


@pytest.mark.parametrize('varied', [
    {'as_built.rpm': [[8000, 9000], [8000, 9500]]},
    {'sweep.rpm_first': [8000, 8500], 'sweep.rpm_last': [9000, 9500]},
], ids=['one case at a time', 'in one call'])  # fmt: skip
def test_a_dimension_that_tables_share_is_that_of_each(varied, tmp_path):
    """Of two tables over the speed one has other speeds in the second variant, whichever is taken first: 9500 does not stand under 9000."""
    case = GEARS.changed(case={'tasks': ['sweep', 'as_built']}, load={'torque_nm': 100}, mesh={'model': 'iso6336'}, as_built={'rpm': [8000, 9000]},
                         sweep={'rpm_first': 8000, 'rpm_last': 9000, 'rpm_step': 1000}, deviations={'pinion_class': 6})  # fmt: skip
    for take in (['sweep.dynamic_factor', 'as_built.dynamic_factor'], ['as_built.dynamic_factor', 'sweep.dynamic_factor']):
        data = many.run(many.Plan.table(case, varied), take, store=tmp_path / take[0])
        assert data.status.values.tolist() == [many.OK, many.REFUSED] and data.rpm.values.tolist() == [8000, 9000]
        assert 'values of rpm are not those of the other variants' in many.failures(tmp_path / take[0]).message[0]


def test_points_without_an_answer_make_a_variant_partial():
    from conftest import PARTIAL

    plan = many.Plan.grid(Case(PARTIAL), dynamics={'damping_ratio': [0.1, 0.17]})
    data = many.run(plan, 'sweep.dynamic_factor')
    assert (data.status == many.PARTIAL).all()
    for at in range(2):
        with pytest.warns(gearsweep.PartialWarning):
            expected = gearsweep.run(plan.case(at)).sweep.dynamic_factor[0]
        np.testing.assert_array_equal(data['sweep.dynamic_factor'].values[at], expected)


def test_a_function_of_the_callers_makes_numbers(tmp_path):
    store = tmp_path / 'x.zarr'
    data = many.run(plan_of(64), TAKE[0], reduce=fails, store=store)
    bad = data['dynamics.damping_ratio'].values > LIMIT
    assert 0 < bad.sum() < 64
    np.testing.assert_array_equal(data.status.values == many.FAILED, bad)
    np.testing.assert_array_equal(data['worst'].values[~bad], data[TAKE[0]].values[~bad])
    assert set(many.failures(store).message) == {'reduce: ValueError: no such number'}


@pytest.mark.parametrize('size', [None, 4])
def test_a_function_that_fails_on_the_first_variants_fails_there_alone(size):
    """The two with the most damping come first."""
    rows = plan_of(8).rows()
    rows[:2, 2] = LIMIT + 0.001
    rows[2:, 2] = np.minimum(rows[2:, 2], LIMIT - 0.001)
    plan = many.Plan.table(CASE, dict(zip(plan_of(8).names, rows.T)))
    data = many.run(plan, TAKE[0], reduce=fails, size=size)
    assert data.status.values.tolist() == 2 * [many.FAILED] + 6 * [many.OK] and np.isnan(data['worst'][:2]).all()
    np.testing.assert_array_equal(data['worst'][2:], data[TAKE[0]][2:])
    fails_with('none of the first 2 variants has a result; of the first: reduce: ValueError: no such number', many.run,
               many.Plan.table(CASE, {'dynamics.damping_ratio': 2 * [LIMIT + 0.001]}), reduce=fails)  # fmt: skip


@pytest.mark.parametrize('options', [{}, {'size': 3}, {'executor': concurrent.futures.ThreadPoolExecutor(2)}], ids=['here', 'blocks', 'threads'])
def test_no_variant_is_computed_twice(monkeypatch, options):
    """Not the first either, which tells what the columns are like."""
    asked = []
    attempt = many.rows.attempt
    monkeypatch.setattr(many.rows, 'attempt', lambda case, *rest, **more: (asked.append(case.text), attempt(case, *rest, **more))[1])
    data = many.run(plan_of(8), reduce=fails, **options)
    assert sorted(asked) == sorted(plan_of(8).case(at).text for at in range(8))
    np.testing.assert_array_equal(data['worst'], many.run(plan_of(8), TAKE[0])[TAKE[0]])


def test_no_variant_at_all_is_an_error():
    fails_with('none of the first 2 variants has a result; of the first: .*damping_ratio', many.run,
               many.Plan.grid(CASE, dynamics={'damping_ratio': [-1, -2]}), TAKE)  # fmt: skip


def test_seeds_of_deviations_are_varied():
    """Gears of a class: each seed draws others, and the same ones again."""
    case = GEARS.changed(case={'tasks': 'as_built'}, gear={'teeth': 21}, load={'torque_nm': 100}, mesh={'model': 'iso6336'},
                         sweep={'rpm_first': 9000, 'rpm_last': 9000, 'rpm_step': 1}, deviations={'pinion_class': 6})  # fmt: skip
    plan = many.Plan.grid(case, deviations={'seed': [1, 2, 1]})
    found = many.run(plan, 'as_built.dynamic_factor')['as_built.dynamic_factor'].values
    assert found.shape == (3,) and found[0] == found[2] != found[1]


def test_keys_that_are_varied_for_nothing_are_reported():
    """Gears as built have speeds of their own: those of the sweep change no number, and `gearsweep.run` says so too."""
    case = GEARS.changed(case={'tasks': 'as_built'}, gear={'teeth': 21}, load={'torque_nm': 100}, mesh={'model': 'iso6336'},
                         as_built={'rpm': 9000}, deviations={'pinion_class': 6})  # fmt: skip
    plan = many.Plan.grid(case, sweep={'rpm_first': [1000], 'rpm_step': [500, 1000]}, load={'torque_nm': [100]})
    with pytest.warns(gearsweep.UnusedWarning, match='no task of the first variant uses: sweep.rpm_first, sweep.rpm_step$') as told:
        found = many.run(plan, 'as_built.dynamic_factor')['as_built.dynamic_factor'].values
    assert found[0] == found[1] and told[0].filename == __file__
    with pytest.warns(gearsweep.UnusedWarning, match='&sweep rpm_first, rpm_step$'):
        gearsweep.run(plan.case(0))
    with pytest.warns(gearsweep.UnusedWarning, match='uses: sweep.rpm_step$'):
        many.robust(case.changed(deviations={'draws': 2}), sweep={'rpm_step': [500, 1000]})
    with warnings.catch_warnings():
        warnings.simplefilter('error')
        many.run(many.Plan.grid(case, load={'torque_nm': [100, 110]}), 'as_built.dynamic_factor')
        many.run(many.Plan.grid(CASE, dynamics={'damping_ratio': [-1, 0.1]}), TAKE)


def test_plans_are_functions(data):
    plan = plan_of()
    rows = plan.rows(0, 6)
    np.testing.assert_array_equal(plan.function(TAKE[0])(rows), data[TAKE[0]][:6])
    np.testing.assert_array_equal(plan.function([TAKE[0]] * 1, axis=1)(rows.T), [data[TAKE[0]].values[:6]])
    assert plan.function(TAKE[0])(rows[2]) == data[TAKE[0]].values[2]
    bad = rows[:2] * [[1, 1, 1], [1, 1, -1]]
    with pytest.warns(gearsweep.PartialWarning, match='1 of 2 variants'):
        assert np.isnan(plan.function(TAKE[0])(bad)).tolist() == [False, True]
    fails_with('must have 3 values for each variant', plan.function(TAKE[0]), rows[:, :2])
    fails_with('a function has one', plan.function(TAKE[1]), rows)


def test_values_that_no_case_has_are_no_number():
    """Whole numbers and positions in lists, as optimizers try them: NaN and a warning, also where no row has a number."""
    plan = many.Plan.table(CASE, {'pinion.teeth': [25, 27], 'sweep.direction': ['up', 'down']})
    call = plan.function(TAKE[0])
    bad = np.array([[np.nan, 0], [25.5, 0], [np.inf, 0], [25, -1], [25, 0.7], [25, 2], [25, np.nan]])
    with pytest.warns(gearsweep.PartialWarning, match='7 of 9 variants'):
        found = call(np.concatenate([plan.rows(), bad]))
    np.testing.assert_array_equal(found[:2], [gearsweep.run(plan.case(at)).sweep_worst.worst_dynamic_factor[0] for at in range(2)])
    assert np.isnan(found[2:]).all()
    with pytest.warns(gearsweep.PartialWarning, match='1 of 1 variants'):
        assert np.isnan(call(bad[0]))
    with pytest.warns(gearsweep.PartialWarning, match='7 of 7 variants'):
        assert np.isnan(plan.function(TAKE, axis=1)(bad.T)).all()


def test_an_import_of_gearsweep_loads_none_of_it():
    code = 'import sys, gearsweep; gearsweep.run(gearsweep.Case(sys.stdin.read())); print(*sys.modules)'
    done = subprocess.run([sys.executable, '-c', code], input=CASE.text, capture_output=True, text=True, check=True)
    assert {'dask', 'distributed', 'zarr', 'xarray', 'scipy', 'SALib', 'pandas'}.isdisjoint(done.stdout.split())
    code = 'import sys; from gearsweep import many; print(*sys.modules)'
    done = subprocess.run([sys.executable, '-c', code], capture_output=True, text=True, check=True)
    assert {'dask', 'distributed', 'matplotlib', 'SALib'}.isdisjoint(done.stdout.split())


def test_other_threads_may_run_plans():
    found = []
    thread = threading.Thread(target=lambda: found.append(many.run(plan_of(4), TAKE)))
    thread.start()
    thread.join()
    assert many.counts(found[0]) == {'ok': 4}
