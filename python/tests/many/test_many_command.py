"""`gearsweep many PLAN.toml`: the plan as a file, and what the command prints, leaves and returns."""

import contextlib
import http.client
import os
import re
import signal
import subprocess
import sys
import threading
import time
import urllib.error
import urllib.request
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from conftest import PARTIAL, ROOT

from gearsweep import Code, Error, PartialWarning
from gearsweep.__main__ import main
from gearsweep.core.watch import Late

many = pytest.importorskip('gearsweep.many')
from test_many import CASE, TAKE, digest, plan_of  # noqa: E402
from worker_faults import fails  # noqa: E402

from gearsweep.many import plan_file  # noqa: E402

PLAN = """
case = 'case.nml'
kind = 'random'
n = 96
seed = 3
take = ['sweep_worst.worst_dynamic_factor', 'sweep.dynamic_factor']
size = 16

[change.relief]
amount_um = 10

[vary.load]
normal_force_n = {distribution = 'norm', loc = 7000, scale = 300}
[vary.relief]
amount_um = {distribution = 'truncnorm', a = -3, b = 3, loc = 15, scale = 1.5}
[vary.dynamics]
damping_ratio = {distribution = 'uniform', loc = 0.1, scale = 0.14}
"""


TABLE = "case = 'case.nml'\nkind = 'table'\ntable = 'rows.csv'\ntake = 'sweep.dynamic_factor'\n"


@pytest.fixture
def folder(tmp_path, monkeypatch):
    CASE.write(tmp_path / 'case.nml')
    (tmp_path / 'plan.toml').write_text(PLAN)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_a_file_tells_the_plan_that_python_makes(folder):
    told = plan_file.read('plan.toml')
    np.testing.assert_array_equal(told.plan.rows(), plan_of().rows())
    assert told.plan.names == plan_of().names and told.take == TAKE and (told.size, told.seconds) == (16, None)
    assert told.plan.base.get('relief', 'amount_um') == 10 and told.store == 'plan.zarr'


@pytest.mark.parametrize(('line', 'instead', 'match'), [
    ("case = 'case.nml'", '', 'plan.toml: case: missing; must be the name of a file'),
    ("case = 'case.nml'", "case = 'none.nml'", 'plan.toml: cannot read none.nml: No such file'),
    ("kind = 'random'", "kind = 'randm'", "kind = 'randm': must be one of sobol, random, lhs"),
    ('n = 96', 'n = 9.6', 'n = 9.6: must be a whole number'),
    ('n = 96', 'n = true', 'n = True: must be a whole number'),
    ('n = 96', 'n = 0', 'n = 0: must be a whole number of at least 1'),
    ('n = 96', '', 'n: missing'),
    ('seed = 3', 'sead = 3', r'sead: unknown \(did you mean seed\?\)'),
    ('seed = 3', 'scrambles = 4', "scrambles: is not used with kind = 'random'"),
    ('seed = 3', 'seed = 3 4', 'plan.toml: is no TOML'),
    ('[vary.load]', '[vary.loads]', 'no group loads.*did you mean load|unknown group.*load'),
    ('normal_force_n = {', 'normal_force = {', r'\[vary.load\]: &load normal_force'),
    ("distribution = 'norm'", "distribution = 'nrom'", r"\[vary.load\] normal_force_n: distribution = 'nrom': must be one of scipy.stats.*did you mean norm"),
    ('loc = 7000, scale', 'mean = 7000, scale', r'\[vary.load\] normal_force_n: mean = 7000: norm has the numbers loc, scale'),
    ("scale = 300", "scale = '300'", r"normal_force_n: scale = '300': must be a number"),
    ('scale = 300', 'scale = -300', 'norm is not possible with loc = 7000, scale = -300'),
    ('a = -3, ', '', r'\[vary.relief\] amount_um: a: missing; truncnorm has the numbers a, b, loc, scale'),
    ("{distribution = 'norm', loc = 7000, scale = 300}", '7000', r'\[vary.load\] normal_force_n = 7000: must be a list of values, or \{distribution'),
    ("{distribution = 'norm', loc = 7000, scale = 300}", '[]', r'\[vary.load\]: &load normal_force_n: the list is empty'),
    ('amount_um = 10', "amount_um = 10\namont_um = 1", 'did you mean amount_um'),
    ("take = [", "take = [3, ", "take = 3: must be a column 'table.column'"),
])  # fmt: skip
def test_what_is_wrong_in_a_file_is_reported_with_its_place(folder, line, instead, match):
    (folder / 'plan.toml').write_text(PLAN.replace(line, instead, 1))
    with pytest.raises(Error, match=match):
        plan_file.read('plan.toml')


