"""Transmitted torque: against a march of the two bodies' equations of motion that knows nothing of the library, against what the
applied torques must be in the mean, and against the losses of the task flank."""

import numpy as np
import pytest
from matplotlib.figure import Figure

import gearsweep
from gearsweep import plots

TEETH, LOAD, MASS, STIFFNESS, DAMPING = (21, 34), 4000.0, (0.6, 1.1), 400e6, 0.25
CASE = f"""
&case tasks = 'load' / &pair module_mm = 3 face_width_mm = 20 /
&pinion teeth = {TEETH[0]} effective_mass_kg = {MASS[0]} / &gear teeth = {TEETH[1]} effective_mass_kg = {MASS[1]} /
&load normal_force_n = {LOAD} / &relief amount_um = 0 / &mesh model = 'polynomial' coefficients = 400, 0, -100 /
&dynamics damping_ratio = {DAMPING} / &sweep load_rpm = 12000 load_torque = .true. / &numerics tolerance = 1e-9 /
"""


@pytest.fixture(scope='module')
def rubbing():
    return gearsweep.run(gearsweep.Case(CASE).changed(dynamics={'friction': 0.08}))


def lengths():
    """Base radii, base pitch, path of contact in base pitches, and the curvature radii at A (mm): ISO 21771."""
    reference, angle = np.array(TEETH) * 1.5, np.radians(20)
    base, tip = reference * np.cos(angle), reference + 3
    pitch = np.pi * 3 * np.cos(angle)
    reach = np.sqrt(tip**2 - base**2)
    tangent = reference.sum() * np.sin(angle)
    return base, pitch, (reach.sum() - tangent) / pitch, np.array([tangent - reach[1], reach[1]])


class March:
    """Both gears on the line of action, m x" = the applied force less what the mesh takes, in steps of Runge and Kutta that end
    where pairs enter, leave and pass the pitch point. Both applied forces are the static load."""

    def __init__(self, friction, rpm):
        self.friction = friction
        self.base, self.pitch, self.ratio, self.at_a = lengths()
        self.period = 60 / (TEETH[0] * rpm)
        self.pitch_point = (self.base[0] * np.tan(np.radians(20)) - self.at_a[0]) / self.pitch
        self.breaks = np.unique([0, self.ratio - 1, self.pitch_point % 1, 1])

    def forces(self, phase, side, x, v):
        """Loads of the pairs with their friction factors on both gears, and what damping carries."""
        load, factors, rate = 0.0, np.zeros(2), 0.0
        for s in (phase, phase + 1):
            middle = s - phase + side
            if middle > self.ratio:
                continue
            place = 2 * s / self.ratio - 1
            stiffness = STIFFNESS - 100e6 * place**2
            radius = self.at_a + np.array([s, -s]) * self.pitch
            sense = self.friction if middle > self.pitch_point else -self.friction
            factor = 1 + sense * radius / self.base
            load += stiffness * x
            factors += stiffness * x * factor
            rate += stiffness * (factor / MASS).sum()
        reduced = 1 / (1 / np.array(MASS)).sum()
        return load, factors - load, reduced * 2 * DAMPING * np.sqrt(rate) * v

    def accelerate(self, phase, side, state):
        load, friction, damping = self.forces(phase, side, *state)
        return np.array([state[1], ((LOAD - load - friction - damping) / MASS).sum()])

    def period_of(self, state, steps):
        """One mesh period: phase and forces at both ends of each step, and the state after it."""
        rows = []
        for first, last in zip(self.breaks, self.breaks[1:]):
            side = (first + last) / 2
            count = max(2, int(np.ceil(steps * (last - first))))
            width = (last - first) / count
            h = width * self.period
            for i in range(count):
                phase = first + i * width
                rows.append((phase, *self.forces(phase, side, *state)))
                k1 = self.accelerate(phase, side, state)
                k2 = self.accelerate(phase + width / 2, side, state + h / 2 * k1)
                k3 = self.accelerate(phase + width / 2, side, state + h / 2 * k2)
                k4 = self.accelerate(phase + width, side, state + h * k3)
                state = state + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
                rows.append((phase + width, *self.forces(phase + width, side, *state)))
        return rows, state

    def steady(self, steps):
        state = np.array([LOAD / STIFFNESS, 0.0])
        for _ in range(45):
            _, state = self.period_of(state, 60)
        for _ in range(3):
            rows, state = self.period_of(state, steps)
        return (np.array([row[0] for row in rows]), np.array([row[1] for row in rows]), np.array([row[2] for row in rows]),
                np.array([row[3] for row in rows]))  # fmt: skip


