"""Numbers in README.md, CHANGELOG.md and doc/, each with what confirms it: claims.csv, doc/validation.md.

Columns of claims.csv: `file`; `text`, a part of it with # for every number that is checked; `by` and `ours`, which confirm them:

    computed  functions with their arguments (claimed.py, quantities.py, the papers' modules), divided by `; `: a number or several each
    found     PATH :: PATTERN, whose groups are the numbers, in another file
    tested    PATH :: TEXT, a line of a test or of the source that holds to it

`tolerance`: as in the ledger; otherwise the rounding of the number as it is written.
"""

import csv
import functools
import pathlib
import re
from dataclasses import dataclass

from . import check, claimed, dogan2021, hassan2009, karpat2012, ledger, quantities, thamba2020

ROOT = pathlib.Path(__file__).parent.parent
MODULES = (claimed, quantities, thamba2020, hassan2009, dogan2021, karpat2012)
NUMBER = r'-?\d+(?:\.\d+)?(?:e-?\d+)?'
ROUNDING = 0.6  # of a unit of the last digit: half of it, and what another processor makes of the next digits

# Files in which no number stands without what confirms it, and what stands for no number there.
COMPLETE = ('README.md', 'CHANGELOG.md', 'doc/dynamics.md', 'doc/elastic.md', 'doc/performance.md', 'doc/limits.md',
            'doc/pictures.md', 'doc/python.md', 'doc/stability.md', 'doc/precision.md', 'doc/linking.md', 'doc/flank.md')
NAMES = re.compile(
    r'ISO \d+(-\d+)?(:\d+)?|ISO/TR \d+-\d|ISO/\S+|(Johnson|Blok|Dowson|Schlenk|Ohlendorf) 19\d\d|Fortran \d+|Eqs?\. \d+( to \d+)?|[Cc]ase 1|FV32|version \d\S*|\d+\.\d+\.\d+|20\d\d-\d\d-\d\d|'
    r'BSD \d|C1[12]|20\d\d|(flang|gfortran|GCC|Python|Debian|Ubuntu) \d[\d.]*|-O\d|[Dd]amping above 1|next to 0|(exit )?code \d|contact\s+ratio of 2')


@dataclass(frozen=True)
class Claim:
    """Numbers in a file, and what confirms them."""

    file: str
    text: str
    by: str
    ours: str
    tolerance: str

    @property
    def pattern(self):
        """Finds the text, with a group for each of its numbers, whatever its line breaks."""
        words = (re.escape(word).replace(r'\#', f'({NUMBER})') for word in self.text.split())
        return re.compile(r'\s+'.join(words))


@functools.cache
def read():
    with open(pathlib.Path(__file__).with_name('claims.csv'), newline='', encoding='utf-8') as file:
        return tuple(Claim(**entry) for entry in csv.DictReader(file))


def wrong(claim):
    """What is wrong with a claim, or nothing."""
    found = claim.pattern.findall(content(claim.file))
    if len(found) != 1:
        return f'{claim.file} has this text {len(found)} times: {claim.text}'
    written = (found[0],) if isinstance(found[0], str) else found[0]
    if claim.by == 'tested':
        path, _, text = claim.ours.partition(' :: ')
        return '' if text in content(path) else f'{path} has no {text}'
    try:
        ours = _found(claim.ours) if claim.by == 'found' else _computed(claim.ours)
    except Exception as error:  # what a function fails with tells as much
        return f'{claim.ours}: {type(error).__name__}: {error}'
    if len(ours) != claim.text.count('#'):
        return f'{claim.text.count("#")} numbers, {len(ours)} of ours: {claim.text}'
    off = [f'{said}, ours {number:.7g}' for said, number in zip(written, ours)
           if abs(float(said) - number) > _allowed(claim, said) + 1e-12 * abs(number)]
    return f'{claim.text}: {"; ".join(off)}' if off else ''


def unconfirmed(file):
    """Lines of a file with a number that no claim has; code, generated blocks and names do not count."""
    text = _prose(content(file))
    for claim in read():
        if claim.file == file:
            text = claim.pattern.sub(lambda match: '\n' * match[0].count('\n'), text)
    text = NAMES.sub('', text)
    return [line.strip() for line in text.splitlines() if re.search(r'(?<![\w.])\d', line)]


@functools.cache
def content(path):
    return (ROOT / path).read_text(encoding='utf-8')


def _prose(text):
    for begin, end in ((r'<!-- validation: begin.*?-->', r'<!-- validation: end -->'),
                       (r'<!-- begin [\w.]+ -->', r'<!-- end [\w.]+ -->'), ('```', '```'), (r'\n## Damping\n', r'\Z')):
        text = re.sub(f'{begin}.*?{end}', '', text, flags=re.DOTALL)
    text = re.sub(r'(?m)^    .*$', '', text)
    return re.sub(r'\]\([^)]*\)', ']', text)


def _allowed(claim, said):
    if claim.tolerance:
        return ledger.tolerance_of(claim.tolerance, said)
    return ROUNDING * ledger.last_digit(said)


def _computed(call):
    numbers = []
    for one in call.split('; '):
        answer = check.value(one, *MODULES)
        numbers += answer if isinstance(answer, (tuple, list)) else [answer]
    return tuple(map(float, numbers))


def _found(place):
    path, _, pattern = place.partition(' :: ')
    found = re.findall(pattern, content(path), flags=re.MULTILINE)
    if len(found) != 1:
        raise ValueError(f'{path} has {pattern} {len(found)} times')
    return tuple(map(_number, (found[0],) if isinstance(found[0], str) else found[0]))


def _number(text):
    """1e-3_dp of Fortran is one as well."""
    return float(text.removesuffix('_dp').replace(' ', ''))
