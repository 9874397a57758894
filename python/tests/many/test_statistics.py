"""Quantiles, Sobol' indices and their bands, and the pictures of many variants."""

import re

import numpy as np
import pytest

import gearsweep
from gearsweep import Case, Error

many = pytest.importorskip('gearsweep.many')
import xarray  # noqa: E402
from scipy import stats  # noqa: E402
from test_many import CASE as SWEEP  # noqa: E402
from test_many import TAKE, plan_of  # noqa: E402

from gearsweep.many.page import write  # noqa: E402
from gearsweep.many.statistics import with_band  # noqa: E402

CASE = Case('&pair module_mm = 3 /')
PI = np.pi


def column(values, **attributes):
    dims = ('variant', 'rpm')[: np.ndim(values)]
    return xarray.DataArray(np.asarray(values, float), dims=dims, name='sweep.dynamic_factor', attrs=attributes)


def saltelli(n, seed, function, *distributions):
    """What a run of Saltelli's rows would give if the gears were this function."""
    keys = ('module_mm', 'face_width_mm', 'centre_distance_mm', 'backlash_um')
    plan = many.Plan.saltelli(CASE, n, seed, pair=dict(zip(keys, distributions)))
    return column(function(*plan.rows().T), points='saltelli', inputs=list(plan.names))


def ishigami(a, b, c):
    return np.sin(a) + 7 * np.sin(b) ** 2 + 0.1 * c**4 * np.sin(a)


#: Ishigami and Homma (1990), An importance quantification technique in uncertainty analysis: in closed form.
ISHIGAMI = {'S1': (0.3139, 0.4424, 0), 'ST': (0.5576, 0.4424, 0.2437)}


def test_ishigamis_indices():
    """Of 4096 base points, within 0.01; each band has the index."""
    angle = stats.uniform(-PI, 2 * PI)
    found = many.sensitivity(saltelli(4096, 3, ishigami, angle, angle, angle))
    for name, expected in ISHIGAMI.items():
        np.testing.assert_allclose(found[name], expected, atol=0.01)
        assert (found[f'{name}_lower'] < expected).all() and (found[f'{name}_upper'] > expected).all()


def test_a_linear_functions_indices():
    """S1 = ST = a_i^2 s_i^2 over their sum, and they add up to 1."""
    a, s = np.array([1.0, -2.0, 0.5, 3.0]), np.array([2.0, 1.0, 4.0, 0.1])
    data = saltelli(4096, 5, lambda *x: np.dot(a, x) + 100, *(stats.norm(7, one) for one in s))
    found = many.sensitivity(data)
    expected = (a * s) ** 2 / ((a * s) ** 2).sum()
    np.testing.assert_allclose(found['S1'], expected, atol=0.02)
    np.testing.assert_allclose(found['ST'], expected, atol=0.02)
    assert found.input.values.tolist() == data.attrs['inputs']


def test_indices_are_scipys_and_salibs():
    sobol = pytest.importorskip('SALib.analyze.sobol')
    angle = stats.uniform(-PI, 2 * PI)
    data = saltelli(256, 3, ishigami, angle, angle, angle)
    found = many.sensitivity(data)
    problem = {'num_vars': 3, 'names': ['a', 'b', 'c'], 'bounds': [[-PI, PI]] * 3}
    salib = sobol.analyze(problem, data.values, calc_second_order=False, seed=1)
    base = data.values.reshape(256, 5)
    scipy = stats.sobol_indices(func={'f_A': base[None, :, 0], 'f_B': base[None, :, -1], 'f_AB': base[:, 1:-1].T[:, None]}, n=256)
    for name, theirs in (('S1', scipy.first_order), ('ST', scipy.total_order)):
        np.testing.assert_allclose(found[name], theirs, rtol=1e-9, atol=1e-12)
        # SALib takes the mean of all variants off, and ours that of the rows of A and B.
        np.testing.assert_allclose(found[name], salib[name], atol=1e-3)
        # SALib's band is the mean and as much to either side; ours has its ends apart.
        np.testing.assert_allclose((found[f'{name}_upper'] - found[f'{name}_lower']) / 2, salib[f'{name}_conf'], rtol=0.2)


