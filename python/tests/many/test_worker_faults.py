"""Workers, schedulers, disks and keys that stop a run of many variants: what is done is kept, and goes on to the same bits."""

import concurrent.futures
import ctypes
import json
import os
import resource
import shutil
import signal
import subprocess
import sys
import threading
import time
import warnings
from random import Random

import numpy as np
import pytest

import gearsweep
from gearsweep import Code, Error
from gearsweep.core import watch
from gearsweep.many.execution import Workers

many = pytest.importorskip('gearsweep.many')
import worker_faults  # noqa: E402
from test_many import TAKE, digest, plan_of  # noqa: E402

#: Where test modules import each other, and conftest.
PLACES = [os.path.dirname(__file__), os.path.dirname(os.path.dirname(__file__))]
PLAN = plan_of(64, 4)
#: Of its variants one ends its process, and it is none of the first, which tell what the columns are like.
(BAD,) = np.flatnonzero(PLAN.rows()[:, 2] == PLAN.rows()[:, 2].max())


@pytest.fixture(autouse=True)
def one_bad_variant():
    """The limit of what goes wrong lies between the largest damping ratio of the plan and the next."""
    ratios = np.sort(PLAN.rows()[:, 2])
    assert ratios[-2] < worker_faults.LIMIT < ratios[-1] and BAD > 16


@pytest.fixture(autouse=True)
def heeds_ctrl_c():
    """As in a terminal, also where the tests run in the background and Ctrl-C is ignored."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.fixture(scope='module')
def expected():
    return many.run(PLAN, TAKE, reduce=worker_faults.slow)


def same_but(data, expected, bad, status):
    """All variants but the bad ones have the numbers that they have without faults."""
    fine = np.setdiff1d(np.arange(expected.sizes['variant']), bad)
    assert (data.status.values[bad] == status).all() and (data.status.values[fine] == many.OK).all()
    for name in (*TAKE, 'worst'):
        np.testing.assert_array_equal(data[name].values[fine], expected[name].values[fine])
        assert np.isnan(data[name].values[bad]).all()


def test_a_variant_that_ends_its_process_is_found_alone(expected, tmp_path):
    store = tmp_path / 'x.zarr'
    data = many.run(PLAN, TAKE, reduce=worker_faults.poison, executor=2, store=store, size=16)
    same_but(data, expected, [BAD], many.CRASHED)
    told = many.failures(store)
    assert told.variant.tolist() == [BAD] and told.status[0] == 'crashed' and 'even if it computes nothing else' in told.message[0]
    assert told['dynamics.damping_ratio'][0] == PLAN.rows()[BAD, 2]


@pytest.mark.parametrize('options', [{}, {'size': 3}], ids=['a variant', 'three in a block'])
def test_a_first_variant_that_ends_its_process_is_found_too(expected, tmp_path, options):
    """And takes neither this process with it nor the other, which is tried beside it."""
    order = [BAD, *range(7)]
    plan = many.Plan.table(PLAN.base, dict(zip(PLAN.names, PLAN.rows()[order].T)))
    data = many.run(plan, TAKE, reduce=worker_faults.poison, executor=2, store=tmp_path / 'x.zarr', **options)
    same_but(data, expected.isel(variant=order), [0], many.CRASHED)
    assert many.failures(tmp_path / 'x.zarr').variant.tolist() == [0]


def test_first_variants_are_tried_side_by_side():
    """Each of two waits for the other."""
    both = threading.Barrier(2, timeout=60)

    def waits(study):
        both.wait()
        return {'worst': worker_faults.worst(study)}

    with concurrent.futures.ThreadPoolExecutor(2) as threads:
        assert many.counts(many.run(plan_of(2), reduce=waits, executor=threads)) == {'ok': 2}


def test_a_worker_that_dies_once_costs_nothing(expected, tmp_path, monkeypatch):
    monkeypatch.setenv('MANY_ONCE', str(tmp_path / 'died'))
    data = many.run(PLAN, TAKE, reduce=worker_faults.once, executor=2, store=tmp_path / 'x.zarr', size=16)
    assert (tmp_path / 'died').exists() and digest(data) == digest(expected)


def test_a_pool_of_the_callers_that_breaks_is_reported_and_the_rest_kept(expected, tmp_path, monkeypatch):
    monkeypatch.setenv('MANY_ONCE', str(tmp_path / 'died'))
    store = tmp_path / 'x.zarr'

    def go():
        with concurrent.futures.ProcessPoolExecutor(1) as pool:
            return many.run(PLAN, TAKE, reduce=worker_faults.once, executor=pool, store=store, size=8, window=1)

    with pytest.raises(Error, match='a worker process ended, and the pool with it') as caught:
        go()
    assert caught.value.code == Code.INTERRUPTED
    done = many.counts(many.open(store))
    assert done == {'pending': 64 - done['ok'], 'ok': BAD // 8 * 8}
    assert digest(go()) == digest(expected)


@pytest.fixture(scope='module')
def cluster():
    """Processes of Dask, of which one death is enough to give up a block, which saves three more each time; a scheduler's own number is 3."""
    dask = pytest.importorskip('dask')
    distributed = pytest.importorskip('distributed')
    with (
        dask.config.set({'distributed.scheduler.allowed-failures': 0}),
        distributed.LocalCluster(n_workers=1, threads_per_worker=1, dashboard_address=None, silence_logs=50) as made,
        distributed.Client(made) as client,
    ):
        yield made, client


