"""Ctrl-C, progress, and runs that go on from where they were interrupted."""

import os
import signal
import subprocess
import sys
import threading
import time
import warnings

import pytest
from conftest import GEARED, PRESCRIBED, bits

import gearsweep
from gearsweep import Case, Code, Error, _watch
from gearsweep.study import attempt

# Some 20 000 points, many of them with loss of contact, that follow each other: half a minute.
LONG = Case(PRESCRIBED).changed(
    case={'tasks': ['sweep']},
    dynamics={'damping_ratio': 0.01},
    relief={'amount_um': [0, 2, 15]},
    sweep={'rpm_step': 2, 'load_rpm': None},
)
BRANCHES = LONG.changed(branches={'first': 2000, 'last': 20000, 'seeds': 1000, 'most_periods': 8})
SHORT = LONG.changed(sweep={'rpm_first': 5000, 'rpm_last': 9000, 'rpm_step': 50})


@pytest.fixture(autouse=True)
def heeds_ctrl_c():
    """As in a terminal, also where the tests run in the background and Ctrl-C is ignored."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


def end_by_ctrl_c(seconds, action):
    """Ctrl-C, as the terminal sends it, so many seconds after the action has begun; returns the seconds that it took to end."""
    sent = []

    def send():
        sent.append(time.monotonic())
        os.kill(os.getpid(), signal.SIGINT)

    timer = threading.Timer(seconds, send)
    with pytest.raises(KeyboardInterrupt):
        # On a busy machine it comes as early as the timer's start.
        timer.start()
        action()
        timer.join()
        time.sleep(60)  # where the action was faster than the signal
    ended = time.monotonic()
    timer.join()
    return ended - sent[0]


def test_ctrl_c_is_not_lost_while_a_study_is_freed(monkeypatch):
    """Python drops what a finalizer raises: sent from within it, the signal comes nowhere else the first time."""
    from gearsweep import _library

    free = _library._flat.gs_free

    class Flat:
        def __getattr__(self, name):
            return getattr(_flat, name)

        def gs_free(self, address):
            free(address)
            if not freed:
                freed.append(address)
                signal.raise_signal(signal.SIGINT)

    freed, _flat, study = [], _library._flat, gearsweep.run(SHORT)
    monkeypatch.setattr(_library, '_flat', Flat())
    with pytest.raises(KeyboardInterrupt):
        del study
        time.sleep(60)
    assert freed


MARCHED = LONG.changed(numerics={'steady_state': 'march'}, sweep={'direction': 'each'})
# Many seconds in which no operating point ends.
GRID = Case(GEARED).changed(section={'elements_across': 60})


@pytest.mark.parametrize(
    ('case', 'task'),
    [(LONG, 'sweep'), (LONG, 'optimum'), (MARCHED, 'sweep'), (LONG, 'hysteresis'), (LONG, 'poincare'), (LONG, 'attractors'), (BRANCHES, 'branches'), (GRID, 'modal'), (GRID, 'mesh')],
    ids=['sweep', 'optimum', 'march', 'hysteresis', 'poincare', 'attractors', 'branches', 'modes', 'stiffness'],
)
def test_ctrl_c_ends_within_a_second(case, task):
    took = end_by_ctrl_c(0.5, lambda: gearsweep.run(case, task))
    # A second, and what a busy machine adds.
    assert took < 5, took


@pytest.mark.parametrize(('task', 'keys'), [('poincare', {'settling_periods': 9_999_999}), ('stability', {'rpm': 7, 'damping_count': 99_999})])
def test_nothing_goes_on_in_the_background(task, keys):
    """Some 10 million mesh periods, and 100 000 damping ratios: minutes of work that end with the run."""
    end_by_ctrl_c(0.5, lambda: gearsweep.run(LONG.changed(**{task: keys}), task))
    deadline = time.monotonic() + 20
    while any(isinstance(thread, _watch._Worker) for thread in threading.enumerate()):
        assert time.monotonic() < deadline
        time.sleep(0.05)


def test_a_file_that_cannot_be_kept_is_told_before_the_run(tmp_path):
    for path in (tmp_path / 'none' / 'x', tmp_path):
        with pytest.raises(Error, match='cannot write') as caught:
            gearsweep.run(LONG, keep=path, progress=lambda done, total: pytest.fail('the run had begun'))
        assert caught.value.code == Code.FILE


def test_what_could_not_be_kept_in_the_end_is_told_with_the_interruption(tmp_path):
    """As where a disk becomes full meanwhile: here the folder is gone."""
    folder = tmp_path / 'gone'
    folder.mkdir()

    def stop(done, total):
        folder.rmdir()
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt) as caught:
        gearsweep.run(LONG, progress=stop, keep=folder / 'kept')
    assert 'it is not kept: cannot write to the folder' in str(caught.value.__cause__)
    folder.mkdir()
    study, error, _ = attempt(LONG, progress=stop, keep=folder / 'kept')
    assert error.code == Code.INTERRUPTED and 'it is not kept: cannot write' in str(error)
    assert 'stopped' in study.sweep.status


def test_the_time_left_counts_from_what_was_taken_over(monkeypatch, capsys):
    """Of 1000 points 700 were there after 10 s; the next 100 take 2 s, so that the last 200 take 4 s."""
    now = iter([0.0, 10.0, 10.0, 12.0])
    monkeypatch.setattr(_watch.time, 'monotonic', lambda: next(now))
    line = _watch.Line()
    line(700, 1000)
    line(800, 1000)
    assert capsys.readouterr().err.split('\r')[-1].strip() == '800 of 1000 points, 80 %, 4 s left'


def test_the_interpreter_ends_while_a_call_that_nobody_waits_for_goes_on(tmp_path):
    """By the signal, as Python ends after Ctrl-C, and not in the middle of libraries that are gone."""
    script = tmp_path / 'ends.py'
    script.write_text(
        'import os, signal, sys, threading\n'
        'import gearsweep\n'
        'signal.signal(signal.SIGINT, signal.default_int_handler)\n'
        'threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT)).start()\n'
        "gearsweep.run(gearsweep.Case(sys.stdin.read()), 'modal')\n"
    )
    ended = subprocess.run([sys.executable, script], input=GRID.text, text=True, capture_output=True, check=False)
    assert ended.returncode == -signal.SIGINT, ended.stderr


def test_progress_counts_up_to_the_whole():
    seen = []
    with warnings.catch_warnings():
        warnings.simplefilter('ignore')
        sweep = gearsweep.run(SHORT, progress=lambda done, total: seen.append((done, total))).sweep
    done = [one for one, _ in seen]
    assert done == sorted(done) and len(set(done)) == len(done)
    assert {total for _, total in seen} == {sweep.status.size} and done[-1] == sweep.status.size


def test_an_exception_in_the_callback_comes_out():
    def stop(done, total):
        raise RuntimeError('enough')

    with pytest.raises(RuntimeError, match=r'^enough$'):
        gearsweep.run(LONG, progress=stop)


@pytest.mark.filterwarnings('ignore::gearsweep.PartialWarning')
@pytest.mark.parametrize('direction', ['both', 'up', 'down', 'each'])
def test_an_interrupted_run_goes_on_to_the_same_bits(direction, tmp_path):
    case = SHORT.changed(sweep={'direction': direction})
    whole = gearsweep.run(case)
    kept = tmp_path / 'kept'

    def stop(done, total):
        if done > total // 3:
            raise KeyboardInterrupt

    # Slow enough for the callback to be asked in between.
    longer = LONG.changed(sweep={'direction': direction})
    with pytest.raises(KeyboardInterrupt):
        gearsweep.run(longer, progress=stop, keep=kept)
    assert kept.exists()
    with pytest.raises(Error, match='is of another case') as caught:
        gearsweep.run(case, resume=kept)
    assert caught.value.code == Code.FILE

    kept.unlink()
    end_by_ctrl_c(0.02, lambda: gearsweep.run(case, threads=1, keep=kept))
    if kept.exists():
        again = gearsweep.run(case, resume=kept)
        assert bits(again) == bits(whole)
        assert not kept.exists(), 'what is done needs no checkpoint'


def test_a_file_that_is_no_checkpoint(tmp_path):
    (tmp_path / 'x').write_text('hello')
    with pytest.raises(Error, match=r'cannot resume from .*: is no checkpoint'):
        gearsweep.run(SHORT, resume=tmp_path / 'x')
    with pytest.raises(Error, match='cannot read'):
        gearsweep.run(SHORT, resume=tmp_path / 'y')


def test_a_bar_without_tqdm(monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, 'tqdm.auto', None)
    with warnings.catch_warnings():
        warnings.simplefilter('ignore')
        gearsweep.run(SHORT, progress=True)
    assert '243 of 243 points, 100 %' in capsys.readouterr().err


def test_a_bar_by_tqdm(monkeypatch):
    class Bar:
        def __init__(self, **options):
            self.n = 0
            self.total = None
            bars.append(self)

        def update(self, more):
            assert more >= 0
            self.n += more

        def close(self):
            self.closed = True

    bars = []
    fake = type(sys)('tqdm.auto')
    fake.tqdm = Bar
    monkeypatch.setitem(sys.modules, 'tqdm', type(sys)('tqdm'))
    monkeypatch.setitem(sys.modules, 'tqdm.auto', fake)
    with warnings.catch_warnings():
        warnings.simplefilter('ignore')
        gearsweep.run(SHORT, progress=True)
    assert len(bars) == 1 and bars[0].n == bars[0].total == 243 and bars[0].closed


def test_time_left():
    assert [_watch._duration(s) for s in (5, 99, 120, 7200)] == ['5 s', '99 s', '2 min', '2.0 h']


def test_callers_in_other_threads_are_not_disturbed():
    found = []
    thread = threading.Thread(target=lambda: found.append(gearsweep.run(SHORT.changed(relief={'amount_um': 0}))))
    thread.start()
    thread.join()
    assert found[0].sweep.rpm.size == 81


def test_the_module_keeps_what_is_done(tmp_path, program):
    """`python -m gearsweep` and the program go on from each other's checkpoints."""
    LONG.changed(sweep={'rpm_step': 10}).write(tmp_path / 'long.nml')
    ours = [sys.executable, '-m', 'gearsweep', 'long.nml', '--no-pictures', '--quiet']
    running = subprocess.Popen([*ours, '--out', 'pieces'], cwd=tmp_path, stderr=subprocess.PIPE, text=True)
    while not (tmp_path / 'pieces').exists():
        time.sleep(0.01)
    time.sleep(0.2)
    running.send_signal(signal.SIGTERM)
    _, said = running.communicate(timeout=60)
    assert running.returncode == 130 and 'gearsweep: interrupted; the same command with --resume' in said
    assert (tmp_path / 'pieces/long.checkpoint').exists()
    assert ',stopped,' in (tmp_path / 'pieces/long.sweep.csv').read_text()
    assert program('long.nml', '--out', 'pieces', '--resume', '--quiet', cwd=tmp_path).returncode in (0, 4)
    assert program('long.nml', '--out', 'whole', '--quiet', cwd=tmp_path).returncode in (0, 4)
    assert (tmp_path / 'pieces/long.sweep.csv').read_bytes() == (tmp_path / 'whole/long.sweep.csv').read_bytes()
    assert not (tmp_path / 'pieces/long.checkpoint').exists()


def test_the_module_reads_standard_input(tmp_path):
    text = SHORT.changed(relief={'amount_um': 0}).text
    for words, name in (([], 'stdin'), (['--name', 'pair'], 'pair')):
        done = subprocess.run(
            [sys.executable, '-m', 'gearsweep', '-', '--no-pictures', *words],
            cwd=tmp_path,
            input=text,
            capture_output=True,
            text=True, check=False,
        )
        assert done.returncode == 0, done.stderr
        assert (tmp_path / f'results/{name}.sweep.csv').exists()
