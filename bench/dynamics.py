"""Dynamic factors: error against run time, all methods on the same problems in one run.

    python bench/dynamics.py PROGRAMS       (bench/run.sh dynamics sets up and does this)

PROGRAMS is the folder with `dynamics` (the library as released), `dynamics-native` (with the
processor's own instructions), `odeint` and `reference`.
"""
import os
import pathlib
import sys
import tempfile
import time
from statistics import median

import numpy as np
import scipy
from peers import scipy_march
from pictures import draw
from report import BENCH, Report, first_line, machine, run, time_at

ROUNDS = 3          # each takes every contender once, so that a busy machine slows all alike
PATIENCE = 5        # seconds: a SciPy method that took longer is not asked for more
SWEEP = 'case1'
POINTS = ('smooth', 'point', 'damped', 'slow', 'light', 'rattle')
SCIPY_SHARE, OCTAVE_SHARE = 41, 82  # of the sweep's speeds they take every so many
AIMS = (1e-3, 1e-6, 1e-9)
COUNTS = (20, 82, 327, 1307, 5227)
RATIOS = (1e-3, 1e-2, 0.05, 0.17, 0.5, 1, 5, 50)
STARTS = 21

programs = pathlib.Path(sys.argv[1])


def tolerances(*exponents):
    return [(10.0**-e, 0) for e in exponents]


def steps(first, count, order, at_first):
    """Pairs of wanted error and steps: the error that marching leaves falls as the steps' does."""
    return [(max(1e-11, at_first * 2.0**(-order * k)), first * 2**k) for k in range(count)]


class Method:
    def __init__(self, label, settings, solve):
        self.label, self.settings, self.solve = label, settings, solve


def numbers(text):
    return [np.array(line.split(), float) for line in text.splitlines()]


def fortran(method, program='dynamics'):
    def solve(problem, settings):
        words = [word for wanted, count in settings for word in (wanted, count)]
        return numbers(run(programs / program, method, problem.case, *words))
    return solve


def odeint(kind):
    def solve(problem, settings):
        return numbers(run(programs / 'odeint', kind, problem.file, *(wanted for wanted, _ in settings)))
    return solve


def scipy_method(method):
    def solve(problem, settings):
        text = problem.thinned(SCIPY_SHARE)
        answers = []
        for wanted, _ in settings:
            start = time.perf_counter()
            factors = scipy_march.dynamic_factors(scipy_march.Problem(text), method, wanted)
            answers.append(np.concatenate([[time.perf_counter() - start], factors]))
            if answers[-1][0] > PATIENCE:
                break
        return answers
    return solve


def octave(problem, settings):
    file = problem.folder / 'octave'
    file.write_text(problem.thinned(OCTAVE_SHARE))
    return [numbers(run('octave-cli', '--norc', BENCH / 'peers' / 'dogan.m', file, wanted, count))[0] for wanted, count in settings]


METHODS = [
    Method('gearsweep', tolerances(2, 3, 4, 5, 5.5, 6, 6.5, 7, 8, 9, 10), fortran('shooting')),
    Method('gearsweep, native build', tolerances(2, 3, 4, 5, 5.5, 6, 6.5, 7, 8, 9, 10),
           fortran('shooting', 'dynamics-native')),
    Method('gearsweep, marching', tolerances(2, 3, 4, 5, 6, 7, 8, 9, 10), fortran('marching')),
    Method('aligned RK4, shooting', steps(50, 7, 4, 1e-2), fortran('rk4_shooting')),
    Method('aligned RK4, marching', steps(50, 7, 4, 1e-2), fortran('rk4_aligned')),
    Method('RK4, equal steps', steps(50, 8, 1, 1e-3), fortran('rk4')),
    Method('constant steps (Karpat)', steps(50, 8, 1, 1e-3), fortran('constant')),
    Method('constant steps, aligned', steps(50, 8, 2, 1e-3), fortran('constant_aligned')),
    Method('Boost.odeint', tolerances(2, 3, 4, 5, 6, 6.5, 7, 8, 9, 10, 11), odeint('located')),
    Method('Boost.odeint, plain', tolerances(2, 3, 4, 5, 6, 7, 8, 9, 10, 11), odeint('plain')),
    Method('SciPy DOP853', tolerances(2, 4, 6, 8, 10), scipy_method('DOP853')),
    Method('SciPy LSODA', tolerances(2, 4, 6, 8, 10), scipy_method('LSODA')),
    Method('SciPy Radau', tolerances(2, 4, 6, 8), scipy_method('Radau')),
    Method('Octave, as in the paper', [(1e-4, 200)], octave)]