def test_the_same_bits_by_dask_with_any_number_of_workers(cluster, tmp_path):
    made, client = cluster
    expected = digest(many.run(PLAN, TAKE))
    for workers in (1, 2, 3):
        made.scale(workers)
        client.wait_for_workers(workers, timeout=300)
        assert digest(many.run(PLAN, TAKE, executor=client, store=tmp_path / f'{workers}.zarr', size=9)) == expected


def test_the_command_asks_a_scheduler(cluster, tmp_path, monkeypatch, capfd):
    from test_many import CASE
    from test_many_command import PLAN as TEXT

    from gearsweep.__main__ import main

    CASE.write(tmp_path / 'case.nml')
    (tmp_path / 'plan.toml').write_text(TEXT)
    monkeypatch.chdir(tmp_path)
    assert main(['many', 'plan.toml', '--scheduler', cluster[0].scheduler_address]) == Code.OK
    assert 'Variants           96: 96 ok' in capfd.readouterr().out
    assert digest(many.open('plan.zarr')) == digest(many.run(plan_of(), TAKE))


def test_dask_finds_the_variant_that_ends_its_worker(cluster, expected, tmp_path):
    data = many.run(PLAN, TAKE, reduce=worker_faults.poison, executor=cluster[1], store=tmp_path / 'x.zarr', size=32)
    same_but(data, expected, [BAD], many.CRASHED)


@pytest.fixture
def empty_cluster(monkeypatch):
    """A scheduler without workers, of which the run reports within half a second."""
    distributed = pytest.importorskip('distributed')
    monkeypatch.setattr(many.execution, '_SILENT', 0.3)
    monkeypatch.setattr(many.execution, '_LOOK', 0.1)
    monkeypatch.setattr(many.execution, '_WAIT', 0.1)
    with (
        distributed.LocalCluster(n_workers=0, threads_per_worker=1, dashboard_address=None, silence_logs=50) as made,
        distributed.Client(made) as client,
    ):
        yield made, client


def test_a_cluster_without_workers_is_reported_and_given_up(empty_cluster):
    without = r'^the Dask cluster has had no worker for \d+ s; '
    with pytest.raises(Error, match=f'{without}finished blocks are kept') as caught, pytest.warns(many.NoWorkerWarning, match=f'{without}the run continues') as said:
        many.run(plan_of(4), TAKE, executor=empty_cluster[1], wait=2)
    assert caught.value.code == Code.INTERRUPTED and len(said) == 1


