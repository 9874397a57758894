"""Puts mutants into copies of the sources, runs the tests that could see each, and reports by room:
what test/mutate.sh runs. Results are kept below build/mutate."""

import argparse
import json
import os
import shutil
import sys
import threading
import time
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import mutants
import trials

import build

ROOT = Path(__file__).resolve().parents[2]
SCRATCH = ROOT / 'build/mutate'
EXPLAINED = ROOT / 'test/mutation/explained.txt'
COUNT = 400
VERDICTS = ('killed', 'explained', 'survived')
NO_MUTANT = ('does not compile', 'same code')


def say(text):
    print(f'{time.strftime("%H:%M:%S")} {text}', flush=True)


def rooms_of(root):
    """The files of each room: {room: {file: text}}."""
    rooms = {folder.name: sorted(folder.glob('**/*.f90')) for folder in sorted((root / 'src').iterdir()) if folder.is_dir()}
    # The module of all calls stands above the rooms and has no statements of its own.
    rooms['app'] = sorted((root / 'app').glob('*.f90'))
    rooms['python'] = sorted((root / 'python/gearsweep').glob('**/*.py'))
    return {room: {str(path.relative_to(root)): path.read_text() for path in paths} for room, paths in rooms.items()}


def shares(rooms, count):
    """How many of the mutants each room gets: in proportion to its lines of code."""
    lines = {room: sum(mutants.code_lines(*item) for item in files.items()) for room, files in rooms.items()}
    exact = {room: count * n / sum(lines.values()) for room, n in lines.items()}
    whole = {room: int(x) for room, x in exact.items()}
    for room in sorted(exact, key=lambda room: whole[room] - exact[room])[: count - sum(whole.values())]:
        whole[room] += 1
    return whole


def explanations():
    """{(file, before, after): why}, from blocks of four lines: file, statement, mutated statement, reason."""
    found = {}
    if EXPLAINED.exists():
        for block in EXPLAINED.read_text().split('\n\n'):
            lines = [line for line in block.split('\n') if line and not line.startswith('#')]
            if lines:
                file, before, after, *why = lines
                found[f'{file}\n{before[2:]}\n{after[2:]}'] = ' '.join(why).strip()
    return found


class Worker:
    """One copy of the checkout, with the programs made from it."""

    def __init__(self, number, base, extension, known=None, within=0.0):
        self.within = within
        self.tree = trials.Tree(ROOT, SCRATCH / f'tree{number}', ROOT / '.venv')
        self.known = known
        self.sources = build.Sources(self.tree.root)
        self.base, self.extension = base, extension
        self.changed = None
        self.restore()

    def restore(self):
        """The programs and the package without a mutant."""
        if self.changed != {}:
            self.changed = {}
            self._link()

    def _link(self):
        build.link(build.TESTS, self.sources, build.RELEASE, self.base, self.tree.check, self.changed)
        self.linked = {'suite'}
        if not self.changed:
            self._link_rest('script')
            self._link_rest('pytest')
            self._link_rest('callers')

    def _link_rest(self, kind):
        """What this kind of test runs, where it was not linked yet."""
        if kind in self.linked:
            return
        if kind in ('script', 'callers'):
            build.link(build.PROGRAM, self.sources, build.RELEASE, self.base, self.tree.program, self.changed)
        if kind in ('pytest', 'callers'):
            build.link(build.PROGRAM, self.sources, build.RELEASE, self.base, self.tree.program, self.changed)
            self.extension.link(self.sources, self.base, self.tree.package / 'gearsweep', self.changed)
        if kind == 'callers':
            self.tree.install(self.base, self.sources, self.changed)
        self.linked.add(kind)

    def judge(self, mutant, tests):
        """{'verdict', 'by', 'why'}, or why it is no mutant."""
        path = self.tree.root / mutant.file
        text = path.read_text()
        lines = text.split('\n')[mutant.first_line - 1 : mutant.last_line]
        path.write_text(text[: mutant.start] + mutant.replacement + text[mutant.end :])
        try:
            if mutant.file.endswith('.py'):
                return self._judge_python(mutant, path, text, tests)
            try:
                made = build.Mutated(self.tree.root, mutant.file, self.sources, self.base, self.tree.root / 'build/mutated')
            except build.CompileError:
                return {'verdict': 'does not compile'}
            if made.same:
                return {'verdict': 'same code'}
            self.changed = made.changed
            try:
                self._link()
            except build.CompileError:
                return {'verdict': 'does not compile'}
            return self._try(mutant, tests, lines)
        finally:
            path.write_text(text)

    def _judge_python(self, mutant, path, text, tests):
        try:
            compile(path.read_text(), mutant.file, 'exec')
        except SyntaxError:
            return {'verdict': 'does not compile'}
        copy = self.tree.package / Path(mutant.file).relative_to('python')
        self.restore()
        try:
            shutil.copy2(path, copy)
            return self._try(mutant, tests, [])
        finally:
            copy.write_text(text)

    def _try(self, mutant, tests, lines):
        for test in sorted(tests, key=lambda test: test.seconds):
            if test.seconds <= self.within and test.reaches(mutant, lines):
                self._link_rest(test.kind)
                why = trials.catches(test, self.tree)
                if why and not self.known.is_sure(test):
                    why = trials.catches(test, self.tree)
                if why:
                    return {'verdict': 'killed', 'by': test.name, 'why': why}
        return {'verdict': 'survived'}