class Problem:
    def __init__(self, name, folder):
        self.name, self.folder, self.case = name, folder, BENCH / 'problems' / f'{name}.nml'
        self.title = self.case.read_text().split("title = '")[1].split("'")[0]
        self.file = folder / name
        self.file.write_text(run(programs / 'dynamics', 'problem', self.case))
        self.numbers = scipy_march.Problem(self.file.read_text())
        self.factor, self.disagreement = self.reference()
        self.results = {}

    def reference(self):
        """By marching in extended precision; how far the library's shooting is away from that."""
        marched = numbers(run(programs / 'reference', self.file, 1e-16))[0]
        wanted, many = (1e-12, 0) if self.name == SWEEP else (1e-9, 51200)
        shot = numbers(run(programs / 'dynamics', 'shooting', self.case, wanted, many))[0][1:]
        return marched, np.abs(marched - shot).max()

    def thinned(self, share):
        """The same text with every so many of the speeds."""
        if self.name != SWEEP:
            return self.file.read_text()
        *lines, _, rpm, start = self.file.read_text().splitlines()
        rpm = rpm.split()[::share]
        return '\n'.join([*lines, str(len(rpm)), ' '.join(rpm), start])

    def references_for(self, count):
        """Reference values at the speeds of as many points, per relief evenly thinned."""
        reliefs, speeds = len(self.numbers.relief), len(self.numbers.rpm)
        share = 1 if count == reliefs * speeds else next(
            k for k in (SCIPY_SHARE, OCTAVE_SHARE) if reliefs * len(range(0, speeds, k)) == count)
        return self.factor.reshape(reliefs, speeds)[:, ::share].ravel()

    def measure(self, method, answers):
        for setting, answer in zip(method.settings, answers):
            factors = answer[1:]
            difference = np.abs(factors - self.references_for(len(factors)))
            error = difference.max() if np.isfinite(factors).all() else float('nan')
            entry = self.results.setdefault(method.label, {}).setdefault(setting, ([], error, len(factors)))
            entry[0].append(answer[0] / len(factors))

    def curve(self, method):
        """Errors and median seconds a point."""
        entries = self.results.get(method.label, {}).values()
        return np.array([entry[1] for entry in entries]), np.array([median(entry[0]) for entry in entries])


def is_asked(method, problem):
    return problem.name == SWEEP or not any(word in method.label for word in ('native', 'Octave'))


def compete(problems):
    for turn in range(ROUNDS):
        for problem in problems:
            for method in METHODS:
                slow = sum(median(entry[0]) * entry[2] for entry in problem.results.get(method.label, {}).values()) > 3
                if is_asked(method, problem) and not (turn > 0 and slow):
                    problem.measure(method, method.solve(problem, method.settings))
        print(f'round {turn + 1} of {ROUNDS} done', file=sys.stderr, flush=True)


def add_references(report, problems):
    report.add('**References.** Marching until periodic by Runge-Kutta-Fehlberg 7(8) in extended precision (64 bit), local errors\n'
               'below 1e-16; largest difference from the library\'s shooting, asked for 1e-12 (case1) or with 51 200 steps a period:\n'
               + ', '.join(f'{problem.name} {problem.disagreement:.1e}' for problem in problems) + '.\n')


def add_sweep(report, problem):
    report.add('**The five curves of case 1** (327 speeds, 5 reliefs), on one thread unless stated. Each row is the cheapest setting of a contender whose error\n'
               'is at most 1e-6, or its most exact one. Error: largest over all points. Ratio: time over that of gearsweep, portable\n'
               'and native build, both times at an error of 1e-6 (between two settings, where they straddle it).\n')
    own = [time_at(1e-6, *problem.curve(method)) for method in METHODS[:2]]
    rows = []
    for method in METHODS:
        errors, seconds = problem.curve(method)
        kept = np.flatnonzero(errors <= 1e-6)
        best = kept[seconds[kept].argmin()] if len(kept) else int(np.nanargmin(errors))
        at = time_at(1e-6, errors, seconds)
        wanted, count = method.settings[best]
        points = list(problem.results[method.label].values())[best][2]
        share = '' if points == len(problem.factor) else f', {points} points, the rest extrapolated'
        ratio = [at / t if np.isfinite(at) else seconds[best] / t for t in own]
        rows.append((method.label + share, f'{count} steps' if count else f'{wanted:.1e}', f'{errors[best]:.1e}',
                     f'{1e6 * seconds[best]:.3g}', f'{seconds[best] * len(problem.factor):.3g}',
                     *(f'{r:.3g}' + ('' if np.isfinite(at) else ' at its own error') for r in ratio)))
    report.table(('', 'asked for', 'error', 'us a point', 's in all', 'ratio', 'to the native build'), rows)
    tell_ratios(report, problem, own)


