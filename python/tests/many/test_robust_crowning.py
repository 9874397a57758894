"""Robust crowning: the least quantile of a face load factor over a scatter of misalignment."""

import numpy as np
import pytest

import gearsweep
from gearsweep import Case, Code, Error

many = pytest.importorskip('gearsweep.many')
from scipy import stats  # noqa: E402

CASE = Case('''&case tasks = 'face_load' / &pair module_mm = 3  face_width_mm = 30 / &pinion teeth = 25 / &gear teeth = 25 /
    &load line_load_n_mm = 300 / &section elements_across = 4 /''')  # fmt: skip
CROWNING = [0, 4, 8, 12, 16, 20, 24]


def robust(distribution, **options):
    options = {'judged': 'face_load_factor', 'seeds': 100, 'pinion': {'crowning_um': CROWNING}} | options
    return many.robust(CASE, scatter={'face': {'misalignment_um': distribution}}, **options)


@pytest.fixture(scope='module')
def found():
    return robust(stats.norm(0, 15))


@pytest.mark.parametrize('judged', ['face_load_factor', 'root_face_load_factor'])
def test_the_choice_is_that_of_all_cases_run_one_by_one(judged):
    """Eight equally likely misalignments; the quantile of NumPy's inverted distribution."""
    misalignments = [-35, -20, -12, -5, 0, 8, 15, 30]
    one = robust(misalignments, judged=judged, seeds=12, pinion={'crowning_um': [2, 8, 14]}, gear={'crowning_um': [0, 3]}, quantile=0.75)
    drawn = one.plan.rows()[1:13, -1]
    assert set(drawn) < set(misalignments) and len(set(drawn)) > 4
    cases = [CASE.changed(pinion={'crowning_um': pinion}, gear={'crowning_um': gear}) for pinion in (2, 8, 14) for gear in (0, 3)]
    each = {f: [gearsweep.run(case.changed(face={'misalignment_um': f})).face_load_summary[judged][0] for case in cases] for f in set(drawn)}
    factors = np.transpose([each[f] for f in drawn])
    np.testing.assert_array_equal(one.factors.values[..., 0, 0], factors)
    values = np.quantile(factors, 0.75, axis=1, method='inverted_cdf')
    np.testing.assert_array_equal(one.table['value'], values)
    assert int(one.best['candidate']) == values.argmin()
    assert one.table['pinion.crowning_um'].values.tolist() == [2, 2, 8, 8, 14, 14] and 'face.misalignment_um' not in one.table.coords


def test_crowning_of_either_gear_is_the_same(found):
    """The gap is the sum of both."""
    other = robust(stats.norm(0, 15), pinion={'crowning_um': [0]}, gear={'crowning_um': CROWNING})
    np.testing.assert_allclose(other.table['value'], found.table['value'], rtol=1e-12)


def test_the_larger_the_scatter_the_more_crowning(found):
    """And none where the faces are parallel, as crowning then concentrates the load."""
    small, some, large = (robust(stats.norm(0, sd), seeds=60) for sd in (0.1, 5, 30))
    best = [float(one.best['pinion.crowning_um']) for one in (small, some, found, large)]
    assert best[0] == 0 and all(np.diff(best) > 0), best


def test_a_scatter_and_its_mirror_want_the_same():
    """A spur pair is the same from both ends of the face."""
    one, other = (robust([sign * f for f in (0, 5, 25, 40)], seeds=20) for sign in (1, -1))
    np.testing.assert_allclose(one.table['value'], other.table['value'], rtol=1e-9)


def test_nominal_is_at_the_median(found):
    aligned = [gearsweep.run(CASE.changed(pinion={'crowning_um': one})).face_load_summary.face_load_factor[0] for one in CROWNING]
    np.testing.assert_array_equal(found.table['nominal'], aligned)
    assert float(found.nominal['pinion.crowning_um']) == 0
    case = found.case()
    assert (case.get('pinion', 'crowning_um'), case.get('face', 'misalignment_um')) == (float(found.best['pinion.crowning_um']), 0)


def test_all_candidates_have_the_same_draws_and_another_seed_has_others(found):
    drawn = found.plan.rows()[:, -1].reshape(len(CROWNING), 101)
    assert (drawn == drawn[0]).all() and len(set(drawn[0])) == 101 and drawn[0, 0] == 0
    other = many.robust(CASE.changed(deviations={'seed': 2}), judged='face_load_factor', scatter={'face': {'misalignment_um': stats.norm(0, 15)}},
                        seeds=100, pinion={'crowning_um': CROWNING})  # fmt: skip
    assert not np.isin(other.plan.rows()[1:101, -1], drawn).any()


def test_report_and_picture_say_that_it_is_scatter(found):
    pyplot = pytest.importorskip('matplotlib.pyplot')
    said = str(found)
    assert said.startswith('K_H_beta in the middle of contact of the fewest pairs; draws: 100\ncrowning_um  nominal')
    assert 'Best with scatter: crowning_um ' in said and ', with scatter ' in said and 'as built' not in said
    figure = found.plot()
    assert figure.axes[0].get_xlabel() == 'Crowning (µm)' and figure.axes[0].get_ylabel() == 'Face load factor $K_{Hβ}$ (–)'
    assert {text.get_text() for text in figure.axes[0].get_legend().get_texts()} == {'95 % with scatter', 'its 95 % band', 'median with scatter', 'nominal'}
    pyplot.close(figure)


def test_loads_have_their_shares_and_a_store_the_same_bits(found, tmp_path):
    """A tenth of the load lets the face touch on a part of it only, which the quantile of 95 % sees."""
    spectrum, options = {'line_load_n_mm': {300: 0.9, 30: 0.1}}, {'store': tmp_path / 'x.zarr', 'pinion': {'crowning_um': CROWNING[:3]}}
    both, again = (robust(stats.norm(0, 15), spectrum=spectrum, **options) for _ in range(2))
    np.testing.assert_array_equal(both.factors.values, again.factors.values)
    np.testing.assert_array_equal(both.factors.values[..., 0], found.factors.values[:3, ..., 0])
    assert (both.table['value'].values > found.table['value'].values[:3]).all() and 'loads: 2' in str(both)


@pytest.mark.parametrize(('match', 'options'), [
    ('needs the scatter of some keys', {'scatter': None}), ('needs the scatter of some keys', {'scatter': {}}),
    ('seeds = 1: must be at least 2 with scatter', {'seeds': 1}), ('scatter: is for face load factors', {'judged': 'dynamic_factor'}),
    ('pinion.crowning_um: is varied twice', {'scatter': {'pinion': {'crowning_um': [1, 2]}}}),
    ('did you mean misalignment_um', {'scatter': {'face': {'misalinment_um': [1]}}}),
    ('&relief amount_um has 2 values', {'relief': {'amount_um': [[0, 5]]}}),
    (r'&pinion crowning_um = 2000\.0: must be at least -1000 and at most 1000', {'pinion': {'crowning_um': [2000]}}),
])  # fmt: skip
def test_what_is_not_usable_is_reported(match, options):
    usual = {'judged': 'face_load_factor', 'seeds': 5, 'pinion': {'crowning_um': [0, 5]}, 'scatter': {'face': {'misalignment_um': stats.norm(0, 5)}}}
    with pytest.raises(Error, match=match) as caught:
        many.robust(CASE, **usual | options)
    assert caught.value.code == Code.INPUT
