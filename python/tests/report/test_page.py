"""The report in one file of HTML, read back by a parser that knows nothing of how it was made."""

import math
import re
import sys
from html.parser import HTMLParser

import numpy as np
import pytest
from conftest import GEARED, PARTIAL, PRESCRIBED

import gearsweep
from gearsweep import Case, Code, Error, plots
from gearsweep.__main__ import main

RATED = Case(GEARED).changed(
    case={'title': '<script>alert(1)</script> & co', 'tasks': ['rating', 'mesh', 'geometry']}, mesh={'model': 'weber'},
    rating={'rpm': [4000, 6000, 7000], 'contact_limit_mpa': [1400, 1300], 'root_limit_mpa': 700}, modal={'modes': None},
)  # fmt: skip
EMPTY = {'br', 'meta', 'link', 'img'}


class Page(HTMLParser):
    """Headings, tables by the heading above them, formulas and pictures of a page; fails where a tag is left open."""

    def __init__(self, text):
        super().__init__()
        self.open, self.attributes, self.tables, self.formulas, self.pictures, self.text = [], set(), {}, [], [], {}
        self.heading = ''
        self.feed(text)
        assert self.open == []

    def handle_starttag(self, tag, attrs):
        attrs = dict(attrs)
        self.attributes |= {(name, value) for name, value in attrs.items() if name in ('src', 'href', 'xlink:href', 'data')}
        if tag not in EMPTY:
            self.open.append((tag, attrs.get('class'), attrs.get('id')))
        if tag in ('h1', 'h2', 'h3'):
            self.heading = ''
        elif tag == 'table':
            self.table = self.tables.setdefault(self.heading, [])
            self.table.append([])
        elif tag == 'tr':
            self.table[-1].append([])
        elif tag in ('td', 'th'):
            self.table[-1][-1].append('')
        elif tag == 'p' and attrs.get('class') == 'formula':
            self.formulas.append((self.heading, {'numbers': '', 'b': ''}))
        elif tag == 'svg':
            self.pictures.append(self.open[-2][2])

    def handle_endtag(self, tag):
        assert self.open.pop()[0] == tag

    def handle_startendtag(self, tag, attrs):
        self.attributes |= {(name, value) for name, value in attrs if name in ('src', 'href', 'xlink:href', 'data')}

    def handle_data(self, data):
        here = [tag for tag, _, _ in self.open]
        if not here:
            return
        if here[-1] in ('h1', 'h2', 'h3'):
            self.heading += data
        elif here[-1] in ('td', 'th'):
            self.table[-1][-1][-1] += data
        elif ('span', 'numbers', None) in self.open:
            self.formulas[-1][1]['numbers'] += data
        elif here[-1] == 'b':
            self.formulas[-1][1]['b'] += data
        else:
            self.text[self.heading] = self.text.get(self.heading, '') + data


@pytest.fixture(scope='module')
def rated():
    return gearsweep.run(RATED)


def read(study, tmp_path):
    study.write_report(tmp_path / 'report.html')
    return Page((tmp_path / 'report.html').read_text('utf-8'))


def same(text, value):
    """A cell of the page and a value: to the six digits that are printed."""
    if isinstance(value, str):
        return text == value
    return text == '–' if math.isnan(value) else float(text) == pytest.approx(value, rel=5.1e-6)


def test_every_table_stands_there_with_its_numbers(rated, tmp_path):
    page = read(rated, tmp_path)
    long = upright = 0
    for table in rated:
        columns = list(table)
        shown = page.tables[table.name]
        if table.rows == 1 or (table.rows <= 5 and len(columns) > 6):  # columns below each other
            upright += 1
            assert [row[0] for row in shown[0]] == columns
            for row in shown[0]:
                assert all(same(*pair) for pair in zip(row[1 : 1 + table.rows], table._read(row[0]).tolist()))
                assert row[1 + table.rows :] == [table.units[row[0]], table.meanings[row[0]]]
        elif table.rows <= 2000:
            assert shown[-1][0] == columns and len(shown[-1]) == 1 + table.rows
            for i, name in enumerate(columns):
                assert all(same(row[i], value) for row, value in zip(shown[-1][1:], table._read(name).tolist())), (table.name, name)
        if table.rows > 40:
            long += 1
            for row in shown[0]:
                found, unit, meaning = row[1:]
                assert (unit, meaning) == (table.units[row[0]], table.meanings[row[0]])
                values = table._read(row[0])
                if values.dtype.kind == 'f' and ' to ' in found:
                    least, most = found.split(',')[0].split(' to ')
                    assert same(least, np.nanmin(values)) and same(most, np.nanmax(values))
    assert long >= 1 and upright >= 4


