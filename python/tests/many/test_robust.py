"""Robust reliefs: `gearsweep.many.robust`."""

import sys
import warnings
from pathlib import Path

import numpy as np
import pytest

import gearsweep
from gearsweep import Case, Code, Error

many = pytest.importorskip('gearsweep.many')
import xarray  # noqa: E402
from scipy import stats  # noqa: E402

from gearsweep.many import cluster_quantiles  # noqa: E402

MODULE = sys.modules['gearsweep.many.robust']
DATA = Path(__file__).resolve().parents[3] / 'data'
CASE = Case('''&case tasks = 'as_built' / &pair module_mm = 3  face_width_mm = 20 / &pinion teeth = 10  profile_shift = 0.4 / &gear teeth = 15 /
    &load torque_nm = 100 / &relief amount_um = 5 / &mesh model = 'iso6336' /
    &sweep rpm_first = 9000  rpm_last = 12000  rpm_step = 3000 /
    &deviations pinion_class = 6  gear_class = 6  draws = 2  assembly = 'all' /''')  # fmt: skip
AMOUNTS = {'amount_um': [5, 10, 15]}
ONE = np.ones(1)


# Quantiles of cluster_quantiles.


@pytest.mark.parametrize(('n', 'q', 'confidence'), [(100, 0.95, 0.95), (100, 0.5, 0.9), (300, 0.95, 0.99), (72, 0.95, 0.95)])
def test_a_band_of_independent_numbers_is_scipys(n, q, confidence):
    """The binomial test of SciPy, turned into an interval."""
    values = np.random.default_rng(n).gamma(3, size=n)
    expected = stats.quantile_test(values, p=q).confidence_interval(confidence)
    assert cluster_quantiles.band(values[:, None], ONE, q, confidence) == pytest.approx((expected.low, expected.high), rel=1e-15)


def test_too_few_numbers_have_no_upper_end():
    """0.95^n is above 2.5 % below 72: all n may then lie below the quantile."""
    values = np.arange(71.0)[:, None]
    lower, upper = cluster_quantiles.band(values, ONE, 0.95, 0.95)
    assert np.isfinite(lower) and np.isnan(upper)
    assert np.isfinite(cluster_quantiles.band(np.arange(72.0)[:, None], ONE, 0.95, 0.95)).all()


def test_equal_numbers_of_a_draw_count_once():
    """Seven assemblies that are alike are one; that they are independent makes the band as of seven times as many draws."""
    rng = np.random.default_rng(2)
    alike, shares = rng.gamma(3, size=(100, 1)), np.full(7, 1 / 7)
    assert cluster_quantiles.band(np.tile(alike, 7), shares, 0.95, 0.95) == cluster_quantiles.band(alike, ONE, 0.95, 0.95)
    points = rng.gamma(3, size=(100, 7))
    least = cluster_quantiles.band(points.reshape(-1, 1), ONE, 0.95, 0.95)
    lower, upper = cluster_quantiles.band(points, shares, 0.95, 0.95)
    assert lower <= least[0] and upper >= least[1] and upper - lower < 1.5 * (least[1] - least[0])


def test_bands_hold_the_quantile_of_clusters():
    """Normal numbers, of which a draw and its assemblies have half the variance each: in 95 % of 300 sets, less three standard errors of that
    share."""
    rng, true, shares = np.random.default_rng(3), stats.norm.ppf(0.95), np.full(10, 0.1)
    held = 0
    for _ in range(300):
        values = np.sqrt(0.5) * (rng.standard_normal((80, 1)) + rng.standard_normal((80, 10)))
        lower, upper = cluster_quantiles.band(values, shares, 0.95, 0.95)
        held += lower <= true <= upper
    assert held / 300 > 0.95 - 3 * np.sqrt(0.95 * 0.05 / 300)


