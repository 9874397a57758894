"""The numbers that people look at first: those of the tables, for each task, whatever a case lacks."""

import re

import numpy as np
import pytest
from conftest import GEARED, PARTIAL, PRESCRIBED, ROOT

import gearsweep
from gearsweep import Case
from gearsweep.core.names import TASKS
from gearsweep.report.headlines import headlines, shown


def by_name(study):
    return {one.name: one for one in headlines(study)}


def test_a_task_has_its_numbers():
    case = Case(GEARED).changed(mesh={'model': 'weber'}, rating={'rpm': [4000, 6000], 'contact_limit_mpa': 1400, 'root_limit_mpa': 700}, flank={'rpm': 4000})
    study = gearsweep.run(case, ('rating', 'flank', 'sweep', 'optimum'))
    told = by_name(study)
    best = study.rating.at(relief_um=study.sweep_summary.best_relief_um)
    assert told['Least safety'].value == f'S_H {shown(best.contact_safety.min())}, S_F {shown(best.root_safety.min())}'
    assert told['Least safety'].more.startswith(f'relief {study.sweep_summary.best_relief_um:g} µm; K_v by Method')
    assert by_name(gearsweep.run(case, 'rating'))['Least safety'].value == f'S_H {shown(study.rating.contact_safety.min())}, S_F {shown(study.rating.root_safety.min())}'
    assert by_name(gearsweep.run(case, 'rating'))['Least safety'].more.startswith('of all reliefs; K_v by Method')
    factors = study.dynamic_factors
    assert told['Largest K_v'].value == shown(max(factors.dynamic_factor_a.max(), factors.dynamic_factor_b.max()))
    assert told['Flash temperature'].value == f'{shown(study.flank_losses.largest_flash_k.max())} K'
    assert told['Efficiency'].value == f'{shown(100 * study.flank_losses.efficiency.min())} %'
    assert told['Best single amount'].value == f'{shown(study.optimum.relief_um)} µm'
    assert (told['Best single amount'].task, told['Best single amount'].picture) == ('optimum', 'optimum')


def test_gears_as_built_tell_the_relief_that_is_best_for_the_worst_of_them():
    case = Case(GEARED).changed(case={'tasks': 'as_built'}, mesh={'model': 'weber'}, gear={'teeth': 42}, deviations={'pinion_class': 6, 'draws': 3},
                                sweep={'rpm_first': 6000, 'rpm_last': 8000, 'rpm_step': 1000})  # fmt: skip
    study = gearsweep.run(case, 'as_built')
    worst = study.as_built_worst.dynamic_factor.reshape(2, 3).max(axis=1)
    best = by_name(study)['Largest dynamic factor as built']
    assert (best.task, best.picture, best.value) == ('as_built', 'as_built', shown(worst.min()))
    nominal = study.as_built_worst.nominal_factor[worst.argmin()].max()
    assert best.more.startswith(f'nominal {shown(nominal)}, relief {shown((0, 10)[worst.argmin()])} µm, at ')


def test_faces_have_their_load_factors():
    study = gearsweep.run(Case(GEARED).changed(case={'tasks': 'face_load'}, mesh={'model': 'fe'}, face={'misalignment_um': 15}))
    told, summary = by_name(study)['K_H_beta'], study.face_load_summary
    assert told.value == shown(summary.face_load_factor.max())
    assert told.more == f'at its worst phase {shown(summary.worst_face_load_factor.max())}, K_F_beta {shown(summary.root_face_load_factor.max())}'


def test_one_relief_is_not_the_best_of_a_list():
    told = by_name(gearsweep.run(Case(PRESCRIBED).changed(relief={'amount_um': 5}), 'sweep'))
    assert 'Best of the list' not in told and told['Largest dynamic factor'].more.startswith('at 12000 1/min')


@pytest.mark.filterwarnings('ignore::gearsweep.PartialWarning')
def test_points_without_an_answer_are_no_failure():
    assert headlines(gearsweep.run(Case(PARTIAL), ('sweep', 'hysteresis')))


@pytest.mark.filterwarnings('ignore::gearsweep.PartialWarning')
def test_motions_that_do_not_repeat_are_reported_with_what_was_seen(chaotic):
    told, summary = by_name(chaotic)['Motions that do not repeat'], chaotic.sweep_summary
    assert told.value == f'{(chaotic.sweep.status == "chaotic").sum()} chaotic of {chaotic.sweep.status.size} points'
    periods = chaotic.sweep.seen_periods[chaotic.sweep.seen_dynamic_factor == np.nanmax(chaotic.sweep.seen_dynamic_factor)]
    assert told.more == f'dynamic factor at least {shown(np.nanmax(chaotic.sweep.seen_dynamic_factor), 5)}, seen over {periods[0]} mesh periods'
    assert summary.seen_periods == periods[0]
    largest = np.nanmax([chaotic.sweep.dynamic_factor, chaotic.sweep.seen_dynamic_factor], axis=(0, 2))
    assert summary.best_relief_um == chaotic.sweep.relief_um[largest.argmin()]
    np.testing.assert_array_equal(chaotic.sweep_worst.seen_dynamic_factor, [summary.seen_dynamic_factor, np.nan])
    assert chaotic.sweep_worst.seen_rpm[0] == chaotic.sweep.rpm[np.nanargmax(chaotic.sweep.seen_dynamic_factor[0])]


def test_numbers_are_short():
    assert [shown(x) for x in (2, 0.123456, 1.5e-7, -3.14159, 123456.7, np.nan, 1e9)] == ['2', '0.1235', '1.500e−07', '−3.142', '123500', '–', '1.000e+09']


def test_tasks_are_grouped_as_on_the_first_page():
    text = (ROOT / 'README.md').read_text().split('## What it answers')[1].split('[doc/case.md]')[0]
    parts = {name: tuple(re.findall(r'`(\w+)`', words)) for name, words in re.findall(r'\*\*([A-Z][a-z ]+)\*\*: (.*?)(?=\*\*|$)', text, re.DOTALL)}
    assert parts == TASKS
    assert sorted(name for names in TASKS.values() for name in names) == sorted(task['name'] for task in gearsweep.core.library.declared()['tasks'])
