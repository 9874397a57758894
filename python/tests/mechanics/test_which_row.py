"""Which relief, speed, side, mode and status a column belongs to: each row against a run, a sum or a formula that leaves no choice."""

import numpy as np
import pytest

import gearsweep

PAIR = """
&pair module_mm = 3 face_width_mm = 20 {pair} /
&pinion teeth = 21 effective_mass_kg = 0.3 /
&gear teeth = {teeth} effective_mass_kg = 0.7 /
&load torque_nm = {torque} /
&mesh model = 'weber' {mesh} /
&dynamics damping_ratio = {damping} /
&relief amount_um = {reliefs} /
"""


def run(groups, reliefs='0', torque=100, damping=0.1, teeth=34, pair='', mesh=''):
    text = PAIR.format(reliefs=reliefs, torque=torque, damping=damping, teeth=teeth, pair=pair, mesh=mesh)
    return gearsweep.run(gearsweep.Case(text + groups))


def flat(table, column):
    return np.ravel(table[column])


def rows(table, *columns):
    """A tuple of these columns for each row, indices included, in the table's order."""
    frame = table.to_pandas().reset_index()
    return list(zip(*(frame[column] for column in columns)))


def test_deviations_of_a_grade_are_those_of_the_larger_gear():
    # ISO 1328-1:1995, annex B: f_pt = 0.3 (m + 0.4 sqrt(d)) + 4 in grade 5; here without running in.
    study = run("&case tasks = 'rating' / &rating rpm = 3000 accuracy_grade = 5 running_in = 0 /", teeth=84)
    allowed = (0.3 * (3 + 0.4 * np.sqrt(3 * 84)) + 4) * np.cos(np.radians(20))
    assert flat(study.rating_factors, 'pitch_deviation_um') == pytest.approx([allowed, allowed], rel=1e-12)


def test_each_relief_has_the_method_b_of_its_own_amount():
    groups = "&case tasks = 'rating' / &rating rpm = 5000, 9000 accuracy_grade = 5 /"
    both = run(groups, '0, 12').dynamic_factors
    for i, relief in enumerate(('0', '12')):
        alone = run(groups, relief).dynamic_factors
        assert list(flat(both, 'dynamic_factor_b')[2 * i : 2 * i + 2]) == list(flat(alone, 'dynamic_factor_b'))
    assert flat(both, 'dynamic_factor_b')[0] != flat(both, 'dynamic_factor_b')[2]


def test_the_drive_side_is_in_tension_and_the_field_is_that_of_the_relief_with_the_largest():
    # The load bends the tooth away from its drive side. Relief widens the range in which one pair carries, to its outer end.
    study = run("&case tasks = 'static' / &section teeth = 1 fixed = 'sides', 'rim' elements_across = 4 / &static positions = 9 field_position = 0 /",
                '0, 25', torque=200)  # fmt: skip
    for side, stress, share in rows(study.static, 'side', 'sigma_mpa', 'load_share'):
        if share > 0.05:
            assert (stress > 0) == (side == 'drive')
    largest = flat(study.root_stress, 'tension_mpa')
    assert largest[1] > largest[0]
    assert float(study.stress_load.relief_um) == 25
    share = [share for *at, share in rows(study.static, 'relief_um', 's', 'load_share')
             if at == [25, float(study.stress_load.s)]]  # fmt: skip
    assert share[0] == float(study.stress_load.load_share)


def test_a_resonance_has_the_largest_of_the_speeds_nearer_to_it_than_to_its_neighbours():
    # A quarter, a fifth and a sixth of the resonance are less than 30 % apart.
    study = run("&case tasks = 'sweep' / &sweep rpm_first = 900 rpm_last = 3000 rpm_step = 10 /", damping=0.02)
    speeds, factor = flat(study.sweep, 'rpm'), flat(study.sweep, 'dynamic_factor')
    peaks = flat(study.resonances, 'resonance_rpm')
    assert len(peaks) >= 3 and np.any(peaks[1:] / peaks[:-1] < 1.3)
    ends = np.concatenate(([0], (peaks[1:] + peaks[:-1]) / 2, [np.inf]))
    for k, (rpm, largest) in enumerate(rows(study.resonances, 'rpm', 'dynamic_factor')):
        near = (abs(speeds - peaks[k]) <= 0.15 * peaks[k]) & (ends[k] < speeds) & (speeds <= ends[k + 1])
        assert largest == factor[near].max()
        assert rpm == speeds[near][factor[near].argmax()]


