"""Texts of the user, in whatever bytes and with whatever letters: decoded once, and shown as they are on the screen, in tables, reports and pictures."""

import html
import io
import os
import pathlib
import subprocess
import sys
import zipfile

import pytest

import gearsweep
from gearsweep import Case, Error
from gearsweep.core.texts import decoded, escaped, visible
from gearsweep.panel.files import archive
from gearsweep.report.page import drawings, page

SMALL = """&case tasks = 'mesh' title = 'TITLE' /
&pinion teeth = 25 effective_mass_kg = 0.8 / &gear effective_mass_kg = 0.9 / &load normal_force_n = 3000 /
&mesh model = 'polynomial' contact_ratio = 1.6 coefficients = 300, 0, -50 /
"""
TITLES = ['Zahnr\u00e4der', r'\\server\c$\gears\d$', '$x$ and $$ and \\$', 'a_{b}^c % {} %s', '<b>&amp; "x"', '\u6b6f\u8eca \u2603', 'a\u200bb\u00a0c\u202ed', '$']  # fmt: skip


def test_bytes_are_decoded_once():
    assert decoded('Zähne −'.encode(), 'x') == 'Zähne −'
    assert decoded(b'Z\xe4hne \xe2\x88\x92 \xe2', 'x') == 'Zähne − â'
    for encoding in ('utf-16', 'utf-16-le', 'utf-16-be'):
        with pytest.raises(Error, match='x: the text is in UTF-16; save it in UTF-8'):
            decoded('&case /'.encode(encoding), 'x')


def test_what_cannot_be_seen_is_named():
    assert visible('a\x1b[31m\nb\u200b\udce4') == 'a<U+001B>[31m<U+000A>b<U+200B>ä'
    assert escaped('$a$') == r'\$a\$'


@pytest.mark.parametrize('title', TITLES)
@pytest.mark.parametrize('encoding', ['utf-8', 'latin-1'])
def test_titles(tmp_path, title, encoding):
    """Through a file into the screen, the tables, the report, the panel's files and all formats of pictures."""
    pytest.importorskip('matplotlib')
    from gearsweep.plots import draw_all, figures

    try:
        data = SMALL.replace('TITLE', title).encode(encoding)
    except UnicodeEncodeError:
        pytest.skip('not of this encoding')
    (tmp_path / 'a.nml').write_bytes(data)
    case = Case.read(tmp_path / 'a.nml')
    study = gearsweep.run(case)
    assert case.get('case', 'title') == title
    assert study.report().splitlines()[0] == title and title in str(study)
    study.report().encode()
    for path in study.write(tmp_path / 'out', 'a'):
        if path.endswith('.csv'):
            assert title in pathlib.Path(path).read_text('utf-8').split('# case:')[1]
    assert html.escape(title) in page(study, drawings(study, 'svg'))
    for path in draw_all(study, tmp_path / 'pictures', 'a$b$', ('png', 'svg', 'pdf')):
        assert os.path.getsize(path) > 1000
    for _, figure in figures(study):
        assert figure._suptitle.get_text().replace('\n', ' ') == escaped(title)
    with zipfile.ZipFile(io.BytesIO(archive(study, 'a'))) as file:
        assert title in file.read('a/a.txt').decode()


@pytest.mark.parametrize('name', ['a$b$c_^.nml', 'Zahnr\u00e4der.nml', 'a{}%s.nml'])
def test_names_of_files_are_drawn_as_they_are(tmp_path, name):
    (tmp_path / name).write_text(SMALL.replace("title = 'TITLE'", ''), 'utf-8')
    for encoding in ('utf-8', 'ascii'):  # of the terminal
        done = subprocess.run([sys.executable, '-m', 'gearsweep', name, '--report', 'r.html'], cwd=tmp_path, capture_output=True,
                              env=os.environ | {'PYTHONIOENCODING': encoding}, check=False)  # fmt: skip
        assert (done.returncode, done.stderr) == (0, b'')


def test_labels_of_studies_are_drawn_as_they_are():
    pytest.importorskip('matplotlib')
    from gearsweep.plots import compare

    study = gearsweep.run(Case(SMALL))
    ax = compare({r'c$\gears\d$': study}, 'mesh', 'ste_um', relief_um=0)
    ax.figure.savefig(io.BytesIO())


def test_no_group_is_none():
    with pytest.raises(TypeError, match='relief: must be a dictionary of keys, not NoneType; None removes a key'):
        Case(SMALL).changed(relief=None)


def test_cautions_are_on_the_page():
    case = Case(SMALL).changed(mesh={'coefficients': 3e5})
    assert '&amp;mesh coefficients: 300000 is unusual' in page(gearsweep.run(case), {}).split('<h2>Warnings</h2>')[1][:400]
