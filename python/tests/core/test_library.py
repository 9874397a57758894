"""The library's calls: errors, odd arguments, threads, what an import loads, and that all languages agree in their lists."""

import concurrent.futures
import copy
import fractions
import importlib.metadata
import importlib.util
import inspect
import multiprocessing
import os
import pickle
import re
import subprocess
import sys
import threading
import time
import warnings

import numpy as np
import pytest
from conftest import GEARED, PARTIAL, PRESCRIBED, ROOT, bits

import gearsweep
from gearsweep import Case, Code, Error


def fails(code, match, call, *arguments, **options):
    with pytest.raises(Error, match=match) as caught:
        call(*arguments, **options)
    assert caught.value.code == code
    assert isinstance(caught.value.code, Code)


def test_errors_carry_code_and_message():
    run = gearsweep.run
    fails(Code.INPUT, 'did you mean module_mm', run, Case('&pair modul_mm = 3 /'), 'geometry')
    fails(Code.INPUT, 'there is no group', run, Case(''))
    fails(Code.INPUT, "'sweeep': must be one of", run, Case(PRESCRIBED), 'sweeep')
    fails(Code.INPUT, 'prescribed mesh', run, Case(PRESCRIBED), 'geometry')
    fails(Code.INPUT, 'prescribed mesh', run, Case(PRESCRIBED), 'modal')
    fails(Code.INPUT, 'rpm_first: missing', run, Case(GEARED).changed(sweep={'rpm_first': None}), 'sweep')
    fine = Case(GEARED).changed(section={'teeth': 0, 'fixed': 'rim', 'elements_across': 200})
    fails(Code.MEMORY, 'GB', run, fine, 'modal')
    assert not issubclass(Error, OSError) and str(Error('words')) == 'words'


def test_names_of_earlier_versions_say_what_they_are_now():
    for name, now in gearsweep._NOW.items():
        with pytest.raises(AttributeError, match=re.escape(f'it is {now} now')):
            getattr(gearsweep, name)


def test_partial_results_warn():
    with pytest.warns(gearsweep.PartialWarning, match='no answer'):
        study = gearsweep.run(Case(PARTIAL), 'sweep')
    assert not study.is_complete
    missing = np.isnan(study.sweep.dynamic_factor)
    assert missing.any() and not missing.all()
    np.testing.assert_array_equal(missing, study.sweep.status == 'unresolved')
    with warnings.catch_warnings():
        warnings.simplefilter('error')
        with pytest.raises(gearsweep.PartialWarning):
            gearsweep.run(Case(PARTIAL))


@pytest.mark.parametrize('threads', [-1, 1025, 10**6, 2**31, 10**30, -(10**30)])
def test_threads_out_of_range(threads):
    fails(Code.INPUT, 'threads', gearsweep.run, Case(PRESCRIBED), threads=threads)


@pytest.mark.parametrize('threads', ['2', 1.5, None])
def test_threads_of_another_type(threads):
    with pytest.raises(TypeError):
        gearsweep.run(Case(PRESCRIBED), threads=threads)


@pytest.mark.parametrize('case', ['&pair /', None, 3, b'&pair /', ['&pair /']])
def test_case_of_another_type(case):
    with pytest.raises(TypeError):
        gearsweep.run(case)


def test_long_texts():
    """Text of any length comes whole."""
    case = Case(PRESCRIBED).changed(relief={'amount_um': np.linspace(0, 10, 3000)})
    assert case.get('relief', 'amount_um')[-1] == 10
    assert len(case.complete().changed(case={'title': 'x' * 50_000}).get('case', 'title')) == 50_000


def test_any_number_of_callers():
    cases = [Case(GEARED), Case(PRESCRIBED), Case(GEARED).changed(pinion={'teeth': 22})]
    expected = [bits(gearsweep.run(case)) for case in cases]
    with concurrent.futures.ThreadPoolExecutor(6) as pool:
        found = list(pool.map(lambda i: bits(gearsweep.run(cases[i % 3], threads=1 + i % 2)), range(12)))
    assert found == expected * 4


def test_any_number_of_threads_read_one_study():
    study = gearsweep.run(Case(GEARED))
    expected = bits(pickle.loads(pickle.dumps(study)))
    fresh = gearsweep.run(Case(GEARED))
    with concurrent.futures.ThreadPoolExecutor(8) as pool:
        found = list(pool.map(lambda _: bits(fresh), range(16)))
    assert found == [expected] * 16


def test_studies_and_tables_can_be_sent():
    """To another process, as the bits they are; what only the library's memory has is refused with its reason."""
    study = gearsweep.run(Case(GEARED))
    for sent in (pickle.loads(pickle.dumps(study)), copy.deepcopy(study)):
        assert bits(sent) == bits(study) and sent.report() == study.report() and repr(sent) == repr(study)
        with pytest.raises(Error, match=r'holds its tables only.*to write'):
            sent.write('out', 'pair')
        with pytest.raises(Error, match=r'holds its tables only.*to start'):
            gearsweep.run(study.case, earlier=sent)
    point = pickle.loads(pickle.dumps(study.sweep.at(rpm=4000)))
    assert point.study.tables == ('sweep',) and point.case == study.case
    np.testing.assert_array_equal(point.dynamic_factor, study.sweep.dynamic_factor[:, 2])