def tell_ratios(report, problem, own):
    def ratio(label):
        method = next(method for method in METHODS if method.label == label)
        errors, seconds = problem.curve(method)
        at = time_at(1e-6, errors, seconds)
        return (at if np.isfinite(at) else seconds[np.nanargmin(errors)]) / own[0], np.isfinite(at)

    told = [f'{name} {rounded(ratio(label)[0])} times as long' + ('' if ratio(label)[1] else ' at its own, larger error')
            for label, name in (('Boost.odeint', 'Boost.odeint takes'), ('SciPy DOP853', "SciPy's DOP853"),
                                ('aligned RK4, marching', 'marching by Runge and Kutta with aligned steps'),
                                ('Octave, as in the paper', "an Octave transcription of a paper's method"))]
    points = len(problem.factor)
    kept = [cheapest(*problem.curve(method)) for method in METHODS[:2]]
    report.tell(f'{points} dynamic factors (case 1 from a given stiffness), each with an error of at most 1e-6, take '
                f'{1e3 * kept[0] * points:.3g} ms,\n  {1e3 * kept[1] * points:.3g} ms built for the processor. To an error of 1e-6, between two '
                'settings where they straddle it,\n  ' + ',\n  '.join(told) + '.')


def cheapest(errors, seconds):
    """Time of the cheapest setting that was measured whose error is at most 1e-6."""
    return min(second for error, second in zip(errors, seconds) if error <= 1e-6)


def rounded(number):
    """Two digits, thousands apart."""
    return f'{float(f"{number:.2g}"):,.0f}'.replace(',', ' ')


def add_parts(report, problem):
    report.add('**Where that time goes**, at a tolerance of 1e-6. Tables: the time to make those of the points again. Collocation: the least number\n'
               'of calls that the points need, times the time of one. Peak: multiplications and additions on registers, in the same build.\n')
    rows = []
    for label, program in (('portable', 'dynamics'), ('native', 'dynamics-native')):
        *parts, (call, rate, peak) = numbers(run(programs / program, 'parts', problem.case, 1e-6))
        points = len(problem.factor) / (len(parts) - 1)
        full = [seconds for seconds, changing, *_ in parts[1:] if not changing]
        changing = [(seconds, count) for seconds, count, *_ in parts[1:] if count > points / 2]
        seconds, _, calls, tables = parts[0]
        rows.append((label, f'{1e3 * seconds:.3g}', f'{1e6 * sum(full) / len(full) / points:.2g}' if full else '-',
                     f'{1e6 * sum(s for s, _ in changing) / len(changing) / points:.2g}' if changing else '-',
                     f'{100 * tables / seconds:.0f} %', f'{100 * calls * call / seconds:.0f} %',
                     f'{1e-9 * rate:.3g}', f'{1e-9 * peak:.3g}', f'{100 * rate / peak:.0f} %'))
    bound = {**os.environ, 'OMP_NUM_THREADS': '2', 'OMP_PROC_BIND': 'true'}
    one, two = numbers(run(programs / 'dynamics', 'threads', problem.case, 1e-6, env=bound))[0]
    told = f'Two threads are {one / two:.2f} times as fast as one, bound to a core each (`OMP_PROC_BIND=true`).'
    report.tell(told)
    report.table(('build', 'all, ms', 'us a point of a relief in full contact', 'us a point of one where contact changes', 'tables', 'collocation',
                  'its Gflop/s', 'peak', 'of peak'), rows)
    report.add(f'{told} Unbound, some virtual machines leave both on one core for some time.\n')


