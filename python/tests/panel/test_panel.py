"""The front panel without a browser: what it answers, to whom, and which files it reads. What pages show is tested by test/cases/panel.sh."""

import http.client
import io
import json
import os
import socket
import subprocess
import sys
import threading
import time
import webbrowser
import zipfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from conftest import GEARED, PARTIAL, PRESCRIBED

import gearsweep
from gearsweep import Case, Code, Error
from gearsweep import panel as front
from gearsweep.core.assignments import assignments
from gearsweep.core.outline import contact_path
from gearsweep.panel import files
from gearsweep.panel.api import Api, StudyDropped
from gearsweep.panel.case_folders import DATA, CaseFolders, description, file_keys
from gearsweep.panel.server import Handler, Server

ROOT = Path(__file__).parents[3]
CASES = sorted(path.name for path in (ROOT / 'data').glob('*.nml'))
# Far more points than are done before it is stopped.
LONG = Case(PRESCRIBED).changed(case={'tasks': 'poincare'}, poincare={'settling_periods': 10_000_000}).text


@pytest.fixture
def api(tmp_path):
    return Api(CaseFolders(tmp_path), {'place': 'data', 'name': 'case1.nml'})


@pytest.fixture
def server(api):
    one = Server(api, 0)
    thread = threading.Thread(target=one.serve_forever, daemon=True)
    thread.start()
    yield one
    one.shutdown()
    one.server_close()


def ask(server, method, path, words=None, **headers):
    """Status and body; the headers of a page of this server, but for those given."""
    connection = http.client.HTTPConnection('127.0.0.1', server.server_port, timeout=60)
    usual = {'Origin': server.address.rstrip('/'), 'Content_Type': 'application/json'} if method == 'POST' else {}
    connection.request(method, path, None if words is None else json.dumps(words),
                       {name.replace('_', '-'): value for name, value in {**usual, **headers}.items() if value is not None})  # fmt: skip
    answer = connection.getresponse()
    body = answer.read()
    connection.close()
    return answer.status, body


def same(values, column):
    """Does JSON hold this column: NaN as null, all else to the last bit?"""
    return [None if value != value else value for value in np.asarray(column).ravel().tolist()] == values


# --- loaded only when asked for ---------------------------------------------------


def test_nothing_of_it_is_loaded_without_it():
    code = 'import gearsweep, sys; gearsweep.Case("").changed(pinion={"teeth": 20}); import gearsweep.__main__; print(*sys.modules)'
    loaded = subprocess.run([sys.executable, '-c', code], capture_output=True, text=True, check=True).stdout.split()
    assert 'gearsweep.core.case' in loaded
    assert not [name for name in loaded if name.startswith('gearsweep.panel') or name in ('http.server', 'webbrowser', 'matplotlib')]


def test_it_needs_nothing_but_what_the_package_needs():
    code = 'import gearsweep.panel, sys; print(*(name.partition(".")[0] for name in sys.modules))'
    loaded = set(subprocess.run([sys.executable, '-c', code], capture_output=True, text=True, check=True).stdout.split())
    assert loaded - set(sys.stdlib_module_names) - {'numpy', 'gearsweep', '__main__'} == {
        name for name in loaded if name.startswith(('_distutils_hack', 'sitecustomize', 'usercustomize', '__mp', '_cython', 'cython'))
    }


# --- cases ------------------------------------------------------------------------


def test_the_papers_cases_are_those_of_the_sources():
    assert sorted(path.name for path in DATA.glob('*.nml')) == CASES
    for name in CASES:
        assert (DATA / name).read_bytes() == (ROOT / 'data' / name).read_bytes()


@pytest.mark.parametrize('name', CASES)
def test_fields_show_what_the_library_reads(name, api):
    """Each value that the text gives is the one in effect, where that is of one kind with it."""
    answer = api.open('data', name)
    assert answer['error'] is None and answer['given']
    for group, keys in answer['given'].items():
        for key, words in keys.items():
            if key in answer['values'].get(group, {}):
                raw, in_effect = words.replace(' ', ''), answer['values'][group][key].replace(' ', '')
                assert raw == in_effect or plain(raw) == plain(in_effect), (group, key)