def test_a_table_and_a_grid_are_reported_by_files(folder):
    (folder / 'rows.csv').write_text('# made by hand\nrelief.amount_um,sweep.direction\n1.5,up\n2.5,down\n')
    (folder / 'plan.toml').write_text("case = 'case.nml'\nkind = 'table'\ntable = 'rows.csv'\ntake = 'sweep.dynamic_factor'\n")
    plan = plan_file.read('plan.toml').plan
    assert plan.case(1).get('relief', 'amount_um') == 2.5 and plan.case(1).get('sweep', 'direction') == 'down'
    (folder / 'plan.toml').write_text("case = 'case.nml'\nkind = 'grid'\ntake = 'sweep.dynamic_factor'\n[vary.relief]\namount_um = [1, 2, 3]\n")
    assert plan_file.read('plan.toml').plan.n == 3
    (folder / 'rows.csv').write_text('relief.amount_um\n')
    (folder / 'plan.toml').write_text("case = 'case.nml'\nkind = 'table'\ntable = 'rows.csv'\ntake = 'sweep.dynamic_factor'\n")
    with pytest.raises(Error, match=r'rows.csv: must be a table \(CSV\) with a line of names'):
        plan_file.read('plan.toml')
    (folder / 'rows.csv').write_bytes('relief.amount_um,sweep.direction\r\n1.5,up\r\n'.encode('utf-8-sig'))  # as Excel writes it
    assert plan_file.read('plan.toml').plan.names == ('relief.amount_um', 'sweep.direction')
    (folder / 'rows.csv').write_text('relief.amount_um, relief.amount_um\n1,2\n')
    with pytest.raises(Error, match=r'rows.csv: has two columns relief.amount_um'):
        plan_file.read('plan.toml')


@pytest.mark.parametrize('line_end', ['\n', '\r\n', '\r'])
@pytest.mark.parametrize(('separator', 'decimal'), [(',', '.'), (';', '.'), (';', ','), ('\t', ','), (' ', '.'), (' ; ', ',')])
def test_a_table_as_spreadsheets_and_data_frames_write_it(folder, separator, decimal, line_end):
    """The same columns in all forms, and so the same plan."""
    names, rows = ['"Relief.Amount_UM"', 'pinion.teeth', 'sweep.direction'], [['1.5', '21.0', 'up'], ['2', '25', '"down"']]
    lines = ['# made by hand', separator.join(names)]
    lines += [separator.join(word.replace('.', decimal) for word in row) + separator.rstrip() for row in rows]
    lines += ['', separator.strip(' ') * 2, '! the end', '\x1a']
    (folder / 'rows.csv').write_bytes(b'\xef\xbb\xbf' + line_end.join(lines).encode())
    plan = TABLE.replace('\n', line_end).encode('utf-8-sig') + b'\x1a'
    (folder / 'plan.toml').write_bytes(plan)
    found = plan_file.read(str(folder / 'plan.toml')).plan
    keys = [('relief', 'amount_um'), ('pinion', 'teeth'), ('sweep', 'direction')]
    assert [[found.case(i).get(*key) for key in keys] for i in range(len(found))] == [[1.5, 21, 'up'], [2, 25, 'down']]