def test_shares_weigh_as_repeated_numbers_do():
    """NumPy's inverted distribution of numbers that are there as often as they weigh."""
    values = np.random.default_rng(4).gamma(3, size=(41, 2))
    repeated = np.concatenate([values[:, 0], *3 * [values[:, 1]]])
    for q in (0.1, 0.5, 0.95):
        found = cluster_quantiles.quantile(values, np.array([0.25, 0.75]), q, np.ones((1, 41)))[0]
        assert found == np.quantile(repeated, q, method='inverted_cdf')


def test_what_all_candidates_share_does_not_blur_them():
    """The same scatter on a parabola over candidates: bands overlap, differences are exact."""
    scatter, valley = np.random.default_rng(5).gamma(3, size=(200, 4)), 0.01 * (np.arange(7) - 3.0) ** 2
    found = cluster_quantiles.compare(valley[:, None, None] + scatter, np.full(4, 0.25), 0.95, 0.95)
    assert found['value'].argmin() == 3 and found['lower'][4] < found['upper'][3]
    for name in ('worse', 'worse_lower', 'worse_upper'):
        np.testing.assert_allclose(found[name], valley, atol=1e-14)
    assert found['best_share'].tolist() == [0, 0, 0, 1, 0, 0, 0]


def test_candidates_that_differ_by_chance_are_distinguishable_so_often_as_is_said():
    """Two with the same distribution: a band without 0 in 5 % of 100 sets at most, and three standard errors of that."""
    rng, apart = np.random.default_rng(6), 0
    for _ in range(100):
        values = rng.standard_normal((1, 80, 1)) + 0.5 * rng.standard_normal((2, 80, 1))
        found = cluster_quantiles.compare(values, ONE, 0.95, 0.95)
        apart += (found['worse_lower'] > 0).any()
    assert apart / 100 < 0.05 + 3 * np.sqrt(0.05 * 0.95 / 100)


# The call, with numbers whose quantiles are known.


def faked(monkeypatch, factor, lacks=lambda rows: 0):
    """`factor` gives the numbers of each variant (variant, draw, assembly) in place of a run; without deviations the optimum is at 15."""

    def run(plan, take, *, reduce, **options):
        rows = xarray.Dataset({name: ('variant', column) for name, column in zip(plan.names, plan.rows().T)})
        values = factor(rows)
        missing = np.broadcast_to(lacks(rows), values.shape)
        rows['as_built_worst.dynamic_factor'] = ('variant', 'draw', 'assembly'), values
        rows['speeds_without_result'] = ('variant', 'draw', 'assembly'), missing
        rows['points_inexact'], rows['sample_error'] = (('variant', np.full(plan.n, one)) for one in (0.0, np.nan))
        rows['relief.amount_um'].attrs['units'] = 'um'
        rows['nominal'] = 'variant', 1 + 0.001 * (rows['relief.amount_um'].values - 15) ** 2
        return rows

    monkeypatch.setattr(MODULE, 'run', run)


def valley(rows, draws=100):
    """At 10 the least; draws add up to 0.5, the same to all."""
    x = rows['relief.amount_um'].values[:, None, None]
    return 1.2 + 0.002 * (x - 10) ** 2 + np.linspace(0, 0.5, draws)[None, :, None] * np.ones((1, 1, 2))


def test_the_best_as_built_and_what_the_nominal_best_is_worth(monkeypatch):
    """95 of 100 draws are at most the 95th, 0.5 times 94/99, above the parabola."""
    faked(monkeypatch, valley)
    found = many.robust(CASE, relief={'amount_um': [5, 8, 10, 12, 15], 'shape': ['linear']})
    assert float(found.best['relief.amount_um']) == 10 and found.case().get('relief', 'amount_um') == 10
    assert float(found.best['value']) == pytest.approx(1.2 + 0.5 * 94 / 99, rel=1e-14)
    assert float(found.nominal['relief.amount_um']) == 15 and float(found.nominal['nominal']) == 1
    assert float(found.nominal['worse']) == pytest.approx(0.05, rel=1e-12) and float(found.nominal['worse_lower']) == pytest.approx(0.05, rel=1e-12)
    assert found.alike['relief.amount_um'].values.tolist() == [10]
    said = str(found)
    for words in ('pairs of gears: 100, assemblies of each: 2', 'Best as built: amount_um 10, shape linear: 1.6747',
                  'Best nominal: amount_um 15, shape linear: 1.0000, as built 1.7247', 'by these draws: none'):  # fmt: skip
        assert words in said


