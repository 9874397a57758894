"""Objects, programs and the Python extension for mutants: everything is compiled once, with the flags of
the released build, and those together once more what they change."""

import hashlib
import itertools
import json
import re
import shutil
import subprocess
from concurrent.futures import ThreadPoolExecutor

import instrument

# Those of fpm's release profile, with which people build; long lines, as a change may lengthen one.
RELEASE = '-O3 -funroll-loops -fPIC -fmax-errors=1 -fcoarray=single -fopenmp -fimplicit-none -ffree-form -ffree-line-length-none'
PROGRAM = 'app/gearsweep.f90'
TESTS = 'test/main.f90'


class CompileError(Exception):
    pass


def command(words, **options):
    done = subprocess.run(words, capture_output=True, text=True, errors='replace', check=False, **options)
    if done.returncode:
        raise CompileError(done.stderr)
    return done.stdout


class Sources:
    """The Fortran sources below a root, in the order in which they can be compiled."""

    def __init__(self, root):
        self.root = root
        paths = sorted((root / 'src').glob('**/*.f90')) + sorted((root / 'test').glob('*.f90')) + sorted((root / 'app').glob('*.f90'))
        self.files = [str(path.relative_to(root)) for path in paths]
        texts = {file: (root / file).read_text().lower() for file in self.files}
        self.modules = {}
        for file, text in texts.items():
            for name in re.findall(r'^\s*module\s+(?!procedure)(\w+)\s*$', text, re.MULTILINE):
                self.modules[name] = file
        self.uses = {
            file: {self.modules[name] for name in re.findall(r'^\s*use\s+(\w+)', text, re.MULTILINE) if name in self.modules} - {file}
            for file, text in texts.items()
        }
        self.order = []
        for file in self.files:
            self._add(file)

    def _add(self, file):
        if file not in self.order:
            for used in sorted(self.uses[file]):
                self._add(used)
            self.order.append(file)

    def modules_of(self, file):
        return [name for name, where in self.modules.items() if where == file]

    def reach_of(self, file):
        """What a file uses, and what that uses."""
        found, new = set(), set(self.uses[file])
        while new:
            found |= new
            new = set().union(*(self.uses[other] for other in new)) - found
        return found

    def reach(self, main):
        """What a program is made of."""
        found = self.reach_of(main) | {main}
        library = {file for file in self.files if file.startswith('src/')}
        return [file for file in self.order if file in found | library]


def object_of(folder, file):
    return folder / (file.replace('/', '_') + '.o')


def others_of(base):
    """Objects of C, and of the switch, which everything needs in which mutants are."""
    return [str(path) for path in (*sorted(base.glob('*.c.o')), *sorted(base.glob('switch*.o')))]


def compile_file(root, file, flags, folder, module_folders):
    """Compiles root/file into folder, with its modules; returns the object."""
    target = object_of(folder, file)
    places = [word for place in module_folders for word in ('-I', str(place))]
    # Objects hold the path as it is given: the same from every copy of the sources.
    command(['gfortran', *flags.split(), '-J', str(folder), *places, '-c', file, '-o', str(target)], cwd=root)
    return target


def compile_all(root, sources, flags, folder, workers):
    """All objects into folder, and those in C; only what changed since the last time."""
    folder.mkdir(parents=True, exist_ok=True)
    c_flags = [flag for flag in flags.split() if flag in ('-O3', '-fPIC')]
    for path in sorted((root / 'src').glob('**/*.c')):
        command(['gcc', *c_flags, '-c', str(path), '-o', str(folder / (path.name + '.o'))])
    known_file = folder / 'known.json'
    known = json.loads(known_file.read_text()) if known_file.exists() else {}
    left, done = list(sources.order), set()
    with ThreadPoolExecutor(workers) as pool:
        while left:
            ready = [file for file in left if sources.uses[file] <= done]
            list(pool.map(lambda file: compile_changed(root, sources, file, flags, folder, known), ready))
            done |= set(ready)
            left = [file for file in left if file not in done]
            known_file.write_text(json.dumps(known))


def compile_changed(root, sources, file, flags, folder, known):
    """Compiles unless the source, what it uses and the flags are as they were."""
    now = hashlib.sha256((root / file).read_bytes() + flags.encode())
    # A module file carries on what the modules it uses tell of themselves.
    for used in sorted(sources.reach_of(file)):
        for name in sources.modules_of(used):
            now.update((folder / f'{name}.mod').read_bytes())
    if known.get(file) != now.hexdigest() or not object_of(folder, file).exists():
        known.pop(file, None)
        compile_file(root, file, flags, folder, [])
        known[file] = now.hexdigest()


