"""Do two builds answer the same? All tables and the screen of one case: python3 test/cases/compare.py ONE OTHER CASE

ONE and OTHER are folders with what each build wrote for the case: its tables CASE.*.csv, its screen CASE.txt and
its exit code CASE.code. Words, counts and the inputs must be the same; numbers as the rules below allow. Prints one
row, `case, values compared, numbers that differ, largest deviation over allowed, where`, and below it each rule broken
with an example. The exit code is 0 where nothing is broken.
"""

import csv
import re
import sys
from pathlib import Path

# Rounding, 2.2e-16, times the condition of what is solved, some 1e6 for the finite-element grids of data/; of the
# largest number in the column.
ROUNDING = 2e-10
# What the sweep is asked for (&numerics tolerance, which no case of data/ states), in static loads.
TOLERANCE = 1e-6
# A bound of an error that lies below this, in units of what it bounds, is rounding and nothing else.
NOTHING = 1e-9
# The steps of a point are chosen by its error; where that lies at the limit, rounding decides. The next choice has
# 2**(1/3) times the steps and, as the method is of sixth order, a fourth of the error.
MORE_STEPS, LESS_ERROR = 1.3, 5

# The rule of a number's column: its largest deviation, where it is not ROUNDING of the column's largest number.
#   text       equal as text: words, whole numbers and what the case gives
#   estimated  the sum of both error estimates, which stand in the column named, and ROUNDING
#   bound      an error estimate or a residual: no number but a bound, alike to LESS_ERROR, or next to nothing
#   steps      a choice, alike to MORE_STEPS
#   own        ROUNDING of each number by itself, as the column mixes quantities
#   asked      a number along the motion, without an estimate of its own: TOLERANCE of the column's largest
#   relative   the same, with the estimate relative to the number
#   angle      ROUNDING of a turn, over amplitude: a harmonic next to nothing has no phase
RULES = {
    'sweep': {
        'relief_um': 'text', 'rpm': 'text', 'steps': 'steps', 'mesh_periods': 'text', 'dynamic_factor': 'estimated error_estimate',
        'error_estimate': 'bound', 'residual': 'bound', 'floquet_modulus': 'asked', 'coast_factor': 'asked',
        'dte_rms_um': 'estimated dte_error_estimate_um', 'dte_peak_to_peak_um': 'estimated dte_error_estimate_um',
        'dte_error_estimate_um': 'bound',
    },
    'load': {
        'relief_um': 'text', 'rpm': 'text', 'mesh_periods': 'text', 'pair': 'text', 'pair_load_n': 'asked', 'load_ratio': 'asked', 'dte_um': 'asked',
    },
    'mesh': {'relief_um': 'text'},
    'harmonics': {
        'relief_um': 'text', 'harmonic': 'text', 'amplitude_um': 'estimated error_estimate_um', 'error_estimate_um': 'bound',
        'phase_deg': 'angle amplitude_um',
    },
    # Reliefs that the search tries follow from the load and the stiffness.
    'optimum_curve': {'worst_dynamic_factor': 'asked', 'rpm': 'text', 'points_without_answer': 'text', 'at_least': 'text'},
    'optimum': {'worst_dynamic_factor': 'asked', 'rpm': 'text', 'points_without_answer': 'text'},
    'load_points': {
        'relief_um': 'text', 'rpm': 'text', 'mesh_periods': 'text', 'dynamic_factor': 'estimated error_estimate', 'error_estimate': 'bound',
        'coast_factor': 'asked', 'mean_load_ratio': 'asked', 'load_rms_ratio': 'asked', 'pair_load_rms_ratio': 'asked',
        'impacts': 'text', 'load_reversals': 'text', 'separation_share': 'asked', 'dte_mean_um': 'asked', 'dte_rms_um': 'asked',
        'dte_peak_to_peak_um': 'asked',
    },
    'motion_harmonics': {
        'relief_um': 'text', 'rpm': 'text', 'harmonic': 'text', 'frequency_hz': 'asked', 'dte_amplitude_um': 'asked',
        'dte_phase_deg': 'angle dte_amplitude_um', 'mesh_load_amplitude_n': 'asked', 'mesh_load_phase_deg': 'angle mesh_load_amplitude_n',
    },
    'torque': {
        'relief_um': 'text', 'rpm': 'text', 'pinion_torque_nm': 'asked', 'gear_torque_nm': 'asked', 'pinion_friction_nm': 'asked',
        'gear_friction_nm': 'asked', 'pinion_damping_nm': 'asked', 'dte_um': 'asked',
    },
    'torque_points': {
        'relief_um': 'text', 'rpm': 'text', 'pinion_mean_nm': 'estimated pinion_error_nm', 'pinion_least_nm': 'estimated pinion_error_nm',
        'pinion_largest_nm': 'estimated pinion_error_nm', 'pinion_error_nm': 'bound', 'pinion_friction_mean_nm': 'asked',
        'gear_mean_nm': 'estimated gear_error_nm', 'gear_least_nm': 'estimated gear_error_nm', 'gear_largest_nm': 'estimated gear_error_nm',
        'gear_error_nm': 'bound', 'gear_friction_mean_nm': 'asked', 'friction_loss': 'asked', 'dynamic_factor': 'estimated error_estimate',
        'error_estimate': 'bound', 'mesh_periods': 'text',
    },
    'torque_harmonics': {
        'relief_um': 'text', 'rpm': 'text', 'harmonic': 'text', 'pinion_amplitude_nm': 'estimated pinion_error_nm',
        'pinion_phase_deg': 'angle pinion_amplitude_nm', 'pinion_error_nm': 'bound', 'gear_amplitude_nm': 'estimated gear_error_nm',
        'gear_phase_deg': 'angle gear_amplitude_nm', 'gear_error_nm': 'bound',
    },
    'sweep_worst': {'relief_um': 'text', 'worst_dynamic_factor': 'asked', 'rpm': 'text'},
    'resonances': {'relief_um': 'text', 'dynamic_factor': 'asked', 'rpm': 'text'},
    'sweep_summary': {'best_relief_um': 'text', 'worst_dynamic_factor': 'asked', 'rpm': 'text', 'largest_error_estimate': 'bound'},
    'transmission_error': {'relief_um': 'text', 'error_estimate_um': 'bound'},
    'root_stress': {'relief_um': 'text', 'tension_deg': 'asked', 'compression_deg': 'asked', 'error_estimate': 'bound'},
    'modal': {'mode': 'text', 'frequency_hz': 'relative error_estimate', 'error_estimate': 'bound', 'residual': 'bound', 'rim_share': ''},
    'mode_energy': {'mode': 'text', 'tooth': 'text', 'energy_share': ''},
    'published': {'printed': 'text', 'ours': 'own'},
}  # fmt: skip