def test_loads_count_by_their_shares(monkeypatch):
    """The rare load, 4 % of the time, lies above all others: 95 % as built lies below it, 97 % is it."""
    faked(monkeypatch, lambda rows: valley(rows) + 10 * (rows['load.torque_nm'].values == 120)[:, None, None])
    spectrum = {'torque_nm': {80: 0.6, 120: 0.04, 100: 0.36}}
    for q, least, most in ((0.95, 1, 2), (0.97, 11, 12)):
        found = many.robust(CASE, spectrum=spectrum, quantile=q, relief=AMOUNTS)
        assert least < float(found.best['value']) < most and float(found.best['relief.amount_um']) == 10
    assert found.factors.dims == ('candidate', 'draw', 'assembly', 'load') and found.factors['load.torque_nm'].values.tolist() == [80, 120, 100]
    assert found.case(2).get('relief', 'amount_um') == 15 and found.case(2).get('load', 'torque_nm') == 80
    assert 'loads: 3' in str(found)


def test_draws_without_a_result_are_refused_or_left_out_whole(monkeypatch):
    """Of the candidate at 5 all lack one; of that at 15 draw 99, the largest."""

    def lacks(rows):
        x = rows['relief.amount_um'].values[:, None, None]
        return (x == 5) * 3 + (x == 15) * (np.arange(100) == 99)[None, :, None] * np.array([0, 1])

    faked(monkeypatch, valley, lacks)
    with pytest.raises(Error, match=r"1 of 3 candidates have no result, 1 of 100 draws lack some; nan='drop'.*; the first is &relief amount_um = 5\.0; "):
        many.robust(CASE, relief=AMOUNTS)
    with pytest.warns(gearsweep.PartialWarning, match='1 of 100 draws lack some; they are omitted'):
        found = many.robust(CASE, relief=AMOUNTS, nan='drop')
    assert found.table['relief.amount_um'].values.tolist() == [10, 15] and found.table['candidate'].values.tolist() == [1, 2]
    assert found.table.attrs['draws'] == 99 and 'omitted: 1 draws, 1 candidates' in str(found)
    assert found.case().get('relief', 'amount_um') == 10
    faked(monkeypatch, valley, lambda rows: 1)
    with pytest.raises(Error, match='nothing remains to compare'):
        many.robust(CASE, relief=AMOUNTS, nan='drop')


@pytest.mark.parametrize('modules', [[-3, 3, 3.5], [3, -3, 3.5]])
def test_a_candidate_that_cannot_be_is_left_out_wherever_it_stands(modules, tmp_path):
    case = CASE.changed(sweep={'rpm_last': 9000}, deviations={'assembly': 'stated'})
    with pytest.warns(gearsweep.PartialWarning, match='1 of 3 candidates have no result, 0 of 2 draws lack some'):
        found = many.robust(case, pair={'module_mm': modules}, nan='drop', quantile=0.5)
    assert found.table['pair.module_mm'].values.tolist() == [3, 3.5]
    with pytest.warns(gearsweep.PartialWarning, match=r'of the first, &pair module_mm = -3\.0: &pair module_mm = -3\.0: must be at least'):
        many.robust(case, pair={'module_mm': modules}, nan='drop', quantile=0.5, store=tmp_path / 'x.zarr')
    alone = many.robust(case, pair={'module_mm': [3, 3.5]}, quantile=0.5)
    np.testing.assert_array_equal(found.table['value'], alone.table['value'])
    with pytest.raises(Error, match=r'&pair module_mm = -3'):
        many.robust(case, pair={'module_mm': modules})
    with pytest.raises(Error, match=r'&pair module_mm = -3'):
        many.robust(case, pair={'module_mm': [-3, -4]}, nan='drop')


