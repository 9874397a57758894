"""Numbers on the pages, in digits and in words, each with what confirms it: claims.csv, doc/validation.md.

Columns of claims.csv: `file`, or `*` for what all pages say alike; `text`, a part of it with # for every number that is checked and
@ for every formula; `by` and `ours`, which confirm them:

    computed  functions with their arguments (claimed.py, quantities.py, the papers' modules), divided by `; `: a number or several each
    found     PATH :: PATTERN, whose groups are the numbers, in another file
    tested    PATH :: TEXT, a line of a test or of the source that holds to it; the numbers of `text` are among its own
    formula   a function of formulas.py: the names that the formulas have, and their values by the library; the page's are evaluated
    stated    SOURCE: what has no other home here: a definition, a page of a book, a measurement with its command

stated.txt has the numbers that no line of claims.csv confirms: definitions, the literature, counts of what a sentence names, examples
that are not run, measurements of long ago. `python -m validation.claims` writes it anew; read what it changes, for nothing else
sees whether it is right.

`tolerance`: as in the ledger; of a formula relative; otherwise the rounding of the number as it is written.
"""

import csv
import functools
import itertools
import pathlib
import re
from dataclasses import dataclass

from . import check, claimed, dogan2021, formulas, hassan2009, karpat2012, ledger, quantities, thamba2020

ROOT = pathlib.Path(__file__).parent.parent
STATED = pathlib.Path(__file__).with_name('stated.txt')
NEAR = 4  # words between numbers that are kept together
MODULES = (claimed, quantities, thamba2020, hassan2009, dogan2021, karpat2012)
DIGITS = r'-?\d+(?:\.\d+)?(?:e-?\d+)?'
#: Numbers in words; `one`, `once`, `first`, `second` and `third` mostly count nothing.
SAID = {'half': 1 / 2, 'quarter': 1 / 4, 'two thirds': 2 / 3, 'three quarters': 3 / 4, 'twice': 2, 'two': 2, 'three': 3, 'four': 4,
        'five': 5, 'six': 6, 'seven': 7, 'eight': 8, 'nine': 9, 'ten': 10, 'eleven': 11, 'twelve': 12, 'twenty': 20, 'thirty': 30,
        'forty': 40, 'fifty': 50, 'hundred': 100, 'thousand': 1000, 'million': 1e6, 'fourth': 4, 'fifth': 5, 'sixth': 6, 'seventh': 7,
        'eighth': 8, 'ninth': 9, 'tenth': 10, 'twentieth': 20, 'fiftieth': 50, 'hundredth': 100, 'thousandth': 1000}
WORDS = '|'.join(sorted(SAID, key=len, reverse=True))
ANY = rf'{WORDS}|halves|tenths|quarters|thirds|hundreds|thousands|[a-z]+teen|[a-z]+ty-[a-z]+'
NUMBER = rf'{DIGITS}|\b(?:{WORDS})\b'
ROUNDING = 0.6  # of a unit of the last digit: half of it, and what another processor makes of the next digits

# Names of cases, which hold no number of a page.
NAMES = re.compile(r'[Cc]ase 1\b|\bC1[12]\b|-O\d')
# In CHANGELOG.md standards, years and versions change no reader's mind.
HISTORY = re.compile(r'ISO(/TR)? [\d-]+(:\d+)?|Fortran \d+|20\d\d|## [\d.]+')
# What stands between these is held by tests of its own: blocks that commands write (test_ledger, test_choices, test_asymmetric,
# test_life_factors; below for what is measured), keys (suite `declarations`), examples (test_pages, test_readme), lines of Python (run), pictures (test_site).
BLOCKS = (r'<!-- validation: begin.*?<!-- validation: end -->', r'<!-- ([\w ]+): begin, by python -m .*?<!-- \1: end -->',
          r'<!-- begin ([\w.]+) -->.*?<!-- end \1 -->', r'<!-- keys of .*?<!-- end of keys -->', r'<!-- its picture: .*? -->',
          r'<!-- (?:a case|the case|what the program prints|prints the|what these lines|from what it prints)[^>]*-->\n```.*?```',
          r'```python\n>>>.*?```', r'```pycon.*?```')
MEASURED = re.compile(r'<!-- begin ([\w.]+) -->\n(.*?)<!-- end \1 -->', re.DOTALL)


def pages():
    """All files whose numbers are confirmed."""
    return ('README.md', 'CHANGELOG.md', 'CONTRIBUTING.md', 'examples/README.md', 'include/gearsweep.h',
            *sorted(str(path.relative_to(ROOT)) for folder in ('doc', 'doc/develop') for path in (ROOT / folder).glob('*.md')))


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
        words = (re.escape(word).replace(r'\#', f'({NUMBER})').replace('@', '(.+?)') for word in self.text.split())
        return re.compile(r'(?<![\w.])' * self.text[:1].isalnum() + r'\s+(?:\* )?'.join(words) + r'(?![\w])' * self.text[-1:].isalnum())


@functools.cache
def read():
    with open(pathlib.Path(__file__).with_name('claims.csv'), newline='', encoding='utf-8') as file:
        return tuple(Claim(**entry) for entry in csv.DictReader(file))