class Campaign:
    """The mutants of one room."""

    def __init__(self, room, files, count, tests, workers, kept):
        self.room, self.count, self.workers = room, count, workers
        self.tests = [test for test in tests if test.fits(room)]
        self.order = mutants.ranked(files)
        self.explained = explanations()
        self.file = SCRATCH / 'results' / f'{room}.jsonl'
        self.file.parent.mkdir(exist_ok=True)
        self.old = {}
        if kept and self.file.exists():
            entries = [json.loads(line) for line in self.file.read_text().splitlines()]
            self.old = {entry['key']: entry for entry in entries if entry['verdict'] in kept}
        if not kept:
            self.file.write_text('')
        self.lock = threading.Condition()
        self.found, self.busy = [], 0

    def run(self):
        with ThreadPoolExecutor(len(self.workers)) as pool:
            for done in [pool.submit(self._work, worker) for worker in self.workers]:
                done.result()
        self.found.sort(key=lambda entry: (entry['file'], entry['line']))
        return self.found

    def _next(self):
        with self.lock:
            while len(self.found) + self.busy >= self.count and self.busy:
                self.lock.wait()
            if len(self.found) >= self.count:
                return None
            mutant = next(self.order, None)
            self.busy += mutant is not None
            return mutant

    def _work(self, worker):
        while mutant := self._next():
            entry = None
            try:
                entry = self.old.get(mutant.key)
                if self.explained.get(mutant.key):
                    # Known to change nothing that could be seen.
                    entry = {'key': mutant.key, 'kind': mutant.kind, 'verdict': 'survived'}
                elif not entry:
                    entry = {'key': mutant.key, 'kind': mutant.kind, **worker.judge(mutant, self.tests)}
            finally:
                with self.lock:
                    self.busy -= 1
                    if entry:
                        entry |= {'file': mutant.file, 'line': mutant.first_line}
                        self._keep(entry)
                    self.lock.notify_all()

    def _keep(self, entry):
        with open(self.file, 'a') as out:
            out.write(json.dumps(entry) + '\n')
        if entry['verdict'] in ('killed', 'survived'):
            self.found.append(entry)
            by = f" by {entry['by']}" if 'by' in entry else ''
            say(f"{self.room} {len(self.found)}/{self.count}: {entry['file']}:{entry['line']} {entry['kind']}: {entry['verdict']}{by}")


def report(results):
    why = explanations()
    print()
    rows = []
    for room, found in results.items():
        for entry in found:
            if entry['verdict'] == 'survived' and why.get(entry['key']):
                entry['verdict'] = 'explained'
        count = Counter(entry['verdict'] for entry in found)
        rows.append((room, len(found), *(count[verdict] for verdict in VERDICTS)))
    for wanted in VERDICTS[1:]:
        for entry in (entry for found in results.values() for entry in found if entry['verdict'] == wanted):
            _file, before, after = entry['key'].split('\n')
            print(f"{wanted}: {entry['file']}:{entry['line']} ({entry['kind']})\n  - {before}\n  + {after}")
            if wanted == 'explained':
                print(f'  {why[entry["key"]]}')
    rows.append(('all', *(sum(row[i] for row in rows) for i in range(1, 5))))
    print('\n| room | mutants | killed | explained | survived | killed, % |\n|---|---|---|---|---|---|')
    for room, n, killed, explained, survived in rows:
        print(f'| {room} | {n} | {killed} | {explained} | {survived} | {100 * killed / max(n, 1):.1f} |')
    return rows[-1][4]


def main():
    rooms = rooms_of(ROOT)
    parser = argparse.ArgumentParser(prog='sh test/mutate.sh', description=__doc__)
    parser.add_argument('rooms', nargs='*', metavar='room', help=', '.join(rooms))
    parser.add_argument('--rest', action='store_true', help='keeps who was killed before, and runs the others again')
    parser.add_argument('--resume', action='store_true', help='keeps all verdicts of a run that was interrupted')
    parser.add_argument('--count', type=int, default=COUNT, help=f'mutants in all rooms together, {COUNT} unless told')
    parser.add_argument('--within', type=float, default=1e9, metavar='SECONDS', help='only tests that take no longer')
    parser.add_argument('--workers', type=int, default=min(2, os.cpu_count() or 1), help='how many run at a time')
    options = parser.parse_args()
    for room in options.rooms:
        if room not in rooms:
            parser.error(f'no room {room}; there are {", ".join(rooms)}')
    began = time.time()
    SCRATCH.mkdir(parents=True, exist_ok=True)
    say('compiles what changed; all of it takes about a minute')
    base = SCRATCH / 'objects'
    first = trials.Tree(ROOT, SCRATCH / 'tree0', ROOT / '.venv')
    sources = build.Sources(first.root)
    build.compile_all(first.root, sources, build.RELEASE, base, options.workers)
    extension = build.Extension(ROOT, SCRATCH / 'extension', str(ROOT / '.venv/bin/python'))
    whole = Worker(0, base, extension)
    known = trials.Known(SCRATCH, whole.tree, whole.sources, say, options.workers)
    workers = [Worker(number, base, extension, known, options.within) for number in range(1, options.workers + 1)]
    wanted = options.rooms or list(rooms)
    tests = [test for test in trials.all_tests(ROOT) if any(test.fits(room) for room in wanted)]
    known.prepare(tests)
    count = shares(rooms, options.count)
    kept = {'killed', *NO_MUTANT} if options.rest else {*VERDICTS, *NO_MUTANT} if options.resume else {}
    results = {}
    for room in wanted:
        say(f'{room}: {count[room]} mutants')
        results[room] = Campaign(room, rooms[room], count[room], tests, workers, kept).run()
    left = report(results)
    print(f'\n{(time.time() - began) / 60:.0f} minutes')
    return 1 if left else 0


if __name__ == '__main__':
    sys.exit(main())