def test_too_few_draws_tell_nothing_apart(monkeypatch):
    faked(monkeypatch, lambda rows: valley(rows, 20))
    found = many.robust(CASE, relief=AMOUNTS)
    assert found.alike.sizes['candidate'] == 3 and np.isnan(found.table['best_share']).all()
    assert str(found).endswith('?: too few draws for this quantile and confidence; 72 are enough')


@pytest.mark.parametrize(('q', 'confidence'), [(0.95, 0.95), (0.5, 0.9), (0.1, 0.95), (0.99, 0.99), (0.3, 0.8)])
def test_so_many_draws_as_are_said_to_be_enough_are_and_one_less_is_not(q, confidence):
    n = cluster_quantiles.enough(q, confidence)
    ends = [cluster_quantiles.band(np.arange(float(count))[:, None], ONE, q, confidence) for count in (n - 1, n)]
    assert np.isnan(ends[0]).any() and np.isfinite(ends[1]).all()


@pytest.mark.parametrize(('match', 'options'), [
    ('there are no candidates', {}), ('&relief amount_um: the list is empty', {'relief': {'amount_um': []}}),
    ('did you mean amount_um', {'relief': {'amont_um': [1]}}), (r'&relief amount_um = -1', {'relief': {'amount_um': [5, -1]}}),
    ('needs a list of values, not a distribution', {'relief': {'amount_um': stats.norm(10, 1)}}),
    ('draws no gears; set &deviations pinion_class', {'relief': AMOUNTS, 'deviations': {
        'pinion_class': [None], 'gear_class': [None], 'pinion_profile_slope_um': [5]}}),
    ('&deviations draws = 1: must be at least 2', {'relief': AMOUNTS, 'deviations': {'draws': [1]}}),
    (r'&relief amount_um has 2 values; write them as relief=', {'relief': {'amount_um': [[1, 2]]}}),
    ('quantile = 95: must be between 0 and 1', {'relief': AMOUNTS, 'quantile': 95}), ("nan = 'keep'", {'relief': AMOUNTS, 'nan': 'keep'}),
    ('spectrum: must be one key of &load', {'relief': AMOUNTS, 'spectrum': {}}),
    ('torque_nm = .*: must be loads with their shares, each above 0', {'relief': AMOUNTS, 'spectrum': {'torque_nm': {100: -1}}}),
    ('seeds = 0: must be a whole number from 1', {'relief': AMOUNTS, 'seeds': 0}),
    ('seed: is varied by seeds', {'deviations': {'seed': [1]}, 'seeds': 2}),
    (r'seeds = 2, from &deviations seed = 1000000000 on: &deviations seed = 1000000001: .* at most 1000000000',
     {'relief': AMOUNTS, 'deviations': {'draws': [2]}, 'seeds': 2}),
    ('&deviations draws: cannot distinguish candidates', {'deviations': {'draws': [4, 6]}}),
    ('&deviations assembly: cannot distinguish candidates', {'deviations': {'assembly': ['stated', 'all']}}),
    ('&deviations seed: cannot distinguish candidates', {'deviations': {'seed': [1, 2]}}),
    ('torque_nm = .*: must be loads .* their sum finite', {'relief': AMOUNTS, 'spectrum': {'torque_nm': {80: 1e308, 90: 1e308}}}),
    ('load: is varied by spectrum', {'load': {'torque_nm': [1]}, 'spectrum': {'torque_nm': {100: 1}}}),
    ('&load: give one of torque_nm', {'relief': AMOUNTS, 'spectrum': {'normal_force_n': {100: 1}}}),
])  # fmt: skip
def test_what_is_not_usable_is_reported_before_anything_is_computed(monkeypatch, match, options):
    monkeypatch.setattr(MODULE, 'run', None)
    with pytest.raises(Error, match=match) as caught:
        many.robust(CASE.changed(deviations={'seed': 10**9}), **options)
    assert caught.value.code == Code.INPUT


