"""The page on asymmetric teeth says what is so."""

import pytest

from validation import asymmetric, page
from validation.cases import ANGLES

RATIO, STIFFNESS, PEAK, FACTOR, THEIRS, STRESS, COASTING = 0, 1, 2, 6, 8, 9, 10


@pytest.fixture(scope='module')
def rows():
    return {angles: asymmetric.row(*angles) for angles in ANGLES}


@pytest.mark.filterwarnings('ignore::gearsweep.PartialWarning')
def test_the_table_on_the_page_is_of_today():
    assert page.same(asymmetric.current(), asymmetric.table())


def test_sentences_on_the_page_hold(rows):
    plain = rows[20, 20]
    for angle in (25, 30):
        coast, drive = rows[20, angle], rows[angle, 20]
        assert coast[RATIO] == pytest.approx(plain[RATIO], rel=1e-12) and drive[RATIO] < plain[RATIO]
        assert coast[STIFFNESS] > plain[STIFFNESS] and coast[PEAK] < plain[PEAK] and coast[STRESS] < plain[STRESS]
        assert abs(coast[FACTOR] - plain[FACTOR]) < 0.02
        assert drive[STRESS] < plain[STRESS] and drive[PEAK] < plain[PEAK] and drive[FACTOR] > plain[FACTOR] + 0.1
    assert plain[COASTING] == pytest.approx(1, rel=1e-12)
    for angles in ((20, 25), (20, 30)):  # what is coast for one is drive for the other
        assert rows[angles][COASTING] * rows[angles[::-1]][COASTING] == pytest.approx(1, rel=1e-12)
    for row in rows.values():  # two methods of integration
        assert row[THEIRS] == pytest.approx(row[FACTOR], abs=2e-3)


def test_the_picture_shows_all_pairs():
    figure = asymmetric.picture()
    error, stiffness, harmonics, factor = figure.axes
    assert all(len(ax.lines) == len(ANGLES) for ax in (error, stiffness, factor)) and len(harmonics.containers) == len(ANGLES)
    assert {text.get_text() for text in error.get_legend().get_texts()} == {f'{drive} / {coast}°' for drive, coast in ANGLES}