def test_tried_reliefs_have_the_worst_speed_of_a_sweep_of_their_own():
    speeds = '&sweep rpm_first = 3000 rpm_last = 15000 rpm_step = 500 /'
    curve = run("&case tasks = 'optimum' / " + speeds).optimum_curve
    whole = [(relief, rpm, factor) for relief, rpm, factor, bound
             in rows(curve, 'relief_um', 'rpm', 'worst_dynamic_factor', 'at_least') if not bound]  # fmt: skip
    ends = [whole[0], whole[-1]]
    assert ends[0][1] != ends[1][1]
    for relief, rpm, factor in ends:
        worst = run("&case tasks = 'sweep' / " + speeds, repr(float(relief))).sweep_worst
        assert flat(worst, 'rpm')[0] == rpm
        assert flat(worst, 'worst_dynamic_factor')[0] == pytest.approx(factor, rel=1e-4)


@pytest.mark.filterwarnings('ignore::gearsweep.PartialWarning')
def test_the_best_of_the_listed_reliefs_counts_what_was_seen_of_motions_that_do_not_repeat():
    def swept(reliefs):
        """The study, and for each relief the largest DF of motions that repeat and of all that were seen."""
        study = run("&case tasks = 'sweep' / &sweep rpm_first = 9000 rpm_last = 26000 rpm_step = 500 /",
                    ', '.join(map(str, reliefs)), torque=10, damping=0.05, pair='backlash_um = 20')  # fmt: skip
        whole, seen = (study.sweep[column].reshape(len(reliefs), -1) for column in ('dynamic_factor', 'seen_dynamic_factor'))
        return study, np.nanmax(whole, axis=1), np.nanmax(np.fmax(whole, seen), axis=1)

    reliefs = [6.7, 6.8, 6.9, 7, 7.5, 8, 8.5, 9, 9.5, 10]
    _, whole, largest = swept(reliefs)
    # Two of which one is the better by motions that repeat, and the other by all.
    i, k = next((i, k) for i in range(10) for k in range(10) if whole[i] < whole[k] and largest[i] > largest[k])
    study, _, _ = swept([reliefs[i], reliefs[k]])
    assert float(study.sweep_summary.best_relief_um) == reliefs[k]


def test_parts_of_a_mesh_period_have_fractions_of_the_mesh_frequency():
    # A motion that repeats after two mesh periods has harmonics of half the mesh frequency.
    study = run("&case tasks = 'load' / &sweep load_rpm = 21000 motion_harmonics = 2 load_torque = .true. /", damping=0.02, torque=100)
    for harmonic, frequency in rows(study.torque_harmonics, 'harmonic', 'frequency_hz'):
        assert frequency == pytest.approx(harmonic * 21 * 21000 / 60, rel=1e-13)
    assert list(flat(study.torque_points, 'mesh_periods')) == [2]
    assert list(flat(study.torque_harmonics, 'harmonic')) == [0, 0.5, 1, 1.5, 2]


def test_each_derivative_has_the_speed_of_its_own_motion():
    groups = "&case tasks = 'sensitivity' / &sensitivity rpm = {} harmonics = 2 /"
    columns = ('rpm', 'number', 'harmonic', 'dte_slope_um')
    both = rows(run(groups.format('5000, 9000')).dte_sensitivity, *columns)
    alone = [row for rpm in (5000, 9000) for row in rows(run(groups.format(rpm)).dte_sensitivity, *columns)]
    assert len(both) == len(alone) and str(both) == str(alone)


def test_modes_of_the_section_are_numbered_alike_in_all_tables():
    study = run("&case tasks = 'harmonic', 'modal' / &section teeth = 1 fixed = 'sides', 'rim' elements_across = 3 / &modal modes = 3 / "
                '&harmonic frequency_hz = 0 modes = 3 harmonics = 2 /')  # fmt: skip
    known = dict(rows(study.modal, 'mode', 'frequency_hz'))
    for system, mode, frequency in rows(study.campbell, 'system', 'mode', 'frequency_hz'):
        assert frequency == pytest.approx(
            known[mode] if system == 'section' else float(study.motion.natural_frequency_hz), rel=1e-9
        )
    assert {mode for system, mode in rows(study.campbell, 'system', 'mode') if system == 'section'} == {1, 2, 3}


