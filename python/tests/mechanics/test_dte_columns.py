"""Columns of the dynamic transmission error of motions that coexist, against an own integration of the equation of motion.

The mesh is prescribed: each pair has one stiffness over its contact ratio, so that the mesh stiffness is a square wave. From the
state that a row states, SciPy's DOP853 integrates x" + 2 zeta w x' + w^2 max(x, 0) = F/m over the periods of the motion; root mean
square and peak-to-peak value are those of that solution.
"""

import numpy as np
import pytest

import gearsweep

TEETH, MASS, FORCE, PAIR, RATIO, ZETA = 25, 0.4, 5000.0, 3e8, 1.6, 0.04
FIRST, LAST, STEP = 5000, 13000, 100
TEXT = f"""
&case tasks = 'sweep', 'hysteresis', 'branches' /
&pinion teeth = {TEETH} effective_mass_kg = {2 * MASS} /
&gear effective_mass_kg = {2 * MASS} /
&load normal_force_n = {FORCE} /
&mesh model = 'polynomial' coefficients = {PAIR * 1e-6} contact_ratio = {RATIO} /
&dynamics damping_ratio = {ZETA} /
&sweep rpm_first = {FIRST} rpm_last = {LAST} rpm_step = {STEP} direction = 'both' /
&branches first = {FIRST} last = {LAST} seeds = 3 /
"""


@pytest.fixture(scope='module')
def study():
    return gearsweep.run(gearsweep.Case(TEXT))


def integrated(rpm, x, rate, periods):
    """Root mean square about the mean, and peak-to-peak value, in the unit of `x` (um), of `rate` mm/s; and the state at the end."""
    from scipy.integrate import solve_ivp

    period = 60 / (rpm * TEETH)
    state = np.array([x * 1e-6, rate * 1e-3])
    first = second = 0.0
    least, largest = np.inf, -np.inf
    for _ in range(periods):
        for pairs, span in ((2, RATIO - 1), (1, 2 - RATIO)):
            stiffness = pairs * PAIR / MASS

            def slope(_, y, stiffness=stiffness):
                touches = y[0] > 0
                return [y[1], FORCE / MASS - touches * (2 * ZETA * np.sqrt(stiffness) * y[1] + stiffness * y[0])]

            t = np.linspace(0, span * period, 801)
            found = solve_ivp(slope, (0, t[-1]), state, method='DOP853', t_eval=t, rtol=1e-11, atol=1e-15, max_step=period / 200)
            deflection = found.y[0]
            first += np.trapezoid(deflection, t) / (period * periods)
            second += np.trapezoid(deflection**2, t) / (period * periods)
            least, largest = min(least, deflection.min()), max(largest, deflection.max())
            state = found.y[:, -1]
    return 1e6 * np.sqrt(second - first**2), 1e6 * (largest - least), 1e6 * state[0]


def rows_of(table):
    return [row for _, row in table.to_pandas().reset_index().iterrows()]


def integrated_row(row):
    return integrated(row.rpm, row.dte_um, row.dte_rate_mm_s, int(row.mesh_periods))


def test_hysteresis_and_the_other_direction_of_a_sweep(study):
    sweep = {row.rpm: row for row in rows_of(study.sweep)}
    directions, other = set(), 0
    for i, row in enumerate(rows_of(study.hysteresis)):
        if row.status != 'ok' or (i % 7 > 0 and sweep[row.rpm].direction == 'both'):
            continue
        directions.add(row.direction)
        rms, peak, end = integrated_row(row)
        assert end == pytest.approx(row.dte_um, abs=1e-3)
        assert row.dte_rms_um == pytest.approx(rms, rel=2e-4)
        assert row.dte_peak_to_peak_um == pytest.approx(peak, rel=2e-4)
        off = max(abs(row.dte_rms_um - rms), abs(row.dte_peak_to_peak_um - peak))
        assert off <= 2 * row.dte_error_estimate_um + 1e-6 * peak
        # Of two motions at a speed, the sweep's row is the one of larger dynamic factor; this one is the other.
        beside = sweep[row.rpm]
        if beside.dynamic_factor - row.dynamic_factor > 1e-3 and abs(beside.other_dynamic_factor - row.dynamic_factor) < 1e-5:
            other += 1
            assert beside.other_dte_rms_um == pytest.approx(rms, rel=2e-4)
    assert directions == {'up', 'down'} and other > 0


def test_points_of_branches(study):
    rows = [row for row in rows_of(study.branch_points) if row.stability == 'stable']
    assert len(rows) > 20
    for row in rows[:: len(rows) // 10]:
        rms, peak, _ = integrated_row(row)
        assert row.dte_rms_um == pytest.approx(rms, rel=1e-3)
        assert row.dte_peak_to_peak_um == pytest.approx(peak, rel=1e-3)
