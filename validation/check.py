"""Our value beside each printed one, and what follows."""

import math
from dataclasses import dataclass

from . import dogan2021, hassan2009, karpat2012, ledger, quantities, thamba2020

# Where the functions of a file's rows are, in this order.
FUNCTIONS = {
    'dogan2021': (dogan2021, quantities),
    'karpat2012': (karpat2012, quantities),
    'hassan2009': (hassan2009, quantities),
    'thamba2020': (thamba2020, quantities),
    'independent': (quantities, thamba2020),
    'golden': (dogan2021, quantities),
}

VERDICTS = ('within', 'deviates', 'failed', 'fitted', 'not reproducible', 'open', 'input', 'repeat')


@dataclass(frozen=True)
class Outcome:
    """A row with our value (None where there is none) and the verdict; `message` says why it failed."""

    row: ledger.Row
    ours: float | bool | None
    verdict: str
    message: str = ''

    @property
    def bad(self):
        return self.verdict in ('deviates', 'failed')

    @property
    def deviation(self):
        """Ours less the printed value; None where either is no number."""
        if self.ours is None or isinstance(self.row.value, bool):
            return None
        return self.ours - self.row.value


def compute(row):
    """Our value of a row, by the function that `ours` names with its arguments."""
    return value(row.ours, *FUNCTIONS[row.paper])


def value(call, *modules):
    """What a function of the first module that has it gives, with its arguments behind blanks."""
    name, *words = call.split()
    for module in modules:
        if hasattr(module, name):
            return getattr(module, name)(*map(_argument, words))
    raise AttributeError(f'no function {name}')


def _argument(word):
    for kind in (int, float):
        try:
            return kind(word)
        except ValueError:
            pass
    return word


def check(row):
    """The outcome of one row. A function that raises makes it `failed`."""
    if row.repeats:
        return Outcome(row, None, 'repeat')
    if not row.ours:
        return Outcome(row, None, row.inputs or 'input')
    try:
        ours = compute(row)
        ours = bool(ours) if isinstance(row.value, bool) else float(ours)
    except Exception as error:  # one row's failure must not hide the others
        return Outcome(row, None, 'failed', f'{type(error).__name__}: {error}')
    if not math.isfinite(ours):
        return Outcome(row, None, 'failed', f'{row.ours} gives {ours}')
    if row.allowed is None:
        return Outcome(row, ours, row.inputs)
    if agrees(row, ours):
        return Outcome(row, ours, 'input' if row.kind == 'input' else 'within')
    return Outcome(row, ours, 'deviates')


def agrees(row, ours):
    """Within the row's tolerance, but for the rounding of binary numbers."""
    return abs(ours - row.value) <= row.allowed + 1e-12 * abs(row.value)


def run(papers):
    """All outcomes of the papers, in their order."""
    return [check(row) for paper in papers for row in ledger.read(paper)]


def counts(outcomes):
    """How many rows have each verdict."""
    return {verdict: sum(outcome.verdict == verdict for outcome in outcomes) for verdict in VERDICTS}