def test_torque_is_that_of_a_march(rubbing):
    phase, load, friction, damping = March(0.08, 12000).steady(1000)
    base = lengths()[0] / 1000
    table, points = rubbing.torque, rubbing.torque_points
    assert points.status == ['ok']
    static = LOAD * base

    def at(values):
        """Where the breaks are, both have the values of either side."""
        return np.interp(inner, phase, values)

    # Away from the breaks, at which the values jump.
    inner = table.tau[np.all(np.abs(table.tau[:, None] - March(0.08, 12000).breaks) > 2e-3, axis=1)]
    pick = np.isin(table.tau, inner)
    for gear, name in enumerate(('pinion', 'gear')):
        whole = base[gear] * (load + friction[:, gear] + damping)
        assert table[f'{name}_torque_nm'][pick] == pytest.approx(at(whole), abs=2e-5 * static[gear])
        assert table[f'{name}_friction_nm'][pick] == pytest.approx(at(base[gear] * friction[:, gear]), abs=2e-5 * static[gear])
        assert points[f'{name}_mean_nm'].item() == pytest.approx(np.trapezoid(whole, phase), rel=1e-5)
        assert points[f'{name}_friction_mean_nm'].item() == pytest.approx(
            np.trapezoid(base[gear] * friction[:, gear], phase), abs=1e-5 * static[gear])  # fmt: skip
        # Between the ends of the march's 1000 steps: of a third harmonic they miss (6 pi/2000)**2/2 of the amplitude, below static.
        assert points[f'{name}_largest_nm'].item() == pytest.approx(whole.max(), abs=5e-5 * static[gear])
        assert points[f'{name}_least_nm'].item() == pytest.approx(whole.min(), abs=5e-5 * static[gear])
        # By the trapezoidal rule, which a harmonic k misses by (2 pi k/1000)**2/12 of what it sums up.
        harmonics = rubbing.torque_harmonics
        parts = harmonics[f'{name}_amplitude_nm'] * np.exp(1j * np.radians(harmonics[f'{name}_phase_deg']))
        sums = [np.trapezoid(whole * np.exp(-2j * np.pi * k * phase), phase) for k in harmonics.harmonic]
        assert list(harmonics.harmonic) == list(range(9))
        assert np.abs(parts - np.array([1, *[2] * 8]) * sums).max() < 1e-4 * static[gear]
    assert table.pinion_damping_nm[pick] == pytest.approx(at(base[0] * damping), abs=2e-5 * static[0])
    assert table.time_s == pytest.approx(table.tau * 60 / (TEETH[0] * 12000), rel=1e-14)


def test_without_friction_the_mean_torques_are_the_applied_ones():
    """Over a period each gear takes up no momentum."""
    case = gearsweep.Case(CASE).changed(relief={'amount_um': [0, 12]}, sweep={'load_rpm': [3000, 9000, 20000]})
    points = gearsweep.run(case).torque_points
    base = lengths()[0] / 1000
    for gear, name in enumerate(('pinion', 'gear')):
        assert points[f'{name}_mean_nm'] == pytest.approx(LOAD * base[gear], rel=1e-9)
        assert not points[f'{name}_friction_mean_nm'].any()
    assert np.abs(points.friction_loss).max() < 1e-9


@pytest.mark.parametrize('friction', [0, 0.08])
@pytest.mark.parametrize('rpm', [2000, 9000, 20000])
def test_harmonics_follow_from_those_of_the_transmission_error(friction, rpm):
    """Newton's law on both gears together: the harmonics of the force are the reduced mass times (2 pi f)**2 those of the transmission
    error, but for friction, which splits between the gears as their masses do."""
    case = gearsweep.Case(CASE).changed(dynamics={'friction': friction}, relief={'amount_um': 12}, sweep={'load_rpm': rpm})
    study = gearsweep.run(case)
    torque, motion = study.torque_harmonics, study.motion_harmonics
    base, mass = lengths()[0] / 1000, np.array(MASS)

    def force(gear):
        name = ('pinion', 'gear')[gear]
        return torque[f'{name}_amplitude_nm'] * np.exp(1j * np.radians(torque[f'{name}_phase_deg'])) / base[gear]

    both = (force(0) / mass[0] + force(1) / mass[1]) / (1 / mass).sum()
    error = 1e-6 * motion.dte_amplitude_um * np.exp(1j * np.radians(motion.dte_phase_deg))
    newton = (2 * np.pi * motion.frequency_hz) ** 2 * error / (1 / mass).sum()
    assert np.abs(both[1:] - newton[1:]).max() < 1e-9 * LOAD
    assert (np.abs(force(0) - force(1))[1:].max() > 1e-3 * LOAD) == (friction > 0)