def test_a_cluster_that_gets_workers_later_goes_on(empty_cluster, tmp_path):
    """The first warning brings the first worker."""
    made, client = empty_cluster

    def scaled(*_, **__):
        made.scale(1)

    with warnings.catch_warnings():
        warnings.showwarning = scaled
        warnings.simplefilter('always')
        data = many.run(plan_of(4), TAKE, executor=client, wait=300)
    assert digest(data) == digest(many.run(plan_of(4), TAKE))


@pytest.mark.parametrize('executor', [None, 2], ids=['here', 'processes'])
def test_seconds_hold_for_reduce_too(expected, executor, tmp_path):
    """One that has no end is late, and neither keeps the run nor goes on in the background."""
    data = many.run(PLAN, TAKE, reduce=worker_faults.endless, executor=executor, seconds=5, store=tmp_path / 'x.zarr', size=16)
    same_but(data, expected, [BAD], many.LATE)
    assert many.failures(tmp_path / 'x.zarr').message.tolist() == ['reduce: not done after 5 s']
    until = time.monotonic() + 60
    while any(isinstance(thread, watch._Worker) for thread in threading.enumerate()):
        assert time.monotonic() < until
        time.sleep(0.01)


def test_processes_are_not_waited_for_after_the_last_block():
    """A call that its limit abandoned goes on in its process, here for two minutes."""
    workers = Workers(1)
    workers.submit(time.sleep, 120)
    began = time.monotonic()
    workers.close()
    assert time.monotonic() - began < 60


def test_a_call_that_holds_the_lock_of_python_is_late():
    """usleep with the lock held, for 0.3 s: the limit cannot end it, but sees that it was passed."""
    with pytest.raises(watch.Late):
        watch.limited(lambda: ctypes.PyDLL(None).usleep(300_000), 0.05)
    assert watch.limited(lambda: 7, 60) == 7


def test_a_variant_that_takes_too_long_is_late(tmp_path):
    """A million speeds, which take a minute, among variants of fifteen."""
    store = tmp_path / 'x.zarr'
    plan = many.Plan.grid(PLAN.base.changed(dynamics={'damping_ratio': 0.01}), sweep={'rpm_step': [1000, 2000, 0.014, 4000]})
    began = time.process_time()
    data = many.run(plan, TAKE[0], seconds=3, store=store)
    assert time.process_time() - began < 20
    assert data.status.values.tolist() == [many.OK, many.OK, many.LATE, many.OK]
    assert many.failures(store).message.tolist() == ['not done after 3 s']
    again = many.run(plan, TAKE[0], seconds=0.2, store=store, again=[many.LATE])
    assert many.failures(store).message.tolist() == ['not done after 0.2 s'] and again[TAKE[0]].equals(data[TAKE[0]])


def test_a_run_has_seconds():
    case = PLAN.base.changed(sweep={'rpm_step': 0.014})
    with pytest.raises(Error, match=r'^the run is not done after 0.3 s$') as caught:
        gearsweep.run(case, seconds=0.3)
    assert caught.value.code == Code.INTERRUPTED
    for seconds in (0, -1, float('nan'), '3', True):
        with pytest.raises(Error, match=f'^seconds = {seconds!r}: must be a number of seconds above 0'):
            gearsweep.run(case, seconds=seconds)
    assert gearsweep.run(PLAN.base, seconds=60).is_complete


@pytest.mark.parametrize('executor', [None, 2], ids=['here', 'processes'])
def test_ctrl_c_keeps_what_is_done(expected, tmp_path, monkeypatch, executor):
    held, store, sent = tmp_path / 'held', tmp_path / 'x.zarr', []
    monkeypatch.setenv('MANY_HELD', str(held))  # so that a signal that is late does not come too late

    def progress(done, total, failed):
        if done >= 16 and not sent:
            sent.append(done)
            held.touch()
            threading.Timer(0.05, os.kill, (os.getpid(), signal.SIGINT)).start()

    options = dict(reduce=worker_faults.slow, store=store, size=8)
    with pytest.raises(KeyboardInterrupt):
        many.run(PLAN, TAKE, executor=executor, progress=progress, **options)
    done = many.counts(many.open(store))
    assert done['ok'] >= 16 and done['pending'] > 0
    held.unlink()
    monkeypatch.setenv('MANY_SLOW', '0')
    assert digest(many.run(PLAN, TAKE, executor=executor, **options)) == digest(expected)


