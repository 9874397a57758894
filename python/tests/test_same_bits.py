"""The same bits as the Fortran program: its tables, its answer, its messages and exit codes."""

import subprocess
import sys

import numpy as np
import pytest
from conftest import GEARED, PARTIAL, PRESCRIBED, ROOT

import gearsweep
from gearsweep import Case

TABLE = """&case tasks = 'mesh', 'sweep' / &pinion teeth = 25 effective_mass_kg = 0.8 / &gear effective_mass_kg = 0.9 /
&load normal_force_n = 6858 / &mesh model = 'table' contact_ratio = 1.6 file = 'pair.csv' /
&sweep rpm_first = 2000 rpm_last = 4000 rpm_step = 500 /
"""
PAIR = ''.join(f'{1.6 * i / 8:.15g}, {400 - 120 * (i / 4 - 1) ** 2:.15g}\n' for i in range(9))


def python_program(*words, cwd):
    return subprocess.run(
        [sys.executable, '-m', 'gearsweep', *words], cwd=cwd, capture_output=True, text=True, timeout=300
    )


def columns(path):
    """The columns of a table by name, as it writes them."""
    names, *rows = [line.split(',') for line in path.read_text().splitlines() if not line.startswith('#')]
    return dict(zip(names, map(list, zip(*rows))))


def digits(values):
    """Numbers as tables have them, with 15 digits."""
    return [f'{value:.14e}' for value in np.ravel(values)]


def same(column, values):
    assert [f'{float(text):.14e}' for text in column] == digits(values)


@pytest.fixture(scope='module')
def tables(program, tmp_path_factory):
    folder = tmp_path_factory.mktemp('tables')
    Case(GEARED).write(folder / 'case.nml')
    done = program('case.nml', cwd=folder)
    assert done.returncode == 0, done.stderr
    return lambda kind: columns(folder / f'results/case.{kind}.csv')


@pytest.fixture(scope='module')
def study():
    return gearsweep.run(Case(GEARED), threads=2)


def test_sweep(tables, study):
    table, sweep = tables('sweep'), study.sweep
    order = {'dynamic_factor': 'dynamic_factor', 'error_estimate': 'estimate', 'floquet_modulus': 'floquet_modulus',
             'residual': 'residual', 'steps': 'steps', 'mesh_periods': 'periods'}  # fmt: skip
    for column, name in order.items():
        same(table[column], getattr(sweep, name).T)
    same(table['rpm'], np.tile(sweep.rpm, 2))
    assert table['status'] == list(sweep.status_name.T.ravel())
    assert table['contact'] == list(sweep.contact_name.T.ravel())


def test_mesh(tables, study):
    table = tables('mesh')
    for column, name in zip(table, ('relief_um', 's', 'pair_n_um', 'mesh_n_um', 'error_um', 'share', 'ste_um')):
        same(table[column], getattr(study.mesh, name))


def test_harmonics(tables, study):
    table, ste = tables('harmonics'), study.harmonics
    same(table['amplitude_um'], np.vstack((ste.mean_um, ste.amplitude_um)).T)
    same(table['phase_deg'], np.vstack((0 * ste.mean_um, ste.phase_deg)).T)
    same(table['error_estimate_um'], np.repeat(ste.estimate_um, 1 + ste.harmonic.size))


def test_load(tables, study):
    table = tables('load')
    for name in ('relief_um', 'rpm', 's', 'pair_load_n', 'dte_um'):
        same(table[name], getattr(study.load, name))


def test_optimum(tables, study):
    table = tables('vcurve')
    for column, name in zip(table, ('relief_um', 'worst_factor', 'rpm', 'failed')):
        same(table[column], getattr(study.optimum, name))


def test_root(tables, study):
    table, static = tables('root'), study.static
    same(table['sigma_mpa'], static.sigma_mpa.transpose(2, 1, 0))
    for part, column in enumerate(('sigma_x_mpa', 'sigma_y_mpa', 'tau_xy_mpa')):
        same(table[column], static.parts_mpa[part].transpose(2, 1, 0))
    same(table['load_share'][::2], static.share.T)


def test_modes_and_outlines(tables, study):
    table = tables('modes')
    for column, name in zip(list(table)[1:], ('frequency_hz', 'estimate', 'residual', 'rim_share')):
        same(table[column], getattr(study.modal, name))
    table = tables('outline')
    both = np.vstack((study.geometry.pinion_outline_mm, study.geometry.gear_outline_mm))
    same(table['x_mm'], both[:, 0])
    same(table['y_mm'], both[:, 1])