NUMBER = re.compile(r'(?<![\w.])[-+]?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?(?![\w])')


class Comparison:
    """What was compared, and what came out."""

    def __init__(self):
        self.values = self.differ = 0
        self.worst, self.place = 0.0, '-'
        self.broken = {}

    def number(self, place, one, other, allowed):
        self.values += 1
        if one == other or (one != one and other != other):
            return
        self.differ += 1
        deviation = abs(one - other)
        over = deviation / allowed if allowed > 0 else float('inf')
        if not over <= self.worst:
            self.worst, self.place = over, place
        if not over <= 1:
            self.breaks(place, f'{one!r} and {other!r}, allowed {allowed:.1e}')

    def same(self, place, one, other):
        self.values += 1
        if one != other:
            self.breaks(place, f'{one!r} and {other!r}')

    def breaks(self, place, example):
        self.broken.setdefault(place, []).append(example)


def table(path):
    """The columns of a table as texts; the case that stands before it is left out."""
    with open(path, newline='') as file:
        rows = list(csv.reader(line for line in file if not line.startswith('#')))
    return dict(zip(rows[0], zip(*rows[1:]))) if len(rows) > 1 else dict.fromkeys(rows[0], ())


def is_number(text):
    try:
        return float(text) == float(text)
    except ValueError:
        return False


def is_bound_alike(one, other):
    return max(one, other) <= NOTHING or max(one, other) <= LESS_ERROR * min(one, other)