@pytest.mark.parametrize(('file', 'data', 'message'), [
    ('rows.csv', 'relief.amount_um,pinion.teeth\n1,5,21\n', 'rows.csv line 2: must have 2 fields, as the line of names has; decimals take a point'),
    ('rows.csv', 'relief.amount_um\n\u22121\n', "line 2: '\u22121': must be a number, as others of the column are; '\u2212' is U+2212, minus sign"),
    ('rows.csv', '\ufeffrelief.amount_um\n1\n'.encode('utf-16'), 'rows.csv: the text is in UTF-16; save it in UTF-8'),
    ('plan.toml', TABLE.encode('utf-16'), 'plan.toml: the text is in UTF-16; save it in UTF-8'),
    ('plan.toml', TABLE.replace("'rows.csv'", '\u2018rows.csv\u2019'), 'is U+2018, left single quotation mark: type a plain character'),
])  # fmt: skip
def test_what_of_a_table_and_a_plan_is_not_read(folder, file, data, message):
    (folder / 'rows.csv').write_text('relief.amount_um\n1\n')
    (folder / 'plan.toml').write_text(TABLE)
    (folder / file).write_bytes(data if isinstance(data, bytes) else data.encode())
    with pytest.raises(Error, match=re.escape(message)):
        plan_file.read(str(folder / 'plan.toml'))


@pytest.mark.parametrize(('rows', 'match'), [
    ('relief.amount_um,sweep.direction\n# 5\n1.5,up\n\nabc,down\n', "rows.csv: column relief.amount_um, line 5: 'abc': must be a number"),
    ('relief.amount_um,sweep.direction\n1.5,up\n,down\n', "rows.csv: column relief.amount_um, line 3: '': must be a number"),
    ('Pinion.Teeth\n25\n1d3\n', "rows.csv: column Pinion.Teeth, line 3: '1d3': must be a number"),
])  # fmt: skip
def test_a_cell_that_is_no_number_among_numbers_is_reported_with_its_place(folder, rows, match):
    (folder / 'rows.csv').write_text(rows)
    (folder / 'plan.toml').write_text(TABLE)
    with pytest.raises(Error, match=match):
        plan_file.read('plan.toml')


def test_logicals_and_words_of_a_table_are_what_their_keys_take(folder):
    """As `Case.changed` writes them; a file may be called by a number, or all cells be words."""
    (folder / 'rows.csv').write_text('as_built.quick,mesh.file,relief.amount_um\n.true.,1,a\n.FALSE.,k.txt,b\nTRUE,2,a\n')
    (folder / 'plan.toml').write_text(TABLE)
    plan = plan_file.read('plan.toml').plan
    for at, (quick, file, amount) in enumerate([(True, '1', 'a'), (False, 'k.txt', 'b'), (True, '2', 'a')]):
        assert plan.case(at) == plan.base.changed(as_built={'quick': quick}, mesh={'file': file}, relief={'amount_um': amount})


def test_the_plan_of_the_page_can_be_read(tmp_path):
    page = (ROOT / 'doc/many.md').read_text()
    (tmp_path / 'data').symlink_to(ROOT / 'data')
    (tmp_path / 'plan.toml').write_text(re.search(r'```toml\n(.*?)```', page, re.DOTALL)[1])
    told = plan_file.read(str(tmp_path / 'plan.toml'))
    assert told.plan.n == 4096 and told.seconds == 60 and told.store == str(tmp_path / 'scatter.zarr')
    assert told.plan.names == ('load.line_load_n_mm', 'dynamics.damping_ratio', 'relief.amount_um')
    assert told.plan.base.get('sweep', 'load_rpm') is None and 'published' not in told.plan.base.text.replace('! ', '')


def test_the_command_prints_quantiles_and_leaves_a_store(folder, capsys):
    assert main(['many', 'plan.toml', '--workers', '1']) == Code.OK
    said = capsys.readouterr().out
    data = many.open('plan.zarr')
    found = many.quantiles(data[TAKE[0]], 0.95)
    assert 'Variants           96: 96 ok' in said and 'Wrote              plan.zarr' in said
    assert f'95 %: {found["value"][0]:.5g} ({found["lower"][0]:.5g} to {found["upper"][0]:.5g})' in said
    assert digest(data) == digest(many.run(plan_of(), TAKE))
    # Again: nothing is left to do.
    assert main(['many', 'plan.toml', '--quiet']) == Code.OK and capsys.readouterr().out == ''


