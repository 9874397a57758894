"""The border: errors, odd arguments, threads, what an import loads, and that all doors agree in their lists."""

import concurrent.futures
import fractions
import importlib.metadata
import inspect
import multiprocessing
import os
import re
import subprocess
import sys
import threading
import time
import warnings

import numpy as np
import pytest
from conftest import GEARED, PARTIAL, PRESCRIBED, ROOT

import gearsweep
from gearsweep import Case, Code, Error


def fails(code, match, call, *arguments, **options):
    with pytest.raises(Error, match=match) as caught:
        call(*arguments, **options)
    assert caught.value.code == code
    assert isinstance(caught.value.code, Code)


def test_errors_carry_code_and_message():
    fails(Code.INPUT, 'did you mean module_mm', gearsweep.geometry, Case('&pair modul_mm = 3 /'))
    fails(Code.INPUT, 'there is no group', gearsweep.run, Case(''))
    fails(Code.INPUT, 'prescribed mesh .* has none', gearsweep.geometry, Case(PRESCRIBED))
    fails(Code.INPUT, 'prescribed mesh', gearsweep.modal, Case(PRESCRIBED))
    fails(Code.INPUT, 'rpm_first: missing', gearsweep.sweep, Case(GEARED).changed(sweep={'rpm_first': None}))
    fails(
        Code.MEMORY,
        'GB',
        gearsweep.modal,
        Case(GEARED).changed(section={'teeth': 0, 'fixed': 'rim', 'elements_across': 200}),
    )
    assert not issubclass(Error, OSError) and str(Error('words')) == 'words'


def test_partial_results_warn():
    with pytest.warns(gearsweep.PartialWarning, match='no answer'):
        sweep = gearsweep.sweep(Case(PARTIAL))
    assert not sweep.is_complete
    missing = np.isnan(sweep.dynamic_factor)
    assert missing.any() and not missing.all()
    np.testing.assert_array_equal(missing, sweep.status >= gearsweep.Status.UNSTABLE)
    with warnings.catch_warnings():
        warnings.simplefilter('error')
        with pytest.raises(gearsweep.PartialWarning):
            gearsweep.run(Case(PARTIAL))


@pytest.mark.parametrize('threads', [-1, 1025, 10**6])
def test_threads_out_of_range(threads):
    fails(Code.INPUT, 'threads', gearsweep.sweep, Case(PRESCRIBED), threads=threads)


@pytest.mark.parametrize('threads', ['2', 1.5, None, 10**12])
def test_threads_of_another_type(threads):
    with pytest.raises((TypeError, Error)):
        gearsweep.sweep(Case(PRESCRIBED), threads=threads)


@pytest.mark.parametrize('case', ['&pair /', None, 3, b'&pair /', ['&pair /']])
def test_case_of_another_type(case):
    with pytest.raises(TypeError):
        gearsweep.run(case)


def test_work_is_shared_and_guarded():
    case = Case(GEARED)
    work = gearsweep.prepare(case)
    expected = gearsweep.sweep(case).dynamic_factor
    spaced = np.repeat(work, 2)[::2]
    frozen = work.copy()
    frozen.setflags(write=False)
    for same in (work, spaced, frozen, list(work), np.append(work, 7)):
        np.testing.assert_array_equal(gearsweep.sweep(case, work=same).dynamic_factor, expected)
    fails(Code.INPUT, 'prepare it again', gearsweep.sweep, case.changed(pinion={'teeth': 22}), work=work)
    fails(Code.INPUT, 'prepare it again', gearsweep.sweep, case, work=work[:-1])
    fails(Code.INPUT, 'prepare it again', gearsweep.sweep, case, work=work.astype(np.float32))
    fails(Code.INPUT, 'prepare it again', gearsweep.sweep, case, work=np.full(3, np.nan))
    for odd in (work.reshape(2, -1), work + 0j, ['a'], 3.5):
        with pytest.raises(TypeError):
            gearsweep.sweep(case, work=odd)
    # Other reliefs, speeds and damping need no other stiffness.
    changed = case.changed(relief={'amount_um': 5}, dynamics={'damping_ratio': 0.1}, sweep={'rpm_step': 1000})
    np.testing.assert_array_equal(
        gearsweep.sweep(changed, work=work).dynamic_factor, gearsweep.sweep(changed).dynamic_factor
    )


