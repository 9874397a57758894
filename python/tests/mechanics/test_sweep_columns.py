"""Which relief, speed and point a column of the sweep's tables belongs to, against runs and counts that leave no choice."""

import numpy as np
import pytest

import gearsweep

PAIR = """
&case tasks = 'sweep' /
&pair module_mm = 3 face_width_mm = 20 {backlash} /
&pinion teeth = 21 effective_mass_kg = 0.3 /
&gear teeth = 34 effective_mass_kg = 0.7 /
&load torque_nm = {torque} /
&mesh model = 'weber' /
&dynamics damping_ratio = {damping} /
&relief amount_um = {reliefs} /
&sweep rpm_first = 2000 rpm_last = 15000 rpm_step = 500 /
"""


def swept(reliefs, torque=100, damping=0.1, backlash=''):
    return gearsweep.run(gearsweep.Case(PAIR.format(reliefs=reliefs, torque=torque, damping=damping, backlash=backlash)))


def test_each_relief_has_the_corner_estimate_of_its_own_worst_speed():
    both = swept('0, 10').sweep_worst
    assert both.rpm[0] != both.rpm[1]
    for i, relief in enumerate((0, 10)):
        alone = swept(relief).sweep_worst
        assert both.rpm[i] == alone.rpm[0]
        assert both.corner_estimate[i] == alone.corner_estimate[0] > 0
    assert both.corner_estimate[0] != both.corner_estimate[1]


@pytest.mark.filterwarnings('ignore::gearsweep.PartialWarning')
def test_points_with_contact_loss_include_those_with_coast_contact():
    study = swept('0', torque=20, damping=0.04, backlash='backlash_um = 5')
    contact = study.sweep.contact.ravel()
    assert np.any(contact == 'coast') and np.any(contact == 'full')
    assert study.sweep_summary.points_with_contact_loss == np.sum((contact == 'lost') | (contact == 'coast'))
    # The coast flanks carry load exactly there.
    factor = study.sweep.coast_factor.ravel()
    known = ~np.isnan(factor)
    assert np.array_equal(factor[known] > 0, contact[known] == 'coast')