def test_the_command_computes_again_what_failed(folder, capsys, monkeypatch):
    """Of 15 speeds and of a million, for which a variant has too little time, however fast the machine is."""
    done = many.rows.attempt

    def attempt(case, *arguments, seconds, **options):
        if case.get('sweep', 'rpm_step') < 1:
            return None, None, Late()
        return done(case, *arguments, seconds=None, **options)

    monkeypatch.setattr(many.rows, 'attempt', attempt)
    text = "case = 'case.nml'\nkind = 'grid'\ntake = 'sweep_worst.worst_dynamic_factor'\nseconds = {}\n[vary.sweep]\nrpm_step = [1000, 0.014]\n"
    (folder / 'plan.toml').write_text(text.format(0.5))
    command = ['many', 'plan.toml', '--workers', '1']
    assert main(command) == Code.PARTIAL and '1 ok, 1 late' in capsys.readouterr().out
    (folder / 'plan.toml').write_text(text.format(0.7))
    for more, seconds in (([], 0.5), (['--again'], 0.7)):
        assert main([*command, *more]) == Code.PARTIAL
        assert many.failures('plan.zarr').message.tolist() == [f'not done after {seconds:g} s']


def test_parts_of_the_command_make_the_whole(folder, capsys):
    assert main(['many', 'plan.toml', '--workers', '1', '--part', '2/2']) == Code.OK
    assert '48 pending, 48 ok' in capsys.readouterr().out
    assert main(['many', 'plan.toml', '--workers', '1', '--part', '1/2', '--quiet']) == Code.OK
    assert digest(many.open('plan.zarr')) == digest(many.run(plan_of(), TAKE))


def test_variants_without_a_result_are_in_the_exit_code(folder, capsys):
    (folder / 'plan.toml').write_text("case = 'case.nml'\nkind = 'grid'\ntake = 'sweep.dynamic_factor'\n[vary.dynamics]\ndamping_ratio = [0.1, -1]\n")
    assert main(['many', 'plan.toml', '--workers', '1']) == Code.PARTIAL
    assert 'Variants           2: 1 ok, 1 refused' in capsys.readouterr().out


def test_variants_with_results_in_part_are_in_the_exit_code(folder, capsys):
    """As where the lowest speed has too few steps."""
    (folder / 'case.nml').write_text(PARTIAL)
    text = "case = 'case.nml'\nkind = 'grid'\ntake = 'sweep.dynamic_factor'\n[vary.sweep]\nrpm_first = [{}]\n"
    for first, code, said in (('1, 1', Code.PARTIAL, '2: 2 partial'), ('5001, 5001', Code.OK, '2: 2 ok')):
        (folder / 'plan.toml').write_text(f"store = 's{code}.zarr'\n" + text.format(first))
        assert main(['many', 'plan.toml', '--workers', '1']) == code and f'Variants           {said}\n' in capsys.readouterr().out


@pytest.mark.parametrize(('words', 'match'), [
    ([], 'no plan given'), (['a', 'b'], 'one plan at a time'), (['a', '--part', '4/3'], '--part 4/3: must be K/M'),
    (['a', '--part'], '--part: a value must follow'), (['a', '--workers', '0'], '--workers 0: must be an integer from 1'),
    (['a', '--fast'], 'unknown option --fast'), (['a', '--workers', '2', '--scheduler', 'tcp://x:1'], 'a scheduler has workers of its own'),
    (['a', '--wait', '5'], '--wait: is for the workers of a --scheduler'), (['a', '--wait', '0.5'], '--wait 0.5: must be a whole number of seconds'),
])  # fmt: skip
def test_command_lines_that_are_no_use(words, match, capsys):
    assert main(['many', *words]) == Code.USAGE
    assert match in capsys.readouterr().err


def test_help_and_a_scheduler_that_is_not_there(folder, capsys):
    assert main(['many', '--help']) == Code.OK and '--scheduler ADDRESS' in capsys.readouterr().out
    assert main(['many', 'plan.toml', '--scheduler', 'nonsense://x']) == Code.FILE
    assert 'cannot reach the scheduler nonsense://x' in capsys.readouterr().err


@pytest.fixture
def stored(folder):
    """A store of 64 variants of which some fail, and its dataset."""
    many.run(plan_of(64), TAKE, reduce=fails, store='x.zarr')
    return many.open('x.zarr')


