"""How far the inputs that a paper leaves open move our values: where tolerances come from."""

from . import check, ledger

MARK = '--spread'  # an origin with this word rests on these variants

# Alternatives by input: variants of the case.
STIFFNESS = ('+weber', '+iso6336', '+one-tooth', '+plane-stress')
RACK_TIP = ('+rack-tip-0.25', '+rack-tip-0.38')
INPUTS = {
    'mode': (RACK_TIP, ('+coarse',)),
    'dogan2021': (STIFFNESS, ('+friction-0.05',)),
}


def rows():
    """The rows whose tolerance rests on a spread."""
    return [row for paper in ledger.PAPERS for row in ledger.read(paper) if MARK in row.origin]


def moves(row):
    """By how much the alternatives move our value of a row: a list of {alternative: difference}, by input."""
    base = check.compute(row)
    inputs = INPUTS.get(row.ours.split()[0]) or INPUTS[row.paper]
    return [{word: check.compute(_with(row, word)) - base for word in alternatives} for alternatives in inputs]


def most(row):
    """The widest tolerance that this bears: all inputs at their worst, and half a printed digit."""
    return sum(max(map(abs, by_input.values())) for by_input in moves(row)) + ledger.last_digit(row.printed) / 2


def text():
    """A line for each of these rows."""
    lines = []
    for row in rows():
        found = '; '.join(', '.join(f'{word} {move:+.3g}' for word, move in part.items()) for part in moves(row))
        lines.append(f'{row.name}: printed {row.printed}, ours {check.compute(row):.5g}; {found}; '
                     f'bears {most(row):.3g}, tolerance {row.allowed:.3g}')
    return '\n'.join(lines)


def _with(row, word):
    """The row with an alternative; the case is the function's first argument."""
    name, case, *rest = row.ours.split()
    return ledger.Row(**{**vars(row), 'ours': ' '.join((name, case + word, *rest))})