WHOLE = f"""
import os, sys
sys.path[:0] = {PLACES!r}
seen = []


def progress(done, total, failed):
    seen.append(done)
    if done >= seen[0] + 8 and 'MANY_HELD' in os.environ:
        open(os.environ['MANY_HELD'], 'w').close()


if __name__ == '__main__':
    from gearsweep import many
    from worker_faults import slow
    from test_many import TAKE, plan_of

    many.run(plan_of(64, 4), TAKE, reduce=slow, executor=2, store=sys.argv[1], size=8, progress=progress)
"""


def test_the_whole_group_killed_again_and_again_gives_the_same_bits(expected, tmp_path, monkeypatch):
    """Each time some blocks more are there, until a run comes to its end."""
    held, store, script = tmp_path / 'held', tmp_path / 'x.zarr', tmp_path / 'whole.py'
    monkeypatch.setenv('MANY_HELD', str(held))
    script.write_text(WHOLE)
    seen = [0]
    for _ in range(2):
        running = subprocess.Popen([sys.executable, script, store], start_new_session=True, stderr=subprocess.DEVNULL)
        while running.poll() is None and not held.exists():
            time.sleep(0.02)
        os.killpg(running.pid, signal.SIGKILL)
        running.wait()
        held.unlink()
        seen.append(done_in(store))
    assert seen == sorted(set(seen)) and seen[-1] < 64, seen
    monkeypatch.delenv('MANY_HELD')
    subprocess.run([sys.executable, script, store], check=True)
    assert digest(many.open(store)) == digest(expected)


def done_in(store):
    try:
        return int((many.open(store).status.values != many.PENDING).sum())
    except Error:
        return 0


def test_statuses_are_written_last(tmp_path, monkeypatch):
    """A store that is killed between two arrays of a block has the block as not done."""
    from gearsweep.many import store as stores

    written = []

    class Array:
        def __init__(self, name):
            self.name = name

        def __setitem__(self, place, values):
            written.append(self.name)

    many.run(plan_of(4), TAKE, store=tmp_path / 'x.zarr')
    kept = stores.read(tmp_path / 'x.zarr')
    block = many.rows.empty(kept.layout, 4, many.FAILED, 'why')
    group = type('Group', (), {'attrs': kept.group.attrs, '__getitem__': lambda self, name: Array(name)})()
    monkeypatch.setattr(kept, 'group', group)
    monkeypatch.setattr(kept, '_clear', lambda at: written.append('clear'))
    kept.put(0, plan_of(4).rows(), block)
    assert written[0] == 'clear' and written[-2:] == ['digest', 'status'] and set(written[1:-2]) == {*PLAN.names, *TAKE, 'message'}


def test_a_full_disk_is_reported_and_what_is_there_goes_on(expected, tmp_path):
    """Files of more than a few hundred bytes cannot be written, as a limit of the process says."""
    store = tmp_path / 'x.zarr'
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    options = dict(reduce=worker_faults.slow, store=store, size=16)

    def full(done, total, failed):
        if done == 16:
            resource.setrlimit(resource.RLIMIT_FSIZE, (300, before[1]))

    try:
        with pytest.raises(Error, match=r'cannot write .*x.zarr: File too large') as caught:
            many.run(PLAN, TAKE, progress=full, **options)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert caught.value.code == Code.FILE
    assert many.counts(many.open(store)) == {'pending': 48, 'ok': 16}
    assert digest(many.run(PLAN, TAKE, **options)) == digest(expected)


TABLE = '0 300\n0.8 400\n1.6 300\n'
FILED = PLAN.base.changed(mesh={'model': 'table', 'file': 'k.txt', 'coefficients': None})


