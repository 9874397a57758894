"""Puts mutants into a copy of the sources, runs the tests that could see each, and reports by room:
what tools/mutate.sh runs. Results are kept below build/mutate."""

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
EXPLAINED = ROOT / 'tools/mutation/explained.txt'
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


class Judge:
    """One copy of the build, in which one mutant at a time is on."""

    def __init__(self, together, tree):
        self.together, self.tree = together, tree

    def judge(self, number, mutant, tests):
        """{'verdict', 'by', 'why'}, or why it is no mutant."""
        if mutant.file.endswith('.py'):
            return self._judge_python(mutant, tests)
        self.tree.states.write_bytes(instrument.states([number]))
        found = self._try([test for test in tests if number in test.reached])
        if found['verdict'] == 'survived' and self.together.is_same(mutant, number):
            return {'verdict': 'same code'}
        return found

    def _judge_python(self, mutant, tests):
        copy = self.tree.package / Path(mutant.file).relative_to('python')
        text = copy.read_text()
        try:
            compile(mutant.put_into(text), mutant.file, 'exec')
        except SyntaxError:
            return {'verdict': 'does not compile'}
        self.tree.states.write_bytes(instrument.states())
        try:
            copy.write_text(mutant.put_into(text))
            return self._try(tests)
        finally:
            copy.write_text(text)

    def _try(self, tests):
        for test in sorted(tests, key=lambda test: test.seconds):
            if why := trials.catches(test, self.tree, self.tree.states):
                return {'verdict': 'killed', 'by': test.name, 'why': why}
        return {'verdict': 'survived'}


def each(judges, work, items):
    """work(judge, item) of each item, by the next judge that is free."""
    free = queue.SimpleQueue()
    for judge in judges:
        free.put(judge)

    def one(item):
        judge = free.get()
        try:
            return work(judge, item)
        finally:
            free.put(judge)

    with ThreadPoolExecutor(len(judges)) as pool:
        return list(pool.map(one, items))


def campaign(room, chosen, tests, judges, kept):
    """The verdicts of the mutants of one room, {number: mutant}; those of these kinds that are known already are kept."""
    file = SCRATCH / 'results' / f'{room}.jsonl'
    file.parent.mkdir(exist_ok=True)
    old = [json.loads(line) for line in file.read_text().splitlines()] if kept and file.exists() else []
    old = {entry['key']: entry for entry in old if entry['verdict'] in kept}
    # Those explained are known to change nothing that could be seen.
    old |= {key: {'verdict': 'survived'} for key in explanations()}
    tests = [test for test in tests if test.fits(room)]
    done, lock = itertools.count(1), threading.Lock()

    def one(judge, item):
        number, mutant = item
        entry = old.get(mutant.key) or judge.judge(number, mutant, tests)
        entry |= {'key': mutant.key, 'kind': mutant.kind, 'file': mutant.file, 'line': mutant.line}
        by = f" by {entry['by']}" if 'by' in entry else ''
        with lock:
            out.write(json.dumps(entry) + '\n')
            out.flush()
            say(f'{room} {next(done)}/{len(chosen)}: {mutant.file}:{mutant.line} {mutant.kind}: {entry["verdict"]}{by}')
        return entry

    with open(file, 'a' if kept else 'w') as out:
        found = each(judges, one, chosen.items())
    return sorted((entry for entry in found if entry['verdict'] in VERDICTS), key=lambda entry: (entry['file'], entry['line']))


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
    parser = argparse.ArgumentParser(prog='sh tools/mutate.sh', description=__doc__)
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
    wanted = options.rooms or list(rooms)
    count = shares(rooms, options.count)
    fortran = [room for room in wanted if room != 'python']
    say('building, about 3 min; all rooms together 6')
    together = build.Together(ROOT, SCRATCH / 'tree', [mutants.ranked(rooms[room]) for room in fortran], [count[room] for room in fortran])
    say(f'{len(together.mutants)} mutants in one build')
    judges = [Judge(together, together.tree.copy(SCRATCH / f'tree{number}')) for number in range(1, options.workers + 1)]
    tests = [test for test in trials.all_tests(ROOT) if any(test.fits(room) for room in wanted)]
    keys = [f'{number} {mutant.key}' for number, mutant in together.mutants.items()]
    stamp = trials.fingerprint(ROOT, ['src', 'app', 'data', 'doc', 'include', 'python', 'test', 'tools', 'validation']) + mutants.hashed(*keys)
    known = trials.Known(SCRATCH / 'tests.json', stamp, max(together.mutants, default=0), say)
    each(judges, lambda judge, test: known.ask(test, judge.tree, len(keys)), sorted(tests, key=lambda test: test.name != trials.WALK))
    kept = {'killed', *NO_MUTANT} if options.rest else {*VERDICTS, *NO_MUTANT} if options.resume else {}
    results = {}
    for room in wanted:
        chosen = {number: mutant for number, mutant in together.mutants.items() if mutant.file in rooms[room]}
        if room == 'python':
            chosen = dict(enumerate(itertools.islice(mutants.ranked(rooms[room]), count[room])))
        results[room] = campaign(room, chosen, tests, judges, kept)
    left = report(results)
    print(f'\n{(time.time() - began) / 60:.0f} minutes')
    return 1 if left else 0


if __name__ == '__main__':
    sys.exit(main())
