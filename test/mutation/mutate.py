"""Puts mutants into copies of the sources, runs the tests that could see each, and reports by room:
what test/mutate.sh runs. Results are kept below build/mutate."""

import argparse
import itertools
import json
import os
import queue
import signal
import sys
import threading
import time
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import instrument
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
    """One copy of the checkout, with the programs in which all mutants of Fortran are, and none is on."""

    def __init__(self, number, sources, base, extension, together):
        self.tree = trials.Tree(ROOT, SCRATCH / f'tree{number}', ROOT / '.venv')
        self.states = self.tree.root / 'build/states'
        self.together, changed = together, together.changed
        build.link(build.TESTS, sources, base, self.tree.check, changed)
        build.link(build.PROGRAM, sources, base, self.tree.program, changed)
        extension.link(sources, base, self.tree.package / 'gearsweep', changed)
        self.tree.install(base, sources, changed)

    def judge(self, number, mutant, tests):
        """{'verdict', 'by', 'why'}, or why it is no mutant."""
        if mutant.file.endswith('.py'):
            return self._judge_python(mutant, tests)
        self.states.write_bytes(instrument.states([number]))
        found = self._try([test for test in tests if number in test.reached])
        if found['verdict'] == 'survived' and self.together.is_same(mutant, self.tree.root, self.tree.root / 'build/alone'):
            return {'verdict': 'same code'}
        return found

    def _judge_python(self, mutant, tests):
        copy = self.tree.package / Path(mutant.file).relative_to('python')
        text = copy.read_text()
        changed = text[: mutant.start] + mutant.replacement + text[mutant.end :]
        try:
            compile(changed, mutant.file, 'exec')
        except SyntaxError:
            return {'verdict': 'does not compile'}
        try:
            copy.write_text(changed)
            self.states.write_bytes(instrument.states())
            return self._try(tests)
        finally:
            copy.write_text(text)

    def _try(self, tests):
        for test in sorted(tests, key=lambda test: test.seconds):
            why = trials.catches(test, self.tree, self.states)
            if why:
                return {'verdict': 'killed', 'by': test.name, 'why': why}
        return {'verdict': 'survived'}


def each(workers, work, items):
    """work(worker, item) of each item, by the next worker that is free."""
    free = queue.SimpleQueue()
    for worker in workers:
        free.put(worker)

    def one(item):
        worker = free.get()
        try:
            return work(worker, item)
        finally:
            free.put(worker)

    with ThreadPoolExecutor(len(workers)) as pool:
        return list(pool.map(one, items))


class Campaign:
    """The mutants of one room, {number: mutant}."""

    def __init__(self, room, chosen, tests, workers, kept):
        self.room, self.chosen, self.workers = room, chosen, workers
        self.tests = [test for test in tests if test.fits(room)]
        self.explained = explanations()
        self.file = SCRATCH / 'results' / f'{room}.jsonl'
        self.file.parent.mkdir(exist_ok=True)
        self.old = {}
        if kept and self.file.exists():
            entries = [json.loads(line) for line in self.file.read_text().splitlines()]
            self.old = {entry['key']: entry for entry in entries if entry['verdict'] in kept}
        if not kept:
            self.file.write_text('')
        self.lock, self.done = threading.Lock(), 0

    def run(self):
        found = each(self.workers, self._one, self.chosen.items())
        return sorted((entry for entry in found if entry['verdict'] in VERDICTS), key=lambda entry: (entry['file'], entry['line']))

    def _one(self, worker, item):
        number, mutant = item
        entry = {'key': mutant.key, 'kind': mutant.kind, 'verdict': 'survived'}
        # Those explained are known to change nothing that could be seen.
        if not self.explained.get(mutant.key):
            entry = self.old.get(mutant.key) or entry | worker.judge(number, mutant, self.tests)
        entry |= {'file': mutant.file, 'line': mutant.first_line}
        with self.lock:
            self.done += 1
            with open(self.file, 'a') as out:
                out.write(json.dumps(entry) + '\n')
            by = f" by {entry['by']}" if 'by' in entry else ''
            say(f"{self.room} {self.done}/{len(self.chosen)}: {entry['file']}:{entry['line']} {entry['kind']}: {entry['verdict']}{by}")
        return entry


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
    parser.add_argument('--workers', type=int, default=min(2, os.cpu_count() or 1), help='how many run at a time')
    options = parser.parse_args()
    for room in options.rooms:
        if room not in rooms:
            parser.error(f'no room {room}; there are {", ".join(rooms)}')
    began = time.time()
    SCRATCH.mkdir(parents=True, exist_ok=True)
    # Beside a shell interrupts are ignored, and so they would be by the tests that send them.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    say('compiles what changed; all of it takes about a minute')
    base, python = SCRATCH / 'objects', str(ROOT / '.venv/bin/python')
    sources = build.Sources(ROOT)
    build.compile_all(ROOT, sources, build.RELEASE, base, options.workers)
    extension = build.Extension(ROOT, SCRATCH / 'extension', python)
    wanted = options.rooms or list(rooms)
    count = shares(rooms, options.count)
    fortran = [room for room in wanted if room != 'python']
    orders = [mutants.ranked(rooms[room]) for room in fortran]
    together = build.Together(ROOT, sources, base, SCRATCH / 'together', orders, [count[room] for room in fortran])
    say(f'{len(together.mutants)} mutants in one build')
    workers = [Worker(number, sources, base, extension, together) for number in range(1, options.workers + 1)]
    tests = [test for test in trials.all_tests(ROOT) if any(test.fits(room) for room in wanted)]
    keys = [f'{number} {mutant.key}' for number, mutant in together.mutants.items()]
    stamp = trials.fingerprint(ROOT, ['src', 'app', 'data', 'doc', 'include', 'python', 'test', 'validation']) + mutants.hashed(*keys)
    known = trials.Known(SCRATCH / 'tests.json', stamp, max(together.mutants, default=0), say)
    each(workers, lambda worker, test: known.ask(test, worker.tree, len(keys)), sorted(tests, key=lambda test: test.name != trials.WALK))
    kept = {'killed', *NO_MUTANT} if options.rest else {*VERDICTS, *NO_MUTANT} if options.resume else {}
    results = {}
    for room in wanted:
        chosen = {number: mutant for number, mutant in together.mutants.items() if mutant.file in rooms[room]}
        if room == 'python':
            chosen = dict(enumerate(itertools.islice(mutants.ranked(rooms[room]), count[room])))
        say(f'{room}: {len(chosen)} mutants')
        results[room] = Campaign(room, chosen, tests, workers, kept).run()
    left = report(results)
    print(f'\n{(time.time() - began) / 60:.0f} minutes')
    return 1 if left else 0


if __name__ == '__main__':
    sys.exit(main())