@pytest.mark.parametrize(
    'text', [GEARED, PRESCRIBED, PARTIAL, TABLE, 'hassan'], ids=['geared', 'prescribed', 'partial', 'table', 'hassan']
)
def test_command_line(program, tmp_path, text):
    """Answer, messages, code, and every file byte for byte."""
    if text == 'hassan':
        text = (ROOT / 'data/hassan.nml').read_text().replace('elements_across = 24', 'elements_across = 6')
        (tmp_path / 'hassan2009.csv').write_bytes((ROOT / 'data/hassan2009.csv').read_bytes())
    (tmp_path / 'pair.csv').write_text(PAIR)
    Case(text).write(tmp_path / 'a.b.nml')
    (tmp_path / 'one').mkdir()
    (tmp_path / 'two').mkdir()
    theirs = program('../a.b.nml', '--verbose', cwd=tmp_path / 'one')
    ours = python_program('../a.b.nml', '--verbose', '--no-pictures', cwd=tmp_path / 'two')
    assert ours.returncode == theirs.returncode
    assert ours.stderr == theirs.stderr
    assert without_time(ours.stdout) == without_time(theirs.stdout)
    files = sorted(path.name for path in (tmp_path / 'one/results').iterdir())
    assert files and files == sorted(path.name for path in (tmp_path / 'two/results').iterdir())
    for name in files:
        assert (tmp_path / 'one/results' / name).read_bytes() == (tmp_path / 'two/results' / name).read_bytes()


def without_time(text):
    return [line for line in text.splitlines() if not line.startswith('Time ')]


@pytest.mark.parametrize(
    'words',
    [['--version'], [], ['a.nml', '--quiet'], ['none.nml'], ['.'], ['bad.nml'], ['lost.nml'], ['a.nml', 'b.nml'],
     ['--colour'], ['a.nml', '--threads'], ['a.nml', '--threads', '0'], ['a.nml', '--threads', 'x'],
     ['a.nml', '--threads', '1025'], ['a.nml', '--out'], ['a.nml', '--out', ''], [''], ['a.nml', '--out', 'no/folder'],
     ['a.nml', '--out', 'a.nml'], ['bad.nml', '--out', 'fresh'], ['lost.nml', '--out', 'fresh'],
     ['a.nml', '--out', 'blocked']],
    ids=' '.join,
)  # fmt: skip
def test_command_line_refusals(program, tmp_path, words):
    results = []
    for folder, command in (('one', program), ('two', python_program)):
        (tmp_path / folder / 'blocked/a.sweep.csv').mkdir(parents=True)
        Case(PARTIAL).write(tmp_path / folder / 'a.nml')
        (tmp_path / folder / 'bad.nml').write_text('&pair modul_mm = 3 /')
        (tmp_path / folder / 'lost.nml').write_text(TABLE)
        plain = ['--no-pictures'] if command is python_program and words else []
        done = command(*plain, *words, cwd=tmp_path / folder)
        files = sorted(str(path.relative_to(tmp_path / folder)) for path in (tmp_path / folder).rglob('*'))
        results.append((done.returncode, done.stderr, without_time(done.stdout), files))
    assert results[0] == results[1]


def test_report_is_the_answer(program, tmp_path):
    Case(GEARED).write(tmp_path / 'case.nml')
    lines = program('case.nml', cwd=tmp_path).stdout.splitlines()
    assert (
        gearsweep.report(Case(GEARED)).splitlines()
        == lines[1 : next(i for i, line in enumerate(lines) if line.startswith('Time'))]
    )


def test_files_lie_beside_the_case(tmp_path, monkeypatch):
    """Whatever the current folder, and without changing it."""
    (tmp_path / 'pair.csv').write_text(PAIR)
    Case(TABLE).write(tmp_path / 'case.nml')
    here = tmp_path / 'elsewhere'
    here.mkdir()
    monkeypatch.chdir(here)
    sweep = gearsweep.sweep(Case.read('../case.nml'))
    expected = gearsweep.sweep(
        Case(
            TABLE.replace("model = 'table'", "model = 'polynomial' coefficients = 400, 0, -120").replace(
                "file = 'pair.csv'", ''
            )
        )
    )
    np.testing.assert_allclose(sweep.dynamic_factor, expected.dynamic_factor, rtol=1e-5)
    with pytest.raises(gearsweep.Error, match='cannot read pair.csv') as caught:
        gearsweep.sweep(Case(TABLE))
    assert caught.value.code == gearsweep.Code.FILE


def test_complete_case_gives_the_same_bits():
    for text in (GEARED, PRESCRIBED):
        case = Case(text)
        one, two = gearsweep.run(case), gearsweep.run(case.complete())
        for name in ('mesh', 'static', 'modal', 'load', 'sweep', 'optimum'):
            a, b = getattr(one, name), getattr(two, name)
            assert (a is None) == (b is None)
            for field in a.units if a else ():
                assert np.array(getattr(a, field)).tobytes() == np.array(getattr(b, field)).tobytes(), (name, field)