def plain(words):
    """The values of a list, with repeats written out."""
    found = []
    for word in words.split(','):
        count, _, value = word.rpartition('*')
        found += [float(value)] * int(count or 1) if value.replace('.', '').replace('-', '').replace('e', '').isdigit() else [value]
    return found


def test_what_is_typed_is_shown_as_it_is_typed_whatever_it_is():
    assert assignments("&pinion teeth = 2x5 ! teeth = 7\n addendum= 1, / gear teeth = 3 &gear teeth=4, 5 tip_diameter_mm =1e2/") == {
        'pinion': {'teeth': '2x5', 'addendum': '1,'}, 'gear': {'teeth': '4, 5', 'tip_diameter_mm': '1e2'}}  # fmt: skip
    assert assignments("&case title = 'it''s / & !a = 3' /") == {'case': {'title': "'it''s / & !a = 3'"}}
    assert assignments('no group a = 3') == {} == assignments('')


def test_a_change_is_that_of_the_library(api):
    text = api.open('data', 'case1.nml')['text']
    assert api.change(text, 'data', 'pinion', 'teeth', '31')['text'] == Case(text).changed(pinion={'teeth': 31}).text
    assert api.change(text, 'data', 'relief', 'amount_um', '0, 7.5')['given']['relief']['amount_um'] == '0, 7.5'
    assert api.change(text, 'data', 'case', 'title', "the mill's")['text'] == Case(text).changed(case={'title': "the mill's"}).text
    assert 'damping_ratio' not in api.change(text, 'data', 'dynamics', 'damping_ratio', None)['given']['dynamics']
    assert api.change(text, 'data', 'mesh', 'model', 'weber')['given']['mesh']['model'] == "'weber'"


@pytest.mark.parametrize('value', ['3', 'abc', '25 30', '1e99', '/', '25 ! x', '25\n&gear', "'"])
def test_bad_values_get_the_librarys_message_beside_their_key(value, api):
    text = api.open('data', 'case1.nml')['text']
    answer = api.change(text, 'data', 'pinion', 'teeth', value)
    assert (answer['error']['group'], answer['error']['key']) == ('pinion', 'teeth')
    assert answer['error']['message'].startswith('&pinion teeth = ')
    if answer.get('unchanged'):
        assert answer['text'] == text
    else:
        with pytest.raises(Error) as expected:
            Case(answer['text']).complete()
        assert answer['error']['message'] == str(expected.value)


def test_all_keys_are_described():
    about = json.loads(gearsweep.core.library.describe('keys'))
    assert description()['keys'] == about and len(about) > 100


# --- runs -------------------------------------------------------------------------


@pytest.mark.parametrize('text', [GEARED, PRESCRIBED, PARTIAL])
def test_numbers_are_those_of_the_package(text, api):
    study = api.study(api.run(text, '')['study'])
    answer = api.run(text, '', columns=dict.fromkeys(study.tables), earlier='none')
    for table in gearsweep.run(Case(text)) if text is not PARTIAL else study:
        if not all(table.is_reproducible.values()):
            continue
        for column in table:
            assert same(answer['columns'][table.name][column], table._read(column)), (table.name, column)
    assert answer['report'] == study.report()
    assert bool(answer['partial']) == (text is PARTIAL)


def test_a_run_from_the_last_gives_the_same_bits_and_takes_its_place(api):
    text = Case(GEARED).changed(dynamics={'damping_ratio': 0.2}).text
    first = api.run(GEARED, '')
    again = api.run(text, '', ['sweep'], earlier=first['study'], drop=first['study'], columns={'sweep': ['dynamic_factor', 'none']})
    assert list(again['columns']['sweep']) == ['dynamic_factor']
    assert same(again['columns']['sweep']['dynamic_factor'], gearsweep.run(Case(text), 'sweep').sweep.dynamic_factor)
    assert 'taken over' in api.study(again['study']).log
    with pytest.raises(StudyDropped):
        api.table(first['study'], 'sweep')