def wrong(claim):
    """What is wrong with a claim, or nothing."""
    anywhere = claim.file == '*'
    found = [said for file in (pages() if anywhere else (claim.file,)) for said in claim.pattern.findall(content(file))]
    if not found or (len(found) > 1 and not anywhere):
        return f'{claim.file} has this text {len(found)} times: {claim.text}'
    if claim.by == 'stated':
        return '' if claim.ours and not re.search('[#@]', claim.text) else 'has no source, or a number that is not compared'
    if claim.by == 'tested':
        return _untested(claim)
    try:
        return ''.join(_off(claim, (said,) if isinstance(said, str) else said) for said in found)
    except Exception as error:  # what a function fails with says as much
        return f'{claim.ours}: {type(error).__name__}: {error}'


def _untested(claim):
    """The line of a test that is not there, or numbers that it lacks."""
    path, _, text = claim.ours.partition(' :: ')
    if text not in content(path):
        return f'{path} has no {text}'
    theirs = {float(number) for number in re.findall(r'(?<![A-Za-z_.\d])\d+(?:\.\d+)?(?:e-?\d+)?', text)}
    ours = [float(number) for number in re.findall(r'(?<![A-Za-z_.\d])\d+(?:\.\d+)?(?:e-?\d+)?', NAMES.sub('', claim.text))]
    lacking = [number for number in ours if not any(abs(number - per_cent * other) <= 1e-9 * number
                                                    for other in theirs for per_cent in (1, 100))]
    return f'{path} has no {lacking} in {text}' if lacking else ''


def _off(claim, written):
    if claim.by == 'formula':
        names, expected = check.value(claim.ours, formulas)
        return formulas.off(written, names, expected, float(claim.tolerance or 1e-9))
    ours = _found(claim.ours) if claim.by == 'found' else _computed(claim.ours)
    if len(ours) != claim.text.count('#'):
        return f'{claim.text.count("#")} numbers, {len(ours)} of ours: {claim.text}'
    off = [f'{said}, ours {number:.7g}' for said, number in zip(written, ours)
           if abs(number_of(said) - number) > _allowed(claim, said) + 1e-12 * abs(number)]
    return f'{claim.text}: {"; ".join(off)}' if off else ''


def number_of(said):
    """In digits or in words."""
    return SAID[said] if said in SAID else float(said)


def unconfirmed(file):
    """The numbers of a file, in digits or in words, that no claim has, with their neighbours; names and what other tests hold do
    not count.
    """
    text = _free(file)
    held = [match.span() for claim in read() if claim.file in (file, '*') for match in claim.pattern.finditer(text)]
    letters = list(text)
    for begin, end in held:
        letters[begin:end] = [' '] * (end - begin)
    text = (HISTORY if file == 'CHANGELOG.md' else NAMES).sub(' ', re.sub(r'\]\([^)]*\)', ']', ''.join(letters)))
    words = r'(?!)' if file == 'CHANGELOG.md' else ANY   # what was done counts in words without end
    number = re.compile(rf'(?<![\w.])\d|\b(?:{words})\b', re.IGNORECASE)
    said = text.split()
    at = [k for k, word in enumerate(said) if number.search(word)]
    runs = [[k] for k in at[:1]]
    for last, k in itertools.pairwise(at):
        runs[-1].append(k) if k - last <= NEAR else runs.append([k])
    return [' '.join(said[max(0, run[0] - 1):run[-1] + 2]) for run in runs]


@functools.cache
def kept():
    """By file, the numbers of stated.txt."""
    found = {file: [] for file in pages()}
    for part in STATED.read_text(encoding='utf-8').split('\n== ')[1:]:
        file, *found_there = part.strip().splitlines()
        found[file] = found_there
    return found


def keep():
    """Writes stated.txt anew."""
    head = STATED.read_text(encoding='utf-8').split('\n== ')[0]
    parts = ['\n'.join([f'== {file}', *sorted(unconfirmed(file))]) for file in pages() if unconfirmed(file)]
    STATED.write_text('\n'.join([head, *parts]) + '\n', encoding='utf-8')


@functools.cache
def content(path):
    return (ROOT / path).read_text(encoding='utf-8')


def _free(file):
    """A page without what other tests hold."""
    text = content(file)
    if file == 'doc/tables.md':
        text = re.sub(r'(?m)^(\||-) `.*$', '', text)             # test_tables
    if file == 'doc/develop/architecture.md':
        text = re.sub(r'<!-- rooms: begin.*?<!-- rooms: end -->', '', text, flags=re.DOTALL)  # test/lint.sh
    for block in BLOCKS:
        text = re.sub(block, '', text, flags=re.DOTALL)
    return re.sub(r'(?m)^(>>>|\.\.\.) .*$', '', text)


def _allowed(claim, said):
    if claim.tolerance:
        return ledger.tolerance_of(claim.tolerance, said)
    return 0 if said in SAID else ROUNDING * ledger.last_digit(said)


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
    """1e-3_dp of Fortran is one as well, and so are words."""
    if text in SAID:
        return SAID[text]
    return float(text.removesuffix('_dp').replace(' ', ''))


if __name__ == '__main__':
    keep()
