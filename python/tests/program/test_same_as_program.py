"""As the Fortran program: its answer, its files, its messages and exit codes. That the numbers have the same bits is told by
test/cases/test_callers.sh."""

import subprocess
import sys

import numpy as np
import pytest
from conftest import GEARED, PARTIAL, PRESCRIBED, ROOT, bits

import gearsweep
from gearsweep import Case

TABLE = """&case tasks = 'mesh', 'sweep' / &pinion teeth = 25 effective_mass_kg = 0.8 / &gear effective_mass_kg = 0.9 /
&load normal_force_n = 6858 / &mesh model = 'table' contact_ratio = 1.6 file = 'pair.csv' /
&sweep rpm_first = 2000 rpm_last = 4000 rpm_step = 500 /
"""
PAIR = ''.join(f'{1.6 * i / 8:.15g}, {400 - 120 * (i / 4 - 1) ** 2:.15g}\n' for i in range(9))


def python_program(*words, cwd):
    return subprocess.run(
        [sys.executable, '-m', 'gearsweep', *words], cwd=cwd, capture_output=True, text=True, timeout=300, check=False
    )


def columns(path):
    """The columns of a table by name, as it writes them."""
    names, *rows = [line.split(',') for line in path.read_text().splitlines() if not line.startswith('#')]
    return dict(zip(names, map(list, zip(*rows))))


@pytest.mark.filterwarnings('ignore::gearsweep.PartialWarning')
@pytest.mark.parametrize('text', [GEARED, PRESCRIBED, PARTIAL], ids=['geared', 'prescribed', 'partial'])
def test_every_table_is_that_of_the_program(program, tmp_path, text):
    """Word by word, and each number to the 15 digits that a file has."""
    Case(text).write(tmp_path / 'q.nml')
    program('q.nml', cwd=tmp_path)
    study = gearsweep.run(Case(text))
    written = {path.name.split('.')[1] for path in (tmp_path / 'results').glob('*.csv')}
    assert written == {table.name for table in study if not table.grid}
    for name in written:
        for column, theirs in columns(tmp_path / f'results/q.{name}.csv').items():
            ours = study[name].to_pandas()[column]
            if not np.issubdtype(np.asarray(ours).dtype, np.number):
                assert list(ours) == theirs
            else:
                np.testing.assert_array_equal([float(f'{number:.14e}') for number in ours], list(map(float, theirs)))


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


@pytest.mark.parametrize('text', [GEARED, PRESCRIBED, PARTIAL], ids=['geared', 'prescribed', 'partial'])
@pytest.mark.filterwarnings('ignore::gearsweep.PartialWarning')
def test_all_at_once_gives_what_each_task_gives(text):
    """To the last bit. Loads are compared elsewhere: beside a sweep they are those of its motions."""
    case = Case(text)
    whole = bits(gearsweep.run(case))
    for task in set(case.tasks) - {'load'}:
        alone = gearsweep.run(case, task)
        for name, values in bits(alone).items():
            assert whole[name] == values, name


def test_pictures_compute_nothing_again(tmp_path, monkeypatch):
    """What the answer, the tables and the pictures show is computed in one call."""
    from gearsweep import __main__
    from gearsweep.core import library

    called = []

    class Flat:
        def __getattr__(self, name):
            called.append(name)
            return getattr(flat, name)

    flat = library._flat
    monkeypatch.setattr(library, '_flat', Flat())
    Case(GEARED).write(tmp_path / 'case.nml')
    assert __main__.main([str(tmp_path / 'case.nml'), '--quiet', '--out', str(tmp_path)]) == 0
    assert (tmp_path / 'case.sweep.csv').exists() and (tmp_path / 'case.sweep.png').exists()
    assert called.count('gs_run') == called.count('gs_write') == 1
    assert set(called) <= {'gs_edit', 'gs_run', 'gs_text', 'gs_size', 'gs_column', 'gs_words', 'gs_write', 'gs_free'}


def test_report_is_the_answer(program, tmp_path):
    Case(GEARED).write(tmp_path / 'case.nml')
    lines = program('case.nml', cwd=tmp_path).stdout.splitlines()
    end = next(i for i, line in enumerate(lines) if line.startswith('Time'))
    assert gearsweep.run(Case(GEARED)).report().splitlines() == lines[1:end]


def test_written_files_are_those_of_the_program(program, tmp_path):
    Case(GEARED).write(tmp_path / 'pair.nml')
    program('pair.nml', cwd=tmp_path)
    written = gearsweep.run(Case(GEARED)).write(tmp_path / 'ours', 'pair')
    theirs = {path.name: path.read_bytes() for path in (tmp_path / 'results').iterdir()}
    assert {path.name: path.read_bytes() for path in (tmp_path / 'ours').iterdir()} == theirs
    assert written == [str(tmp_path / 'ours' / name) for name in written_names(written)] and len(written) == len(theirs)


def written_names(paths):
    return [path.rpartition('/')[2] for path in paths]


def test_files_lie_beside_the_case(tmp_path, monkeypatch):
    """Whatever the current folder, and without changing it."""
    (tmp_path / 'pair.csv').write_text(PAIR)
    Case(TABLE).write(tmp_path / 'case.nml')
    here = tmp_path / 'elsewhere'
    here.mkdir()
    monkeypatch.chdir(here)
    sweep = gearsweep.run(Case.read('../case.nml'), 'sweep').sweep
    text = TABLE.replace("model = 'table'", "model = 'polynomial' coefficients = 400, 0, -120").replace("file = 'pair.csv'", '')
    expected = gearsweep.run(Case(text), 'sweep').sweep
    np.testing.assert_allclose(sweep.dynamic_factor, expected.dynamic_factor, rtol=1e-5)
    with pytest.raises(gearsweep.Error, match=r'cannot read pair.csv') as caught:
        gearsweep.run(Case(TABLE))
    assert caught.value.code == gearsweep.Code.FILE


def test_complete_case_gives_the_same_bits():
    for text in (GEARED, PRESCRIBED):
        case = Case(text)
        assert bits(gearsweep.run(case)) == bits(gearsweep.run(case.complete()))