def test_bands_of_indices_have_the_index_as_often_as_they_say():
    """Of 50 seeds at least 43 with a confidence of 95 %: fewer have a probability of 0.4 % with independent points."""
    angle = stats.uniform(-PI, 2 * PI)
    hits = {'S1': 0, 'ST': 0}
    for seed in range(50):
        found = many.sensitivity(saltelli(128, seed, ishigami, angle, angle, angle), seed=seed)
        for name, expected in ISHIGAMI.items():
            hits[name] += (found[f'{name}_lower'] < expected).values & (found[f'{name}_upper'] > expected).values
    assert min(hits['S1'].min(), hits['ST'].min()) >= 43, hits


def test_indices_over_speeds_are_those_of_each_speed():
    angle = stats.uniform(-PI, 2 * PI)
    one = saltelli(64, 3, ishigami, angle, angle, angle)
    both = column(np.column_stack([one, 3 * one.values**2]), **one.attrs)
    found = many.sensitivity(both)
    for at in range(2):
        alone = many.sensitivity(column(both.values[:, at], **one.attrs))
        for name in alone:
            np.testing.assert_allclose(found[name][:, at], alone[name], rtol=1e-9, atol=1e-12)


def test_numbers_that_are_missing_are_refused_or_left_out_by_base_points():
    angle = stats.uniform(-PI, 2 * PI)
    data = saltelli(64, 3, ishigami, angle, angle, angle)
    with_gaps = data.copy()
    with_gaps[[7, 8, 100]] = np.nan
    with pytest.raises(Error, match=r"sensitivity: 2 of 64 base points have no number; .*nan='drop'"):
        many.sensitivity(with_gaps)
    with pytest.warns(gearsweep.PartialWarning, match='2 of 64 base points have no number and are omitted') as said:
        found = many.sensitivity(with_gaps, nan='drop')
    assert said[0].filename == __file__
    kept = np.delete(data.values.reshape(64, 5), [1, 20], axis=0)
    expected = many.sensitivity(column(kept.ravel(), **data.attrs))
    np.testing.assert_array_equal(found['S1'], expected['S1'])
    assert found.attrs['base_points'] == 62


@pytest.mark.parametrize(('match', 'data', 'options'), [
    ("points = 'random': must be those of Plan.saltelli", column(np.arange(10), points='random'), {}),
    ('all numbers are equal', column(np.ones(10), points='saltelli', inputs=['a', 'b', 'c']), {}),
    ('12 variants are no whole number of base points, which have 5', column(np.arange(12), points='saltelli', inputs=['a', 'b', 'c']), {}),
    ("nan = 'ignore': must be 'refuse' or 'drop'", column(np.arange(10), points='saltelli', inputs=['a', 'b', 'c']), {'nan': 'ignore'}),
    ('the column has no variant', column([], points='saltelli', inputs=['a', 'b', 'c']), {}),
    *((f'confidence = {one}: must be between 0 and 1', column(np.arange(10), points='saltelli', inputs=['a', 'b', 'c']), {'confidence': one})
      for one in (-1, 0, 1, 2, np.nan)),
    *((f'seed = {one}: must be a whole number of at least 0', column(np.arange(10), points='saltelli', inputs=['a', 'b', 'c']), {'seed': one})
      for one in (-1, 0.5, True)),
    ('no base point has a number', column(np.full(10, np.nan), points='saltelli', inputs=['a', 'b', 'c']), {'nan': 'drop'}),
])  # fmt: skip
def test_what_has_no_indices_is_reported(match, data, options):
    with pytest.raises(Error, match=match):
        many.sensitivity(data, **options)