def test_studies_have_names_that_no_other_window_knows(api):
    names = {api.run(PRESCRIBED, '', ['mesh'])['study'] for _ in range(3)}
    assert len(names) == 3 and all(len(name) >= 16 for name in names)
    with pytest.raises(StudyDropped):
        api.table('x', 'sweep')


def test_the_forty_first_study_puts_out_the_first(api):
    study = gearsweep.run(Case(PRESCRIBED), 'mesh')
    names = [api._keep(study, '') for _ in range(40)]
    assert api.study(names[0]) is study  # and is now the one that was looked at last
    names.append(api._keep(study, ''))
    with pytest.raises(StudyDropped):
        api.study(names[1])
    assert all(api.study(name) is study for name in [names[0], *names[2:]])


def test_a_run_is_stopped_from_another_thread(api):
    ended = []

    def run():
        try:
            api.run(LONG, '', run='it')
        except Error as error:
            ended.append(error.code)

    thread = threading.Thread(target=run)
    thread.start()
    deadline = time.monotonic() + 60
    while not api.stop('it'):  # until it has begun
        assert time.monotonic() < deadline
        time.sleep(0.01)
    thread.join(60)
    assert ended == [Code.INTERRUPTED] and not api.stop('it')


@pytest.mark.parametrize('changes', [{}, {'pair': {'pressure_angle_deg': 25, 'coast_angle_deg': 20}}, {'gear': {'teeth': 900}}])
def test_drawn_teeth_touch_on_the_path_of_contact_in_every_phase(changes, api):
    """Flank and path are known apart: the outline turns, and must go through the points of the line of action."""
    case = Case(GEARED).changed(**changes)
    study, scene = gearsweep.run(case, 'geometry'), api.run(case.text, '', ['mesh'], teeth=True)['scene']
    size = 0.002 * scene['module']  # the chords lie off the flank by less
    for s in (0.05, 0.4, 0.9, scene['contact_ratio'] - 0.05):
        touch = contact_path(study, np.array([s]))[0]
        for gear, way, centre in (('pinion', 1, 0.0), ('gear', -1, scene['centre'])):
            about = scene[gear]
            angle = way * about['turn'] * s
            cos, sin = np.cos(angle), np.sin(angle)
            tooth = np.array(about['tooth']) @ np.array([[cos, -sin], [sin, cos]]) + [0, centre]
            assert distance(touch, tooth) < size, (gear, s)
    assert scene['pinion']['turn'] == pytest.approx(2 * np.pi / 21, rel=1e-12)  # a mesh period is a pitch


def distance(point, line):
    """Of a point from a line of chords."""
    start, side = line[:-1], np.diff(line, axis=0)
    length = (side**2).sum(axis=1)
    part = np.clip(((point - start) * side).sum(axis=1) / np.where(length > 0, length, 1), 0, 1)
    return np.hypot(*(start + part[:, None] * side - point).T).min()


def test_the_gap_drawn_is_the_backlash_that_the_case_states(api):
    case = Case(GEARED)
    tight, wide = (api.run(text, '', ['mesh'], teeth=True)['scene'] for text in (case.text, case.changed(pair={'backlash_um': 80}).text))
    assert wide['pinion'] == tight['pinion']
    teeth = [np.array(scene['gear']['tooth']) for scene in (tight, wide)]
    radius = scene_base_radius(tight)
    moved = np.arctan2(teeth[1][:, 1], teeth[1][:, 0]) - np.arctan2(teeth[0][:, 1], teeth[0][:, 0])
    # Turned by the backlash over the base radius, on one side of the tooth only.
    assert np.abs(moved).max() == pytest.approx(0.08 / radius, rel=1e-3)
    assert (np.abs(moved) < 1e-9).any() and np.allclose(np.hypot(*teeth[0].T), np.hypot(*teeth[1].T), atol=2e-6)


def scene_base_radius(scene):
    return scene['base_pitch'] * scene['gear']['teeth'] / (2 * np.pi)


def test_a_prescribed_mesh_has_no_teeth(api):
    assert api.run(PRESCRIBED, '', ['mesh'], teeth=True)['scene'] is None


# --- files that a case names ------------------------------------------------------