def link(main, sources, base, target, changed=None):
    """The program of `main`, with changed objects ({file: object}) in place of those of base."""
    objects = [str((changed or {}).get(file, object_of(base, file))) for file in sources.reach(main)]
    others = others_of(base)
    command(['gfortran', '-fopenmp', *objects, *others, '-lopenblas', '-ldmumps_seq', '-larpack', '-o', str(target)])


class Extension:
    """The Python package's compiled part, from the same objects."""

    def __init__(self, root, folder, python):
        self.folder = folder
        folder.mkdir(parents=True, exist_ok=True)
        pyf = root / 'python/gearsweep/flat.pyf'
        command([python, '-m', 'numpy.f2py', str(pyf), '--lower', '--quiet', '--build-dir', str(folder)], cwd=folder)
        ask = ('import numpy, numpy.f2py, sysconfig; print(numpy.get_include()); print(numpy.f2py.get_include()); '
               'print(sysconfig.get_path("include")); print(sysconfig.get_config_var("EXT_SUFFIX"))')
        *includes, self.suffix = command([python, '-c', ask]).split()
        self.objects = []
        for source in (folder / '_flatmodule.c', root / 'python/gearsweep/f2py_support.c'):
            target = folder / (source.stem + '.o')
            command(['gcc', '-O2', '-fPIC', *(f'-I{place}' for place in includes), '-c', str(source), '-o', str(target)])
            self.objects.append(str(target))

    def link(self, sources, base, target_folder, changed=None):
        files = [file for file in sources.order if file.startswith('src/')]
        objects = [str((changed or {}).get(file, object_of(base, file))) for file in files]
        others = others_of(base)
        target = target_folder / ('_flat' + self.suffix)
        command(['gfortran', '-shared', '-fopenmp', *self.objects, *objects, *others, '-lopenblas', '-ldmumps_seq', '-larpack', '-o', str(target)])


class Together:
    """All mutants of some rooms in objects of their own: {number: mutant}, and the objects."""

    def __init__(self, root, sources, base, folder, orders, counts):
        shutil.rmtree(folder, ignore_errors=True)
        (folder / 'tree').mkdir(parents=True)
        self.root, self.base, self.folder, self.tree = root, base, folder, folder / 'tree'
        self.mutants, self.changed, numbers = {}, {}, itertools.count(1)
        (folder / 'switch.f90').write_text(instrument.SWITCH)
        (folder / 'switch.c').write_text(instrument.SWITCH_C)
        command(['gfortran', '-O2', '-fPIC', '-J', str(base), '-c', str(folder / 'switch.f90'), '-o', str(base / 'switch.f90.o')])
        command(['gcc', '-O2', '-fPIC', '-c', str(folder / 'switch.c'), '-o', str(base / 'switch.o')])
        for order, count in zip(orders, counts, strict=True):
            left, found = count, {}
            while left > 0 and (more := {next(numbers): mutant for mutant in itertools.islice(order, left)}):
                found |= more
                for file in {mutant.file for mutant in more.values()}:
                    kept = self._compile(file, {n: mutant for n, mutant in found.items() if mutant.file == file})
                    found = {n: mutant for n, mutant in found.items() if mutant.file != file or n in kept}
                left = count - len(found)
            self.mutants |= found
        if next(numbers) >= instrument.ROOM:
            raise SystemExit(f'at most {instrument.ROOM} mutants at a time')

    def _compile(self, file, found):
        """With those that can be wrapped and compile: a message of the compiler names the line of one that does not."""
        (self.tree / file).parent.mkdir(parents=True, exist_ok=True)
        for _ in range(9):
            text, spans = instrument.wrapped((self.root / file).read_text(), found)
            (self.tree / file).write_text(text)
            found = {number: mutant for number, mutant in found.items() if number in spans}
            try:
                flags = RELEASE.replace('-fmax-errors=1', '-fmax-errors=99')
                self.changed[file] = compile_file(self.tree, file, flags, self.folder, [self.base])
                return found
            except CompileError as error:
                lines = [int(line) for line in re.findall(rf'^{file}:(\d+):', str(error), re.MULTILINE)]
                bad = {number for number, (first, last) in spans.items() if any(first <= line <= last for line in lines)}
                if not bad:
                    raise
                found = {number: mutant for number, mutant in found.items() if number not in bad}
        return {}

    def is_same(self, mutant, tree, folder):
        """Does the compiler make the same of this mutant as of the clean source?"""
        folder.mkdir(parents=True, exist_ok=True)
        path = tree / mutant.file
        text = path.read_text()
        path.write_text(text[: mutant.start] + mutant.replacement + text[mutant.end :])
        try:
            made = compile_file(tree, mutant.file, RELEASE, folder, [self.base])
            return made.read_bytes() == object_of(self.base, mutant.file).read_bytes()
        finally:
            path.write_text(text)