def test_quantiles_of_independent_points_are_scipys():
    """`scipy.stats.quantile_test`, whose band is NaN too where there are too few points."""
    values = np.random.default_rng(1).gamma(2, size=(200, 3))
    found = many.quantiles(column(values, points='random'), [0.01, 0.05, 0.5, 0.95, 0.999], confidence=0.9)
    for i, q in enumerate(found.q.values):
        for j in range(3):
            low, high = stats.quantile_test(values[:, j], p=q).confidence_interval(0.9)
            np.testing.assert_array_equal([found['lower'][i, j], found['upper'][i, j]], [low, high])
            assert found['value'][i, j] == np.quantile(values[:, j], q)
    assert np.isnan(found['upper'][-1]).all() and not np.isnan(found['upper'][:-1]).any()


def test_a_band_of_sobol_points_has_the_quantile_as_often_as_it_says():
    """Of the sum of three normal variables, whose quantiles are known: at least 90 % of 100 seeds with a confidence of 95 %; and it is
    narrower than that of as many independent points."""
    wanted = [0.05, 0.5, 0.95]
    hits, width, independent = np.zeros(3), np.zeros(3), np.zeros(3)
    truth = stats.norm.ppf(wanted) * np.sqrt(3)
    keys = {name: stats.norm(0, 1) for name in ('module_mm', 'face_width_mm', 'backlash_um')}
    for seed in range(100):
        plan = many.Plan.sobol(CASE, 1024, seed, pair=keys)
        found = many.quantiles(column(plan.rows().sum(axis=1), points='sobol', scrambles=8), wanted)
        hits += (found['lower'].values <= truth) & (truth <= found['upper'].values)
        width += (found['upper'] - found['lower']).values
        other = many.quantiles(column(many.Plan.random(CASE, 1024, seed, pair=keys).rows().sum(axis=1), points='random'), wanted)
        independent += (other['upper'] - other['lower']).values
    assert (hits >= 90).all(), hits
    assert (width < 0.9 * independent).all()


def test_a_band_of_sobol_points_is_half_a_point_of_a_scramble_wide_at_least():
    """Four scrambles with the same eight numbers, 0 to 7, have no scatter; a sixteenth more or less of the 32 points reaches the next number."""
    found = many.quantiles(column(np.repeat(np.arange(8.0), 4), points='sobol', scrambles=4), 0.5)
    assert [float(found[name][0]) for name in ('lower', 'value', 'upper')] == [3, 3.5, 4]


def test_a_band_of_independent_points_has_the_quantile_as_often_as_it_says():
    wanted, truth, hits = [0.05, 0.5, 0.95], stats.norm.ppf([0.05, 0.5, 0.95]), np.zeros(3)
    for seed in range(200):
        values = many.Plan.random(CASE, 300, seed, pair={'module_mm': stats.norm(0, 1)}).rows()[:, 0]
        found = many.quantiles(column(values, points='random'), wanted)
        hits += (found['lower'].values <= truth) & (truth <= found['upper'].values)
    assert (hits >= 180).all(), hits


def test_quantiles_of_other_points_and_missing_numbers_are_refused():
    for kind in ('grid', 'table', 'saltelli', None):
        with pytest.raises(Error, match='are no sample'):
            many.quantiles(column(np.arange(20), points=kind))
    for few in (0, 2, 3):
        with pytest.raises(Error, match=f'scrambles = {few}: must be at least 4'):
            many.quantiles(column(np.arange(20), points='sobol', scrambles=few))
    many.quantiles(column(np.arange(20), points='sobol', scrambles=4))
    with pytest.raises(Error, match='must be between 0 and 1'):
        many.quantiles(column(np.arange(20), points='random'), 1.0)
    values = np.arange(40.0).reshape(20, 2)
    values[3, 1] = np.nan
    with pytest.raises(Error, match='quantiles: the column has no variant'):
        many.quantiles(column(np.arange(20), points='random')[:0])
    with pytest.raises(Error, match=r'quantiles: 1 of 20 variants have no number; .*variant=3 of the column, has the reason'):
        many.quantiles(column(values, points='random'))
    with pytest.warns(gearsweep.PartialWarning, match='1 of 20 variants have no number and are omitted'):
        found = many.quantiles(column(values, points='random'), 0.5, nan='drop')
    np.testing.assert_array_equal(found['value'][0], np.quantile(np.delete(values, 3, axis=0), 0.5, axis=0))


