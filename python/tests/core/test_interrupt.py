"""Ctrl-C, progress, and what an interrupted run leaves."""

import os
import signal
import subprocess
import sys
import threading
import time
import warnings

import numpy as np
import pytest
from conftest import GEARED, PRESCRIBED

import gearsweep
from gearsweep import Case, Code
from gearsweep.core import watch
from gearsweep.core.study import attempt

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
    """Ctrl-C, as the terminal sends it, so many seconds after the action has begun; returns the seconds of the processor that it took to
    end, on which other work on the machine has no influence."""
    sent = []

    def send():
        sent.append(time.process_time())
        os.kill(os.getpid(), signal.SIGINT)

    timer = threading.Timer(seconds, send)
    with pytest.raises(KeyboardInterrupt):
        # On a busy machine it comes as early as the timer's start.
        timer.start()
        action()
        timer.join()
        time.sleep(60)  # where the action was faster than the signal
    ended = time.process_time()
    timer.join()
    return ended - sent[0]


def test_ctrl_c_is_not_lost_while_a_study_is_freed(monkeypatch):
    """Python drops what a finalizer raises: sent from within it, the signal comes nowhere else the first time."""
    from gearsweep.core import library

    free = library._flat.gs_free

    class Flat:
        def __getattr__(self, name):
            return getattr(_flat, name)

        def gs_free(self, address):
            free(address)
            if not freed:
                freed.append(address)
                signal.raise_signal(signal.SIGINT)

    freed, _flat, study = [], library._flat, gearsweep.run(SHORT)
    monkeypatch.setattr(library, '_flat', Flat())
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
    # A second on two processors, and what a slow one adds.
    assert took < 5, took


@pytest.mark.parametrize(('task', 'keys'), [('poincare', {'settling_periods': 9_999_999}), ('stability', {'rpm': 7, 'damping_count': 99_999})])
def test_nothing_goes_on_in_the_background(task, keys):
    """Some 10 million mesh periods, and 100 000 damping ratios: minutes of work that end with the run."""
    end_by_ctrl_c(0.5, lambda: gearsweep.run(LONG.changed(**{task: keys}), task))
    deadline = time.monotonic() + 300
    while any(isinstance(thread, watch._Worker) for thread in threading.enumerate()):
        assert time.monotonic() < deadline
        time.sleep(0.05)


def test_the_time_left_counts_from_what_was_there(monkeypatch, capsys):
    """Of 1000 points 700 were there after 10 s; the next 100 take 2 s, so that the last 200 take 4 s."""
    now = iter([0.0, 10.0, 10.0, 12.0])
    monkeypatch.setattr(watch.time, 'monotonic', lambda: next(now))
    line = watch.Line()
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


def test_an_interrupted_run_has_its_finished_points():
    """With their bits; all others have no number."""
    case = LONG.changed(sweep={'rpm_step': 10, 'direction': 'each'})
    whole, _, _ = attempt(case)

    def stop(done, total):
        raise KeyboardInterrupt

    study, error, cause = attempt(case, progress=stop, waits=True)
    assert error.code == Code.INTERRUPTED and isinstance(cause, KeyboardInterrupt)
    stopped = study.sweep.status == 'stopped'
    assert stopped.any() and not stopped.all() and np.isnan(study.sweep.dynamic_factor[stopped]).all()
    assert (study.sweep.status[~stopped] == whole.sweep.status[~stopped]).all()
    assert study.sweep.dynamic_factor[~stopped].tobytes() == whole.sweep.dynamic_factor[~stopped].tobytes()


GONE = (
    'a single run is no longer resumed from a file: a run that is stopped keeps its finished tables, and a long study goes on from '
    'the store of `gearsweep many`'
)


@pytest.mark.parametrize('name', ['resume', 'keep'])
def test_a_single_run_is_not_resumed(name, tmp_path):
    """The package has no such argument; the calls for other languages refuse any text in theirs."""
    from gearsweep.core import library

    with pytest.raises(TypeError, match=name):
        gearsweep.run(SHORT, **{name: tmp_path / 'kept'})
    files = [b'a.checkpoint' if name == 'resume' else b'', b'a.checkpoint' if name == 'keep' else b'']
    study, info, message = library._flat.gs_run(SHORT.text.encode(), b'', 1, 0, np.zeros(3, dtype=np.intc), *files)
    assert (study, info, message.decode().rstrip()) == (0, Code.INPUT, f'{name} = a.checkpoint: {GONE}')


def test_the_module_refuses_to_resume_as_the_program_does(tmp_path, program):
    SHORT.write(tmp_path / 'short.nml')
    ours = subprocess.run([sys.executable, '-m', 'gearsweep', 'short.nml', '--resume'], cwd=tmp_path, capture_output=True, text=True, check=False)
    theirs = program('short.nml', '--resume', cwd=tmp_path)
    assert (ours.returncode, ours.stderr) == (theirs.returncode, theirs.stderr) == (Code.USAGE, f'gearsweep: --resume: {GONE}; gearsweep --help has more\n')
    assert sorted(path.name for path in tmp_path.iterdir()) == ['short.nml']


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
    assert [watch._duration(s) for s in (5, 99, 120, 7200)] == ['5 s', '99 s', '2 min', '2.0 h']


def test_callers_in_other_threads_are_not_disturbed():
    found = []
    thread = threading.Thread(target=lambda: found.append(gearsweep.run(SHORT.changed(relief={'amount_um': 0}))))
    thread.start()
    thread.join()
    assert found[0].sweep.rpm.size == 81


def test_the_module_keeps_what_is_done(tmp_path):
    LONG.changed(sweep={'rpm_step': 10}).write(tmp_path / 'long.nml')
    ours = [sys.executable, '-m', 'gearsweep', 'long.nml', '--no-pictures', '--quiet']
    running = subprocess.Popen([*ours, '--out', 'pieces'], cwd=tmp_path, stderr=subprocess.PIPE, text=True)
    while not (tmp_path / 'pieces').exists():
        time.sleep(0.01)
    time.sleep(0.2)
    running.send_signal(signal.SIGTERM)
    _, said = running.communicate(timeout=60)
    assert (running.returncode, said) == (130, 'gearsweep: interrupted; the tables have what was computed by then\n')
    assert {path.suffix for path in (tmp_path / 'pieces').iterdir()} == {'.csv'}
    assert ',stopped,' in (tmp_path / 'pieces/long.sweep.csv').read_text()


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