@pytest.mark.parametrize('changes', [{}, {'dynamics': {'friction': 0.08}}, {'dynamics': {'damping_ratio': 0.02}, 'pair': {'backlash_um': 60}}])
def test_estimates_are_honest(changes):
    """Against ten times as many steps."""
    case = gearsweep.Case(CASE).changed(relief={'amount_um': [0, 12]}, sweep={'load_rpm': [1500, 6000, 9500, 20000]}).changed(**changes)
    study = gearsweep.run(case)
    exact = gearsweep.run(case.changed(numerics={'steps_per_period': 4000}))
    for table, columns in (('torque_points', ('mean', 'least', 'largest')), ('torque_harmonics', ('amplitude',))):
        for gear in ('pinion', 'gear'):
            estimate = study[table][f'{gear}_error_nm']
            assert estimate.max() < 2e-3 * LOAD * lengths()[0][1] / 1000
            for column in columns:
                assert (np.abs(study[table][f'{gear}_{column}_nm'] - exact[table][f'{gear}_{column}_nm']) <= 2 * estimate + 1e-9).all()


def test_slow_loss_is_that_of_the_flanks():
    """At rest nearly, friction takes mu H_V of the power, with the loss factor H_V of the static load by the task flank; to the first
    order in mu."""
    friction = 1e-3
    case = gearsweep.Case(CASE).changed(case={'tasks': ['load', 'flank']}, dynamics={'friction': friction}, sweep={'load_rpm': 20},
                                        flank={'rpm': 20, 'dynamic_load': False, 'friction_coefficient': friction})  # fmt: skip
    study = gearsweep.run(case)
    loss = np.ravel(study.torque_points.friction_loss)[0]
    assert loss == pytest.approx(friction * np.ravel(study.flank_losses.loss_factor)[0], rel=5e-3)


def test_mirrored_teeth_driven_on_their_other_side_are_the_same():
    """Sides are names: every table is the same to the last bit, as the library has one code for both."""
    rack = {'pinion': {'rack_tip_radius': 0.1, 'coast_rack_tip_radius': 0.2}, 'gear': {'rack_tip_radius': 0.1, 'coast_rack_tip_radius': 0.15}}
    other = {'pinion': {'rack_tip_radius': 0.2, 'coast_rack_tip_radius': 0.1}, 'gear': {'rack_tip_radius': 0.15, 'coast_rack_tip_radius': 0.1}}
    case = gearsweep.Case(CASE).changed(mesh={'model': 'fe', 'coefficients': None}, section={'elements_across': 3},
                                        case={'tasks': ['mesh', 'static', 'load']}, static={'positions': 3})  # fmt: skip
    one = gearsweep.run(case.changed(pair={'pressure_angle_deg': 28, 'coast_angle_deg': 20}, **rack))
    two = gearsweep.run(case.changed(pair={'pressure_angle_deg': 20, 'coast_angle_deg': 28, 'loaded_flanks': 'coast'}, **other))
    plain = gearsweep.run(case.changed(pair={'pressure_angle_deg': 20, 'coast_angle_deg': 28}, **other))
    for name in ('geometry', 'gears', 'mesh', 'static', 'torque'):
        for column in one[name]:
            first, second = np.asarray(one[name][column]), np.asarray(two[name][column])
            assert np.array_equal(first, second, equal_nan=first.dtype.kind == 'f'), column
    # The load on the other flank is another matter: ISO 21771's contact ratio, each side's own.
    assert plain.geometry.contact_ratio == two.geometry.coast_contact_ratio
    assert plain.geometry.contact_ratio > two.geometry.contact_ratio + 0.2


