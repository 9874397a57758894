"""Numbers on the pages are confirmed, each by what claims.csv names."""

import collections
import dataclasses

import numpy as np
import pytest

from validation import claims, formulas


@pytest.fixture
def claim():
    """A claim that holds: 1635 dynamic factors take ..."""
    return next(claim for claim in claims.read() if claim.ours == 'sweep_ms')


@pytest.mark.parametrize('claim', [pytest.param(claim, id=f'{claim.file}: {claim.text}'[:100]) for claim in claims.read()])
def test_claim_holds(claim):
    assert not claims.wrong(claim)


@pytest.mark.parametrize('file', claims.pages())
def test_every_number_is_claimed(file):
    there, known = (collections.Counter(phrases) for phrases in (claims.unconfirmed(file), claims.kept()[file]))
    assert not there - known, 'numbers without a line in validation/claims.csv or stated.txt'
    assert not known - there, 'numbers of validation/stated.txt that the page has no more: python -m validation.claims'


def test_a_changed_number_is_found(claim, monkeypatch):
    text = claims.content(claim.file)
    said = claim.pattern.search(text)
    for changed in (text.replace(said[0], said[0].replace(said[1], '137')), text.replace(said[0], '')):
        monkeypatch.setattr(claims, 'content', lambda path, changed=changed: changed)
        assert claims.wrong(claim)


@pytest.mark.parametrize(('words', 'found'), [
    ('It is 17 times as good.', 'is 17 times'), ('It is a fiftieth too stiff.', 'a fiftieth too'), ('Now half of it is enough.', 'Now half of'),
    ('As a block:\n\n    f = 3 x', '= 3 x')])
def test_a_number_without_a_claim_is_found(claim, words, found, monkeypatch):
    known = claims.unconfirmed(claim.file)
    text = claims.content(claim.file) + f'\n{words}\n'
    monkeypatch.setattr(claims, 'content', lambda path: text)
    assert claims.unconfirmed(claim.file) == [*known, found]


def test_a_changed_formula_is_found(monkeypatch):
    claim = next(claim for claim in claims.read() if claim.ours == 'friction_factors')
    text = claims.content(claim.file)
    changed = text.replace('f = 1 - mu rho/r_b', 'f = 1 + mu rho/r_b')
    assert changed != text
    monkeypatch.setattr(claims, 'content', lambda path: changed)
    assert 'by the library' in claims.wrong(claim)


def test_the_numbers_of_a_tested_claim_are_those_of_the_line():
    claim = next(claim for claim in claims.read() if claim.by == 'tested' and '0.5 %' in claim.text)
    path, _, line = claim.ours.partition(' :: ')
    assert claims.wrong(dataclasses.replace(claim, ours=f'{path} :: {line[:3]}'))


def test_the_page_has_what_was_measured():
    blocks = dict(claims.MEASURED.findall(claims.content('doc/accuracy.md')))
    stored = {path.stem: claims.content(f'bench/measured/{path.name}') for path in (claims.ROOT / 'bench' / 'measured').glob('*.short.md')}
    assert blocks == stored and len(stored) > 2, 'run sh bench/run.sh doc'


@pytest.mark.parametrize(('text', 'names', 'value'), [
    ('30000/(pi z1) sqrt(c/m)', {'z1': 2, 'c': 9, 'm': 4}, 30000 / (2 * np.pi) * 1.5), ('2 w/(pi p)', {'w': 3, 'p': 2}, 3 / np.pi),
    ("|1 - c' a|", {"c'": 2, 'a': 3}, 5), ('1/E*', {'E*': 4}, 0.25), ('U^0.5 W^-1', {'U': 4, 'W': 8}, 0.25)])
def test_formulas_are_read_as_printed(text, names, value):
    assert formulas.value(text, names) == pytest.approx(value, rel=1e-14)


@pytest.mark.parametrize('changes', [{'ours': 'prescribed'}, {'by': 'tested', 'ours': 'doc/case.md :: shows 136 stiff'},
                                     {'by': 'found', 'ours': r'test/properties/extreme/cases.txt :: ^# (\d+) never'}])
def test_what_does_not_confirm_is_found(claim, changes):
    assert claims.wrong(dataclasses.replace(claim, **changes))
