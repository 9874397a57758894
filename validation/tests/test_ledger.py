"""The ledger's own rules, its tolerances, and what is made from it."""

import csv
import dataclasses
import html
import io
import math
import re

import pytest

import gearsweep
from validation import __main__ as runner
from validation import cases, check, ledger, moving_load, page, pictures, published, report, spread, three


@pytest.fixture
def row():
    """A row that agrees with ours."""
    return ledger.find('karpat2012', 'hertz_width')


@pytest.mark.parametrize('name', [*ledger.PAPERS, *ledger.CHECKS])
def test_files_are_sound(name):
    assert ledger.read(name)


@pytest.mark.parametrize(('changes', 'message'), [
    ({'id': 'two words'}, 'not a new word'),
    ({'kind': 'guess'}, 'kind = guess'),
    ({'inputs': 'sure'}, 'inputs = sure'),
    ({'by': 'hand'}, 'by = hand'),
    ({'by': ''}, 'go together'),
    ({'origin': ''}, 'needs its origin'),
    ({'reason': ''}, 'needs a reason'),
    ({'tolerance': '', 'origin': ''}, 'only what is compared'),
    ({'inputs': 'not reproducible'}, 'only what is compared'),
    ({'inputs': 'fitted'}, 'only what is compared'),
    ({'inputs': 'open', 'tolerance': '', 'origin': ''}, 'no value of ours'),
    ({'kind': 'input'}, 'an input has no status'),
    ({'ours': 'same nothing'}, 'does not stand before it'),
    ({'printed': 'about 2'}, 'could not convert'),
    ({'tolerance': 'some'}, 'could not convert'),
])
def test_refused(row, changes, message):
    with pytest.raises(ValueError, match=message):
        ledger.check_row(dataclasses.replace(row, **changes), {})


def test_a_repeat_must_agree(row):
    seen = {row.id: row}
    again = dataclasses.replace(row, id='again', ours=f'same {row.id}')
    ledger.check_row(again, seen)
    with pytest.raises(ValueError, match='contradicts'):
        ledger.check_row(dataclasses.replace(again, printed='2.16'), seen)


@pytest.mark.parametrize(('paper', 'pattern'), [(paper, pattern) for paper in ledger.TOGETHER for pattern in ledger.TOGETHER[paper]])
def test_rows_of_one_contradiction_have_one_status(paper, pattern):
    rows = ledger.read(paper)
    at = next(i for i, row in enumerate(rows) if re.fullmatch(pattern, row.id))
    other = 'stated' if rows[at].inputs == 'not reproducible' else 'not reproducible'
    changed = [*rows[:at], dataclasses.replace(rows[at], inputs=other), *rows[at + 1:]]
    ledger.check_together(paper, rows)
    with pytest.raises(ValueError, match=f'of one status, not .*{other}'):
        ledger.check_together(paper, changed)


@pytest.mark.parametrize(('place', 'rows'), [('Table 2', 18), ('Table 3', 12)])
def test_the_stresses_of_a_table_have_one_status(place, rows):
    """Those of Hassan et al.; a von Mises stress is that of the printed components of its row."""
    found = [row.inputs for row in ledger.read('hassan2009') if (row.place, row.unit) == (place, 'MPa') and row.by != 'printed']
    assert found == ['not reproducible'] * rows


@pytest.mark.parametrize(('name', 'sort'), [
    ('dogan2021:df1_28', 'dynamic factors'), ('dogan2021:n1_1', 'resonance speeds'), ('dogan2021:best_1', 'reliefs'),
    ('dogan2021:v_1', 'statements'), ('hassan2009:beam_frequency_rad_s', 'natural frequencies'), ('hassan2009:beam_sigma_y_mpa', 'stresses'),
    ('hassan2009:dynamic_360_tau_xy', 'stresses'), ('hassan2009:contact_ratio', 'other numbers'), ('thamba2020:shear', 'other numbers'),
    ('thamba2020:omega', 'other numbers'), ('thamba2020:d_5', 'lengths and diameters'), ('thamba2020:tip_modified', 'strains and deformations'),
    ('thamba2020:change_gear_1', 'other numbers'), ('karpat2012:hertz_width', 'other numbers'),
])
def test_sorts(name, sort):
    assert ledger.find(*name.split(':')).sort == sort


