#!/usr/bin/env python3
"""Compiles what changed, and links it: python3 app/build.py FOLDER library|program|check [--flags=...] [--c-flags=...] [--link-flags=...]
FOLDER gets libgearsweep.a, its modules (in src), and the program or the tests (`check`). Without flags: as released; $FFLAGS come behind.
Progress goes to stdout, messages of the compilers to stderr."""

import argparse
import concurrent.futures
import hashlib
import os
import re
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
ALWAYS = '-fPIC -fopenmp -fimplicit-none -Werror=implicit-interface -fcoarray=single'
HEAVY = '-O3 -funroll-loops'
# What reads cases and fills tables is no slower with -O1, and compiled in half the time. What such a file computes itself, as the
# radius of a point of contact, may have another last digit than with the flags of the others, which fpm takes for all.
LIGHT = '-O1'
LIGHT_FILES = re.compile(r'(app|test|src/api|src/study|src/rating)/|.*/(task_\w+|tables|\w+_keys)\.')
FOLDERS = {'library': ['src'], 'program': ['src', 'app'], 'check': ['src', 'test']}


def digest(*parts):
    return hashlib.sha256('\0'.join(parts).encode()).hexdigest()[:16]


class Source:
    """A file: the modules that it has and uses, and how it is compiled."""

    def __init__(self, path, folder, options):
        self.name, text = str(path.relative_to(ROOT)), path.read_text()
        home = folder / self.name.split('/')[0]
        home.mkdir(parents=True, exist_ok=True)
        is_light = not options.flags and LIGHT_FILES.match(self.name)
        self.has, self.uses = [], []
        if path.suffix == '.c':
            words = ['gcc', *options.c_flags.split()]
        else:
            self.has = re.findall(r'^ *module +(\w+) *(?:!.*)?$', text.lower(), re.MULTILINE)
            self.uses = re.findall(r'^ *use *(?:, *\w+ *)?(?:::)? *(\w+)', text.lower(), re.MULTILINE)
            flags = f'{ALWAYS} {options.flags or (LIGHT if is_light else HEAVY)} {os.environ.get("FFLAGS", "")}'
            words = ['gfortran', *flags.split(), '-J', str(home), '-I', str(folder / 'src')]
        self.object = home / (self.name.replace('/', '_') + '.o')
        self.modules = [home / f'{name}.mod' for name in self.has]
        self.command = [*words, '-c', self.name, '-o', str(self.object)]
        self.key = digest(text, options.compiler, *self.command)
        # In characters of text; reading the modules that it uses is added in `in_order`.
        self.cost = len(text) * (0.2 if path.suffix == '.c' else 0.45 if is_light else 1)
        self.tail = 0  # the cost of the longest chain of files that use each other, from this one on

    def interface(self):
        """Digest of its modules: while it is the same, files that use them need not be compiled again."""
        return digest(*(hashlib.sha256(module.read_bytes()).hexdigest() for module in self.modules))


class Progress:
    """One line that changes on a screen, else a line now and then: how much is done, and how long the rest will take."""

    def __init__(self, left):
        self.left, self.spent, self.began, self.told = left, 0, time.time(), 0

    def add(self, cost, is_compiled):
        self.left -= cost
        self.spent += cost if is_compiled else 0
        passed, on_screen = time.time() - self.began, sys.stdout.isatty()
        if self.spent and passed > self.told + (1 if on_screen else 10):
            self.told = passed
            text = f'gearsweep: {100 * self.spent / (self.spent + self.left):.0f} %, about {passed * self.left / self.spent:.0f} s left'
            print(f'{text}\033[K' if on_screen else text, end='\r' if on_screen else '\n', flush=True)


class Build:
    def __init__(self, folder, sources):
        owner = {module: source for source in sources for module in source.has}
        self.sources, self.journal = sources, folder / 'journal'
        self.needs = {source: {owner[name] for name in source.uses if name in owner} - {source} for source in sources}
        # By name of the file: the key with which it was compiled, and its interface.
        lines = self.journal.read_text().splitlines() if self.journal.exists() else []
        self.done = {name: (key, interface) for name, key, interface in map(str.split, lines)}

    def compile(self, source):
        """Compiles a file unless its key is that of the last time; returns whether it was compiled."""
        key = digest(source.key, *sorted(f'{need.name} {self.done[need.name][1]}' for need in self.needs[source]))
        if self.done.get(source.name, ('',))[0] == key and all(file.exists() for file in (source.object, *source.modules)):
            return False
        done = subprocess.run(source.command, cwd=ROOT, stderr=subprocess.PIPE, text=True, check=False)
        sys.stderr.write(done.stderr)
        if done.returncode:
            sys.exit(f'failed: {source.name}')
        self.done[source.name] = key, source.interface()
        with open(self.journal, 'a') as journal:
            print(source.name, *self.done[source.name], file=journal)
        return True

    def in_order(self):
        """Lists each file after those that it uses, and finds the costs of their chains."""
        order, waiting = [], dict(self.needs)
        while waiting:
            ready = [source for source, needs in waiting.items() if not needs & waiting.keys()]
            if not ready:
                sys.exit(f'use each other: {", ".join(source.name for source in waiting)}')
            order += ready
            waiting = {source: needs for source, needs in waiting.items() if source not in ready}
        reach = {}
        for source in order:
            reach[source] = self.needs[source].union(*(reach[need] for need in self.needs[source]))
            source.cost += 60 * len(reach[source])
        for source in reversed(order):
            source.tail += source.cost
            for need in self.needs[source]:
                need.tail = max(need.tail, source.tail)
        return order

    def run(self):
        waiting, running, jobs = self.in_order(), {}, len(os.sched_getaffinity(0))
        progress = Progress(sum(source.cost for source in waiting))
        waiting.sort(key=lambda source: -source.tail)
        with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
            while waiting or running:
                unfinished = {*waiting, *running.values()}
                for source in [source for source in waiting if not self.needs[source] & unfinished][: jobs - len(running)]:
                    waiting.remove(source)
                    running[pool.submit(self.compile, source)] = source
                for future in concurrent.futures.wait(running, return_when='FIRST_COMPLETED').done:
                    progress.add(running.pop(future).cost, future.result())


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument('folder', type=Path)
    arguments.add_argument('what', choices=FOLDERS)
    arguments.add_argument('--flags', default='')
    arguments.add_argument('--c-flags', default='-O3 -fPIC -fopenmp')
    arguments.add_argument('--link-flags', default='')
    options = arguments.parse_args()
    folder = options.folder.resolve()
    options.compiler = subprocess.run(['gfortran', '--version'], capture_output=True, text=True, check=True).stdout
    paths = [path for top in FOLDERS[options.what] for path in sorted((ROOT / top).rglob('*')) if path.suffix in ('.f90', '.c')]
    sources = [Source(path, folder, options) for path in paths]
    Build(folder, sources).run()
    library = folder / 'libgearsweep.a'
    library.unlink(missing_ok=True)
    objects = {True: [], False: []}
    for source in sources:
        objects[source.name.startswith('src/')].append(str(source.object))
    subprocess.run(['ar', 'rcs', str(library), *objects[True]], check=True)
    if options.what != 'library':
        needs = re.search(r'^link *= *\[(.*?)\]', (ROOT / 'fpm.toml').read_text(), re.MULTILINE | re.DOTALL)[1]
        link = ['gfortran', '-fopenmp', *options.link_flags.split(), *objects[False], str(library)]
        link += [f'-l{name}' for name in re.findall(r'"(.*?)"', needs)]
        subprocess.run([*link, '-o', str(folder / options.what)], check=True)


if __name__ == '__main__':
    main()
