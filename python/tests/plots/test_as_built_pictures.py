"""Pictures of gears as built: what is drawn is what the tables hold, and the words are whole and free."""

import numpy as np
import pytest
from matplotlib.collections import FillBetweenPolyCollection, LineCollection, QuadMesh
from matplotlib.figure import Figure
from matplotlib.patches import StepPatch
from matplotlib.text import Text
from test_plots import check_text

import gearsweep
from gearsweep import Case, plots

#: Three pairs of gears in each of seven assemblies.
BUILT = Case("""&case title = 'as built' tasks = 'as_built' / &pair module_mm = 3 face_width_mm = 20 /
&pinion teeth = 14 profile_shift = 0.3 / &gear teeth = 21 / &load normal_force_n = 4000 / &relief amount_um = 0, 10 / &mesh model = 'weber' /
&sweep rpm_first = 5000 rpm_last = 9000 rpm_step = 2000 / &as_built waterfall = .true. turn_rpm = 6000, 9000 /
&deviations pinion_class = 6 gear_class = 7 draws = 3 assembly = 'all' /""")
PICTURES = ('as_built', 'as_built_worst', 'as_built_turn', 'as_built_orders', 'as_built_waterfall')


@pytest.fixture(scope='module')
def built():
    return gearsweep.run(BUILT)


@pytest.fixture(scope='module')
def alone():
    """One pair of gears that is put together in one way, at one speed."""
    return gearsweep.run(BUILT.changed(sweep={'rpm_last': 5000}, as_built={'turn_rpm': None}, deviations={'draws': 1, 'assembly': 'stated'}))


@pytest.fixture(scope='module')
def unanswered():
    """No motion has an answer."""
    with pytest.warns(gearsweep.PartialWarning):
        return gearsweep.run(BUILT.changed(sweep={'rpm_first': 1, 'rpm_last': 1}, as_built={'turn_rpm': None}, relief={'amount_um': 0},
                                           numerics={'steps_per_period': 20}, deviations={'draws': 1, 'assembly': 'stated'}))  # fmt: skip


@pytest.fixture(scope='module')
def long():
    """The same teeth meet again after 168 mesh periods, too many to be drawn side by side."""
    return gearsweep.run(BUILT.changed(gear={'teeth': 24}, as_built={'waterfall': None}))


@pytest.fixture
def ax():
    return Figure().subplots()


def words_of(ax):
    return [text.get_text() for text in ax.findobj(Text)]


def points_of(line):
    return np.array(line.get_data())


@pytest.mark.parametrize('i', [0, 1])
def test_over_speed_stand_median_band_and_nominal_factor(built, ax, i):
    table = built.as_built
    assert table.dynamic_factor.shape == (2, 3, 7, 3) and np.isfinite(table.dynamic_factor).all()
    plots.plot_as_built(built, ax, relief_um=table.relief_um[i])
    ordered = np.sort(table.dynamic_factor[i].reshape(21, 3), axis=0)
    median, nominal = (points_of(line) for line in ax.lines)
    np.testing.assert_allclose(median, [table.rpm, ordered[10]], rtol=1e-14)
    np.testing.assert_array_equal(nominal, [table.rpm, table.nominal_factor[i, 2, 6]])
    (band,) = ax.findobj(FillBetweenPolyCollection)
    corners = band.get_paths()[0].vertices
    # 5 and 95 % of the way from the first to the last of 21 are the second of them from either side.
    for rpm, low, high in zip(table.rpm, ordered[1], ordered[19]):
        there = corners[corners[:, 0] == rpm, 1]
        assert (there.min(), there.max()) == pytest.approx((low, high), rel=1e-12)
    assert {'median of 21 as built', '5 to 95 %', 'nominal', f'Tip relief {table.relief_um[i]:g} µm'} <= set(words_of(ax))


def test_of_one_pair_of_gears_there_is_no_band(alone, ax):
    plots.plot_as_built(alone, ax)
    np.testing.assert_array_equal(points_of(ax.lines[0]), [[5000], alone.as_built.dynamic_factor[0, 0, 0]])
    assert not ax.findobj(FillBetweenPolyCollection) and {'as built', 'nominal'} < set(words_of(ax))


def test_what_has_no_answer_is_reported(unanswered, ax):
    assert np.isnan(unanswered.as_built.dynamic_factor).all()
    plots.plot_as_built(unanswered, ax)
    (cross,) = [line for line in ax.lines if line.get_marker() == 'x']
    np.testing.assert_array_equal(cross.get_xdata(), [1])
    assert f'no answer: {unanswered.as_built.status[0, 0, 0, 0]}' in words_of(ax)
    for plot in (plots.plot_turn, plots.plot_orders):
        assert 'Tip relief 0 µm, no answer in motion' in words_of(plot(unanswered, Figure().subplots()))
    with pytest.raises(ValueError, match='relief_um: there is none, as no point has a result'):
        plots.plot_turn_loads(unanswered, ax)