def test_the_page_of_a_store_has_its_numbers_pictures_and_failures(stored):
    from gearsweep.many.page import page

    text = page('x.zarr')
    bad = many.failures('x.zarr')
    assert len(bad) > 0 and f'<td>failed</td><td>{len(bad)}</td>' in text and text.count('<td>reduce: ValueError: no such number</td>') == len(bad)
    with pytest.warns(PartialWarning):
        found = many.quantiles(stored[TAKE[0]], 0.95, nan='drop')
    band = f'{float(found["value"][0]):.5g} ({float(found["lower"][0]):.5g} to {float(found["upper"][0]):.5g})'
    assert band.replace('nan', '?') in text
    assert f'quantiles: {len(bad)} of 64 variants have no number and are omitted' in text
    assert '<td>load.normal_force_n</td><td>norm(7000, 300)</td>' in text and 'sweep.dynamic_factor over rpm' in text
    # Two numbers over the keys and as a distribution, and one over speed.
    assert text.count('<figure>') == 5
    names = re.findall(r' id="([^"]+)"', text)
    assert len(names) == len(set(names)), 'names inside drawings clash'


def test_the_page_says_what_it_leaves_out(stored, monkeypatch):
    """Of 64 variants the curves have 15 numbers each."""
    from gearsweep.many import page

    assert 'Not on this page' not in page.page('x.zarr')
    monkeypatch.setattr(page, '_LARGEST', 64 * 15 - 1)
    text = page.page('x.zarr')
    assert 'numbers each: sweep.dynamic_factor.</p>' in text and 'sweep.dynamic_factor over rpm' not in text


def test_each_row_of_a_picture_over_keys_has_its_height(folder):
    """Three pictures in a row: seven keys have three, at the width and the height of those that one has."""
    from gearsweep.many.page import page

    keys = {'load.normal_force_n': 7000, 'relief.amount_um': 10, 'dynamics.damping_ratio': 0.1, 'mesh.contact_ratio': 1.6,
            'pinion.effective_mass_kg': 0.8, 'gear.effective_mass_kg': 0.8, 'dynamics.friction': 0}  # fmt: skip
    sizes = []
    for count in (3, 7):
        many.run(many.Plan.table(CASE, {name: [value] for name, value in [*keys.items()][:count]}), TAKE[0], store=f'{count}.zarr')
        width, height = re.search(r'<figure><svg[^>]* viewBox="0 0 ([\d.]+) ([\d.]+)"', page(f'{count}.zarr')).groups()
        sizes.append((float(width), float(height)))
    assert sizes[1] == pytest.approx((sizes[0][0], 3 * sizes[0][1]), rel=1e-6)


def test_the_page_of_a_plan_for_indices(folder):
    from gearsweep.many.page import page

    plan = many.Plan.saltelli(CASE, 8, 1, dynamics={'damping_ratio': [0.1, 0.15, 0.2]}, relief={'amount_um': [0, 10, 20]})
    data = many.run(plan, TAKE[0], store='x.zarr')
    found = many.sensitivity(data[TAKE[0]])
    assert f'<td>dynamics.damping_ratio</td><td>{float(found["S1"][0]):.5g} (' in page('x.zarr')


def test_a_page_that_cannot_be_written_is_reported_before_the_run(folder, capsys):
    assert main(['many', 'plan.toml', '--report', 'nowhere/page.html']) == Code.FILE
    assert capsys.readouterr().err == 'gearsweep: cannot write nowhere/page.html: No such file or directory\n' and not (folder / 'plan.zarr').exists()


def test_the_command_writes_the_page(folder):
    assert main(['many', 'plan.toml', '--workers', '1', '--quiet', '--report', 'page.html']) == Code.OK
    assert '<td>ok</td><td>96</td>' in (folder / 'page.html').read_text()


def test_the_panel_shows_a_store(panel_of_store):
    assert '<td>ok</td>' in got(panel_of_store.address)
    panel_of_store.store = 'none.zarr'
    with pytest.raises(urllib.error.HTTPError, match='404'):
        got(panel_of_store.address)


@pytest.fixture
def panel_of_store(stored):
    from gearsweep import panel

    server = panel.listen(panel.api_of(''), 0)
    server.store = 'x.zarr'
    threading.Thread(target=server.serve_forever, daemon=True).start()
    yield server
    server.shutdown()
    server.server_close()