def test_coast_flanks_may_not_jam():
    """The tip that just reaches the end of the coast flank's involute, where the rack's straight flank ends (ISO 21771)."""
    case = gearsweep.Case(CASE).changed(pair={'coast_angle_deg': 14.5}, pinion={'coast_rack_tip_radius': 0.6, 'teeth': 60},
                                        gear={'teeth': 90, 'rack_tip_radius': 0.1})  # fmt: skip
    angle = np.radians(14.5)
    reference = np.array([60, 90]) * 1.5
    end = reference[0] * np.sin(angle) - (1.25 - 0.6 * (1 - np.sin(angle))) * 3 / np.sin(angle)
    deepest = 2 * np.hypot(reference[1] * np.cos(angle), reference.sum() * np.sin(angle) - end)
    with pytest.raises(gearsweep.Error, match='the involute of the pinion on the coast flanks; at most') as error:
        gearsweep.run(case.changed(gear={'tip_diameter_mm': deepest + 1e-4}), 'geometry')
    assert float(str(error.value).split('at most ')[1].split()[0]) == pytest.approx(deepest, rel=1e-4)
    gearsweep.run(case.changed(gear={'tip_diameter_mm': deepest - 1e-4}), 'geometry')


def test_sides_of_the_rack_refuse_by_name():
    case = gearsweep.Case(CASE)
    with pytest.raises(gearsweep.Error, match=r"&pair loaded_flanks = 'coast': is for asymmetric teeth"):
        gearsweep.run(case.changed(pair={'loaded_flanks': 'coast'}), 'geometry')
    with pytest.raises(gearsweep.Error, match=r'&pinion rack_tip_radius = 0.3, 0.7 \(drive, coast\): do not fit the rack together'):
        gearsweep.run(case.changed(pinion={'rack_tip_radius': 0.3, 'coast_rack_tip_radius': 0.7}), 'geometry')
    # ISO 53: the tip land of this rack, pi/2 - 2.5 tan 20 in modules, takes corners of (1 - sin 20)/cos 20 times their radii.
    land, taken = np.pi / 2 - 2.5 * np.tan(np.radians(20)), (1 - np.sin(np.radians(20))) / np.cos(np.radians(20))
    fits = 0.999 * land / taken - 0.3
    case = case.changed(gear={'addendum': 0.6})
    gearsweep.run(case.changed(pinion={'rack_tip_radius': 0.3, 'coast_rack_tip_radius': fits}), 'geometry')
    with pytest.raises(gearsweep.Error, match='do not fit'):
        gearsweep.run(case.changed(pinion={'rack_tip_radius': 0.3, 'coast_rack_tip_radius': fits * 1.01}), 'geometry')


def test_picture_repeats_each_motion_as_often_as_the_longest_lasts():
    case = gearsweep.Case(CASE).changed(dynamics={'damping_ratio': 0.02}, relief={'amount_um': [0, 12]}, sweep={'load_rpm': 3600})
    study = gearsweep.run(case)
    assert sorted(study.torque_points.mesh_periods.ravel()) == [1, 4]
    ax = plots.plot_torque(study, Figure().subplots())
    curves = [line.get_xdata() for line in ax.lines if np.size(line.get_xdata()) > 2]
    assert [x.max() for x in curves] == [4, 4] and ax.get_xlim() == (0, 4)


def test_picture_has_the_mean_of_its_own_speed():
    """With friction the means differ from speed to speed; the line across is that of the curve's speed and gear."""
    study = gearsweep.run(gearsweep.Case(CASE).changed(dynamics={'friction': 0.08}, sweep={'load_rpm': [3000, 12000]}))
    points = study.torque_points
    for gear in ('pinion', 'gear'):
        first, second = points[f'{gear}_mean_nm'][0]
        assert abs(first / second - 1) > 1e-4
        ax = plots.plot_torque(study, Figure().subplots(), rpm=12000, gear=gear, periods=3)
        assert [line.get_ydata()[0] for line in ax.lines if np.ptp(line.get_ydata()) == 0] == [second]
        assert ax.get_xlim() == (0, 3)
    table = study.torque_harmonics
    ax = plots.plot_torque_harmonics(study, Figure().subplots(), rpm=12000, gear='gear')
    assert [bar.get_height() for bar in ax.patches] == list(table.gear_amplitude_nm[(table.rpm == 12000) & (table.harmonic > 0)])
    with pytest.raises(ValueError, match="gear = 'wheel'"):
        plots.plot_torque_harmonics(study, gear='wheel')
    for wrong, message in (({'rpm': 5000}, 'rpm = 5000: must be one of 3000, 12000'), ({'gear': 'wheel'}, "gear = 'wheel'"),
                           ({'periods': 0}, 'periods = 0: must be at least 1')):  # fmt: skip
        with pytest.raises(ValueError, match=message):
            plots.plot_torque(study, **wrong)
