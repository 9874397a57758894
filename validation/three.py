"""The three checks that the project was asked for, beside ours: a natural frequency, dynamic stresses, dynamic factors."""

import sys
import textwrap

from . import check, hassan2009, ledger
from .moving_load import GRID, SPEEDS


def sentences():
    """What is printed, ours, and why, of each in its turn, as each takes a second or more."""
    yield _frequency()
    yield _stresses()
    yield _factors()


def computed(stream=None):
    """All of them, with a line on the progress before each."""
    found, one_by_one = [], sentences()
    for number, what in enumerate(('natural frequency', 'stresses of Table 3', 'dynamic factors'), 1):
        print(f'Check {number} of 3: {what} ...', file=stream or sys.stderr, flush=True)
        found.append(next(one_by_one))
    return found


def text(found):
    """For the screen."""
    return '\n'.join(textwrap.fill(one, 130, initial_indent='- ', subsequent_indent='  ') for one in found)


def markdown(found):
    """For the page."""
    return '\n'.join(f'- {one}' for one in found)


def _frequency():
    row, stress = _row('hassan2009', 'beam_frequency_rad_s'), _row('hassan2009', 'beam_sigma_y_mpa')
    steel = hassan2009.COMMON_STEEL
    return (f'{row.printed} rad/s, a tooth as a beam (Hassan 2009): ours {check.compute(row):.0f} by the stated inputs, {row.inputs}; '
            f'{hassan2009.beam_frequency("r_a-r_b"):.0f} with l = r_a - r_b, which the printed {stress.printed} MPa needs too; '
            f'{hassan2009.beam_frequency("r_a-r_b", *steel):.0f} with E and density of common steel besides, which contradict the stated ones.')


def _stresses():
    row, name = _row('hassan2009', 'dynamic_360_sigma_x'), hassan2009.MOVING + GRID
    printed = _list(f'{hassan2009.printed(f"dynamic_{speed}_mises"):.0f}' for speed in SPEEDS)
    ranges = []
    for speed in SPEEDS:
        values = (hassan2009.largest(speed, 'mises', name), *hassan2009.band(speed, 'mises', name))
        ranges.append(f'{min(values):.0f} to {max(values):.0f}')
    return (f'Table 3, largest von Mises stress at {_list(SPEEDS)} 1/min (Hassan 2009): printed {printed} MPa, ours {_list(ranges)}, '
            f'{row.inputs}: whether and where the load jumps between nodes 70 and 68 is not stated, and the stress depends on it; at '
            f'{SPEEDS[0]} 1/min sigma_y is printed nearly as at rest, {hassan2009.printed("dynamic_360_sigma_y"):g} for '
            f'{hassan2009.printed("step_4_sigma_y_mpa"):g}, as if the load came slowly.')


def _factors():
    rows = [_row('dogan2021', id) for id in ('df_1', 'df1_15', 'df2_15')]
    without, relieved, second = rows
    ours = [check.compute(row) for row in rows]
    within = 'within' if all(check.agrees(row, value) for row, value in zip(rows[:2], ours)) else 'NOT within'
    return (f'DF {without.printed} -> {relieved.printed}, without relief at 1600 1/min, with 15 um in the first resonance (Dogan 2021, case 1): ours {ours[0]:.3f} -> {ours[1]:.3f}, {within} '
            f'{without.allowed:g} and {relieved.allowed:g}, {without.inputs}: load, body behind the teeth and which gear is relieved are not stated. '
            f'{second.printed} in the second resonance is {second.inputs}: ours {ours[2]:.3f}.')


def _list(values):
    *first, last = map(str, values)
    return f'{", ".join(first)} and {last}'


def _row(paper, id):
    return ledger.find(paper, id)