def got(address):
    with urllib.request.urlopen(address, timeout=300) as answer:
        return answer.read().decode()


def test_eight_who_ask_at_once_get_the_page_that_one_gets(panel_of_store, monkeypatch):
    """Which is made once, and anew when a block was written; a report that is drawn meanwhile has its own names."""
    from gearsweep.many import page

    made, there = [], page.page
    monkeypatch.setattr(page, 'page', lambda store: made.append(store) or there(store))
    with ThreadPoolExecutor(8) as threads:
        texts = {*threads.map(got, [panel_of_store.address] * 8)}
    assert len(made) == 1
    panel_of_store.pages.clear()
    assert texts == {got(panel_of_store.address)} and len(made) == 2
    got(panel_of_store.address)
    assert len(made) == 2
    many.run(plan_of(64), TAKE, reduce=fails, store='x.zarr', again='failed')
    assert got(panel_of_store.address) == texts.pop() and len(made) == 3


def test_nobody_else_draws_while_a_page_is_drawn(panel_of_store, monkeypatch):
    """The settings of matplotlib are those of the process."""
    from gearsweep.many import page
    from gearsweep.panel import files

    at_once, seen = [], []

    def draws(*_):
        at_once.append(1)
        seen.append(len(at_once))
        time.sleep(0.1)
        at_once.pop()
        return files.File('x', 'text/plain', b'') if _[1:] else ''

    monkeypatch.setattr(page, 'page', draws)
    monkeypatch.setattr(files, 'download', draws)
    with ThreadPoolExecutor(4) as threads:
        [*threads.map(got, [panel_of_store.address, panel_of_store.address + 'file/report'] * 2)]
    assert seen == [1] * len(seen) and len(seen) >= 3


def test_ctrl_c_ends_a_panel_that_draws_a_page(stored):
    """The page is not waited for: its drawing takes a minute here."""
    code = ('import signal, sys, time; signal.signal(signal.SIGINT, signal.default_int_handler); from gearsweep.many import page; '
            "page._svg = lambda *_: (print('draws', flush=True), time.sleep(60)); from gearsweep.__main__ import main; "
            "sys.exit(main(['panel', 'x.zarr', '--no-browser', '--port', '0']))")  # fmt: skip
    running = subprocess.Popen([sys.executable, '-c', code], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    address = re.search(r'http://\S+', running.stdout.readline())[0]

    def asks():
        with contextlib.suppress(OSError, http.client.HTTPException):
            got(address)

    threading.Thread(target=asks, daemon=True).start()
    assert running.stdout.readline() == 'draws\n'
    running.send_signal(signal.SIGINT)
    _, said = running.communicate(timeout=40)
    assert running.returncode == Code.OK and not said


def test_ctrl_c_ends_the_command_and_its_processes(folder):
    """To the whole group, as a terminal sends it: what is done is kept, and one line says how to go on."""
    (folder / 'plan.toml').write_text(PLAN.replace('n = 96', 'n = 100000').replace('[change.relief]', '[change.sweep]\nrpm_step = 100\n[change.relief]'))
    code = ('import signal, sys; signal.signal(signal.SIGINT, signal.default_int_handler); from gearsweep.__main__ import main; '
            "sys.exit(main(['many', 'plan.toml', '--workers', '2']))")  # fmt: skip
    running = subprocess.Popen([sys.executable, '-c', code], start_new_session=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    while running.poll() is None and len([*(folder / 'plan.zarr/status/c').glob('[0-9]*')]) < 3:  # in any order
        time.sleep(0.05)
    os.killpg(running.pid, signal.SIGINT)
    out, said = running.communicate(timeout=300)
    assert running.returncode == Code.INTERRUPTED and not out
    assert said == 'gearsweep: interrupted; the same command continues the run\n'
    assert many.counts(many.open('plan.zarr'))['ok'] >= 48
    with pytest.raises(ProcessLookupError):
        until = time.monotonic() + 60
        while time.monotonic() < until:
            os.killpg(running.pid, 0)
            time.sleep(0.05)
