"""The tests as mutants meet them: quickest first, each with a limit, and only those that reach the change."""

import contextlib
import hashlib
import json
import os
import re
import signal
import subprocess
import threading
from dataclasses import dataclass, field

import instrument

# Of the Python tests, those that look at pictures see only changes in Python; and a
# test that runs every command of the README takes longer than all others together. Scripts that build on their
# own have no mutant to look at.
PICTURES = ('test_plots', 'pictures.md')
LEFT_OUT = ('test_nothing_on_the_page_is_old',)
# The walk over all keys takes longer than all other suites together: it sees mutants of the rooms that read keys.
WALK, WALKED = 'inputs', ('case', 'tasks')
SCRIPTS_APART = ('test_lint', 'test_python', 'test_sanitize', 'test_wheel', 'test_callers', 'test_fpm', 'test_matrix', 'test_memory')


@dataclass
class Test:
    """One test program, script or file of Python tests."""

    name: str
    kind: str
    seconds: float = 0.0
    code: int = 0
    fails: list = field(default_factory=list)
    reached: set = field(default_factory=set)

    def fits(self, room):
        """Could it see a change in this room?"""
        if self.name == WALK:
            return room in WALKED
        if self.kind == 'suite':
            return room not in ('app', 'python')
        if self.kind == 'pytest':
            return room == 'python' or not any(word in self.name for word in PICTURES)
        if self.kind == 'callers':
            return room in ('study', 'results', 'api', 'app')
        return room != 'python'


def all_tests(root):
    suites = re.findall(r"suite_t\('(\w+)'", (root / 'test/main.f90').read_text())
    scripts = sorted(path.stem for path in (root / 'test/cases').glob('test_*.sh') if path.stem not in SCRIPTS_APART)
    python = [*root.glob('python/tests/*/test_*.py'), *root.glob('validation/tests/test_*.py'), *root.glob('doc/*.md')]
    said = (root / 'test/cases/test_python.sh').read_text()
    pages = [str(path.relative_to(root)) for path in sorted(python) if path.suffix == '.py' or f'doc/{path.name}"' in said]
    return (
        [Test(name, 'suite') for name in suites]
        + [Test(name, 'script') for name in scripts]
        + [Test(name, 'pytest') for name in pages]
        + [Test('docstrings', 'pytest'), Test('test_callers', 'callers')]
    )


def environment(tree):
    unset = ('MAKEFLAGS', 'PYTHONHOME')
    found = {name: value for name, value in os.environ.items() if name not in unset}
    found |= {
        'OMP_NUM_THREADS': '1', 'OPENBLAS_NUM_THREADS': '1', 'GFORTRAN_UNBUFFERED_ALL': '1', 'PYTHONDONTWRITEBYTECODE': '1',
        'GEARSWEEP_PROGRAM': str(tree.program), 'PYTHONPATH': f'{tree.package}:{tree.root}', 'MPLCONFIGDIR': str(tree.root / 'build'),
    }
    return found


def words_of(test, tree):
    """Its command and the folder in which it runs."""
    if test.kind == 'suite':
        return [str(tree.check), test.name], tree.root
    if test.kind in ('script', 'callers'):
        return ['sh', str(tree.root / 'test/cases' / f'{test.name}.sh'), str(tree.program)], tree.root
    what = ['--pyargs', 'gearsweep'] if test.name == 'docstrings' else [str(tree.root / test.name)]
    apart = [word for name in LEFT_OUT for word in ('-k', f'not {name}')] if test.name.startswith('validation') else []
    return [str(tree.root / '.venv/bin/python'), '-m', 'pytest', '-x', '-q', '--tb=line', '-p', 'no:cacheprovider',
            '--doctest-modules', '--doctest-glob=*.md', *apart, *what], tree.work


# Seconds of one process, kB of memory, blocks of a file: tests of long files make them of 5 GB, and set limits of their own.
LIMITS = 'ulimit -t {seconds} && ulimit -v {memory} && ulimit -S -f 12000000 && exec "$@"'


def run(test, tree, states, stop_early=True):
    """Runs a test; returns (code, lines that tell of failures, seconds of processor)."""
    words, folder = words_of(test, tree)
    seconds = int(10 * test.seconds + 5) if test.seconds else 1800
    words = ['sh', '-c', LIMITS.format(seconds=seconds, memory=6_000_000), 'sh', *words]
    process = subprocess.Popen(words, cwd=folder, env=environment(tree) | {'GEARSWEEP_MUTANTS': str(states)}, stdin=subprocess.DEVNULL, text=True,
                               stdout=subprocess.PIPE, stderr=subprocess.STDOUT, errors='replace', start_new_session=True)

    def end():
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)

    # The machine may be busy, so that the limit that matters is that of processor time.
    clock = threading.Timer(30 * test.seconds + 60 if test.seconds else 3600, end)
    clock.start()
    fails = []
    try:
        for line in process.stdout:
            if line.lstrip().startswith(('FAILED', 'E ')):
                fails.append(line.strip()[:160])
                if stop_early and fails[-1] not in test.fails:
                    break
    finally:
        clock.cancel()
        end()
        process.stdout.close()
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    return process.returncode, fails, usage.ru_utime + usage.ru_stime


def catches(test, tree, states):
    """What a mutant's test says: why it is caught, or nothing."""
    code, fails, _ = run(test, tree, states)
    new = [line for line in fails if line not in test.fails]
    if new:
        return new[0]
    return f'ends with code {code}' if code != test.code else ''


# --- what is known of the tests without a mutant ------------------------------


class Known:
    """What each test does without a mutant: how it ends, how long it takes and which mutants it reaches, asked once for each
    choice of mutants and kept below build/."""

    def __init__(self, file, stamp, count, say):
        self.file, self.stamp, self.count, self.say = file, stamp, count, say
        kept = json.loads(file.read_text()) if file.exists() else {}
        self.entries = kept['tests'] if kept.get('stamp') == stamp else {}
        self.lock = threading.Lock()

    def ask(self, test, tree, awaited):
        with self.lock:
            entry = self.entries.get(test.name)
        if entry is None:
            states = tree.root / f'build/awaited-{os.path.basename(test.name)}'
            states.write_bytes(instrument.states(count=self.count))
            # Without a limit, as its time is what is asked for.
            code, fails, seconds = run(test, tree, states, stop_early=False)
            entry = {'code': code, 'fails': fails, 'seconds': seconds,
                     'reached': sorted(instrument.reached(states.read_bytes(), self.count))}
            self.say(f'{test.name}: {seconds:.0f} s, reaches {len(entry["reached"])} of {awaited}' + (f', ends with {code}' if code else ''))
            with self.lock:
                self.entries[test.name] = entry
                self.file.write_text(json.dumps({'stamp': self.stamp, 'tests': self.entries}))
        test.code, test.fails, test.seconds = entry['code'], entry['fails'], entry['seconds']
        test.reached = set(entry['reached'])


def fingerprint(root, folders):
    found = hashlib.sha256()
    for folder in folders:
        for path in sorted((root / folder).glob('**/*')):
            if path.is_file() and '__pycache__' not in path.parts:
                found.update(str(path.relative_to(root)).encode() + path.read_bytes())
    return found.hexdigest()