TABLE = Case(PRESCRIBED).changed(mesh={'coefficients': None, 'model': 'table'})
CONTENT = '0 400\n0.8 500\n1.6 400\n'


def test_files_are_read_in_the_cases_folder(tmp_path, api):
    (tmp_path / 'table.txt').write_text(CONTENT)
    text = TABLE.changed(mesh={'file': 'table.txt'}).text
    answer = api.run(text, 'folder', ['mesh'], columns={'mesh': None})
    assert max(answer['columns']['mesh']['pair_stiffness_n_um']) == pytest.approx(500)


@pytest.mark.parametrize('name', ['{outside}/table.txt', '../outside/table.txt', 'sub/../../outside/table.txt', 'link.txt', 'linked/table.txt'])
def test_files_elsewhere_are_refused(name, tmp_path):
    (tmp_path / 'outside').mkdir()
    (tmp_path / 'outside/table.txt').write_text(CONTENT)
    folder = tmp_path / 'cases'
    (folder / 'sub').mkdir(parents=True)
    (folder / 'link.txt').symlink_to(tmp_path / 'outside/table.txt')
    (folder / 'linked').symlink_to(tmp_path / 'outside')
    text = TABLE.changed(mesh={'file': name.format(outside=tmp_path / 'outside')}).text
    gearsweep.run(Case(text, str(folder)), 'mesh')  # the library itself would read it
    with pytest.raises(Error, match=r'&mesh file = .*: must be in the folder of the case'):
        Api(CaseFolders(folder), {}).run(text, 'folder', ['mesh'])


def test_a_case_from_the_browser_names_no_files(tmp_path, api, monkeypatch):
    (tmp_path / 'table.txt').write_text(CONTENT)
    monkeypatch.chdir(tmp_path)
    with pytest.raises(Error, match='this case has no folder'):
        api.run(TABLE.changed(mesh={'file': 'table.txt'}).text, '', ['mesh'])


def test_every_key_that_says_that_it_names_a_file_is_watched():
    saying = {(key['group'], key['name']) for key in description()['keys'] if key['meaning'].startswith('file ')}
    assert saying and saying <= set(file_keys())


def test_only_cases_in_the_folder_are_opened(tmp_path):
    folder = tmp_path / 'cases'
    folder.mkdir()
    (tmp_path / 'other.nml').write_text(PRESCRIBED)
    (folder / 'mine.nml').write_text(PRESCRIBED)
    (folder / 'link.nml').symlink_to(tmp_path / 'other.nml')
    (folder / 'notes.txt').write_text('x')
    api = Api(CaseFolders(folder), {})
    assert [one['name'] for one in api.about()['cases'] if one['place'] == 'folder'] == ['mine.nml']
    assert api.open('folder', 'mine.nml')['text'] == PRESCRIBED
    for name in ('../other.nml', str(tmp_path / 'other.nml'), 'link.nml', 'notes.txt', 'none.nml'):
        with pytest.raises(Error):
            api.open('folder', name)


# --- the server -------------------------------------------------------------------


def test_it_listens_to_this_machine_alone(server):
    assert server.server_address[0] == '127.0.0.1'


@pytest.mark.parametrize('headers', [
    {'Host': 'example.org'}, {'Host': '127.0.0.1:80'}, {'Origin': 'http://example.org'}, {'Origin': 'null'},
    {'Sec_Fetch_Site': 'cross-site'}, {'Content_Type': 'text/plain'}, {'Content_Type': None},
])  # fmt: skip
def test_pages_of_others_are_refused(headers, server):
    assert ask(server, 'POST', '/call/check', {'text': '', 'place': ''}, **headers)[0] == 403
    if not headers.keys() & {'Content_Type', 'Origin'}:
        assert ask(server, 'GET', '/', **headers)[0] == 403
    assert ask(server, 'POST', '/call/check', {'text': '', 'place': ''})[0] == 200


