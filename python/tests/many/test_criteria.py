"""What `many.robust` can judge candidates by beside the dynamic factor."""

import pickle

import numpy as np
import pytest

import gearsweep
from gearsweep import Case, Code, Error

many = pytest.importorskip('gearsweep.many')

from gearsweep.many.criteria import CRITERIA  # noqa: E402

CASE = Case('''&case tasks = 'as_built' / &pair module_mm = 3  face_width_mm = 20 / &pinion teeth = 10  profile_shift = 0.4 / &gear teeth = 15 /
    &load torque_nm = 100 / &relief amount_um = 5 / &mesh model = 'iso6336' /
    &sweep rpm_first = 9000  rpm_last = 12000  rpm_step = 3000 /
    &deviations pinion_class = 6  gear_class = 6  draws = 2 /''')  # fmt: skip
AMOUNTS = [5, 10]
OTHERS = [name for name, one in CRITERIA.items() if one.is_as_built and name != 'dynamic_factor']


def judged(case, name, **options):
    return many.robust(case, judged=name, quantile=0.5, **{'relief': {'amount_um': AMOUNTS}} | options)


@pytest.fixture(scope='module')
def found():
    return {name: judged(CASE, name) for name in OTHERS}


@pytest.fixture(scope='module', params=AMOUNTS)
def perfect(request):
    """Which candidate, and a study of its gears without deviations, by the tasks of nominal gears."""
    none = {'pinion_class': None, 'gear_class': None, 'draws': None, 'pinion_runout_um': 0, 'pinion_runout_phase_deg': 0}
    case = CASE.changed(relief={'amount_um': request.param}, deviations=none)
    return AMOUNTS.index(request.param), gearsweep.run(case, ['mesh', 'sweep', 'as_built'])


@pytest.fixture(scope='module', params=AMOUNTS)
def first(request):
    """Which candidate, and a study of its first draw alone, which is followed over the turn."""
    return AMOUNTS.index(request.param), gearsweep.run(CASE.changed(relief={'amount_um': request.param}, deviations={'draws': None}))


def test_nominal_numbers_are_those_of_the_tasks_of_nominal_gears(found, perfect):
    """Peak-to-peak of the table transmission_error, largest of sweep, and the loads of a turn of gears that do not deviate."""
    at, study = perfect
    nominal = {name: float(one.table['nominal'][at]) for name, one in found.items()}
    assert nominal['static_transmission_error'] == pytest.approx(study.transmission_error.peak_to_peak_um[0], rel=1e-8)
    assert nominal['mesh_harmonic'] == pytest.approx(study.harmonics.amplitude_um[0, 1], rel=1e-8)
    assert nominal['dynamic_transmission_error'] == pytest.approx(study.sweep.dte_peak_to_peak_um.max(), rel=1e-9)
    loads = study.as_built_loads
    assert nominal['root_stress'] == pytest.approx(max(loads.pinion_root_stress_mpa.max(), loads.gear_root_stress_mpa.max()), rel=1e-12)


def test_numbers_as_built_are_those_of_the_turn(found, first):
    """Of the first draw. At rest the table as_built_turn has 50 samples of a mesh period, which miss little of the range."""
    at, study = first
    number = {name: float(one.factors[at, 0, 0, 0]) for name, one in found.items()}
    turn = study.as_built_turn
    sampled = np.ptp(turn.transmission_error_um[turn.rpm == 0])
    assert sampled * (1 - 1e-9) <= number['static_transmission_error'] <= sampled * 1.005
    x, tau = turn.transmission_error_um[turn.rpm == 0], turn.tau[turn.rpm == 0]
    wave = (x - x.mean()) * np.exp(-2j * np.pi * tau)
    sampled = abs(((wave[1:] + wave[:-1]) * np.diff(tau)).sum()) / np.ptp(tau)
    assert number['mesh_harmonic'] == pytest.approx(sampled, rel=0.02)
    assert number['dynamic_transmission_error'] == study.as_built.dte_peak_to_peak_um.max()
    loads = study.as_built_loads
    assert number['root_stress'] == max(loads.pinion_root_stress_mpa.max(), loads.gear_root_stress_mpa.max())


