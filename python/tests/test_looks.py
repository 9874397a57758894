"""What a newcomer sees: names, reprs, notebooks."""

import dataclasses
import re
import subprocess
import sys

import numpy as np
import pytest
from conftest import GEARED, PARTIAL, PRESCRIBED

import gearsweep
from gearsweep import Case


@pytest.fixture(scope='module')
def study():
    return gearsweep.run(Case(GEARED).changed(case={'title': 'a <small> pair'}))


def test_dir_shows_what_people_use_and_nothing_else():
    shown = dir(gearsweep)
    assert set(gearsweep.__all__) < set(shown)
    for name in set(shown) - {'__version__', 'plots'}:
        thing = getattr(gearsweep, name)
        assert callable(thing) and thing.__doc__, name
    assert {name for name in shown if name.startswith('plot_')} == {
        name for name in gearsweep.plots.__all__ if name.startswith('plot_')
    }
    # No module of ours, nothing imported for our own use.
    assert {'case', 'results', 'tasks', 'maps', 'store', 'importlib', '_border'}.isdisjoint(shown)


def test_dir_loads_no_matplotlib():
    program = "import sys, gearsweep; dir(gearsweep); print('matplotlib' in sys.modules)"
    done = subprocess.run([sys.executable, '-c', program], capture_output=True, text=True, check=True)
    assert done.stdout == 'False\n'
    with pytest.raises(AttributeError, match="no attribute 'plot_swep'"):
        _ = gearsweep.plot_swep


def test_errors_are_named_as_people_write_them():
    assert gearsweep.Error.__module__ == gearsweep.PartialWarning.__module__ == 'gearsweep'


def test_a_sweep_says_its_answer(study):
    """Best relief, its worst dynamic factor and the resonances, here found without the library's help."""
    sweep = study.sweep
    worst = sweep.dynamic_factor.max(axis=0)
    best = worst.argmin()
    at = sweep.rpm[sweep.dynamic_factor[:, best].argmax()]
    said = f'best relief {sweep.relief_um[best]:g} um: worst DF {worst[best]:.4f} at {at:g} rpm'
    assert said in repr(sweep) and '13 rpm, 2 relief_um' in repr(sweep)
    rpm, _ = sweep.resonances()
    if len(rpm):
        assert f'resonances {", ".join(f"{one:.0f}" for one in rpm)} rpm' in repr(sweep)
    assert said in repr(study)


def test_an_optimum_says_its_answer(study):
    optimum = study.optimum
    i = np.nanargmin(optimum.worst_factor)
    assert f'best relief {optimum.relief_um[i]:.4g} um' in repr(optimum)
    assert f'worst DF {optimum.worst_factor[i]:.4f} at {optimum.rpm[i]:g} rpm' in repr(optimum)


def test_every_result_has_one_line_and_a_table(study):
    for name in study.tasks:
        part = getattr(study, name)
        assert '\n' not in repr(part) and repr(part).startswith(f'<gearsweep.{type(part).__name__}: ')
        assert re.fullmatch(r'<table>.*</table>', part._repr_html_())
    assert len(repr(study).splitlines()) == 1 + len(study.tasks)
    assert set(study.tasks) == {f.name for f in dataclasses.fields(study)} - {'case', 'version'}


def test_a_notebook_shows_no_foreign_markup(study):
    shown = study._repr_html_()
    assert 'a &lt;small&gt; pair' in shown and '<small>' not in shown


def test_points_without_an_answer_are_told():
    with pytest.warns(gearsweep.PartialWarning):
        sweep = gearsweep.sweep(Case(PARTIAL))
    missing = int(np.isnan(sweep.dynamic_factor).sum())
    assert f'without an answer {missing} of 7 points' in repr(sweep)
    with pytest.warns(gearsweep.PartialWarning):
        none = gearsweep.sweep(Case(PARTIAL).changed(sweep={'rpm_last': 1}))
    assert 'without an answer 1 of 1 points' in repr(none) and 'DF' not in repr(none)


def test_maps_say_their_answers():
    case = Case(PRESCRIBED).changed(dynamics={'damping_ratio': 0.02}, relief={'amount_um': 0})
    assert 'changes' in repr(gearsweep.hysteresis(case.changed(sweep={'rpm_first': 12000, 'rpm_step': 500})))
    assert 'unstable' in repr(gearsweep.stability_map(case))