def test_only_the_pages_own_files_are_served(server):
    for path in ('/', '/static/app.js', '/static/style.css', '/static/icon.svg'):
        assert ask(server, 'GET', path)[0] == 200
    for path in ('/static/../api.py', '/static/%2e%2e/api.py', '/static/', '/static/none.js', '/api.py', '/call/about', '/file/none'):
        assert ask(server, 'GET', path)[0] in (400, 404, 410)
    for path in ('/call/_keep', '/call/study', '/about', '/call/'):
        assert ask(server, 'POST', path, {})[0] == 404


def test_requests_that_are_none_are_refused(server):
    assert ask(server, 'POST', '/call/check', [1])[0] == 400
    assert ask(server, 'POST', '/call/check', {'nothing': 1})[0] == 400
    assert ask(server, 'POST', '/call/check', {'text': 5, 'place': ''})[0] == 400
    assert ask(server, 'POST', '/call/check', {}, Content_Length='999999999999')[0] == 400


def test_requests_without_bounds_get_an_answer(server):
    assert ask(server, 'POST', '/call/check', {}, Content_Length='-1')[0] == 400
    assert ask(server, 'GET', '/static/' + 5000 * 'x' + '.js')[0] == 404
    connection = http.client.HTTPConnection('127.0.0.1', server.server_port, timeout=60)
    connection.request('POST', '/call/check', 100_000 * '[', {'Origin': server.address.rstrip('/'), 'Content-Type': 'application/json'})
    assert connection.getresponse().status == 400
    connection.close()


def test_connections_that_say_nothing_are_ended(server, monkeypatch):
    assert 0 < Handler.timeout <= 60
    monkeypatch.setattr(Handler, 'timeout', 0.2)
    with socket.create_connection(('127.0.0.1', server.server_port), timeout=60) as silent:
        silent.sendall(b'POST /call/check HTTP/1.1\r\nContent-')
        assert silent.recv(1) == b''


def test_no_more_connections_at_once_than_a_browser_opens(server, monkeypatch):
    """The first is kept, and the last is not: none of them would be ended for saying nothing."""
    monkeypatch.setattr(Handler, 'timeout', 600)
    many = []
    for _ in range(120):
        many.append(socket.create_connection(('127.0.0.1', server.server_port), timeout=300))
        time.sleep(0.01)  # the queue of a server is short, and who finds it full tries again a second later
    assert many[-1].recv(1) == b''
    many[0].settimeout(0.2)
    with pytest.raises(TimeoutError):
        many[0].recv(1)
    for one in many:
        one.close()


def test_runs_wait_for_their_turn_and_can_be_stopped_then(api, monkeypatch):
    """Two at once; the third waits, and ends when it is stopped, before it had begun."""
    begun, ends = [], threading.Event()

    def run_for_long(case, *rest, **words):
        begun.append(case)
        assert ends.wait(60)
        raise Error('done')

    monkeypatch.setattr('gearsweep.panel.api.attempt', run_for_long)
    ended = {}

    def run(name):
        with pytest.raises(Error) as caught:
            api.run(PRESCRIBED, '', run=name)
        ended[name] = str(caught.value)

    threads = [threading.Thread(target=run, args=(name,)) for name in 'abc']
    for thread in threads:
        thread.start()
        time.sleep(0.3)
    assert len(begun) == 2
    assert api.stop('c')
    threads[2].join(60)
    assert ended == {'c': 'stopped before it was done'} and len(begun) == 2
    ends.set()
    for thread in threads:
        thread.join(60)
    assert ended['a'] == ended['b'] == 'done'


def test_eight_requests_at_once_are_all_answered_alike(server):
    case = Case(PRESCRIBED).changed(case={'tasks': 'sweep'}, sweep={'load_rpm': None})

    def at_once(*asked):
        with ThreadPoolExecutor(8) as pool:
            answers = list(pool.map(lambda _: ask(server, *asked), range(8)))
        assert [status for status, _ in answers] == 8 * [200]
        return [body for _, body in answers]

    results = [json.loads(body.splitlines()[-1])['result'] for body in at_once('POST', '/call/run', {'text': case.text, 'place': ''})]
    assert all({**one, 'study': '', 'seconds': 0} == {**results[0], 'study': '', 'seconds': 0} for one in results)
    assert len({one['study'] for one in results}) == 8
    for path in ('table?table=sweep', 'report?'):
        assert len(set(at_once('GET', f'/file/{path}&name=pair&study={results[0]["study"]}'))) == 1