@pytest.mark.parametrize('name', OTHERS)
def test_the_finer_the_class_the_nearer_to_nominal(found, name):
    """Tolerances of ISO 1328-1 grow by the root of 2 a class, but for their rounding: those of class 1 are 0.18 of those of class 6. Parts of
    the errors that add up as squares are less still, so that half is a bound with room."""
    fine = judged(CASE.changed(deviations={'pinion_class': 1, 'gear_class': 1}), name)
    off = [np.abs(one.factors.values[..., 0, 0] - one.table['nominal'].values[:, None]).max() for one in (fine, found[name])]
    assert 0 < off[0] < off[1] / 2


def test_quick_gears_have_the_same_numbers():
    """At rest none is found quickly, and stress is that of a motion to the tolerance, at the same one speed."""
    case = CASE.changed(sweep={'rpm_last': 9000}, deviations={'draws': 3})
    for name in ('static_transmission_error', 'mesh_harmonic', 'root_stress'):
        exact, quick = (judged(case.changed(as_built={'quick': way}), name).factors.values for way in (False, True))
        np.testing.assert_allclose(quick, exact, rtol=1e-12)


@pytest.mark.parametrize(('name', 'words', 'label', 'digits'), [
    ('dynamic_transmission_error', 'Largest peak-to-peak dynamic transmission error over the speeds, um;', 'Largest peak-to-peak DTE (µm)', 3),
    ('static_transmission_error', 'Peak-to-peak static transmission error over the turn, um;', 'Peak-to-peak STE (µm)', 3),
    ('mesh_harmonic', 'Amplitude of the mesh frequency in the static transmission error, um;', 'Mesh harmonic of the STE (µm)', 3),
    ('root_stress', 'Largest root stress at the speed of the largest dynamic factor, MPa;', 'Largest root stress (MPa)', 1),
])  # fmt: skip
def test_report_and_picture_say_what_is_judged(found, name, words, label, digits):
    pyplot = pytest.importorskip('matplotlib.pyplot')
    one = found[name]
    said = str(one)
    assert said.startswith(words) and f': {float(one.best["value"]):.{digits}f} {CRITERIA[name].unit}\n' in said
    assert one.factors.attrs['units'] == CRITERIA[name].unit and one.table.attrs['judged'] == name
    figure = one.plot()
    assert figure.axes[0].get_ylabel() == label
    pyplot.close(figure)


def test_pinion_and_gear_are_varied_each_by_itself():
    """Four pairs of amounts, none like another; half of 10 um at both tips is 5 um at both."""
    fractions = {'amount_um': [10], 'pinion_fraction': [1, 0.5], 'gear_fraction': [1, 0.5]}
    one = judged(CASE, 'static_transmission_error', relief=fractions)
    assert len(set(one.table['nominal'].values)) == 4
    half = judged(CASE, 'static_transmission_error', relief={'amount_um': [5]})
    np.testing.assert_allclose(half.factors[0], one.factors[3], rtol=1e-12)


def test_another_quantity_in_the_same_store_is_refused(tmp_path):
    judged(CASE, 'dynamic_factor', relief={'amount_um': [5]}, store=tmp_path / 'x.zarr')
    with pytest.raises(Error, match=r'has the columns as_built_worst\.dynamic_factor; take asks for as_built\.dte_peak_to_peak_um'):
        judged(CASE, 'dynamic_transmission_error', relief={'amount_um': [5]}, store=tmp_path / 'x.zarr')


@pytest.mark.parametrize('name', ['stress', '', None, ['root_stress']])
def test_an_unknown_quantity_is_reported(name):
    with pytest.raises(Error, match=r'judged = .*: must be one of dynamic_factor, dynamic_transmission_error, static_transmission_error, mesh_harmonic, root_stress') as caught:
        judged(CASE, name)
    assert caught.value.code == Code.INPUT


def test_workers_can_take_what_is_made_of_a_study():
    for one in (one for one in CRITERIA.values() if one.is_as_built):
        assert pickle.loads(pickle.dumps(one.reduce)).keywords == one.reduce.keywords