@pytest.mark.parametrize(('printed', 'tolerance', 'allowed'), [
    ('1.388e-3', 'digit', 1e-6), ('1.388e-3', 'digit/2', 0.5e-6), ('110', 'digit', 1), ('300.0000', 'digit/2', 5e-5),
    ('8e10', 'digit/2', 5e9), ('0.5', 'exact', 0), ('-2.0', '5 %', 0.1), ('2', '0.03', 0.03),
    ('1.36e-4', '0.5 % + digit/2', 0.68e-6 + 0.5e-6),
])
def test_tolerances(row, printed, tolerance, allowed):
    assert math.isclose(dataclasses.replace(row, printed=printed, tolerance=tolerance).allowed, allowed, rel_tol=1e-12)


def test_verdicts(row):
    assert check.check(row).verdict == 'within'
    assert check.check(dataclasses.replace(row, printed='2.16')).verdict == 'deviates'
    assert check.check(dataclasses.replace(row, ours='hertz_width 2')).verdict == 'failed'
    assert check.check(dataclasses.replace(row, ours='no_such_function')).verdict == 'failed'
    assert check.check(dataclasses.replace(row, inputs='not reproducible', tolerance='')).verdict == 'not reproducible'
    assert check.check(dataclasses.replace(row, inputs='fitted', tolerance='')).verdict == 'fitted'
    assert check.check(dataclasses.replace(row, inputs='open', by='', ours='')).verdict == 'open'


@pytest.mark.parametrize('row', [pytest.param(row, id=row.name) for row in spread.rows()])
def test_tolerance_is_not_wider_than_unstated_inputs_bear(row):
    assert row.allowed <= spread.most(row)


def test_nothing_in_table_3_is_old():
    assert moving_load.same(moving_load.current(), moving_load.block()), 'run python -m validation --pages'


def test_nothing_on_the_page_is_old():
    assert page.same(page.current(), page.block(check.run(ledger.PAPERS))), 'run python -m validation --pages'


@pytest.mark.parametrize(('text', 'other', 'alike'), [
    ('DF 1.2410 at 7 um', 'DF 1.2409 at 7 um', True), ('DF 1.2410', 'DF 1.2408', False), ('DF 1.2', 'F 1.2', False),
    ('6.6e-5', '6.7e-5', True), ('12 rows', '14 rows', False), ('a 1', 'a 1 2', False),
])
def test_the_last_digit_may_round_otherwise(text, other, alike):
    assert page.same(text, other) == alike


def test_the_first_lines_of_the_page_are_of_today():
    lines = page.first_lines()
    assert page.PATH.read_text(encoding='utf-8').startswith(f'# Validation\n\n{page.FIRST}\n{lines}\n{page.FIRST_END}\n')
    assert page.same(lines, three.markdown(three.computed(io.StringIO()))), 'run python -m validation --pages'


def test_the_three_checks_by_hand():
    """The frequencies by Eqs. 1 to 4 of Hassan et al., t/(2 l^2) sqrt(E/rho) with t = pi m/2; what else is printed stands in the papers."""
    module, steel, common = 25, 2.15e5 / 8.75e-9, 2.07e5 / 7.8e-9
    height, other = 2.25 * module, 16 * module - 15 * module * math.cos(math.radians(20))
    by_hand = [math.pi * module / 4 / length**2 * math.sqrt(ratio) for length, ratio in ((height, steel), (other, steel), (other, common))]
    said = three.computed(io.StringIO())
    assert re.findall(r'\b\d{5}\b', said[0]) == ['44600', *(f'{value:.0f}' for value in by_hand)] and '39.006' in said[0]
    assert 'printed 66, 82, 106 and 112 MPa' in said[1] and said[2].startswith('DF 1.25 -> 1.03')
    factors = [check.compute(ledger.find('dogan2021', id)) for id in ('df_1', 'df1_15')]
    assert 'ours {:.3f} -> {:.3f}, within 0.03 and 0.02'.format(*factors) in said[2]
    assert three.text(said).count('\n- ') == 2 and len(said) == 3


def test_the_programs_file_is_the_ledgers():
    assert published.PATH.read_text(encoding='utf-8') == published.text(), 'run python -m validation --pages'