# Gears.


@pytest.fixture(scope='module')
def found():
    return many.robust(CASE, relief=AMOUNTS, quantile=0.5)


def test_numbers_are_those_of_the_task(found):
    """Bit for bit what a run of the case tells in as_built_worst and as_built_summary."""
    study = gearsweep.run(CASE.changed(relief={'amount_um': [5, 10, 15]}))
    np.testing.assert_array_equal(found.factors.values[..., 0], study.as_built_worst.dynamic_factor)
    np.testing.assert_array_equal(found.table['nominal'], study.as_built_summary.nominal_factor)
    assert found.factors.shape == (3, 2, 5, 1) and found.table['relief.amount_um'].attrs['units'] == 'um'


@pytest.mark.filterwarnings('ignore::gearsweep.PartialWarning')
def test_inexact_dynamic_factors_are_reported():
    """So many as a run of the case has with that status; where no motion is looked at, none are."""
    case, relief = CASE.changed(numerics={'steps_per_period': 60}), {'amount_um': [5, 10]}
    count = int((gearsweep.run(case.changed(relief=relief)).as_built.status == 'inexact').sum())
    assert count > 0
    with pytest.warns(UserWarning, match=f'robust: {count} dynamic factors, in [12] of 2 variants, are inexact$') as told:
        many.robust(case, relief=relief, quantile=0.5)
    assert told[0].filename == __file__
    with warnings.catch_warnings():
        warnings.simplefilter('error')
        many.robust(case, judged='static_transmission_error', relief=relief, quantile=0.5)
        many.robust(CASE, relief=relief, quantile=0.5)


def test_by_how_much_quick_ones_are_off_is_reported():
    with pytest.warns(UserWarning, match=r'robust: 35 dynamic factors, in 2 of 4 variants, are inexact; with quick they are off by up to 0.02 in a sample$'):
        MODULE._warn_of_inexact(np.array([0, 30, np.nan, 5]), np.array([1e-4, 0.02, np.nan, 0.003]))


def test_the_same_by_a_pool_and_from_a_store(found, tmp_path, monkeypatch):
    """Bit for bit; the second call finds all in the store, and computes nothing."""
    pool = many.robust(CASE, relief=AMOUNTS, quantile=0.5, executor=2, store=tmp_path / 'x.zarr')
    xarray.testing.assert_identical(pool.table, found.table)
    np.testing.assert_array_equal(pool.factors, found.factors)
    monkeypatch.setattr(many.rows, 'attempt', lambda *_, **__: pytest.fail('a variant is computed'))
    monkeypatch.setattr(many.rows, 'run_rows', lambda *_, **__: pytest.fail('a variant is computed'))
    again = many.robust(CASE, relief=AMOUNTS, quantile=0.5, store=tmp_path / 'x.zarr')
    xarray.testing.assert_identical(again.table, found.table)


def test_the_nominal_optimum_is_not_the_best_as_built():
    """Case 1 in class 6: an independent prototype (Taylor series of 26th order, its own draws, 300 of them, 327 speeds to 20000 1/min) has
    95 % quantiles of 1.339 at 10 um and 1.377 at 15 um, with a standard deviation of 0.007 each. Here the speeds about the largest peaks."""
    case = Case.read(DATA / 'case1.nml').changed(deviations={'pinion_class': 6, 'gear_class': 6, 'draws': 80},
                                                 sweep={'rpm_first': 8000, 'rpm_last': 14000, 'rpm_step': 600})  # fmt: skip
    found = many.robust(case, relief={'amount_um': [10, 15]})
    assert float(found.best['relief.amount_um']) == 10 and float(found.nominal['relief.amount_um']) == 15
    assert float(found.nominal['worse_lower']) > 0
    for at, expected in enumerate((1.339, 1.377)):
        row = found.table.isel(candidate=at)
        assert float(row['lower']) - 2 * 0.007 <= expected <= float(row['upper']) + 2 * 0.007


