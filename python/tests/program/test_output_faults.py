"""Full disks, links, names and full standard output: old files stay, and nothing ends without a word."""

import json
import os
import re
import stat
import subprocess
import sys
import threading
import time

import numpy as np
import pytest
from conftest import GEARED, PRESCRIBED

import gearsweep
from gearsweep import Case, Code, Error, plots
from gearsweep.core.assignments import assignments

# Files may have 1 kB, as if the disk were full then; Python leaves out the signal that would end the process.
LIMITED = """
import resource
import gearsweep
def limited(write):
    resource.setrlimit(resource.RLIMIT_FSIZE, (1024, resource.RLIM_INFINITY))
    try:
        write()
    except gearsweep.Error as error:
        print(error.code.name, error)
    resource.setrlimit(resource.RLIMIT_FSIZE, (resource.RLIM_INFINITY, resource.RLIM_INFINITY))
"""


def said(script, folder):
    """What a script prints that runs in this folder."""
    done = subprocess.run([sys.executable, '-c', LIMITED + script], cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.parametrize(
    ('name', 'write'),
    [
        ('x.npz', 'study.save("x.npz")'),
        ('x.nml', 'gearsweep.Case(case.text + "! " + 2000*"x").write("x.nml")'),
        ('x.png', 'gearsweep.plots.save(gearsweep.plot_geometry(study).figure, "x.png", "png")'),
    ],
)
def test_full_disk(tmp_path, name, write):
    (tmp_path / name).write_text('old')
    script = f'import gearsweep.plots\ncase = gearsweep.Case({GEARED!r})\nstudy = gearsweep.run(case)\nlimited(lambda: {write})\n'
    assert said(script, tmp_path) == f'FILE cannot write {name}: File too large\n'
    assert os.listdir(tmp_path) == [name] and (tmp_path / name).read_text() == 'old'


def write_picture(study, path):
    plots.save(plots.plot_ste(study).figure, path, 'svg')


WRITES = {
    'case': lambda study, path: study.case.write(path),
    'study': lambda study, path: study.save(path),
    'page': lambda study, path: study.write_report(path),
    'picture': write_picture,
}


@pytest.fixture(scope='module')
def small():
    return gearsweep.run(Case(GEARED).changed(mesh={'model': 'weber'}), 'mesh')


@pytest.mark.parametrize('write', WRITES.values(), ids=WRITES)
def test_what_is_no_regular_file_is_written_into(small, tmp_path, write):
    """A link keeps leading to its target, which gets the content; a pipe and a device remain what they are."""
    write(small, tmp_path / 'plain')
    content = (tmp_path / 'plain').read_bytes()
    (tmp_path / 'deep').mkdir()
    for target, link in ((tmp_path / 'deep/old', 'link'), (tmp_path / 'deep/new', 'dangling'), ('deep/old', 'relative'), ('link', 'chain')):
        (tmp_path / 'deep/old').write_text('old')
        (tmp_path / link).symlink_to(target)
        write(small, tmp_path / link)
        assert (tmp_path / link).is_symlink() and (tmp_path / link).read_bytes() == content
    assert sorted(os.listdir(tmp_path / 'deep')) == ['new', 'old']

    pipe, came = tmp_path / 'pipe', []
    os.mkfifo(pipe)
    reader = threading.Thread(target=lambda: came.append(pipe.read_bytes()), daemon=True)
    reader.start()
    write(small, pipe)
    reader.join(60)
    assert came == [content] and pipe.is_fifo()

    (tmp_path / 'around').symlink_to('around')
    for path, why in ((tmp_path / 'around', 'Too many levels of symbolic links'), (tmp_path / 'deep', 'Is a directory')):
        with pytest.raises(Error, match=f'cannot write .*: {why}'):
            write(small, path)


def test_a_device_remains_a_device(small, tmp_path):
    """Two of our own: what swallows everything, and what is always full."""
    try:
        for name, minor in (('null', 3), ('full', 7)):
            os.mknod(tmp_path / name, 0o666 | stat.S_IFCHR, os.makedev(1, minor))
            open(tmp_path / name, 'rb').close()
    except PermissionError:
        pytest.skip('only root makes devices, and not everywhere')
    small.save(tmp_path / 'null')
    with pytest.raises(Error, match=r'cannot write .*full: No space left on device'):
        small.save(tmp_path / 'full')
    assert (tmp_path / 'null').is_char_device() and (tmp_path / 'full').is_char_device() and len(os.listdir(tmp_path)) == 2


def test_a_case_can_be_written_to_the_standard_output(tmp_path):
    script = f"import gearsweep; gearsweep.Case({GEARED!r}).write('/dev/stdout')"
    assert said(script, tmp_path) == GEARED


def test_tables_on_a_full_disk(tmp_path):
    study = gearsweep.run(Case(PRESCRIBED))
    first = study.write(tmp_path / 'kept', 'q')
    assert [os.path.basename(path) for path in first] == [f'q.{name}.csv' for name in study.tables]
    script = f'study = gearsweep.run(gearsweep.Case({PRESCRIBED!r}))\nstudy.write("out", "q")\nlimited(lambda: study.write("out", "q"))\n'
    assert re.fullmatch(r'FILE cannot write out/q\.\w+\.csv: File too large\n', said(script, tmp_path))
    assert sorted(os.listdir(tmp_path / 'out')) == sorted(os.listdir(tmp_path / 'kept'))
    for table in os.listdir(tmp_path / 'out'):
        assert (tmp_path / 'out' / table).read_bytes() == (tmp_path / 'kept' / table).read_bytes()


def test_temporary_names(tmp_path):
    """Links under names that a temporary file could have are not followed; of the file itself, what the link leads to is replaced."""
    (tmp_path / 'victim').write_text('mine')
    (tmp_path / 'x.npz.part').symlink_to(tmp_path / 'victim')
    (tmp_path / 'x.nml').symlink_to(tmp_path / 'case')
    study = gearsweep.run(Case(GEARED), 'geometry')
    study.save(tmp_path / 'x.npz')
    Case(GEARED).write(tmp_path / 'x.nml')
    assert (tmp_path / 'victim').read_text() == 'mine'
    assert gearsweep.read(tmp_path / 'x.npz').geometry.centre_distance_mm == study.geometry.centre_distance_mm
    assert Case.read(tmp_path / 'x.nml').text == GEARED
    assert (tmp_path / 'x.nml').is_symlink() and (tmp_path / 'case').read_text() == GEARED
    assert sorted(os.listdir(tmp_path)) == ['case', 'victim', 'x.nml', 'x.npz', 'x.npz.part']
    umask = os.umask(0)
    os.umask(umask)
    assert os.stat(tmp_path / 'x.npz').st_mode & 0o777 == 0o666 & ~umask


@pytest.mark.parametrize('name', ['', ' ', '.', '..', '../x', 'a/b', '/x', 'a\nb', 'a\x1bb', 'a\x9bb', 'a\x85'])
def test_names(tmp_path, name):
    study = gearsweep.run(Case(PRESCRIBED), 'mesh')
    with pytest.raises(Error, match='name') as caught:
        study.write(tmp_path / 'out', name)
    assert caught.value.code == Code.INPUT
    assert os.listdir(tmp_path) == []


def test_control_characters():
    for control in '\x1b\x07\x00\x7f\x80\x9b':
        with pytest.raises(Error, match='NUL' if control == '\0' else f'control character .code {ord(control)}.'):
            gearsweep.run(Case(PRESCRIBED + f'! {control}'))
    with pytest.raises(Error, match=r'control character .code 155.'):
        gearsweep.run(Case(PRESCRIBED + '! \udc9b'))


def test_values_of_a_case_are_a_list_at_most():
    ring = [1.0]
    ring.append(ring)
    for value in (np.ones((2, 2)), [[1, 2], [3, 4]], ring, [np.ones(2)], [range(3)]):
        with pytest.raises(TypeError, match='a case has no values such as'):
            Case(PRESCRIBED).changed(relief={'amount_um': value})
    assert Case(PRESCRIBED).changed(relief={'amount_um': np.array([0, 5])}).get('relief', 'amount_um') == (0, 5)


@pytest.mark.parametrize('wrong', [{'texts': None}, {'texts': {'report': None, 'log': None}}, {'folder': None}, {'text': 5}])
def test_a_file_whose_texts_are_none(tmp_path, wrong):
    gearsweep.run(Case(PRESCRIBED), 'mesh').save(tmp_path / 'x.npz')
    with np.load(tmp_path / 'x.npz') as file:
        arrays = dict(file)
    about = json.loads(arrays.pop('about').tobytes()) | wrong
    np.savez(tmp_path / 'x.npz', about=np.frombuffer(json.dumps(about).encode(), np.uint8), **arrays)
    with pytest.raises(Error, match='is no result of gearsweep'):
        gearsweep.read(tmp_path / 'x.npz')


def test_what_a_text_gives_is_found_in_linear_time():
    """By seconds of this process, whatever else the machine does; where each word took as long as all before it, 35 s."""
    speeds = ', '.join(str(1000 + i / 2) for i in range(100_000))
    for text, wanted in ((f'&poincare rpm = {speeds} /', speeds), ('&poincare rpm = ' + 100_000 * '"\'', None)):
        began = time.process_time()
        found = assignments(text)
        assert time.process_time() - began < 5
        assert wanted is None or found == {'poincare': {'rpm': wanted}}


def test_endless_and_long_cases(tmp_path):
    with pytest.raises(Error, match='is longer than 10 MB'):
        Case.read('/dev/zero')
    with open(tmp_path / 'x.nml', 'wb') as file:
        file.truncate(3_000_000_000)
    with pytest.raises(Error, match='is longer than 10 MB'):
        Case.read(tmp_path / 'x.nml')


PROGRAM = [sys.executable, '-m', 'gearsweep']


@pytest.mark.parametrize('words', [['--help'], ['--version'], ['q.nml', '--no-pictures']])
def test_standard_output(tmp_path, words):
    (tmp_path / 'q.nml').write_text(PRESCRIBED)

    def run(command):
        return subprocess.run(['sh', '-c', command, 'sh', *PROGRAM, *words], cwd=tmp_path, capture_output=True, text=True, check=False)

    for command, reason in (('"$@" >/dev/full', 'No space left on device'), ('"$@" >&-', 'Bad file descriptor')):
        done = run(command)
        assert (done.returncode, done.stderr) == (3, f'gearsweep: cannot write to the standard output: {reason}\n')
    done = run('{ "$@"; echo $? >ended; } | true')
    assert done.stderr == '' and (tmp_path / 'ended').read_text() == '0\n'
    if words[0] == 'q.nml':
        assert (tmp_path / 'results' / 'q.sweep.csv').exists()


def test_title_in_latin_1(tmp_path):
    (tmp_path / 'q.nml').write_bytes(b"&case title = 'Gr\xf6\xdfe' tasks = 'mesh' /" + PRESCRIBED.split('/', 1)[1].encode())
    words = [*PROGRAM, 'q.nml', '--no-pictures']
    done = subprocess.run(words, cwd=tmp_path, capture_output=True, env=os.environ | {'PYTHONUTF8': '1'}, check=False)
    assert done.returncode == 0 and 'Größe' in done.stdout.decode()