def test_it_opens_with_its_result_its_date_and_a_picture_and_ends_with_the_keys(rated, tmp_path):
    page = read(rated, tmp_path)
    text = (tmp_path / 'report.html').read_text('utf-8')
    told = page.text['<script>alert(1)</script> & co']
    assert re.fullmatch(rf'Computed by gearsweep {rated.version}, written on \d{{4}}-\d\d-\d\d\.', told.strip())
    assert re.findall(r'<h2>(\w+)', text) == ['Result', 'Warnings', 'Answer', 'Pictures', 'Formulas', 'Tables', 'Input']
    result = {row[0]: row[1] for row in page.tables['Result'][0]}
    least = [f'{name} {np.nanmin(rated.rating[column]):.4g}' for name, column in (('S_H', 'contact_safety'), ('S_F', 'root_safety'))]
    assert result['Least safety'] == ', '.join(least)
    assert text.index('<figure') < text.index('<h2>Warnings') < text.index('id="input"')


def test_the_input_stands_there_with_what_is_in_effect(rated, tmp_path):
    page = read(rated, tmp_path)
    assert page.text['Input'].startswith('\n' + rated.case.text) or rated.case.text in page.text['Input']
    found = {row[0]: row[1:] for row in page.tables['Input'][0][1:]}
    assert found['&rating rpm'][:3] == ['4000, 6000, 7000', '1/min', 'case']
    assert found['&pinion profile_shift'][0] == '0.2' and found['&dynamics damping_ratio'][2] == 'default'
    assert set(found) == {f'&{group} {key}' for group, keys in rated.case.values.items() for key in keys}


def test_formulas_give_the_numbers_that_stand_behind_them(rated, tmp_path):
    page = read(rated, tmp_path)
    rating, symbols = rated.rating, []
    for _, parts in page.formulas:
        numbers = parts['numbers'].replace('·', '*').replace('√', 'sqrt').replace('π', 'pi').replace('−', '-')
        assert re.fullmatch(r'(?:[\d.e+\-*/() ]|sqrt|pi)+', numbers), numbers
        symbols.append(eval(numbers, {'sqrt': math.sqrt, 'pi': math.pi}))
        assert symbols[-1] == pytest.approx(float(parts['b']), rel=6e-6)
    assert len(symbols) == 3 + 2 * (2 + 3)
    # What decides stands there: the largest stresses and the least safety factors of both gears.
    told = [float(parts['b']) for _, parts in page.formulas]
    for i, gear in enumerate(('pinion', 'gear')):
        of = rating.at(gear=gear)
        expected = [of.contact_stress_mpa.max(), of.contact_safety.min(), of.root_stress_mpa.max(), of.root_safety.min()]
        assert [told[3 + 5 * i + k] for k in (0, 1, 3, 4)] == pytest.approx(expected, rel=5.1e-6)


def test_without_limits_there_are_no_safety_factors(tmp_path):
    study = gearsweep.run(RATED.changed(rating={'contact_limit_mpa': None, 'root_limit_mpa': None}), 'rating')
    page = read(study, tmp_path)
    assert len(page.formulas) == 3 + 2 * 3
    assert 'no limits and no material are stated, so there is no safety factor' in page.text['Answer']


def test_what_safety_factors_rest_on_stands_above_them(rated, tmp_path):
    answer = read(rated, tmp_path).text['Answer']
    above = answer[answer.index('Rating by ISO 6336') : answer.index('stress MPa')]
    for words in ('K_v by the larger of Methods A (motion) and B (formula)', 'K_A 1,', 'K_H_beta 1 (not computed)', 'accuracy grade 5',
                  'pinion: sigma_HG 1400 MPa, sigma_FG 700 MPa, as stated', 'gear: sigma_HG 1300 MPa, sigma_FG 700 MPa, as stated'):  # fmt: skip
        assert words in above, words


def test_it_needs_nothing_from_elsewhere_and_runs_nothing(rated, tmp_path):
    page = read(rated, tmp_path)
    text = (tmp_path / 'report.html').read_text('utf-8')
    assert all(value.startswith('#') for _, value in page.attributes)
    assert '<script' not in text and '@import' not in text and not re.search(r'url\((?!#|"#)', text)
    assert '@media print' in text


def test_pictures_are_those_of_the_study(rated, tmp_path):
    page = read(rated, tmp_path)
    assert sorted(page.pictures) == sorted(f'picture-{name}' for name, _ in plots.figures(rated)) and page.pictures[0] == 'picture-dynamic_factors'
    text = (tmp_path / 'report.html').read_text('utf-8')
    names = re.findall(r'\bid="([^"]+)"', text)
    assert len(names) == len(set(names))
    assert set(re.findall(r'(?:href="#|url\(#)([^")]+)', text)) <= set(names)