def test_program_and_ledger_say_the_same():
    """Of each printed number that the program sets beside ours: printed, our value, status."""
    table = gearsweep.run(cases.case('hassan')).published
    rows = [row for row in ledger.read('hassan2009') if re.fullmatch(published.KNOWN, row.id)]
    assert list(table.quantity) == [row.id for row in rows] and rows
    for row, printed, ours, status in zip(rows, table.printed, table.ours, table.status):
        assert (printed, status) == (row.value, row.inputs), row.id
        assert math.isclose(ours, check.compute(row), rel_tol=2e-5), row.id


def test_runner(tmp_path, capsys):
    assert runner.main(['karpat2012', '--out', str(tmp_path)]) == 0
    assert 'Karpat' in capsys.readouterr().out
    with open(tmp_path / 'report.csv', newline='') as file:
        lines = list(csv.DictReader(file))
    assert sum(line['paper'] == 'karpat2012' for line in lines) == len(ledger.read('karpat2012'))
    page = (tmp_path / 'report.html').read_text(encoding='utf-8')
    assert all(row.quantity.replace("'", '&#x27;') in page for row in ledger.read('karpat2012'))
    assert 'src="http' not in page and 'href="http' not in page
    assert report.made() in page and re.match(r'gearsweep \d+\.\d+\.\d+, 20\d\d-\d\d-\d\d, \w', report.made())


def test_the_three_checks_come_last(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(check, 'run', lambda papers: [])
    monkeypatch.setattr(pictures, 'all_for', lambda papers: [])
    assert runner.main(['--out', str(tmp_path)]) == 0
    said = capsys.readouterr()
    text = three.text(three.computed(io.StringIO()))
    assert said.out.endswith(f'\n{text}\n') and 'hassan2009: 165 rows ...' in said.err
    assert all(f'<li>{html.escape(one)}</li>' in (tmp_path / 'report.html').read_text() for one in three.computed(io.StringIO()))
    assert runner.main(['--three']) == 0
    said = capsys.readouterr()
    assert said.out == f'{text}\n' and said.err.count('Check ') == 3
    monkeypatch.setattr(check, 'agrees', lambda row, ours: False)
    assert runner.main(['--three']) == 1 and 'NOT within 0.03' in ' '.join(capsys.readouterr().out.split())


def test_every_paper_has_its_picture():
    assert {picture.paper for picture in pictures.PICTURES} == set(ledger.PAPERS)


def test_a_row_out_of_its_tolerance_fails_the_run(row, tmp_path, capsys, monkeypatch):
    wrong = dataclasses.replace(row, printed='2.16')
    monkeypatch.setattr(check, 'run', lambda papers: [check.check(wrong)])
    assert runner.main(['karpat2012', '--out', str(tmp_path)]) == 1
    assert 'karpat2012:hertz_width' in capsys.readouterr().err


@pytest.mark.long
def test_the_report_has_the_pictures_of_all_papers(row, tmp_path, monkeypatch):
    monkeypatch.setattr(check, 'run', lambda papers: [check.check(row)])
    assert runner.main(['--out', str(tmp_path)]) == 0
    page = (tmp_path / 'report.html').read_text(encoding='utf-8')
    assert len(re.findall('<svg|<img', page)) == len(pictures.PICTURES)


@pytest.mark.parametrize('arguments', [['nobody2020'], ['--pages', 'karpat2012'], ['--no-such']])
def test_wrong_usage(arguments, capsys):
    with pytest.raises(SystemExit) as stopped:
        runner.main(arguments)
    assert stopped.value.code == 2
    assert capsys.readouterr().err


def test_every_row_is_counted_once():
    outcomes = check.run(['karpat2012', 'hassan2009'])
    header, lines = report.summary(outcomes)
    assert all(line[1] == sum(line[2:5]) + line[-1] and line[4] == sum(line[5:-1]) for line in lines) and len(header) == len(lines[0])
    header, sorts = report.summary_of_results(outcomes)
    assert all(line[1] == sum(line[2:-1]) for line in sorts) and len(header) == len(sorts[0])
    assert sorts[-1] == ('all', *lines[-1][4:]) == ('all', *map(sum, zip(*(line[1:] for line in sorts[:-1]))))
    named = {line[0]: line[1] + line[-1] for line in sorts[:-1]}
    hertz = [row for row in ledger.read('hassan2009') if re.search('frequency', row.quantity) and row.kind == 'result' and not row.repeats]
    assert named['natural frequencies'] == len(hertz) == 13