def compare_column(result, place, rule, one, other, ones, others):
    """One column of two tables of as many rows; `ones` and `others` are the tables."""
    if rule == 'text' or not any(map(is_number, one)):
        for a, b in zip(one, other):
            result.same(place, a, b)
        return
    a, b = [float(v) for v in one], [float(v) for v in other]
    largest = max((abs(v) for v in a if v == v), default=0)
    kind, _, name = rule.partition(' ')
    for i in range(len(a)):
        if kind in ('bound', 'steps'):
            result.values += 1
            result.differ += a[i] != b[i]
            alike = is_bound_alike(a[i], b[i]) if kind == 'bound' else max(a[i], b[i]) <= MORE_STEPS * min(a[i], b[i])
            if not alike:
                result.breaks(place, f'{a[i]!r} and {b[i]!r}')
            continue
        allowed = TOLERANCE * largest if kind == 'asked' else ROUNDING * (abs(a[i]) if kind == 'own' else largest)
        if kind in ('estimated', 'relative'):
            estimates = float(ones[name][i]) + float(others[name][i])
            allowed += estimates * (abs(a[i]) if kind == 'relative' else 1)
        if kind == 'angle':
            amplitude = [float(v) for v in ones[name]]
            allowed = min(360, ROUNDING * 360 * max(amplitude) / max(amplitude[i], 1e-300))
        result.number(place, a[i], b[i], allowed)


def compare_tables(result, one, other, case):
    names = sorted(path.name for path in one.glob(f'{case}.*.csv'))
    result.same('tables', names, sorted(path.name for path in other.glob(f'{case}.*.csv')))
    for name in names:
        kind = name.split('.')[-2]
        if not (other / name).exists():
            continue
        ones, others = table(one / name), table(other / name)
        result.same(f'{kind}: columns', list(ones), list(others))
        result.same(f'{kind}: rows', [len(v) for v in ones.values()], [len(v) for v in others.values()])
        if list(ones) != list(others) or [len(v) for v in ones.values()] != [len(v) for v in others.values()]:
            continue
        for column in ones:
            rule = RULES.get(kind, {}).get(column, '')
            compare_column(result, f'{kind}: {column}', rule, ones[column], others[column], ones, others)


def screen(path):
    """Lines of an answer without what tells of time and place."""
    lines = path.read_text().splitlines()
    return [line for line in lines if not line.startswith(('Time', 'Wrote'))]


def compare_screens(result, one, other):
    """The same words; whole numbers the same but for resonances, others but for one unit of the last digit shown.

    With a negative exponent stand error estimates, residuals and what is zero but for rounding: as bounds.
    """
    result.same('screen: lines', len(one), len(other))
    for a, b in zip(one, other):
        words = [' '.join(NUMBER.sub('#', line).split()) for line in (a, b)]
        result.same('screen: words', *words)
        if words[0] != words[1]:
            continue
        for x, y in zip(NUMBER.findall(a), NUMBER.findall(b)):
            if 'e-' in x.lower() or 'e-' in y.lower():
                result.values += 1
                if not is_bound_alike(abs(float(x)), abs(float(y))):
                    result.breaks('screen: bounds', f'{x} and {y} in {a!r}')
            elif '.' in x or '.' in y or not a.strip(' 0123456789'):
                # Rounded to so many digits, two numbers next to each other may lie on both sides of a half.
                digits = min(len(t.partition('.')[2].partition('e')[0]) for t in (x, y))
                result.number('screen: numbers', float(x), float(y), 1.001 * 10.0**-digits)
            else:
                result.same('screen: whole numbers', x, y)


def undecided(one, case):
    """How many points have no steady motion that repeats, and so no number to compare: their word is compared."""
    path = one / f'{case}.sweep.csv'
    status = table(path)['status'] if path.exists() else ()
    return sum(word in ('aperiodic', 'chaotic', 'transient') for word in status)


def main():
    one, other, case = Path(sys.argv[1]), Path(sys.argv[2]), sys.argv[3]
    result = Comparison()
    compare_tables(result, one, other, case)
    compare_screens(result, screen(one / f'{case}.txt'), screen(other / f'{case}.txt'))
    result.same('exit code', (one / f'{case}.code').read_text(), (other / f'{case}.code').read_text())
    print(f'{case:<10}{result.values:>9}{result.differ:>9}{result.worst:>12.1e}   {result.place}')
    if count := undecided(one, case):
        print(f'  {count} points are chaotic or have a transient that stays: rounding decides where they are, so only the word is compared')
    for place, examples in result.broken.items():
        print(f'  FAILED {place}: {len(examples)} differ, as {examples[0]}')
    if result.values < 100:
        print('  FAILED there is hardly anything to compare')
        return 1
    return 1 if result.broken else 0


if __name__ == '__main__':
    sys.exit(main())