@pytest.mark.parametrize('change', [lambda file: file.write_text(TABLE.replace('400', '450')), os.remove], ids=['edited', 'away'])
@pytest.mark.parametrize('first', [False, True], ids=['later', 'with the first variants'])
def test_a_file_that_changes_during_a_run_ends_it(tmp_path, change, first):
    """Blocks before are kept and none after is written, so that with the file as it was the bits are those of a run without a change."""
    file, store = tmp_path / 'k.txt', tmp_path / 'x.zarr'
    file.write_text(TABLE)
    plan = many.Plan.grid(gearsweep.Case(FILED.text, str(tmp_path)), dynamics={'damping_ratio': list(np.linspace(0.1, 0.2, 12))})
    expected = digest(many.run(plan, TAKE))

    def changes(study):
        if first:
            change(file)
        return {}

    with pytest.raises(Error, match=r'k\.txt: was changed during the run') as caught:
        many.run(plan, TAKE, store=store, size=3, reduce=changes if first else None, progress=lambda done, *_: done == 6 and change(file))
    assert caught.value.code == Code.FILE
    assert not store.exists() if first else many.counts(many.open(store)) == {'pending': 6, 'ok': 6}
    file.write_text(TABLE)
    assert digest(many.run(plan, TAKE, store=store, size=3)) == expected


def test_a_file_that_is_written_anew_with_the_same_words_is_no_change(tmp_path):
    file = tmp_path / 'k.txt'
    file.write_text(TABLE)
    plan = many.Plan.grid(gearsweep.Case(FILED.text, str(tmp_path)), dynamics={'damping_ratio': [0.1, 0.12, 0.14]})
    data = many.run(plan, TAKE, size=1, progress=lambda *_: (os.remove(file), file.write_text(TABLE)))
    assert many.counts(data) == {'ok': 3}


WORST = 'sweep_worst.worst_dynamic_factor/c/{}'


@pytest.fixture(scope='module')
def whole(tmp_path_factory):
    """A store of four blocks, the last of which is not full."""
    store = tmp_path_factory.mktemp('whole') / 'x.zarr'
    many.run(plan_of(20), TAKE, store=store, size=6)
    return store


def damaged(whole, tmp_path, harm):
    shutil.copytree(whole, tmp_path / 'x.zarr')
    harm(tmp_path / 'x.zarr')
    return tmp_path / 'x.zarr'


@pytest.mark.parametrize('at', [1, 3])
@pytest.mark.parametrize(('name', 'harm'), [
    (WORST, os.remove), (WORST, lambda file: os.truncate(file, 0)), (WORST, lambda file: os.truncate(file, 10)),
    ('load.normal_force_n/c/{}', os.remove), ('sweep.dynamic_factor/c/{}/0', os.remove), ('status/c/{}', lambda file: os.truncate(file, 0)),
], ids=['away', 'empty', 'cut', 'key away', 'curves away', 'status'])  # fmt: skip
def test_a_block_that_is_damaged_is_reported_and_computed_again(whole, tmp_path, name, harm, at):
    """Not read as NaN; the bits after are those before, and the other blocks are not computed again."""
    store = damaged(whole, tmp_path, lambda store: harm(store / name.format(at)))
    with pytest.raises(Error, match=f'x.zarr: values of {name.partition("/")[0]} are damaged or missing; the same run computes them again') as caught:
        digest(many.open(store))
    assert caught.value.code == Code.FILE
    seen = []
    assert digest(many.run(plan_of(20), TAKE, store=store, progress=lambda done, *_: seen.append(done))) == digest(many.open(whole))
    assert seen == [14 if at == 1 else 18, 20]


def all_of(store):
    """All numbers, words and cases that a store has, as they are read."""
    data, told = many.open(store), many.failures(store)
    return {name: data[name].values for name in data.variables} | {f'told {name}': told[name].to_numpy() for name in told} | {
        'cases': [many.case_of(store, at).text for at in (0, 19)]}  # fmt: skip


@pytest.fixture(scope='module')
def failing(tmp_path_factory):
    """A store of four blocks, in which some variants have messages; and all that is in it."""
    store = tmp_path_factory.mktemp('failing') / 'x.zarr'
    plan = many.Plan.table(PLAN.base, dict(zip(PLAN.names, np.where(np.arange(20)[:, None] % 7 == 5, [1, 1, -1], PLAN.rows()[:20]).T)))
    many.run(plan, TAKE, store=store, size=6)
    return plan, store, all_of(store)