def test_a_call_does_not_hold_the_lock():
    """Other threads get their turn while a sweep runs."""
    case = Case(PRESCRIBED).changed(sweep={'rpm_first': 400, 'rpm_step': 2}, case={'tasks': 'sweep'})
    caller = threading.Thread(target=gearsweep.run, args=(case,), kwargs={'threads': 1})
    turns = 0
    caller.start()
    while caller.is_alive():
        time.sleep(0.001)
        turns += 1
    assert turns > 10


@pytest.mark.skipif(not hasattr(os, 'fork'), reason='this system does not fork')
def test_forked_processes():
    """OpenMP's threads do not survive a fork; a child that waits for them would hang."""
    expected = factors(2)
    with multiprocessing.get_context('fork').Pool(2) as pool:
        found = pool.map_async(factors, [0, 2]).get(timeout=120)
    np.testing.assert_array_equal(found, [expected] * 2)


def factors(threads):
    return gearsweep.run(Case(PRESCRIBED), 'sweep', threads=threads).sweep.dynamic_factor


HEAVY = {'matplotlib', 'pandas', 'xarray', 'scipy', 'gearsweep.plots'}
MAIN = "from gearsweep.__main__ import main; main([{case!r}, '--quiet', '--out', {out!r}, {more}])"


@pytest.mark.parametrize(
    ('program', 'needed'),
    [
        ('import gearsweep', set()),
        ('import gearsweep; gearsweep.run(gearsweep.Case.read({case!r}))', set()),
        (MAIN.replace('{more}', "'--no-pictures'"), set()),
        (MAIN.replace('{more}', "'--threads', '1'"), {'matplotlib', 'gearsweep.plots'}),
        ("import gearsweep; gearsweep.run(gearsweep.Case.read({case!r}), 'sweep').sweep.to_pandas()", {'pandas'}),
        ("import gearsweep; gearsweep.run(gearsweep.Case.read({case!r}), 'sweep').sweep.to_xarray()", {'pandas', 'xarray'}),
    ],
)
def test_only_what_is_needed_is_loaded(program, needed, tmp_path):
    """xarray itself loads pandas, and SciPy where that is installed."""
    (tmp_path / 'case.nml').write_text(PRESCRIBED)
    code = program.format(case=str(tmp_path / 'case.nml'), out=str(tmp_path))
    done = subprocess.run([sys.executable, '-c', code + '; import sys; print(*sys.modules)'], capture_output=True, text=True, check=False)
    loaded = set(done.stdout.split())
    assert 'gearsweep' in loaded, done.stderr
    assert (HEAVY - {'scipy'} if 'xarray' in needed else HEAVY) & loaded == needed


def test_one_version():
    version = re.search(r'^version = "(.*)"', (ROOT / 'fpm.toml').read_text(), re.MULTILINE).group(1)
    assert gearsweep.__version__ == version
    assert importlib.metadata.version('gearsweep') == version
    assert f"version = '{version}'" in (ROOT / 'src/base/version.f90').read_text()


def enumeration(prefix, names):
    header = (ROOT / 'include/gearsweep.h').read_text()
    return {name: int(re.search(rf'\b{prefix}{name} = (\d+)', header).group(1)) for name in names}


def test_the_stub_is_that_of_the_tables():
    spec = importlib.util.spec_from_file_location('stub', ROOT / 'python/tools/stub.py')
    stub = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(stub)
    assert stub.STUB.read_text(encoding='utf-8') == stub.text(), 'run python python/tools/stub.py'


def test_codes_are_those_of_the_header():
    assert enumeration('GSC_', Code.__members__) == dict(Code.__members__)


def test_signatures_are_those_of_the_flat_layer():
    """Names, order, and that no double precision is taken for single."""

    def heads(path):
        text = re.sub(r'&\s*\n\s*&?', '', path.read_text())
        return re.findall(r'^ *subroutine (gs_\w+)\(([^)]*)\)', text, re.MULTILINE)

    ours = {name: re.sub(r'\s', '', words) for name, words in heads(ROOT / 'python/gearsweep/flat.pyf')}
    theirs = {name: re.sub(r'\s', '', words) for name, words in heads(ROOT / 'src/api/flat_calls.f90')}
    assert ours == theirs and len(ours) == 11
    text = (ROOT / 'python/gearsweep/flat.pyf').read_text()
    assert not re.search(r'^\s*real', text, re.MULTILINE)
    assert text.count('threadsafe') == len(ours)


def test_every_public_name_is_described():
    for name in gearsweep.__all__:
        thing = getattr(gearsweep, name)
        assert inspect.getdoc(thing), name
        if inspect.isfunction(thing):
            assert all(p.annotation is not p.empty for p in inspect.signature(thing).parameters.values()), name
    with pytest.raises(AttributeError):
        _ = gearsweep.no_such_name


def test_numbers_that_no_case_has():
    """Of an array nothing is lost: imaginary parts and masks are refused, not left out."""
    case = Case(PRESCRIBED)
    with pytest.raises(Error):
        case.changed(dynamics={'damping_ratio': fractions.Fraction(10**400)})
    masked = np.ma.array([1000.0, 2000.0, 3000.0], mask=[False, True, False])
    for values in (masked, np.array([1j]), [0, None]):
        with pytest.raises(TypeError):
            case.changed(relief={'amount_um': values})