@pytest.mark.parametrize(('values', 'scrambles', 'none'), [([1, 2, np.nan, 4, 5, np.nan, 7, 8], 8, 2), (np.arange(7), 1000, 993)])
def test_scrambles_without_numbers_leave_no_band(values, scrambles, none):
    """One point a scramble; the quantile is NumPy's of what is there."""
    data = column(values, points='sobol', scrambles=scrambles)
    with pytest.warns(gearsweep.PartialWarning) as said:
        found = many.quantiles(data, nan='drop')
    assert str(said[-1].message) == f'quantiles: {none} of {scrambles} scrambles have no number; there is no band' and said[-1].filename == __file__
    np.testing.assert_array_equal(found['value'], np.nanquantile(values, found.q))
    assert np.isnan(found['lower']).all() and np.isnan(found['upper']).all()


def test_the_page_is_written_where_a_scramble_has_no_number(tmp_path):
    """One point a scramble, of which those with a negative damping are refused."""
    plan = many.Plan.sobol(SWEEP, 8, 1, dynamics={'damping_ratio': stats.uniform(-0.1, 0.3)})
    refused = int((plan.rows() < 0).sum())
    assert 1 <= refused <= 6
    many.run(plan, TAKE[0], store=tmp_path / 'x.zarr')
    write(tmp_path / 'x.zarr', tmp_path / 'x.html')
    text = (tmp_path / 'x.html').read_text()
    assert f'{refused} of 8 scrambles have no number; there is no band' in text and '(? to ?)' in text


# Pictures.


@pytest.fixture(scope='module')
def data():
    return many.run(plan_of(64), TAKE)


@pytest.fixture(autouse=True)
def no_figure_stays():
    yield
    from matplotlib import pyplot

    pyplot.close('all')


def test_the_band_over_speed_is_of_the_quantiles(data):
    factor = data['sweep.dynamic_factor']
    ax = many.plot_band(factor)
    (median,) = ax.lines
    np.testing.assert_array_equal(median.get_xydata(), np.column_stack((data.rpm, np.quantile(factor, 0.5, axis=0))))
    for band, ends in zip(ax.collections, ([0.05, 0.95], [0.25, 0.75])):
        corners = {tuple(one) for one in band.get_paths()[0].vertices}
        for q in ends:
            assert {*zip(data.rpm.values.tolist(), np.quantile(factor, q, axis=0).tolist())} <= corners
    assert ax.get_xlabel() == 'Speed of the pinion (1/min)' and ax.get_ylabel() == 'Dynamic factor (–)'


def test_the_distribution_marks_its_quantile_and_band(data):
    worst = data[TAKE[0]]
    ax = many.plot_distribution(worst, q=0.9)
    steps, mark = (line.get_xydata() for line in ax.lines)
    np.testing.assert_array_equal(steps, np.column_stack((np.sort(worst), np.arange(1, 65) / 64)))
    assert mark.tolist() == [[np.quantile(worst, 0.9), 0], [np.quantile(worst, 0.9), 0.9]]
    low, high = stats.quantile_test(worst.values, p=0.9).confidence_interval(0.95)
    (band,) = ax.patches
    assert (band.get_x(), band.get_x() + band.get_width()) == pytest.approx((low, high), rel=1e-12)
    assert f'{low:.4g} to {high:.4g}' in ax.texts[0].get_text()


def test_the_distribution_has_a_question_mark_for_an_end_that_is_not_known():
    values = column(np.arange(10.0), points='random')
    ax = many.plot_distribution(values)
    (band,) = ax.patches
    assert ax.texts[0].get_text() == '95 %: 8.55\n95 % sure: 7 to ?'
    assert band.get_x() == 7 and band.get_x() + band.get_width() == ax.get_xlim()[1] > 9
    ax = many.plot_distribution(values[:3], q=0.5)
    assert ax.texts[0].get_text().endswith('sure: ? to ?') and not ax.patches