def add_points(report, problems):
    report.add('**Single operating points**, tables and start included: us to an error of 1e-3, 1e-6 and 1e-9. A dash: no setting tried\n'
               'reached that error.\n')
    rows = []
    for method in METHODS:
        if not is_asked(method, problems[0]):
            continue
        cells = []
        for problem in problems:
            times = [time_at(aim, *problem.curve(method)) for aim in AIMS]
            cells.append(', '.join(f'{1e6 * t:.3g}' if np.isfinite(t) else '-' for t in times))
        rows.append((method.label, *cells))
    report.table(('', *(problem.name for problem in problems)), rows)
    report.add(faster(problems))
    report.add('\n'.join(f'- *{problem.name}*: {problem.title}, {problem.numbers.rpm[0]:.0f} rpm; DF {problem.factor[0]:.12f}'
                         for problem in problems) + '\n')


def faster(problems):
    """Where a contender needs less time than gearsweep, and by how much the fastest of them."""
    found = []
    for problem in problems:
        for aim in AIMS:
            own, best = time_at(aim, *problem.curve(METHODS[0])), ('', np.inf)
            for method in METHODS[2:]:
                taken = time_at(aim, *problem.curve(method)) if method.label in problem.results else np.inf
                if taken < best[1] and not method.label.startswith('gearsweep'):
                    best = (method.label, taken)
            if best[1] < own:
                found.append(f'*{problem.name}* to {aim:.0e} {best[0]}, {own / best[1]:.1f} times')
    return f'A contender is faster: {"; ".join(found) or "nowhere"}.\n'


def add_corners(report):
    """With contact beyond A and E and without."""
    rows = []
    for label, (points, plain, steps, seconds, more) in zip(
            ('each pair by itself', 'with the compliance that neighbouring teeth share'),
            numbers(run(programs / 'dynamics', 'corners', BENCH / 'problems' / 'corners.nml', 1e-6))):
        rows.append((label, micro(plain, points), f'{steps:.0f}', micro(seconds, points), f'{more:.0f}', f'{seconds / plain:.2f}'))
    report.add('**Contact beyond A and E.** The same sweep with the pair stiffness from finite elements, the path from A to E and then with the\n'
               'contact of the tip corners, which begins and ends under load in every period. So every point has events; us a point.\n')
    report.table(('', 'from A to E', 'steps', 'with corners', 'steps', 'times as long'), rows)


def add_searches(report, problem, light):
    """The best relief beside sweeps, and all motions of a point beside the march to one."""
    points, every, one, apart, best = numbers(run(programs / 'dynamics', 'optimum', problem.case, 1e-6))[0]
    found, search, march = numbers(run(programs / 'dynamics', 'attractors', light.case, 1e-6))[0]
    report.add(f'**Searches.** The best relief of case 1 takes {1e3 * best:.3g} ms: {best / every:.2f} times its sweep of {points:.0f} points over '
               f'all reliefs,\n{best / apart:.1f} times the sweep of the largest relief alone, with which pairs part, and '
               f'{best / one:.1f} times that of a relief in full contact.\nAll motions that attract at the point *light*, {found:.0f}, take '
               f'{1e3 * search:.3g} ms, the march to one of them from rest {1e3 * march:.3g} ms.\n')


def micro(seconds, points):
    return f'{1e6 * seconds / points:.3g}' if points else '-'