def test_a_run_comes_line_by_line_and_its_files_are_the_programs(server, tmp_path):
    case = Case(PRESCRIBED).changed(case={'tasks': 'sweep'}, sweep={'load_rpm': None})
    status, body = ask(server, 'POST', '/call/run', {'text': case.text, 'place': ''})
    lines = [json.loads(line) for line in body.splitlines()]
    assert status == 200 and all(set(line) == {'done', 'of'} for line in lines[:-1])
    study = lines[-1]['result']['study']
    gearsweep.run(case).write(tmp_path, 'pair')
    status, table = ask(server, 'GET', f'/file/table?study={study}&table=sweep&name=pair')
    assert status == 200 and table == (tmp_path / 'pair.sweep.csv').read_bytes()
    status, everything = ask(server, 'GET', f'/file/all?study={study}&name=..%2Fpair')
    names = {os.path.basename(name): name for name in zipfile.ZipFile(io.BytesIO(everything)).namelist()}
    assert {'_pair.sweep.csv', '_pair.sweep.svg', '_pair.sweep.png', '_pair.html', '_pair.nml'} <= set(names)
    assert not any('/..' in name or name.startswith(('/', '../')) for name in names.values())
    assert ask(server, 'GET', '/file/table?study=none&table=sweep')[0] == 410


def test_a_bad_case_is_an_error_line(server):
    body = ask(server, 'POST', '/call/run', {'text': '&pinion teeth = 3 /', 'place': ''})[1]
    assert json.loads(body)['error']['code'] == 'INPUT'


def test_the_report_is_that_of_the_package(api, tmp_path):
    answer = api.run(GEARED, '', ['optimum', 'mesh'])
    study = api.study(answer['study'])
    study.write_report(tmp_path / 'report.html')
    assert files.download(api, 'report', {'study': answer['study'], 'name': 'x'}).content == (tmp_path / 'report.html').read_bytes()


# --- the command ------------------------------------------------------------------


def test_its_command_line(tmp_path):
    assert front.arguments([]) == ('', None, True)
    assert front.arguments(['x.nml', '--port', '0', '--no-browser']) == ('x.nml', 0, False)
    for words in (['--port'], ['--port', '70000'], ['--port', 'x'], ['--none'], ['a', 'b']):
        with pytest.raises(Error) as error:
            front.arguments(words)
        assert error.value.code == Code.USAGE
    with pytest.raises(Error):
        front.api_of(str(tmp_path / 'none.nml'))
    (tmp_path / 'mine.nml').write_text(PRESCRIBED)
    assert front.api_of(str(tmp_path / 'mine.nml')).about()['start'] == {'place': 'folder', 'name': 'mine.nml'}


def test_it_opens_browsers_with_windows_only(monkeypatch):
    opened = []

    class Window:
        def open(self, address):
            opened.append(address)
            return True

    monkeypatch.setattr(webbrowser, 'get', Window)
    assert front.show('http://127.0.0.1:1/') and opened == ['http://127.0.0.1:1/']
    monkeypatch.setattr(webbrowser, 'get', lambda: webbrowser.GenericBrowser('false'))  # in a terminal
    assert not front.show('http://127.0.0.1:1/')

    def none():
        raise webbrowser.Error('could not locate runnable browser')

    monkeypatch.setattr(webbrowser, 'get', none)
    assert not front.show('http://127.0.0.1:1/')


def test_a_port_that_is_taken_is_reported_or_replaced(server):
    with pytest.raises(Error, match=f'--port {server.server_port}: '):
        front.listen(server.api, server.server_port)


def test_it_ends_with_ctrl_c(tmp_path):
    words = [sys.executable, '-m', 'gearsweep', 'panel', '--no-browser', '--port', '0']
    process = subprocess.Popen(words, cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    try:
        assert process.stdout.readline().startswith('The panel is at http://127.0.0.1:')
        process.send_signal(2)
        assert process.wait(30) == 0 and process.stderr.read() == ''
    finally:
        process.kill()
        process.communicate()