def test_more_rows_than_expected():
    """The load's rows are known only when it is computed: there may be more than the first room."""
    load = gearsweep.load(Case(PRESCRIBED).changed(sweep={'load_rpm': np.linspace(2000, 9000, 40)}))
    assert load.s.size > 10_000 and load.s.shape == load.dte_um.shape
    assert np.unique(load.rpm).size == 40


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


def bits(study):
    parts = (part for part in vars(study).values() if isinstance(part, gearsweep.Result))
    return [np.asarray(getattr(part, name)).tobytes() for part in parts for name in part.units]


def test_a_call_does_not_hold_the_lock():
    """Other threads get their turn while a sweep runs."""
    case = Case(PRESCRIBED).changed(sweep={'rpm_first': 400, 'rpm_step': 2}, case={'tasks': 'sweep'})
    caller = threading.Thread(target=gearsweep.sweep, args=(case,), kwargs={'threads': 1})
    turns = 0
    caller.start()
    while caller.is_alive():
        time.sleep(0.001)
        turns += 1
    assert turns > 10


@pytest.mark.skipif(not hasattr(os, 'fork'), reason='this system does not fork')
def test_forked_processes():
    """OpenMP's threads do not survive a fork; a child that waits for them would hang."""
    expected = gearsweep.sweep(Case(PRESCRIBED), threads=2).dynamic_factor
    with multiprocessing.get_context('fork').Pool(2) as pool:
        found = pool.map_async(factors, [0, 2]).get(timeout=120)
    np.testing.assert_array_equal(found, [expected] * 2)


def factors(threads):
    return gearsweep.sweep(Case(PRESCRIBED), threads=threads).dynamic_factor


HEAVY = {'matplotlib', 'pandas', 'xarray', 'scipy', 'gearsweep.plots', 'gearsweep.tables'}
MAIN = "from gearsweep.__main__ import main; main([{case!r}, '--quiet', '--out', {out!r}, {more}])"


@pytest.mark.parametrize(
    ('program', 'needed'),
    [
        ('import gearsweep', set()),
        ('import gearsweep; gearsweep.run(gearsweep.Case.read({case!r}))', set()),
        (MAIN.replace('{more}', "'--no-pictures'"), set()),
        (MAIN.replace('{more}', "'--threads', '1'"), {'matplotlib', 'gearsweep.plots'}),
        ('import gearsweep; gearsweep.sweep(gearsweep.Case.read({case!r})).to_pandas()', {'pandas', 'gearsweep.tables'}),
        (
            'import gearsweep; gearsweep.sweep(gearsweep.Case.read({case!r})).to_xarray()',
            {'pandas', 'xarray', 'gearsweep.tables'},
        ),
    ],
)
def test_only_what_is_needed_is_loaded(program, needed, tmp_path):
    """xarray itself loads pandas."""
    (tmp_path / 'case.nml').write_text(PRESCRIBED)
    code = program.format(case=str(tmp_path / 'case.nml'), out=str(tmp_path))
    done = subprocess.run([sys.executable, '-c', code + '; import sys; print(*sys.modules)'], capture_output=True, text=True, check=False)
    loaded = set(done.stdout.split())
    assert 'gearsweep' in loaded, done.stderr
    assert HEAVY & loaded == needed


def test_one_version():
    version = re.search(r'^version = "(.*)"', (ROOT / 'fpm.toml').read_text(), re.MULTILINE).group(1)
    assert gearsweep.__version__ == version
    assert importlib.metadata.version('gearsweep') == version
    assert f"version = '{version}'" in (ROOT / 'src/foundation/gearsweep_version.f90').read_text()