def test_the_turn_has_the_motion_and_what_is_at_rest(built, ax):
    table = built.as_built_turn
    plots.plot_turn(built, ax, relief_um=10, rpm=9000)
    for line, rpm in zip(ax.lines, (0, 9000)):
        rows = (table.relief_um == 10) & (table.rpm == rpm)
        np.testing.assert_array_equal(points_of(line), [table.tau[rows], table.transmission_error_um[rows]])
    assert 'Tip relief 10 µm, 9000 1/min, pair of gears 1, assembly 1' in words_of(ax)
    # The same teeth meet again after 42 mesh periods, three turns of the pinion.
    assert ax.get_xlim() == (0, 42)
    assert [line.get_xdata()[0] for line in ax.lines[2:]] == [0, 14, 28, 42]


def test_each_pair_of_teeth_has_a_bar(built, ax):
    table = built.as_built_loads
    plots.plot_turn_loads(built, ax, relief_um=10, rpm=6000)
    rows = (table.relief_um == 10) & (table.rpm == 6000)
    (bars,) = ax.findobj(StepPatch)
    values, edges, _ = bars.get_data()
    np.testing.assert_array_equal(values[::2], table.load_ratio[rows])
    assert not values[1::2].any() and len(values[::2]) == 42
    np.testing.assert_allclose((edges[::2] + edges[1::2]) / 2, table.pair[rows] - 0.5)
    most = np.flatnonzero(rows)[table.load_ratio[rows].argmax()]
    told = f'{table.load_ratio[most]:.4g}, pinion tooth {table.pinion_tooth[most]} on gear tooth {table.gear_tooth[most]}'
    assert told in words_of(ax)


def test_orders_are_stems_and_the_largest_have_names(built, ax):
    table = built.as_built_orders
    plots.plot_orders(built, ax, relief_um=0, rpm=6000)
    rows = (table.relief_um == 0) & (table.rpm == 6000)
    stems = sorted((x, y) for part in ax.findobj(LineCollection) for (x, _), (_, y) in part.get_segments())
    assert stems == sorted(zip(table.order[rows], table.dte_amplitude_um[rows]))
    np.testing.assert_array_equal(points_of(ax.lines[0]), [table.order[rows], table.ste_amplitude_um[rows]])
    named = {text.get_text().replace('−', '-'): text.xy for text in ax.texts}
    order, amplitude = (dict(zip(table.order_name[rows], table[column][rows])) for column in ('order', 'dte_amplitude_um'))
    assert named == {name: (order[name], amplitude[name]) for name in named} and len(named) == 9
    assert {'mesh 1', 'mesh 2', 'mesh 3'} < set(named)
    for begin, most in (('mesh', 7), ('pinion gear', 2)):
        kind = [name for name in amplitude if name.split()[0] in begin]
        least = min(amplitude[name] for name in named if name in kind and len(name) > 6)
        assert sum(amplitude[name] > least for name in kind) < most


@pytest.mark.parametrize('rpm', [6000, 9000])
@pytest.mark.parametrize('relief', [0, 10])
def test_of_a_long_turn_the_part_about_the_largest_load_is_drawn(long, relief, rpm):
    loads, turn = long.as_built_loads, long.as_built_turn
    above, below = plots.plot_turn(long, relief_um=relief, rpm=rpm), plots.plot_turn_loads(long, relief_um=relief, rpm=rpm)
    rows = (loads.relief_um == relief) & (loads.rpm == rpm)
    assert rows.sum() == 168
    most = np.flatnonzero(rows)[loads.load_ratio[rows].argmax()]
    first, last = below.get_xlim()
    assert above.get_xlim() == (first, last) and last - first == 25
    # In the middle, which is half a mesh period wide of a whole number; or as near to it as the ends of the turn are.
    assert abs(loads.pair[most] - 0.5 - (first + last) / 2) <= 0.5 or first == 0 or last == 168
    assert first < loads.pair[most] <= last
    for line, one in zip(above.lines, (0, rpm)):
        shown = (turn.relief_um == relief) & (turn.rpm == one) & (turn.tau >= first) & (turn.tau <= last)
        np.testing.assert_array_equal(points_of(line), [turn.tau[shown], turn.transmission_error_um[shown]])
    (bars,) = below.findobj(StepPatch)
    values, edges, _ = bars.get_data()
    shown = rows & (loads.pair > first) & (loads.pair <= last)
    np.testing.assert_array_equal(values[::2], loads.load_ratio[shown])
    np.testing.assert_allclose((edges[::2] + edges[1::2]) / 2, loads.pair[shown] - 0.5)
    for ax in (above, below):
        words = f'Tip relief {relief} µm, {rpm} 1/min, pair of gears 1, assembly 1\nMesh periods {first:g} to {last:g} of 168, about the largest load'
        assert words in words_of(ax)


def test_a_long_turn_without_an_answer_begins_at_its_begin(unanswered, ax):
    with pytest.warns(gearsweep.PartialWarning):
        study = gearsweep.run(unanswered.case.changed(gear={'teeth': 24}))
    plots.plot_turn(study, ax)
    assert ax.get_xlim() == (0, 25)
    assert 'Tip relief 0 µm, no answer in motion\nMesh periods 0 to 25 of 168' in words_of(ax)