def test_pictures_without_matplotlib(tmp_path, monkeypatch):
    study = gearsweep.run(Case(GEARED).changed(case={'tasks': 'geometry'}, load={'normal_force_n': None}, modal={'modes': None}), 'geometry')
    page = read(study, tmp_path)
    assert page.pictures == ['picture-outline'] and 'need matplotlib' not in page.text['Pictures'] and 'gears' in page.tables
    monkeypatch.setitem(sys.modules, 'matplotlib', None)
    monkeypatch.delitem(sys.modules, 'gearsweep.plots', raising=False)
    mesh = gearsweep.run(Case(PRESCRIBED), 'mesh')
    monkeypatch.delattr(gearsweep, 'plots', raising=False)
    bare = read(mesh, tmp_path)
    assert bare.pictures == [] and 'need matplotlib' in bare.text['Pictures']


def test_warnings_name_rows_without_a_result_and_keys_without_use(tmp_path):
    with pytest.warns(gearsweep.PartialWarning):
        study = gearsweep.run(Case(PARTIAL), 'sweep')
    missing = int(np.isnan(study.sweep.dynamic_factor).sum())
    told = read(study, tmp_path).text['Warnings']
    assert missing and f'{missing} unresolved' in told and 'Some operating points have no result.' in told
    with pytest.warns(gearsweep.UnusedWarning):
        unused = gearsweep.run(Case(PRESCRIBED).changed(case={'tasks': 'mesh'}))
    assert '&sweep load_rpm' in read(unused, tmp_path).text['Warnings']
    plain = gearsweep.run(Case(PRESCRIBED))
    assert read(plain, tmp_path).text['Warnings'].strip().startswith('None')


def test_a_study_read_from_a_file_has_the_same_report(rated, tmp_path):
    rated.save(tmp_path / 'study.npz')
    rated.write_report(tmp_path / 'one.html')
    gearsweep.read(tmp_path / 'study.npz').write_report(tmp_path / 'two.html')
    assert (tmp_path / 'one.html').read_bytes() == (tmp_path / 'two.html').read_bytes()


# --- the command --------------------------------------------------------------------


def run(tmp_path, capsys, *words, text=PRESCRIBED):
    """Exit code and what is said of a run in a folder."""
    (tmp_path / 'case.nml').write_text(text)
    code = main([str(tmp_path / 'case.nml'), '--out', str(tmp_path / 'out'), *map(str, words)])
    return code, capsys.readouterr()


def test_the_command_writes_it(tmp_path, capsys):
    target = tmp_path / 'a report.html'
    code, said = run(tmp_path, capsys, '--report', target)
    assert code == Code.OK and said.out.splitlines()[-1] == f'Wrote              {target}'
    page = Page(target.read_text('utf-8'))
    assert len(page.pictures) == 7 and 'optimum' in page.tables
    code, _ = run(tmp_path, capsys, '--report', tmp_path / 'out' / 'new.html', '--no-pictures', '--quiet')  # in the folder of the tables
    assert code == Code.OK and Page((tmp_path / 'out/new.html').read_text('utf-8')).pictures == []


def test_a_partial_answer_has_a_report_too(tmp_path, capsys):
    code, _ = run(tmp_path, capsys, '--report', tmp_path / 'r.html', '--no-pictures', text=PARTIAL)
    assert code == Code.PARTIAL and 'unresolved' in Page((tmp_path / 'r.html').read_text('utf-8')).text['Warnings']


@pytest.mark.parametrize('name, reason', [('none/r.html', 'No such file or directory'), ('case.nml/r.html', 'Not a directory'), ('', 'Is a directory')])
def test_a_place_that_takes_no_file_is_reported_before_anything_is_computed(name, reason, tmp_path, capsys):
    target = tmp_path / name
    code, said = run(tmp_path, capsys, '--report', target)
    assert code == Code.FILE and said.err == f'gearsweep: cannot write {target}: {reason}\n' and said.out == ''
    assert [path.name for path in tmp_path.iterdir()] == ['case.nml']


@pytest.mark.parametrize('words, message', [
    (['--report'], '--report: a value must follow'), (['--report', ''], '--report: the value is empty'),
])  # fmt: skip
def test_misuse(words, message, tmp_path, capsys):
    code, said = run(tmp_path, capsys, *words)
    assert code == Code.USAGE and message in said.err


def test_a_failed_write_leaves_what_is_there(rated, tmp_path):
    (tmp_path / 'r.html').write_text('before')
    with pytest.raises(Error, match='cannot write') as caught:
        rated.write_report(tmp_path / 'none' / 'r.html')
    assert caught.value.code == Code.FILE and (tmp_path / 'r.html').read_text() == 'before'