def harmed(random, store):
    """One damage of a store, of whichever kind; what it was."""
    files = sorted(file for file in store.rglob('*') if file.is_file())
    chunks = [file for file in files if file.name != 'zarr.json']
    file = random.choice(files if random.random() < 0.3 else chunks)
    kind = random.choice(['bit', 'bit', 'bytes', 'cut', 'longer', 'away', 'folder', 'exchange', 'copy', 'other sum'])
    content = bytearray(file.read_bytes())
    if kind == 'bit':
        content[random.randrange(len(content))] ^= 1 << random.randrange(8)
        file.write_bytes(content)
    elif kind == 'bytes':
        for _ in range(random.randrange(2, 9)):
            content[random.randrange(len(content))] = random.randrange(256)
        file.write_bytes(content)
    elif kind == 'cut':
        os.truncate(file, random.randrange(len(content)))
    elif kind == 'longer':
        file.write_bytes(content + random.randbytes(5))
    elif kind == 'away':
        file.unlink()
    elif kind == 'folder':
        file.unlink()
        file.mkdir()
    elif kind in ('exchange', 'copy'):
        other = random.choice(chunks)
        there = other.read_bytes()
        if kind == 'exchange':
            other.write_bytes(content)
        file.write_bytes(there)
    else:  # right for Zarr: a number that is another one, written by Zarr itself
        import zarr

        group = zarr.open_group(store)
        array = group[random.choice([*PLAN.names, *TAKE, 'status', 'message', 'digest', 'rpm'])]
        at = tuple(random.randrange(size) for size in array.shape)
        array[at] = {'f': random.random(), 'i': random.randrange(-128, 128)}.get(array.dtype.kind, random.randrange(256))
    return f'{kind} {file.relative_to(store)}'


@pytest.mark.parametrize('seed', range(5))
@pytest.mark.filterwarnings('ignore')
def test_whatever_is_damaged_is_reported_or_changes_nothing(failing, tmp_path, seed):
    """Forty damages: what is read is the truth, or not done yet, or an `Error`; and where the descriptions hold, the same run makes it whole."""
    plan, whole, truth = failing
    random, reported, mended = Random(seed), 0, 0
    for at in range(40):
        store = tmp_path / f'{at}.zarr'
        shutil.copytree(whole, store)
        what = harmed(random, store)
        try:
            found = all_of(store)
        except Error:
            reported += 1
        else:
            pending = found['status'] == many.PENDING
            for name, values in found.items():
                told = [int(one) for one in truth['told variant'] if not pending[one]]
                expected = truth[name][np.isin(truth['told variant'], told)] if name.startswith('told') else truth[name]
                kept = ~pending if len(values) == 20 and name != 'cases' else slice(None)
                np.testing.assert_array_equal(np.asarray(values)[kept], np.asarray(expected)[kept], f'{what}: {name}')
            reported += pending.any()
        if at % 4:
            continue
        try:
            many.run(plan, TAKE, store=store)
        except Error as error:
            assert 'makes a new store' in str(error) or 'is no store' in str(error) or 'is another' in str(error), what
        else:
            mended += 1
            for name, values in all_of(store).items():
                np.testing.assert_array_equal(values, truth[name], f'{what}, mended: {name}')
    assert reported > 25 and mended > 4, (reported, mended)


def test_a_chunk_of_another_block_array_or_store_is_no_value(whole, tmp_path):
    """Each is right for Zarr."""
    other = tmp_path / 'other.zarr'
    many.run(plan_of(20, 5), TAKE, store=other, size=6)
    force, damping = 'load.normal_force_n/c/1', 'dynamics.damping_ratio/c/1'
    for at, (source, name, target) in enumerate([(whole, 'load.normal_force_n/c/2', force), (whole, damping, force), (other, force, force), (other, 'status/c/1', 'digest/c/1/0')]):
        (tmp_path / str(at)).mkdir()
        store = damaged(whole, tmp_path / str(at), lambda store: shutil.copy(source / name, store / target))  # noqa: B023
        with pytest.raises(Error, match=r'values of \S+ are damaged or missing'):
            digest(many.open(store))
        assert digest(many.run(plan_of(20), TAKE, store=store)) == digest(many.open(whole))


