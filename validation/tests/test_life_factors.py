"""The page on life has the S-N curves of the program."""

from validation import life_factors, page


def test_the_table_on_the_page_is_of_today():
    assert page.same(life_factors.current(), life_factors.table()), 'run python -m validation.life_factors'
    assert len(life_factors.materials()) == 10