def test_bars_of_indices_have_whiskers_over_their_bands():
    angle = stats.uniform(-PI, 2 * PI)
    found = many.sensitivity(saltelli(256, 3, ishigami, angle, angle, angle))
    ax = many.plot_indices(found)
    order = np.argsort(found['ST'].values)
    assert [bar.get_width() for bar in ax.patches] == [*found['S1'].values[order], *found['ST'].values[order]]
    labels = [one.get_text() for one in ax.get_yticklabels()]
    assert labels == [('pair: module', 'pair: face width', 'pair: centre distance')[at] for at in order]
    ends = np.concatenate([np.array(one.get_segments())[:, :, 0] for one in ax.collections])
    expected = np.concatenate([np.column_stack((found[f'{name}_lower'], found[f'{name}_upper']))[order] for name in ('S1', 'ST')])
    np.testing.assert_allclose(ends, expected, rtol=1e-12)


def test_scatter_over_each_key_marks_failures(data):
    with_gaps = data.copy(deep=True)
    with_gaps['status'][5:8] = many.FAILED
    with_gaps[TAKE[0]][5:8] = np.nan
    figure = many.plot_scatter(with_gaps, TAKE[0])
    assert len(figure.axes) == 3 and figure.axes[0].get_title(loc='left') == '3 of 64 without a result'
    for ax, key in zip(figure.axes, data.attrs['inputs']):
        points, crosses = ax.lines
        np.testing.assert_array_equal(points.get_xdata(), np.delete(data[key].values, range(5, 8)))
        np.testing.assert_array_equal(crosses.get_xdata(), data[key].values[5:8])
        assert re.search(r'[A-Za-z].* \((N|µm|–)\)$', ax.get_xlabel())
        assert (ax.get_xlabel() == 'Tip relief (µm)') == (key == 'relief.amount_um')
    assert len(many.plot_scatter(data, TAKE[0]).axes[0].lines) == 1


def test_scatter_has_no_cross_for_variants_that_are_not_done(data):
    """A store that is half done: the others have no result yet, which is no failure."""
    half = data.copy(deep=True)
    half[TAKE[0]][40:], half['status'][40:] = np.nan, many.PENDING
    axes = many.plot_scatter(half, TAKE[0]).axes
    assert [len(ax.lines) for ax in axes] == [1] * len(axes) and len(axes[0].lines[0].get_xdata()) == 40 and not axes[0].get_title(loc='left')


@pytest.mark.parametrize(('words', 'unit', 'shown'), [
    ('torque_nm', 'N m', 'Torque (N m)'), ('ramp_rpm_s', '1/min/s', 'Ramp rpm s (1/min/s)'), ('amount_um', 'um', 'Amount (µm)'),
    ('stiffness_n_um_mm', 'N/um/mm', 'Stiffness (N/µm/mm)'), ('damping_ratio', '', 'Damping ratio (–)'), ('normal_force_n', 'N', 'Normal force (N)'),
])  # fmt: skip
def test_a_unit_stands_once_on_an_axis(words, unit, shown):
    from gearsweep.many.pictures import _axis

    assert _axis(words, {'units': unit}) == shown


def test_pictures_of_other_dimensions_are_refused(data):
    with pytest.raises(ValueError, match='must have variant and 1 more'):
        many.plot_band(data[TAKE[0]])
    with pytest.raises(ValueError, match='must have variant and 0 more'):
        many.plot_distribution(data[TAKE[1]])
    with pytest.raises(AttributeError, match='no attribute'):
        _ = many.plot_everything


@pytest.mark.parametrize('name', ['quantiles', 'sensitivity', 'plot_band', 'plot_distribution'])
def test_all_columns_at_once_are_refused(data, name):
    with pytest.raises(Error, match=rf'{name}: must be a column, such as data\["sweep_worst\.worst_dynamic_factor"\], not a Dataset'):
        getattr(many, name)(data)


def test_an_open_end_of_a_band_is_a_question_mark():
    found = many.quantiles(column(np.arange(10.0), points='random'), 0.95)
    assert with_band(*(float(found[name][0]) for name in ('value', 'lower', 'upper'))).endswith(' to ?)')
