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

# What a number is, for the counts: by words of its quantity and its unit, the first that fits both.
SORTS = (
    ('dynamic factors', r'(least )?DF\b', r'-'),
    ('natural frequencies', r'.*frequency', r'Hz|rad/s'),
    ('resonance speeds', r'.*resonance', r'1/min'),
    ('stresses', r'.*(stress|sigma|tau)', r'MPa|Pa'),
    ('strains and deformations', r'.*(strain|deformation)', r'-|mm|m'),
    ('reliefs', r'relief', r'um|mm'),
    ('lengths and diameters', r'', r'mm'),
    ('other numbers', r'', r'.*'),
)
SORT_NAMES = (*(name for name, *_ in SORTS), 'statements')

# Rows that one contradiction, or one input that is not stated, hits alike have one status, whatever ours are: their ids.
TOGETHER = {
    'dogan2021': (r'(best|rise)_(1600|1000)', r'(rise_peak|falls)_\d'),
    'karpat2012': (r'(approach|recess)_sign',),
    'hassan2009': (r'step_\d_sigma_[xy]_mpa|worst_step', r'dynamic_\d+_(sigma_[xy]|tau_xy)|growth|mean_is_static', r'mode_[2-5]_hz'),
    'thamba2020': (r'deformation_\w+_(tip|pitch|root)', r'(strain|stress)_(involute|modified)_\w+', r'f\d_modified', r'f\da_\w+',
                   r'life_(involute|modified)', r'd_[3-8]', r'f[23]_involute'),
}


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
    def sort(self):
        """What the number is, of `SORTS`; a statement without a number is one."""
        if isinstance(self.value, bool):
            return 'statements'
        return next(sort for sort, quantity, unit in SORTS if re.match(quantity, self.quantity) and re.fullmatch(unit, self.unit))

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
    check_together(name, rows)
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


def check_together(name, rows):
    """ValueError where rows that one contradiction hits differ in status, or are not there."""
    for pattern in TOGETHER.get(name, ()):
        hit = [row for row in rows if re.fullmatch(pattern, row.id) and not row.repeats]
        status = sorted({row.inputs for row in hit})
        if len(hit) < 2 or len(status) > 1:
            raise ValueError(f'{name}: {pattern}: {len(hit)} rows, of one status, not {", ".join(status)}')