@pytest.mark.parametrize('rpm', [6000, 9000])
def test_of_many_orders_the_largest_are_drawn(long, ax, rpm):
    table = long.as_built_orders
    plots.plot_orders(long, ax, relief_um=10, rpm=rpm)
    rows = (table.relief_um == 10) & (table.rpm == rpm)
    points = list(zip(table.order[rows], table.dte_amplitude_um[rows], table.order_name[rows]))
    others = sorted((point for point in points if point[2] not in ('mesh 1', 'mesh 2', 'mesh 3')), key=lambda point: -point[1])
    assert len(points) - len(others) == 3 and len(points) > 100
    wanted = sorted(point[:2] for point in points if point not in others[40:])
    stems = sorted((x, y) for part in ax.findobj(LineCollection) for (x, _), (_, y) in part.get_segments())
    assert stems == wanted and len(wanted) == 43
    np.testing.assert_array_equal(np.sort(points_of(ax.lines[0])[0]), [order for order, _ in wanted])
    assert any(words.endswith(f'\nMesh orders, and the 40 largest of {len(others)} others') for words in words_of(ax))


def test_the_map_has_the_amplitude_at_each_speed_and_order(built, ax):
    table = built.as_built_waterfall
    plots.plot_waterfall(built, ax)
    (cells,) = ax.findobj(QuadMesh)
    np.testing.assert_array_equal(cells.get_array(), table.dte_amplitude_um.T)
    ticks = dict(zip((label.get_text() for label in ax.get_yticklabels()), ax.get_yticks()))
    assert ticks == {'1': 1, 'mesh 1: 14': 14, 'mesh 2: 28': 28, 'mesh 3: 42': 42}
    (curve,) = ax.lines  # on which so many cycles a turn have the natural frequency
    np.testing.assert_allclose(curve.get_xdata() / 60 * curve.get_ydata(), built.motion.natural_frequency_hz)


def test_the_best_and_the_worst_assembly_are_named(built, ax):
    table = built.as_built_worst
    plots.plot_assemblies(built, ax, relief_um=10, draw=2)
    factor = table.dynamic_factor[list(table.relief_um).index(10), 1]
    nominal, shown = ax.lines[:2]
    np.testing.assert_array_equal(points_of(shown), [table.assembly, factor])
    assert set(nominal.get_ydata()) == {table.nominal_factor[1, 0, 0]}
    most, least = factor.argmax(), factor.argmin()
    first = table.first_gear_tooth[1, 1]
    assert {f'{word}: assembly {k + 1}\n(gear tooth {first[k]:g} first), {factor[k]:.3f}' for word, k in (('worst', most), ('best', least))} < \
        set(words_of(ax))
    ax = plots.plot_assemblies(gearsweep.run(BUILT.changed(deviations={'assembly': 'stated'}, as_built={'waterfall': None})), Figure().subplots())
    assert ax.get_xlabel() == 'Pair of gears (–)'
    of_each = table.dynamic_factor[0, :, 0]
    assert f'worst: pair of gears {of_each.argmax() + 1}, {of_each.max():.3f}' in words_of(ax)
    np.testing.assert_array_equal(points_of(ax.lines[1]), [[1, 2, 3], table.dynamic_factor[0, :, 0]])


@pytest.mark.parametrize('plot, table', [
    (plots.plot_as_built, 'as_built'), (plots.plot_turn, 'as_built_turn'), (plots.plot_turn_loads, 'as_built_loads'),
    (plots.plot_orders, 'as_built_orders'), (plots.plot_waterfall, 'as_built_waterfall'), (plots.plot_assemblies, 'as_built_worst'),
])  # fmt: skip
def test_a_study_without_the_task_is_refused(built, plot, table, ax):
    without = gearsweep.run(BUILT.changed(case={'tasks': 'geometry'}), 'geometry')
    with pytest.raises(KeyError, match=f'this study has no table {table}'):
        plot(without, ax)
    assert plot(built[table], ax) is ax  # as the table alone


def test_points_that_there_are_not_are_refused(built, ax):
    for plot in (plots.plot_turn, plots.plot_turn_loads, plots.plot_orders):
        with pytest.raises(ValueError, match='rpm = 5000: must be one of 6000, 9000'):
            plot(built, ax, rpm=5000)
    for plot in (plots.plot_as_built, plots.plot_assemblies):
        with pytest.raises(ValueError, match='relief_um = 3: must be one of 0, 10'):
            plot(built, ax, relief_um=3)
    with pytest.raises(ValueError, match='draw = 4: must be one of 1, 2, 3'):
        plots.plot_assemblies(built, ax, draw=4)


@pytest.mark.parametrize('which', ['built', 'alone', 'unanswered', 'long'])
def test_all_text_is_large_enough_whole_and_free(which, request, monkeypatch):
    study = request.getfixturevalue(which)
    # One pair of gears in one assembly has nothing to compare.
    absent = {'built': '', 'long': 'as_built_waterfall'}.get(which, 'as_built_worst')
    expected = tuple(name for name in PICTURES if name != absent)
    assert tuple(name for name, _ in plots.figures(study, *PICTURES)) == expected
    check_text(plots.figures(study, *PICTURES), monkeypatch)