def test_the_worst_part_is_the_one_whose_engagements_do_most_harm_together():
    # Twice the load for a hundredth of the time, by an S-N curve of slope 5: 32 times the harm of a cycle, a third of the damage.
    study = run("&case tasks = 'life' / &life rpm = 3000, 3000 duration_h = 10, 0.1 load_factor = 1, 2 dynamic_load = .false. "
                "mean_stress = 'none' curve_cycles = 1e4, 9.765625e10 curve_stress_mpa = 500, 20 /", mesh='corner_contact = .false.')  # fmt: skip
    damage = study.life_parts.damage.reshape(2, 2)
    assert damage[1] == pytest.approx(0.32 * damage[0], rel=1e-9)
    assert list(flat(study.life, 'worst_part')) == [1, 1]


def test_the_motions_and_the_corner_estimate_of_a_point_are_those_of_its_relief_and_speed():
    groups = "&case tasks = 'load' / &sweep load_rpm = {} /"
    reliefs, speeds = ('0', '8'), (12000, 16000, 21000)
    kept = {'torque': 60, 'damping': 0.03, 'pair': 'backlash_um = 60'}
    both = run(groups.format('12000, 16000, 21000'), '0, 8', **kept)
    alone = {(relief, rpm): run(groups.format(rpm), relief, **kept).load_points for relief in reliefs for rpm in speeds}
    for column in ('motions', 'corner_estimate', 'dynamic_factor', 'mesh_periods'):
        expected = [alone[relief, rpm][column].item() for relief in reliefs for rpm in speeds]
        assert list(flat(both.load_points, column)) == expected
        if column != 'mesh_periods':
            assert len(set(expected)) > 1


def test_points_of_the_fillet_are_named_by_the_side_whose_history_they_sum_up():
    study = run("&case tasks = 'transient' / &section teeth = 1 fixed = 'sides', 'rim' elements_across = 3 / "
                '&transient rpm = 4000 modes = 2 positions = 4 samples = 200 /')  # fmt: skip
    seen = {}
    for side, stress in rows(study.transient, 'side', 'sigma_mpa'):
        seen.setdefault(side, []).append(stress)
    for side, highest, lowest in rows(study.transient_points, 'side', 'highest_mpa', 'lowest_mpa'):
        scale = max(abs(highest), abs(lowest))
        assert highest == pytest.approx(max(seen[side]), abs=0.02 * scale)
        assert lowest == pytest.approx(min(seen[side]), abs=0.02 * scale)
    # The drive side is pulled, the coast side pressed.
    largest = dict(rows(study.transient_points, 'side', 'sigma_mpa'))
    assert largest['drive'] > 0 > largest['coast']


def test_points_changes_and_ends_belong_to_their_branch():
    study = run("&case tasks = 'branches' / &branches first = 8000 last = 14000 seeds = 2 /", '0, 6', torque=60, damping=0.03,
                pair='backlash_um = 60')  # fmt: skip
    points = {}
    for branch, rpm, relief, stability in rows(study.branch_points, 'branch', 'rpm', 'relief_um', 'stability'):
        points.setdefault(branch, []).append((rpm, relief, stability))
    assert {relief for one in points.values() for _, relief, _ in one} == {0, 6}
    ends = set()
    columns = ('branch', 'relief_um', 'points', 'stable_points', 'least', 'largest', 'first_end', 'last_end')
    for branch, relief, count, stable, least, largest, first, last in rows(study.branches, *columns):
        own = points[branch]
        assert len(own) == count
        assert {of for _, of, _ in own} == {relief}
        assert sum(word == 'stable' for *_, word in own) == stable
        assert least <= min(rpm for rpm, *_ in own) and max(rpm for rpm, *_ in own) <= largest
        # A branch ends at the range exactly where its point there is the first or the last speed.
        assert (first == 'range') == (own[0][0] in (8000, 14000))
        assert (last == 'range') == (own[-1][0] in (8000, 14000))
        ends.add((first, last))
    assert any(first != last for first, last in ends)
    inside = 0
    for branch, after, rpm in rows(study.branch_changes, 'branch', 'after_point', 'rpm'):
        around = [point[0] for point in points[branch][max(after - 2, 0) : after + 2]]
        # Between the speeds of both points, away from where the branch turns back.
        if len(around) == 4 and len(set(np.sign(np.diff(around)))) == 1:
            inside += 1
            assert min(around[1:3]) <= rpm <= max(around[1:3])
    assert inside > 0