def enumeration(prefix, names):
    header = (ROOT / 'include/gearsweep.h').read_text()
    return {name: int(re.search(rf'\b{prefix}{name} = (\d+)', header).group(1)) for name in names}


def test_codes_are_those_of_the_header():
    header = (ROOT / 'include/gearsweep.h').read_text()
    assert enumeration('GSC_', Code.__members__) == dict(Code.__members__)
    names = [name for name in gearsweep.Status.__members__ if name != 'OK']
    assert enumeration('GSC_', names) == {name: gearsweep.Status[name] for name in names}
    assert enumeration('GSC_CONTACT_', gearsweep.Contact.__members__) == dict(gearsweep.Contact.__members__)
    assert len(re.findall(r'GSC_\w+ = \d', header)) == len(Code) + len(gearsweep.Status) + len(gearsweep.Contact)


def test_signatures_are_those_of_the_flat_layer():
    """Names, order, and that no double precision is taken for single."""

    def heads(path):
        text = re.sub(r'&\s*\n\s*&?', '', path.read_text())
        return re.findall(r'^ *subroutine (gs_\w+)\(([^)]*)\)', text, re.MULTILINE)

    ours = {name: re.sub(r'\s', '', words) for name, words in heads(ROOT / 'python/gearsweep/flat.pyf')}
    theirs = {name: re.sub(r'\s', '', words) for path in ('api/gearsweep_calls', 'doors/gearsweep_old_calls')
              for name, words in heads(ROOT / f'src/{path}.f90')}
    assert ours == theirs and len(ours) > 15
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


@pytest.mark.parametrize('huge', [10**30, -(10**30), 2**31])
def test_huge_integers(huge):
    """They are refused with the library's error, not with the overflow of some conversion."""
    case = Case(PRESCRIBED)
    calls = [
        lambda: gearsweep.sweep(case, threads=huge),
        lambda: gearsweep.hysteresis(case, relief=huge),
        lambda: gearsweep.strobe(case, relief=huge),
        lambda: gearsweep.strobe(case, settle=huge),
        lambda: gearsweep.stability_map(case, tongues=huge),
    ]
    for call in calls:
        with pytest.raises(Error):
            call()


def test_numbers_beyond_the_largest_real():
    case = Case(PRESCRIBED)
    for call in (
        lambda: gearsweep.stability_map(case, [1000, 10**400]),
        lambda: gearsweep.hysteresis(case, jump=10**400),
        lambda: gearsweep.strobe(case, start=(10**400, 0)),
        lambda: case.changed(dynamics={'damping_ratio': fractions.Fraction(10**400)}),
    ):
        with pytest.raises(Error):
            call()


def test_nothing_of_an_array_is_lost():
    """Imaginary parts and masks are refused, not left out."""
    case = Case(PRESCRIBED)
    masked = np.ma.array([1000.0, 2000.0, 3000.0], mask=[False, True, False])
    for call in (
        lambda: gearsweep.stability_map(case, [1000, 2000 + 1j]),
        lambda: gearsweep.stability_map(case, masked),
        lambda: gearsweep.stability_map(case, [1000], np.array([0.1 + 0.1j])),
        lambda: gearsweep.hysteresis(case, masked),
        lambda: gearsweep.hysteresis(case, jump=0.02 + 1j),
        lambda: gearsweep.strobe(case, start=(1j, 0)),
        lambda: gearsweep.sweep(case, work=np.ma.array(gearsweep.prepare(case), mask=True)),
        lambda: case.changed(relief={'amount_um': masked}),
        lambda: case.changed(relief={'amount_um': np.array([1j])}),
        lambda: case.changed(relief={'amount_um': [0, None]}),
    ):
        with pytest.raises(TypeError):
            call()