def test_titles_may_tell_candidates_apart():
    """`case` is a group of keys too; a title changes no number."""
    found = many.robust(CASE.changed(sweep={'rpm_last': 9000}, deviations={'assembly': 'stated'}), case={'title': ['a', 'b']}, quantile=0.5)
    assert found.table['case.title'].values.tolist() == ['a', 'b'] and found.table['value'][0] == found.table['value'][1]


def test_seeds_draw_more_gears():
    """Those that each seed of the case draws, one after the other, for each candidate and load."""
    options = {'relief': {'amount_um': [5, 10]}, 'quantile': 0.5, 'spectrum': {'torque_nm': {100: 1, 80: 2}}}
    case = CASE.changed(sweep={'rpm_last': 9000}, deviations={'assembly': 'stated'})
    found = many.robust(case, seeds=2, **options)
    seeds = found.plan.rows()[:, -1].astype(int)
    assert (seeds.reshape(4, 2) == seeds[:2]).all() and len(set(seeds)) == 2
    each = [many.robust(case.changed(deviations={'seed': seed}), **options).factors.values for seed in seeds[:2]]
    np.testing.assert_array_equal(found.factors.values, np.concatenate(each, axis=1))
    assert found.case(1).get('relief', 'amount_um') == 10 and found.case(1).get('load', 'torque_nm') == 100
    assert found.table['relief.amount_um'].values.tolist() == [5, 10] and found.factors['load.torque_nm'].values.tolist() == [100, 80]
    assert 'deviations.seed' not in found.table.coords and found.table.attrs['draws'] == 4


def test_the_picture_has_the_numbers_of_the_table(monkeypatch):
    """A panel for each shape; a line each of quantile, median and nominal, the two best marked, and the nominal one as built."""
    pyplot = pytest.importorskip('matplotlib.pyplot')
    from gearsweep.many.robust_pictures import plot_valley

    faked(monkeypatch, valley)
    found = many.robust(CASE, relief={'shape': ['linear', 'parabolic'], 'amount_um': [5, 15, 10]})
    figure = found.plot()
    assert [ax.get_title(loc='right') for ax in figure.axes] == ['shape linear', 'shape parabolic']
    lines = figure.axes[1].lines
    for line, name in zip(lines, ('value', 'median', 'nominal')):
        assert line.get_xdata().tolist() == [5, 10, 15]
        np.testing.assert_array_equal(line.get_ydata(), found.table[name].values[[3, 5, 4]])
    assert [tuple(line.get_xydata()[0]) for line in figure.axes[0].lines[3:]] == \
        [(10, float(found.best['value'])), (15, 1.0), (15, float(found.nominal['value']))]
    assert figure.axes[0].get_xlabel() == 'Tip relief (µm)' and figure.axes[0].get_ylabel() == 'Largest dynamic factor (–)'
    with pytest.raises(ValueError, match=r'must be one of relief\.amount_um'):
        plot_valley(found, along='relief.shape')
    pyplot.close(figure)


@pytest.mark.parametrize(('draws', 'band'), [(100, ['its 95 % band']), (4, [])])
def test_the_legend_has_the_band_after_its_line_and_where_there_is_one(monkeypatch, draws, band):
    pyplot = pytest.importorskip('matplotlib.pyplot')
    faked(monkeypatch, lambda rows: valley(rows, draws))
    figure = many.robust(CASE, relief=AMOUNTS).plot()
    assert [text.get_text() for text in figure.axes[0].get_legend().get_texts()] == ['95 % as built', *band, 'median as built', 'nominal']
    assert len(figure.axes[0].collections) == len(band)
    pyplot.close(figure)
