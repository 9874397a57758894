"""The tests as mutants meet them: quickest first, each with a limit, and only those that reach the change."""

import contextlib
import gzip
import hashlib
import json
import os
import re
import shutil
import signal
import subprocess
import threading
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field

import build

# Of the Python tests, those that look at pictures see only changes in Python; and a
# test that runs every command of the README takes longer than all others together. Scripts that build on their
# own have no mutant to look at.
PICTURES = ('test_plots', 'pictures.md')
LEFT_OUT = ('test_nothing_on_the_page_is_old',)
# The walk over all keys takes longer than all other suites together, many times so with line coverage: it sees
# mutants of the rooms that read keys, whatever the lines, as the last test.
WALK, WALKED = 'inputs', ('case', 'tasks')
SCRIPTS_APART = ('test_python', 'test_sanitize', 'test_wheel', 'test_callers', 'test_fpm', 'test_matrix', 'test_memory')


@dataclass
class Test:
    """One test program, script or file of Python tests."""

    name: str
    kind: str
    seconds: float = 0.0
    code: int = 0
    fails: list = field(default_factory=list)
    reached: dict = field(default_factory=dict)

    def reaches(self, mutant, lines):
        """Does it run one of these changed lines? Lines are known by their text, so that what was measured
        once holds while others move. Those without code, as constants have, and new ones count as reached
        where anything of their file is."""
        if self.kind != 'suite' or self.name == WALK:
            return True
        known = self.reached.get(mutant.file)
        if known is None:
            return False
        own = [line for line in map(short, lines) if line in known]
        return not own or any(known[line] for line in own)

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
    scripts = sorted(path.stem for path in (root / 'test').glob('test_*.sh') if path.stem not in SCRIPTS_APART)
    python = [*root.glob('python/tests/test_*.py'), *root.glob('validation/tests/test_*.py'), *root.glob('doc/*.md')]
    said = (root / 'test/test_python.sh').read_text()
    pages = [str(path.relative_to(root)) for path in sorted(python) if path.suffix == '.py' or f'doc/{path.name}"' in said]
    return (
        [Test(name, 'suite') for name in suites]
        + [Test(name, 'script') for name in scripts]
        + [Test(name, 'pytest') for name in pages]
        + [Test('docstrings', 'pytest'), Test('test_callers', 'callers')]
    )


class Tree:
    """A copy of the checkout that one worker may change."""

    def __init__(self, root, folder, venv):
        self.root = folder
        shutil.rmtree(folder, ignore_errors=True)
        listed = subprocess.run(['git', 'ls-files', '-co', '--exclude-standard'], cwd=root, capture_output=True, text=True, check=True)
        for name in listed.stdout.split('\n'):
            if name and (root / name).is_file():
                (folder / name).parent.mkdir(parents=True, exist_ok=True)
                shutil.copy2(root / name, folder / name)
        (folder / '.venv').symlink_to(venv)
        self.bin = folder / 'build/run'
        self.package = folder / 'build/package'
        self.work = folder / 'build/work'
        for place in (self.bin, self.work):
            place.mkdir(parents=True)
        (self.work / 'data').symlink_to(folder / 'data')
        self.check, self.program = self.bin / 'check-release', self.bin / 'gearsweep'
        shutil.copytree(folder / 'python/gearsweep', self.package / 'gearsweep')
        # As meson.build installs them for the panel.
        shutil.copytree(folder / 'data', self.package / 'gearsweep/panel/cases')
        # What the scripts would build is there already.
        with open(folder / 'app/setup.sh', 'a') as setup:
            setup.write(INSTALLED.format(build=folder / 'build'))

    def install(self, base, sources, changed):
        """Library and modules as app/install.sh leaves them."""
        target = self.root / 'build/installed'
        shutil.rmtree(target, ignore_errors=True)
        include = target / 'include/gearsweep'
        include.mkdir(parents=True)
        (target / 'lib').mkdir()
        (target / 'bin').mkdir()
        for module in base.glob('*.mod'):
            shutil.copy2(module, include)
        for object in changed.values():
            for module in object.parent.glob('*.mod'):
                shutil.copy2(module, include)
        shutil.copy2(self.program, target / 'bin')
        objects = [changed.get(file, build.object_of(base, file)) for file in sources.order if file.startswith('src/')]
        build.command(['ar', 'rcs', str(target / 'lib/libgearsweep.a'), *map(str, objects), *map(str, base.glob('*.c.o'))])


