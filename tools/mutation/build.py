"""Copies of the checkout, of which one has all mutants in it and is built as any checkout is: program, suites, library and package."""

import itertools
import re
import shutil
import subprocess

import instrument

# Those of most files of app/build.py, with which people build. A change may lengthen a line.
RELEASE = '-O3 -funroll-loops -fPIC -fcoarray=single -fopenmp -fimplicit-none -ffree-form -ffree-line-length-none'
SWITCH = 'src/base/gearsweep_mutants'
# Appended to the copy's app/setup.sh.
SETUP = """
export FFLAGS=-ffree-line-length-none
builds_anew=no
build_package() { :; }
"""
# As pip does it, but not into the environment.
PACKAGE = """
export PATH="$venv/bin:$PATH"
meson setup build/python -Dlibrary=build/release/libgearsweep.a -Dpython.purelibdir="$root/build/package" -Dpython.platlibdir="$root/build/package" && meson install -C build/python
"""


def command(words, **options):
    """What a command says on stdout, and whether it succeeds."""
    done = subprocess.run(words, capture_output=True, text=True, errors='replace', check=False, **options)
    return done.stdout + done.stderr, done.returncode == 0


class Tree:
    """A copy of the checkout."""

    def __init__(self, root):
        self.root = root
        self.check, self.program = root / 'build/run/check-release', root / 'build/run/gearsweep'
        self.package, self.work, self.states = (root / 'build' / name for name in ('package', 'work', 'states'))

    def fill(self, root):
        """With the files of the checkout at `root`."""
        shutil.rmtree(self.root, ignore_errors=True)
        for name in command(['git', 'ls-files', '-co', '--exclude-standard'], cwd=root)[0].splitlines():
            if (root / name).is_file():
                (self.root / name).parent.mkdir(parents=True, exist_ok=True)
                shutil.copy2(root / name, self.root / name)
        (self.root / '.venv').symlink_to(root / '.venv')
        self.work.mkdir(parents=True)
        (self.work / 'data').symlink_to('../../data')
        with open(self.root / 'app/setup.sh', 'a') as setup:
            setup.write(SETUP)

    def copy(self, folder):
        """Another one, with all that is built."""
        shutil.rmtree(folder, ignore_errors=True)
        shutil.copytree(self.root, folder, symlinks=True)
        return Tree(folder)

    def run(self, script):
        said, is_done = command(['sh', '-c', f'set -e; root=$PWD; . app/setup.sh; {script}'], cwd=self.root)
        if not is_done:
            raise SystemExit(said)


class Together:
    """A tree with all mutants of some rooms, {number: mutant}: of each order of them the first `count` that compile."""

    def __init__(self, root, folder, orders, counts):
        self.root, self.tree, self.mutants = root, Tree(folder), {}
        self.tree.fill(root)
        (folder / f'{SWITCH}.f90').write_text(instrument.SWITCH)
        (folder / f'{SWITCH}.c').write_text(instrument.SWITCH_C)
        # For the modules, all of them.
        self.tree.run('sh app/install.sh build/clean')
        self.modules = folder / 'build/release/src'
        (folder / 'build/apart').mkdir()
        numbers = itertools.count(1)
        for order, count in zip(orders, counts, strict=True):
            found = {}
            while more := {next(numbers): mutant for mutant in itertools.islice(order, count - len(found))}:
                found |= more
                for file in {mutant.file for mutant in more.values()}:
                    kept = self._put_in({n: mutant for n, mutant in found.items() if mutant.file == file}, file)
                    found = {n: mutant for n, mutant in found.items() if mutant.file != file or n in kept}
            self.mutants |= found
        if next(numbers) >= instrument.ROOM:
            raise SystemExit(f'at most {instrument.ROOM} mutants at a time')
        self.tree.run(f'build_program; build_check_release; {PACKAGE}')

    def _put_in(self, found, file):
        """Those that can be wrapped and compile: a message of the compiler names the line of one that does not."""
        while True:
            text, spans = instrument.wrapped((self.root / file).read_text(), found)
            (self.tree.root / file).write_text(text)
            found = {number: found[number] for number in spans}
            said, is_done = self._compile(file, '-fsyntax-only -fmax-errors=99')
            if is_done:
                return found
            lines = [int(line) for line in re.findall(rf'^{file}:(\d+):', said, re.MULTILINE)]
            bad = {number for number, (first, last) in spans.items() if any(first <= line <= last for line in lines)}
            if not bad:
                raise SystemExit(said)
            found = {number: mutant for number, mutant in found.items() if number not in bad}

    def _compile(self, file, options):
        words = ['gfortran', *RELEASE.split(), *options.split(), '-J', 'build/apart', '-I', self.modules, '-c', file]
        return command(words, cwd=self.tree.root)

    def is_same(self, mutant, number):
        """Does the compiler make the same of this mutant as of the clean source?"""
        text, made = (self.root / mutant.file).read_text(), []
        # The object has the name of the source in it.
        name = f'build/apart/{number}.f90'
        for changed in (text, mutant.put_into(text)):
            (self.tree.root / name).write_text(changed)
            is_done = self._compile(name, f'-o {name}.o')[1]
            made.append(is_done and (self.tree.root / f'{name}.o').read_bytes())
        return made[0] == made[1]