def add_cost(report, problem):
    """Over the number of speeds and over the damping."""
    reliefs = len(problem.numbers.relief)
    speeds = numbers(run(programs / 'dynamics', 'speeds', problem.case, 1e-6, *COUNTS))
    report.add('**One more speed.** The same sweep with other numbers of speeds over the same range, at a tolerance of 1e-6; us a point.\n'
               'Eight neighbours share a table and run side by side. If there are few, far apart, the most demanding of the\n'
               'eight costs all of them more steps, and fewer points pay for the tables.\n')
    held = int(speeds[0][3])
    report.table(('speeds', f'{reliefs} reliefs', f'the {held} in full contact', 'ms in all', 'of that tables', 'steps a point'),
                 [(str(int(n)), micro(every, reliefs * n), micro(full, held * n), f'{1e3 * every:.3g}', f'{100 * tables / every:.0f} %',
                   f'{steps:.0f}') for n, every, full, _, tables, steps in speeds])
    damping = numbers(run(programs / 'dynamics', 'damping', problem.case, 1e-6, *RATIOS))
    report.add(f'**More or less damping.** The same sweep, {len(problem.numbers.rpm)} speeds and {reliefs} reliefs, first as a whole and then by kinds of points, each solved by itself; us a\n'
               'point. For comparison, a march from rest until periodic by the same steps, at every eighth point in full contact: the lighter the\n'
               'damping, the more periods it takes. Shooting needs two periods whatever the damping. Two things still grow:\n'
               'the number of steps, as sharper resonances (upper rows) or a decay faster than the mesh period (lower rows) take more for the\n'
               'same tolerance; and with light damping more motions change contact, repeat only after several mesh periods or never\n'
               '(*others*), where Newton\'s method often does not converge and the library marches the transient.\n')
    report.table(('damping ratio', 'all', 'in full contact', 'points', 'steps of these', 'contact changes', 'points', 'others', 'points',
                  'in full contact, marched', 'without a result'),
                 [(f'{z:g}', micro(every, sum(count)), micro(full, count[0]), str(int(count[0])), f'{steps:.0f}', micro(changing, count[1]),
                   str(int(count[1])), micro(other, count[2]), str(int(count[2])), micro(march, marched), f'{lost:.0f} of {marched:.0f}')
                  for z, *count, steps, every, full, changing, other, marched, lost, march in damping])
    report.csv('cost_speeds', ('speeds', 'seconds', 'seconds_full_contact', 'reliefs_full_contact', 'seconds_tables', 'mean_steps'), speeds)
    report.csv('cost_damping', ('damping_ratio', 'points_full', 'points_changing', 'points_other', 'steps_full', 'seconds', 'seconds_full',
                                'seconds_changing', 'seconds_other', 'points_marched', 'points_lost', 'seconds_marched'), damping)
    draw('cost')
    return speeds


def add_start(report, problem, inside):
    """The whole program beside the sweep in it."""
    lone = problem.folder / 'lone.nml'
    lone.write_text(problem.case.read_text().replace('rpm_last = 20000', 'rpm_last = 400'))
    program = BENCH.parent / 'build' / 'run' / 'gearsweep'
    commands = {'`gearsweep --version`': ('--version',),
                'one speed': (lone, '--quiet', '--out', problem.folder),
                f'{len(problem.numbers.rpm)} speeds': (problem.case, '--quiet', '--out', problem.folder)}
    taken = {name: [] for name in commands}
    for _ in range(STARTS):
        for name, words in commands.items():
            start = time.perf_counter()
            run(program, *words)
            taken[name].append(time.perf_counter() - start)
    report.add('**Start-up.** The whole program, from its start to its end, with that case, one thread: reading, mesh, sweep, table of\n'
               'all points written. The last row is the sweep in it alone.\n')
    report.table(('', 'ms'), [(name, f'{1e3 * median(each):.3g}') for name, each in taken.items()] + [('the sweep in it', f'{1e3 * inside:.3g}')])


def write_csv(report, problems):
    rows = []
    for problem in problems:
        for method in METHODS:
            for (wanted, count), (taken, error, points) in problem.results.get(method.label, {}).items():
                rows.append((problem.name, method.label, wanted, count, f'{error:.6e}', f'{median(taken):.6e}', len(taken), points))
    report.csv('dynamics', ('problem', 'method', 'asked_error', 'steps', 'error', 'seconds_per_point', 'repeats', 'points'), rows)


def write_report(problems):
    report = Report('dynamics', 'Dynamic factors: error against run time')
    report.add(f'{machine()}, one thread, medians of {ROUNDS} runs.\n{first_line("g++", "--version")} -O3 -march=native, Boost '
               f'{first_line("dpkg-query", "-W", "-f", "${Version}", "libboost-dev")}; SciPy {scipy.__version__}; '
               f'{first_line("octave-cli", "--version")}.\n')
    add_references(report, problems)
    add_sweep(report, problems[0])
    add_parts(report, problems[0])
    add_corners(report)
    add_searches(report, problems[0], problems[1 + POINTS.index('light')])
    speeds = add_cost(report, problems[0])
    add_start(report, problems[0], next(seconds for n, seconds, *_ in speeds if n == len(problems[0].numbers.rpm)))
    add_points(report, problems[1:])
    write_csv(report, problems)
    draw('dynamics')
    report.save()


def main():
    with tempfile.TemporaryDirectory() as name:
        problems = [Problem(each, pathlib.Path(name)) for each in (SWEEP, *POINTS)]
        for problem in problems:
            assert problem.disagreement < 1e-12, f'{problem.name}: the references differ by {problem.disagreement:.1e}'
        compete(problems)
        write_report(problems)


main()