# Appended to the copy of app/setup.sh.
INSTALLED = """
builds_anew=no
build_package() {{ :; }}
build_program() {{ :; }}
run_fpm() {{ mkdir -p "$prefix" && cp -r "{build}/installed/." "$prefix/"; }}
"""


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
        return ['sh', str(tree.root / 'test' / f'{test.name}.sh'), str(tree.program)], tree.root
    what = ['--pyargs', 'gearsweep'] if test.name == 'docstrings' else [str(tree.root / test.name)]
    apart = [word for name in LEFT_OUT for word in ('-k', f'not {name}')] if test.name.startswith('validation') else []
    return [str(tree.root / '.venv/bin/python'), '-m', 'pytest', '-x', '-q', '--tb=line', '-p', 'no:cacheprovider',
            '--doctest-modules', '--doctest-glob=*.md', *apart, *what], tree.work


# Seconds, until a test has been timed.
GUESSES = {WALK: 250, 'suite': 5, 'script': 30, 'pytest': 20, 'callers': 120}
# Seconds of one process, kB of memory, blocks of a file.
LIMITS = 'ulimit -t {seconds} && ulimit -v {memory} && ulimit -f 400000 && exec "$@"'


def run(test, tree, stop_early=True, more=None):
    """Runs a test; returns (code, lines that tell of failures, seconds of processor)."""
    words, folder = words_of(test, tree)
    seconds = int(3 * test.seconds + 10) if test.seconds else 1800
    words = ['sh', '-c', LIMITS.format(seconds=seconds, memory=6_000_000), 'sh', *words]
    process = subprocess.Popen(words, cwd=folder, env=environment(tree) | (more or {}), stdin=subprocess.DEVNULL, text=True,
                               stdout=subprocess.PIPE, stderr=subprocess.STDOUT, errors='replace', start_new_session=True)

    def end():
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)

    # The machine may be busy, so that the limit that matters is that of processor time.
    clock = threading.Timer(30 * test.seconds + 300 if test.seconds else 3600, end)
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


def catches(test, tree):
    """What a mutant's test says: why it is caught, or nothing."""
    code, fails, _ = run(test, tree)
    new = [line for line in fails if line not in test.fails]
    if new:
        return new[0]
    return f'ends with code {code}' if code != test.code else ''


# --- what is known of the tests without a mutant ------------------------------


def short(line):
    """A line of a source as it is kept."""
    return hashlib.sha256(' '.join(line.split()).encode()).hexdigest()[:10]


def fingerprint(root, folders):
    found = hashlib.sha256()
    for folder in folders:
        for path in sorted((root / folder).glob('**/*')) if (root / folder).is_dir() else [root / folder]:
            if path.is_file() and '__pycache__' not in path.parts:
                found.update(str(path.relative_to(root)).encode() + path.read_bytes())
    return found.hexdigest()


