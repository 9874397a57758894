"""The ledger: one row for each printed number, read from a CSV file beside this module.

Columns: `id` (unique in its file), `place`, `quantity`, `unit`, `printed`, `kind`, `inputs`, `reason`
(why the inputs have that status), `by`, `ours`, `tolerance`, `origin` (of the tolerance), `comment`.
doc/validation.md says what they mean.
"""

import csv
import decimal
import functools
import pathlib
import re
from dataclasses import dataclass

FOLDER = pathlib.Path(__file__).parent
PAPERS = {
    'dogan2021': 'Dogan, Kalay, Karpat 2021',
    'karpat2012': 'Karpat et al. 2012',
    'hassan2009': 'Hassan, Thanigaiyarasu, Ramamurti 2009',
    'thamba2020': 'Thamba et al. 2020',
}
CHECKS = {
    'independent': 'Other codes and other calculations',
    'golden': 'Pins of our own earlier output',
}
KINDS = ('input', 'result', 'claim')
INPUTS = ('stated', 'inferred', 'fitted', 'not reproducible', 'open')
BY = ('gearsweep', 'closed form', 'printed', 'case')


@dataclass(frozen=True)
class Row:
    """One printed number and how ours is found."""

    paper: str
    id: str
    place: str
    quantity: str
    unit: str
    printed: str
    kind: str
    inputs: str
    reason: str
    by: str
    ours: str
    tolerance: str
    origin: str
    comment: str

    @property
    def name(self):
        return f'{self.paper}:{self.id}'

    @property
    def value(self):
        """The printed value: a float, or a bool for a statement without a number."""
        return value_of(self.printed)

    @property
    def repeats(self):
        """Id of the row that this one repeats, or None."""
        return self.ours.removeprefix('same ') if self.ours.startswith('same ') else None

    @property
    def allowed(self):
        """The tolerance in the row's unit; None where the row has none."""
        return tolerance_of(self.tolerance, self.printed) if self.tolerance else None


def value_of(text):
    """A printed number, or true or false."""
    return text == 'true' if text in ('true', 'false') else float(text)


def tolerance_of(text, printed):
    """A sum of `exact`, `digit`, `digit/2`, `1 %` and numbers, in the unit of what is printed."""
    return sum(_part(part.strip(), printed) for part in text.split('+'))


def _part(part, printed):
    if part == 'exact':
        return 0.0
    if part in ('digit', 'digit/2'):
        return last_digit(printed) / (2 if part == 'digit/2' else 1)
    if part.endswith('%'):
        return abs(value_of(printed)) * float(part[:-1]) / 100
    return float(part)


def last_digit(text):
    """One unit of the last printed digit: 0.001 for 1.388, 1e-6 for 1.388e-3."""
    return float(decimal.Decimal(1).scaleb(decimal.Decimal(text).as_tuple().exponent))


@functools.cache
def read(name):
    """The rows of a file, in the order of the paper. ValueError names what is wrong with it."""
    with open(FOLDER / f'{name}.csv', newline='', encoding='utf-8') as file:
        rows = tuple(Row(paper=name, **entry) for entry in csv.DictReader(file))
    seen = {}
    for row in rows:
        check_row(row, seen)
        seen[row.id] = row
    return rows


def find(name, id):
    """The row of a file with this id."""
    return next(row for row in read(name) if row.id == id)


def check_row(row, seen):
    """ValueError where a row contradicts itself or those before it."""
    def need(condition, text):
        if not condition:
            raise ValueError(f'{row.name}: {text}')

    need(re.fullmatch(r'\w+', row.id) and row.id not in seen, 'the id is not a new word')
    need(row.kind in KINDS, f'kind = {row.kind}')
    need(row.by in (*BY, ''), f'by = {row.by}')
    _ = row.value, row.allowed  # which have their own errors
    if row.repeats:
        need(row.repeats in seen and not seen[row.repeats].repeats,
             f'repeats {row.repeats}, which does not stand before it')
        need(row.value == seen[row.repeats].value, f'contradicts {row.repeats}')
        return
    need(bool(row.by) == bool(row.ours), 'by and ours go together')
    need(bool(row.tolerance) == bool(row.origin), 'a tolerance needs its origin')
    if row.kind == 'input':
        need(not row.inputs, 'an input has no status')
    else:
        need(row.inputs in INPUTS, f'inputs = {row.inputs}')
        need(row.inputs == 'stated' or row.reason, 'what is not stated needs a reason')
        need((row.inputs in ('stated', 'inferred')) == bool(row.tolerance), 'only what is compared has a tolerance')
        need(row.inputs != 'open' or not row.ours, 'an open row has no value of ours')
