"""Numbers in README.md, CHANGELOG.md and doc/ are confirmed, each by what claims.csv names."""

import dataclasses

import pytest

from validation import claims


@pytest.fixture
def claim():
    """A claim that holds: 1635 dynamic factors take ..."""
    return next(claim for claim in claims.read() if claim.ours == 'sweep_ms')


@pytest.mark.parametrize('claim', [pytest.param(claim, id=f'{claim.file}: {claim.text}'[:100]) for claim in claims.read()])
def test_claim_holds(claim):
    assert not claims.wrong(claim)


@pytest.mark.parametrize('file', claims.COMPLETE)
def test_every_number_is_claimed(file):
    assert not claims.unconfirmed(file), 'numbers without a line in validation/claims.csv'


def test_a_changed_number_is_found(claim, monkeypatch):
    text = claims.content(claim.file)
    said = claim.pattern.search(text)
    for changed in (text.replace(said[0], said[0].replace(said[1], '137')), text.replace(said[0], '')):
        monkeypatch.setattr(claims, 'content', lambda path, changed=changed: changed)
        assert claims.wrong(claim)


def test_a_number_without_a_claim_is_found(claim, monkeypatch):
    text = claims.content(claim.file) + '\nIt is 17 times as good.\n'
    monkeypatch.setattr(claims, 'content', lambda path: text)
    assert claims.unconfirmed(claim.file) == ['It is 17 times as good.']


@pytest.mark.parametrize('changes', [{'ours': 'prescribed'}, {'by': 'tested', 'ours': 'doc/case.md :: shows 136 stiff'},
                                     {'by': 'found', 'ours': r'test/extreme/cases.txt :: ^# (\d+) never'}])
def test_what_does_not_confirm_is_found(claim, changes):
    assert claims.wrong(dataclasses.replace(claim, **changes))