def test_a_status_that_is_none_is_reported(failing, tmp_path):
    store = damaged(failing[1], tmp_path, lambda store: None)
    import zarr

    zarr.open_group(store)['status'][5] = 65
    for call in (many.failures, lambda store: many.counts(many.open(store)), lambda store: many.case_of(store, 5)):
        with pytest.raises(Error, match='values of status are damaged'):
            call(store)


def test_variants_without_a_number_are_no_damage(tmp_path):
    """All of a block, which is NaN throughout: the run after has nothing to do, also in a store whose empty chunks were not written."""
    plan = many.Plan.table(PLAN.base, {'dynamics.damping_ratio': [0.1, 0.1, -1, -1]})
    store, seen = tmp_path / 'x.zarr', []
    many.run(plan, TAKE, store=store, size=2)
    for file in (WORST, 'sweep.dynamic_factor/c/{}/0'):
        os.remove(store / file.format(1))
        data = many.run(plan, TAKE, store=store, progress=lambda done, *_: seen.append(done))
        assert np.isnan(data[TAKE[0]].values).tolist() == [False, False, True, True]
    assert seen == [4, 4]


def attributes(**changed):
    def harm(store):
        told = json.loads((store / 'zarr.json').read_text())
        told['attributes']['gearsweep'].update(changed)
        (store / 'zarr.json').write_text(json.dumps(told))

    return harm


@pytest.mark.parametrize(('match', 'harm'), [
    ('status is damaged or missing', lambda store: os.remove(store / 'status/zarr.json')),
    ('status is damaged or missing', lambda store: os.truncate(store / 'status/zarr.json', 0)),
    ('or its zarr.json is damaged', lambda store: os.truncate(store / 'zarr.json', 0)),
    ('sweep.dynamic_factor is damaged or missing', lambda store: shutil.rmtree(store / 'sweep.dynamic_factor')),
    ('message is damaged or missing', lambda store: shutil.rmtree(store / 'message')),
    ('rpm is damaged or missing', lambda store: os.truncate(store / 'rpm/c/0', 0)),
    ('rpm is damaged or missing', lambda store: os.remove(store / 'rpm/c/0')),
    ('zarr.json is damaged', attributes(size=0)), ('zarr.json is damaged', attributes(plan=3)), ('zarr.json is damaged', attributes(names=None)),
    ('zarr.json is damaged', attributes(n=19)), ('zarr.json is damaged', attributes(folder='elsewhere')),
])  # fmt: skip
@pytest.mark.filterwarnings('ignore:Object at')
def test_a_store_whose_descriptions_are_damaged_is_reported(whole, tmp_path, match, harm):
    store = damaged(whole, tmp_path, harm)
    for call in (many.open, many.failures, lambda store: many.run(plan_of(20), TAKE, store=store), lambda store: many.case_of(store, 1)):
        with pytest.raises(Error, match=f'cannot read .*x.zarr: .*{match}') as caught:
            call(store)
        assert caught.value.code == Code.FILE


def test_a_store_that_may_not_be_read_is_reported_as_such(whole, monkeypatch):
    import zarr

    def refused(*_, **__):
        raise PermissionError(13, 'Permission denied')

    monkeypatch.setattr(zarr, 'open_group', refused)
    with pytest.raises(Error, match=r'cannot read .*x.zarr: Permission denied$'):
        many.open(whole)


def test_values_are_read_as_they_are_asked_for(whole):
    """By any index, as NumPy has it of all."""
    curves = many.open(whole)[TAKE[1]]
    expected = many.open(whole)[TAKE[1]].values
    for key in (3, (slice(None, None, -2), 4), ([1, 7, 19], slice(2, 5)), (slice(5, 8), [0, 3]), (-1, -1), (slice(3, 3),)):
        np.testing.assert_array_equal(many.open(whole)[TAKE[1]][key].values, expected[key])
    np.testing.assert_array_equal(curves.isel(variant=expected[:, 0] > np.median(expected[:, 0])), expected[expected[:, 0] > np.median(expected[:, 0])])


