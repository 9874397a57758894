"""What a newcomer sees: names, reprs, notebooks."""

import re
import subprocess
import sys

import numpy as np
import pytest
from conftest import GEARED, PARTIAL, ROOT

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
    assert {'core', 'library', 'report', 'importlib'}.isdisjoint(shown)


def test_dir_loads_no_matplotlib():
    program = "import sys, gearsweep; dir(gearsweep); print('matplotlib' in sys.modules)"
    done = subprocess.run([sys.executable, '-c', program], capture_output=True, text=True, check=True)
    assert done.stdout == 'False\n'
    with pytest.raises(AttributeError, match="no attribute 'plot_swep'"):
        _ = gearsweep.plot_swep


def test_errors_are_named_as_people_write_them():
    assert gearsweep.Error.__module__ == gearsweep.PartialWarning.__module__ == 'gearsweep'


def test_completion_offers_tables_and_columns(study):
    assert set(study.tables) < set(dir(study)) and {'report', 'write', 'save', 'log'} < set(dir(study))
    assert set(study.sweep) < set(dir(study.sweep)) and {'units', 'dims', 'at', 'to_pandas'} < set(dir(study.sweep))
    assert not [name for name in (*dir(study), *dir(study.sweep)) if name.startswith('_')]


def test_a_study_says_its_answer(study):
    """Its single numbers, here those of the optimum, and how much there is of the others."""
    optimum = study.optimum
    assert repr(study).splitlines()[0] == '<gearsweep.Study of a <small> pair'
    line = next(line for line in repr(study).splitlines() if line.startswith('  optimum:'))
    assert f'relief_um {optimum.relief_um:.6g}, worst_dynamic_factor {optimum.worst_dynamic_factor:.6g}' in line
    assert re.search(r'^  sweep: +2 relief_um, 13 rpm$', repr(study), re.MULTILINE)
    assert len(repr(study).splitlines()) == 1 + len(study.tables)


def test_a_table_says_its_answer(study):
    """A line for each column: size, unit, least and largest value or the words, meaning."""
    factor = study.sweep.dynamic_factor
    shown = [re.split(' {2,}', line.strip().rstrip('>')) for line in repr(study.sweep).splitlines()]
    assert shown[0] == ['<gearsweep.Table sweep: ' + study.sweep.meaning]
    assert shown[2][:3] == ['rpm (13)', '1/min', '3000 to 9000']
    assert shown[3] == ['dynamic_factor', f'{factor.min():.6g} to {factor.max():.6g}', study.sweep.meanings['dynamic_factor']]
    assert shown[5][:2] == ['status', '26 ok']
    assert shown[1][:3] == ['relief_um (2)', 'um', '0, 10']


def test_every_table_has_its_columns_in_a_notebook(study):
    for table in study:
        assert len(repr(table).splitlines()) == 1 + len(list(table))
        assert re.fullmatch(r'<table>.*</table>', table._repr_html_()) and table._repr_html_().count('<tr>') == 1 + len(list(table))


def test_a_notebook_shows_no_foreign_markup(study):
    shown = study._repr_html_()
    assert 'a &lt;small&gt; pair' in shown and '<small>' not in shown


def test_points_without_an_answer_are_reported():
    with pytest.warns(gearsweep.PartialWarning):
        sweep = gearsweep.run(Case(PARTIAL), 'sweep').sweep
    missing = int(np.isnan(sweep.dynamic_factor).sum())
    assert missing and f', {missing} without  ' in repr(sweep) and f'{missing} unresolved' in repr(sweep)


def test_case_shows_its_text():
    """Twenty lines, as they stand in the file."""
    text = '&pair module_mm = 3\n  face_width_mm = 20 /'
    assert repr(gearsweep.Case(text)) == 'Case:\n' + text
    assert repr(gearsweep.Case(text, '/gears')).splitlines()[0] == 'Case with files of /gears:'
    long = repr(gearsweep.Case('\n'.join(f'! {line}' for line in range(1, 31)))).splitlines()
    assert long[20] == '! 20' and long[21:] == ['... (10 more lines)']


@pytest.mark.parametrize('package', ['pandas', 'xarray'])
def test_optional_package_is_named(study, package, monkeypatch):
    """What is not installed is asked for by the name of the extra that has it."""
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(ModuleNotFoundError, match=rf"^{package} is not installed: pip install 'gearsweep\[tables\]' has it$"):
        getattr(study.sweep, f'to_{package}')()


def test_rating_shows_a_status():
    """A motion that is not known to the accuracy asked for is marked on the screen, in its row of dynamic factors."""
    case = gearsweep.Case.read(ROOT / 'examples/first.nml').changed(
        case={'tasks': 'rating'}, rating={'rpm': [9000, 6000]}, numerics={'steps_per_period': 20}, sweep=dict.fromkeys(('rpm_first', 'rpm_last', 'rpm_step'))
    )
    study = gearsweep.run(case)
    shown = [line for line in study.report().splitlines() if line.strip().endswith('inexact')]
    assert len(shown) == (study.dynamic_factors.status == 'inexact').sum() > 0
