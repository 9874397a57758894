"""What leaving out saves: scenes without something beside the same scenes with it.

    python bench/scenes.py PROGRAMS         (bench/run.sh scenes sets up and does this)
"""
import pathlib
import sys
import tempfile
import time
from statistics import median

from report import BENCH, Report, machine, run

PRESCRIBED = BENCH / 'problems' / 'case1.nml'
PAIR, SECTION = (BENCH.parent / 'data' / name for name in ('case1.nml', 'hassan.nml'))
# Title, what is left out, why the answers may differ.
SCENES = {
    'geometry': ('geometry only', 'all other tasks: stiffness, grids, modes, motion', ''),
    'speed': ('one speed, five reliefs', 'the other 326 speeds', 'neighbours decide the steps; both within 1e-6'),
    'reliefs': ('3267 speeds, one relief', 'four other reliefs', 'other steps; both within 1e-6'),
    'optimum': ('one sweep with the best relief', 'the search for it', 'the search is for 1e-5'),
    'stiffness': ('sweep, stiffness passed in', 'finite elements', ''),
    'friction': ('no friction', 'friction factors, steps that end at the pitch point', 'other steps; both within 1e-6'),
    'relief': ('no relief', 'steps that end where relief begins', 'other steps; both within 1e-6'),
    'coast': ('no backlash', 'coast side', ''),
    'contact': ('no contact loss possible', "making the steps' maps anew", ''),
    'gears': ('equal gears', "the second gear's finite elements", ''),
    'modes': ('modes only', 'stress, load sharing', ''),
    'mode': ('one frequency', 'nine others', 'rounding; at most 1e-11'),
    'stress': ('stress only', 'modes, mass matrix', ''),
    'body': ('stress and modes in one case', 'their grids, made and factored again', ''),
}
PACKAGES = ('matplotlib', 'pandas', 'xarray', 'scipy')
ROUNDS = 5
MAIN = "import sys; from gearsweep.__main__ import main; main([{case!r}, '--quiet', '--out', {out!r}{more}])"
PYTHON = {
    'import gearsweep': 'import gearsweep',
    'a sweep': "import gearsweep; gearsweep.run(gearsweep.Case.read({case!r}), 'sweep')",
    'python -m gearsweep CASE --no-pictures': MAIN.replace('{more}', ", '--no-pictures'"),
    'python -m gearsweep CASE': MAIN.replace('{more}', ''),
    'sweep.to_pandas()': "import gearsweep; gearsweep.run(gearsweep.Case.read({case!r}), 'sweep').sweep.to_pandas()",
    'sweep.to_xarray()': "import gearsweep; gearsweep.run(gearsweep.Case.read({case!r}), 'sweep').sweep.to_xarray()",
}

# Everything at once, and task by task; medians of both in turn.
ONCE = """
import time, gearsweep
from statistics import median
case = gearsweep.Case.read({case!r})
mesh = gearsweep.run(case, 'mesh')
def apart():
    for task in case.tasks:
        gearsweep.run(case, task, earlier=mesh)
taken = []
for _ in range({rounds}):
    for way in (lambda: gearsweep.run(case, earlier=mesh), apart):
        start = time.perf_counter()
        way()
        taken.append(time.perf_counter() - start)
print(median(taken[::2]), median(taken[1::2]))
"""

# What a task takes beside what it builds on: stress over time beside the modes, flanks, rating and face beside the mesh.
TASKS = """
import time, gearsweep
def seconds(case, task, earlier=None):
    start = time.process_time()
    gearsweep.run(case, task, earlier=earlier)
    return time.process_time() - start
section = gearsweep.Case.read({section!r}).changed(modal={{'modes': 50}}, transient={{
    'modes': 50, 'rpm': [360, 720, 1080, 1440, 1800], 'samples': 110, 'time_step_s': None, 'rayleigh_alpha_1_s': None,
    'rayleigh_beta_s': None}})
pair = gearsweep.Case.read({pair!r}).changed(mesh={{'model': 'fe'}})
mesh = gearsweep.run(pair, 'mesh')
ways = [(section, 'modal', None), (section, 'transient', None), (pair, 'mesh', None), (pair, 'flank', mesh),
        (pair, 'rating', mesh), (pair.changed(face={{'misalignment_um': 20}}), 'face_load', mesh)]
taken = [[seconds(*way) for way in ways] for _ in range({rounds})]
print(*map(min, zip(*taken)))
"""

programs = pathlib.Path(sys.argv[1])