def test_a_store_that_cannot_be_made_leaves_nothing(tmp_path):
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    try:
        resource.setrlimit(resource.RLIMIT_FSIZE, (100, before[1]))
        with pytest.raises(Error, match=r'cannot write .*x.zarr: ') as caught:
            many.run(plan_of(4), TAKE, store=tmp_path / 'x.zarr')
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert caught.value.code == Code.FILE and not list(tmp_path.iterdir())


def test_a_scheduler_that_dies_is_reported_and_what_is_there_goes_on(expected, tmp_path):
    distributed = pytest.importorskip('distributed')
    store, file = tmp_path / 'x.zarr', tmp_path / 'scheduler.json'
    environment = os.environ | {'PYTHONPATH': os.pathsep.join([*PLACES, os.environ.get('PYTHONPATH', '')]).rstrip(os.pathsep)}
    quiet = dict(stderr=subprocess.DEVNULL, stdout=subprocess.DEVNULL, env=environment, cwd=tmp_path)
    command = [sys.executable, '-m', 'distributed.cli.dask_scheduler', '--host', '127.0.0.1', '--port', '0', '--no-dashboard']
    scheduler = subprocess.Popen([*command, '--scheduler-file', file], **quiet)
    worker = subprocess.Popen([sys.executable, '-m', 'distributed.cli.dask_worker', '--scheduler-file', file, '--nthreads', '1', '--no-nanny',
                               '--no-dashboard', '--death-timeout', '20'], **quiet)  # fmt: skip
    options = dict(reduce=worker_faults.slow, store=store, size=8)
    try:
        until = time.monotonic() + 30
        while not file.exists() and time.monotonic() < until:
            time.sleep(0.05)
        with distributed.Client(scheduler_file=str(file), timeout=20, set_as_default=False) as client:
            with pytest.raises(Error, match=r'the scheduler is gone|accepts no work') as caught:
                many.run(PLAN, TAKE, executor=client, progress=lambda done, total, failed: done >= 16 and scheduler.kill(), **options)
            assert caught.value.code == Code.INTERRUPTED
    finally:
        for process in (scheduler, worker):
            process.kill()
            process.wait()
    done = many.counts(many.open(store))
    assert done['ok'] >= 16 and done['pending'] > 0
    assert digest(many.run(PLAN, TAKE, **options)) == digest(expected)


def test_a_worker_with_another_kernel_is_refused(monkeypatch):
    """Its bits would be others. A name that no kernel has, as any of them may be that of this processor."""
    version, _ = many.rows.build_id()
    monkeypatch.setattr(many.rows, 'build_id', lambda: (version, 'Another'))
    with pytest.raises(Error, match=r'a worker has the OpenBLAS kernel Another, this process .*set OPENBLAS_CORETYPE'):
        many.run(plan_of(4), TAKE)


def test_a_script_without_its_guard_is_reported(tmp_path):
    """Its processes read the script again, and would start processes themselves."""
    script = tmp_path / 'bare.py'
    script.write_text(WHOLE.replace("if __name__ == '__main__':", 'if True:'))
    done = subprocess.run([sys.executable, script, tmp_path / 'x.zarr'], capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 1 and "processes end as they start: put the lines of the script below if __name__" in done.stderr


def test_a_task_that_cannot_be_sent_is_reported():
    with pytest.raises(Error, match=r'reduce: cannot be sent to other processes: .*lambda'):
        many.run(plan_of(4), TAKE, reduce=lambda study: {'x': 1}, executor=1)


@pytest.mark.parametrize('given', ['two', 2.5, object()])
def test_what_is_no_executor_is_reported(given):
    with pytest.raises(TypeError, match='executor: must be an Executor'):
        many.run(plan_of(4), TAKE, executor=given)
    with pytest.raises(Error, match='executor = 0: must be a number of processes'):
        many.run(plan_of(4), TAKE, executor=0)
