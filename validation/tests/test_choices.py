"""The page on choices shows what is so."""

import pytest

from validation import choices, page


@pytest.mark.filterwarnings('ignore::gearsweep.PartialWarning')
@pytest.mark.parametrize('name', choices.NAMES)
def test_the_tables_on_the_page_are_of_today(name):
    assert page.same(choices.current(name), getattr(choices, name)()), 'run python -m validation.choices'