class Known:
    """What each test does without a mutant, kept below build/ from run to run: which lines of src it runs,
    measured again where its own source changes, and how it ends, which is asked again where anything
    changes, and only of tests that say they caught something."""

    def __init__(self, scratch, tree, sources, say, workers):
        self.scratch, self.tree, self.sources, self.say, self.workers = scratch, tree, sources, say, workers
        self.file = scratch / 'tests.json'
        self.entries = json.loads(self.file.read_text()) if self.file.exists() else {}
        self.now = fingerprint(tree.root, ['src', 'app', 'data', 'doc', 'include', 'python', 'test', 'validation'])
        self.lock = threading.Lock()

    def prepare(self, tests):
        with ThreadPoolExecutor(self.workers) as pool:
            for done in [pool.submit(self._reach, test) for test in tests if test.kind == 'suite' and test.name != WALK]:
                done.result()
        for test in tests:
            entry = self.entries.setdefault(test.name, {})
            if 'seconds' not in entry:
                entry |= {'now': '', 'code': 0, 'fails': [], 'seconds': GUESSES.get(test.name, GUESSES[test.kind])}
            test.code, test.fails, test.seconds = entry['code'], entry['fails'], entry['seconds']
        self._keep()

    def _keep(self):
        self.file.write_text(json.dumps(self.entries))

    def _reach(self, test):
        """Fills in which lines the suite runs, measured again where its own source has changed."""
        own = fingerprint(self.tree.root, [f'test/test_{test.name}.f90'])
        with self.lock:
            entry = self.entries.setdefault(test.name, {})
            if entry.get('own') != own:
                self._build_for_coverage()
        if entry.get('own') != own:
            reached = self._lines_run(test)
            with self.lock:
                entry |= {'own': own, 'reached': reached}
                self._keep()
        test.reached = entry['reached']

    def is_sure(self, test):
        """Was the test asked as things are? If not, it is now, and what it caught must be looked at again."""
        with self.lock:
            entry = self.entries[test.name]
            if entry['now'] == self.now:
                return True
            self._ask(test)
            test.code, test.fails, test.seconds = entry['code'], entry['fails'], entry['seconds']
            self._keep()
            return False

    def _ask(self, test):
        # Without a limit, as its time is what is asked for.
        code, fails, seconds = run(Test(test.name, test.kind), self.tree, stop_early=False)
        if code:
            self.say(f'{test.name} fails without a mutant: {fails[:1] or code}')
        self.entries[test.name] |= {'now': self.now, 'code': code, 'fails': fails, 'seconds': seconds}

    def _build_for_coverage(self):
        base = self.scratch / 'coverage'
        stamp = base / 'stamp'
        if not stamp.exists() or stamp.read_text() != self.now:
            self.say('builds for line coverage')
            build.compile_all(self.tree.root, self.sources, build.COVERAGE, base, self.workers)
            build.link(build.TESTS, self.sources, build.COVERAGE, base, base / 'check')
            stamp.write_text(self.now)

    def _lines_run(self, test):
        """The lines of src with code and whether the suite runs them: {file: {line: bool}}."""
        self.say(f'asks which lines {test.name} runs')
        base = self.scratch / 'coverage'
        data, out = (self.scratch / name / test.name for name in ('counts', 'gcov'))
        for folder in (data, out):
            shutil.rmtree(folder, ignore_errors=True)
            folder.mkdir(parents=True)
        subprocess.run([base / 'check', test.name], cwd=self.tree.root, env=environment(self.tree) | {'GCOV_PREFIX': str(data)},
                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False)
        counts = sorted(data.glob('**/src_*.gcda'))
        for path in counts:
            shutil.copy2(base / (path.stem + '.gcno'), path.with_suffix('.gcno'))
        subprocess.run(['gcov', '--json-format', *map(str, counts)], cwd=out, stdout=subprocess.DEVNULL, check=True)
        found = {}
        for path in out.glob('*.gcov.json.gz'):
            for file in json.loads(gzip.decompress(path.read_bytes()))['files']:
                text = (self.tree.root / file['file']).read_text().split('\n')
                lines = {}
                for line in file['lines']:
                    key = short(text[line['line_number'] - 1])
                    lines[key] = lines.get(key, False) or line['count'] > 0
                if any(lines.values()):
                    found[file['file']] = lines
        shutil.rmtree(data)
        shutil.rmtree(out)
        return found