def duration(seconds):
    for unit, size in (('s', 1), ('ms', 1e-3)):
        if seconds >= size:
            return f'{seconds / size:.3g} {unit}'
    return f'{1e6 * seconds:.3g} us'


def scenes(report):
    found = {name: map(float, rest) for name, *rest in map(str.split, run(programs / 'scenes', PRESCRIBED, PAIR, SECTION).splitlines())}
    rows, table = [], []
    for name, (title, left_out, reason) in SCENES.items():
        lean, full, off, allowed = found[name]
        answers = f'{off:.0e}: {reason}' if off > 0 else 'the same bits'
        table.append((title, left_out, duration(lean), duration(full), f'{full / lean:.3g}', answers))
        rows.append((title, lean, full, off, allowed))
    report.table(('scene', 'left out', 'without it', 'with it', 'ratio', 'answers differ by'), table)
    report.csv('scenes', ('scene', 'seconds_without', 'seconds_with', 'difference', 'allowed'), rows)


def modules(program):
    """Names of all modules that a Python program loads."""
    return set(run(sys.executable, '-c', program + '; import sys; print(*sys.modules)').split())


def seconds(program):
    start = time.perf_counter()
    run(sys.executable, '-c', program)
    return time.perf_counter() - start


def packages(report):
    table = []
    with tempfile.TemporaryDirectory() as out:
        for title, template in PYTHON.items():
            program = template.replace('{case!r}', repr(str(PRESCRIBED))).replace('{out!r}', repr(out))
            loaded = modules(program)
            spared = [name for name in PACKAGES if name not in loaded]
            burdened = f'import {", ".join(spared)}; {program}' if spared else program
            taken = [(seconds(program), seconds(burdened)) for _ in range(ROUNDS)]
            lean, full = map(median, zip(*taken))
            table.append((title, ', '.join(spared) or 'none', duration(lean), duration(full) if spared else '', str(len(loaded))))
    report.add('**Packages.** The packages that Python does not load (`sys.modules`), the time of the whole process without and with them\n'
               'loaded first, and the number of modules that it loads without them.\n')
    report.table(('process', 'not loaded', 'as it is', 'with them', 'modules'), table)


def once(report):
    table = []
    for case in (PAIR, SECTION):
        lean, full = map(float, run(sys.executable, '-c', ONCE.format(case=str(case), rounds=ROUNDS)).split())
        table.append((f'`data/{case.name}`', duration(lean), duration(full), f'{full / lean:.3g}'))
    report.add('**Python.** All tasks of a case by `gearsweep.run`, of which `python -m gearsweep` also draws its pictures, and each task by\n'
               'a call of its own; stiffness of an earlier study. The same bits (`python/tests/program/test_same_as_program.py`).\n')
    report.table(('case', 'in one call', 'task by task', 'ratio'), table)


def tasks(report):
    """Each beside what it builds on, and what it may take of that at most."""
    section, pair = (str(BENCH.parent / 'data' / name) for name in ('hassan_transient.nml', 'fzg_c40.nml'))
    found = run(sys.executable, '-c', TASKS.format(section=section, pair=pair, rounds=ROUNDS))
    modal, transient, mesh, flank, rating, face = map(float, found.split())
    rows = [('transient, modes included', '50 modes, 110 times, 5 speeds of `data/hassan_transient.nml`', 'modal', transient, modal, 1.1),
            ('flank', '`data/fzg_c40.nml`, stiffness by finite elements', 'mesh', flank, mesh, 1),
            ('rating', 'the same', 'mesh', rating, mesh, 1),
            ('face_load', 'the same, misaligned by 20 um', 'mesh', face, mesh, 1)]
    report.add('**Tasks that build on others.** The time of stress over time against that of the modes of its section, and of flanks, rating and the load over the face against the stiffness of\n'
               'the pair, which does not count for them; the least processor time of some runs.\n')
    report.table(('task', 'of', 'builds on', 'takes', 'that takes', 'ratio', 'aim'), [
        (name, of, base, duration(own), duration(whole), f'{own / whole:.2g}', f'{aim:g}')
        for name, of, base, own, whole, aim in rows])


def main():
    report = Report('scenes', 'Cost of each part')
    report.add(f'{machine()}, one thread, medians. Both cases run in turn in one process. The prescribed mesh of\n'
               '`bench/problems/case1.nml` (327 speeds, five reliefs), `data/case1.nml` for geometry, passed-in stiffness and equal\n'
               'gears, `data/hassan.nml` for modes and stress. Differences are relative; the run fails where they are larger than the table says.\n')
    scenes(report)
    packages(report)
    once(report)
    tasks(report)
    report.save()


main()
