"""The tests as mutants meet them: quickest first, each with a limit, and only those that reach the change."""

import gzip
import hashlib
import json
import os
import re
import shutil
import signal
import subprocess
import threading
from dataclasses import dataclass, field

import build

# Of the Python tests, those that look at pictures see only changes in Python; and a
# test that runs every command of the README takes longer than all others together.
PICTURES = ('test_plots', 'pictures.md')
LEFT_OUT = ('test_nothing_in_the_readme_is_old',)
SCRIPTS_APART = ('test_python', 'test_sanitize', 'test_wheel', 'test_callers')


@dataclass
class Test:
    """One test program, script or file of Python tests."""

    name: str
    kind: str
    seconds: float = 0.0
    code: int = 0
    fails: list = field(default_factory=list)
    reached: dict = field(default_factory=dict)

    def reaches(self, mutant):
        """Does it run the changed lines? Lines without code, as constants have, count as reached where
        their file is, or where nothing of it is run at all."""
        if self.kind != 'suite':
            return True
        lines = self.reached.get(mutant.file)
        if lines is None:
            return False
        own = [line for line in range(mutant.first_line, mutant.last_line + 1) if str(line) in lines['all']]
        return not own or any(str(line) in lines['run'] for line in own)

    def fits(self, room):
        """Could it see a change in this room?"""
        if self.kind == 'suite':
            return room not in ('app', 'python')
        if self.kind == 'pytest':
            return room == 'python' or not any(word in self.name for word in PICTURES)
        if self.kind == 'callers':
            return room in ('doors', 'app')
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
        'PYTHONPATH_PACKAGE': str(tree.package),
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
        try:
            os.killpg(process.pid, signal.SIGKILL)
        except ProcessLookupError:
            pass

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


def fingerprint(root, folders):
    found = hashlib.sha256()
    for folder in folders:
        for path in sorted((root / folder).glob('**/*')) if (root / folder).is_dir() else [root / folder]:
            if path.is_file() and '__pycache__' not in path.parts:
                found.update(str(path.relative_to(root)).encode() + path.read_bytes())
    return found.hexdigest()


def needs(test):
    if test.kind == 'suite':
        return ['src', 'test']
    if test.kind == 'script':
        return ['src', 'app', 'data', f'test/{test.name}.sh']
    if test.kind == 'callers':
        return ['src', 'app', 'include', 'python/gearsweep', 'test/callers', 'test/test_callers.sh', 'doc/linking.md']
    return ['src', 'app/gearsweep.f90', 'python', 'validation', 'doc', 'data']


def measure(tests, tree, sources, scratch, say, workers):
    """Times, failures without a mutant, and for suites the lines they run; kept until a file changes."""
    known_file = scratch / 'tests.json'
    known = json.loads(known_file.read_text()) if known_file.exists() else {}
    for test in tests:
        now = fingerprint(tree.root, needs(test))
        was = known.get(test.name)
        if not was or was['now'] != now:
            say(f'runs {test.name} without a mutant')
            code, fails, seconds = run(test, tree, stop_early=False)
            if code:
                say(f'{test.name} fails without a mutant: {fails[:1] or code}')
            was = known[test.name] = {'now': now, 'code': code, 'fails': fails, 'seconds': seconds, 'reached': {}}
            if test.kind == 'suite':
                was['reached'] = lines_run(test, tree, sources, scratch, say, workers)
            known_file.write_text(json.dumps(known))
        test.code, test.fails, test.seconds, test.reached = was['code'], was['fails'], was['seconds'], was['reached']


def lines_run(test, tree, sources, scratch, say, workers):
    """The lines of src that a suite runs: {file: {'run': lines, 'all': lines with code}}."""
    base = scratch / 'coverage'
    check = base / 'check'
    stamp = base / 'stamp'
    now = fingerprint(tree.root, ['src', 'test'])
    if not stamp.exists() or stamp.read_text() != now:
        say('builds for line coverage')
        build.compile_all(tree.root, sources, build.COVERAGE, base, workers)
        build.link(build.TESTS, sources, build.COVERAGE, base, check)
        stamp.write_text(now)
    data = scratch / 'counts'
    shutil.rmtree(data, ignore_errors=True)
    data.mkdir()
    subprocess.run([check, test.name], cwd=tree.root, env=environment(tree) | {'GCOV_PREFIX': str(data)},
                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    counts = sorted(data.glob('**/src_*.gcda'))
    for path in counts:
        shutil.copy2(base / (path.stem + '.gcno'), path.with_suffix('.gcno'))
    out = scratch / 'gcov'
    shutil.rmtree(out, ignore_errors=True)
    out.mkdir()
    subprocess.run(['gcov', '--json-format', *map(str, counts)], cwd=out, stdout=subprocess.DEVNULL, check=True)
    found = {}
    for path in out.glob('*.gcov.json.gz'):
        for file in json.loads(gzip.decompress(path.read_bytes()))['files']:
            name = file['file']
            lines = {'run': {}, 'all': {}}
            for line in file['lines']:
                lines['all'][str(line['line_number'])] = 1
                if line['count']:
                    lines['run'][str(line['line_number'])] = 1
            if lines['run']:
                found[name] = lines
    shutil.rmtree(data)
    return found
