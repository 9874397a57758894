"""What compares pages with what commands make sees a changed number, however small it is."""

import pytest
from conftest import alike

SAME = [('3e-9', '8e-9'), ('3e-15', '8e-14'), ('0', '1e-14'), ('1.13462572', '1.13462573'), ('161.6', '161.7'), ('136 cases. A, 1', '136 cases. B, 2')]
OTHER = [('3e-9', '1e-15'), ('8e-10', '8e-8'), ('4e-10', '9e-8'), ('0.01', '0.02'), ('0.0006', '0.0007'), ('5e-5', '4e-5'), ('2', '2.4'), ('0', '1e-10'),
         ('1.13462572', '1.13462592'), ('136 cases.', '137 cases.'), ('-3e-9', '3e-9'), ('2e-7', '-2e-7'), ('2 mm', '2 um')]


@pytest.mark.parametrize(('text', 'other'), SAME)
def test_what_rounding_changes(text, other):
    assert alike(text, other) and alike(other, text)


@pytest.mark.parametrize(('text', 'other'), OTHER)
def test_what_is_another_number(text, other):
    assert not alike(text, other) and not alike(other, text)
