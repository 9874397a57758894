"""Results in files and tables."""

import os

import numpy as np
import pytest
from conftest import GEARED, PARTIAL, bits

import gearsweep
from gearsweep import Case, Code, Error


@pytest.fixture(scope='module')
def study():
    return gearsweep.run(Case(GEARED, 'some/folder'))


def alike(one, two):
    assert one.tables == two.tables and (one.case, one.version, one.is_complete) == (two.case, two.version, two.is_complete)
    assert bits(one) == bits(two) and repr(one) == repr(two)
    for table, other in zip(one, two):
        assert (table.units, table.meanings, table.dims) == (other.units, other.meanings, other.dims)
        assert [np.asarray(table[name]).dtype for name in table] == [np.asarray(other[name]).dtype for name in other]


def test_study_comes_back(study, tmp_path):
    study.save(tmp_path / 'all.npz')
    back = gearsweep.read(tmp_path / 'all.npz')
    alike(study, back)
    assert back.report() == study.report() and back.log == study.log
    assert os.listdir(tmp_path) == ['all.npz']
    with pytest.raises(ValueError):
        back.sweep.rpm[0] = 0


@pytest.mark.filterwarnings('ignore::gearsweep.PartialWarning')
def test_table_comes_back(tmp_path):
    """Alone, with its NaN, and a case of any bytes."""
    sweep = gearsweep.run(Case(PARTIAL + '! \u00fc \udcff\r\n'), 'sweep').sweep
    path = str(tmp_path / 'sweep')
    sweep.save(path)
    back = gearsweep.read(path)
    assert back.tables == ('sweep',) and back.case == sweep.case and repr(back.sweep) == repr(sweep)
    assert np.isnan(back.sweep.dynamic_factor).any() and not back.is_complete


def test_files_that_are_no_results(study, tmp_path):
    def fails(match):
        with pytest.raises(Error, match=match) as caught:
            gearsweep.read(tmp_path / 'x')
        assert caught.value.code == Code.FILE

    fails('No such file')
    np.savez(tmp_path / 'x.npz', a=1)
    os.rename(tmp_path / 'x.npz', tmp_path / 'x')
    fails('no result')
    np.save(tmp_path / 'x.npy', np.arange(3))
    os.replace(tmp_path / 'x.npy', tmp_path / 'x')
    fails('no result')
    for content in (b'', b'PK\x03\x04', b'text', b'\x80\x04pickle'):
        (tmp_path / 'x').write_bytes(content)
        fails('no result')
    study.motion.save(tmp_path / 'x')
    whole = (tmp_path / 'x').read_bytes()
    (tmp_path / 'x').write_bytes(whole[: len(whole) // 2])
    fails('no result')
    # Bytes that are wrong at any place: the file is read as it was, or refused by its name.
    study.harmonics.save(tmp_path / 'x')
    whole = (tmp_path / 'x').read_bytes()
    refused = 0
    for at in range(0, len(whole), max(1, len(whole) // 400)):
        (tmp_path / 'x').write_bytes(whole[:at] + bytes([whole[at] ^ 0x55]) + whole[at + 1 :])
        try:
            gearsweep.read(tmp_path / 'x')
        except Error as error:
            assert error.code == Code.FILE and str(tmp_path / 'x') in str(error)
            refused += 1
    assert refused > 100
    with pytest.raises(Error, match='cannot write') as caught:
        study.save(tmp_path / 'no' / 'folder')
    assert caught.value.code == Code.FILE


def test_files_of_another_format(study, tmp_path, monkeypatch):
    monkeypatch.setattr('gearsweep.core.study._FORMAT', 1)
    study.motion.save(tmp_path / 'x')
    monkeypatch.undo()
    with pytest.raises(Error, match='format 1 is not known'):
        gearsweep.read(tmp_path / 'x')


def test_pandas(study):
    frame = study.sweep.to_pandas()
    assert list(frame.relief_um) == [0] * 13 + [10] * 13 and list(frame.rpm[:13]) == list(study.sweep.rpm)
    np.testing.assert_array_equal(frame.dynamic_factor, study.sweep.dynamic_factor.ravel())
    assert frame.status[0] == 'ok' and frame.attrs['units']['rpm'] == '1/min'
    assert frame.attrs['case'] == GEARED and frame.attrs['version'] == gearsweep.__version__
    for table in study:
        frame = table.to_pandas()
        assert list(frame.columns) == list(table) and len(frame) == table.rows
        for name in table:
            if table.dims[name] != (name,):
                np.testing.assert_array_equal(frame[name], np.ravel(table[name]))


def test_xarray(study):
    data = study.sweep.to_xarray()
    assert data.dynamic_factor.dims == ('relief_um', 'rpm')
    assert float(data.dynamic_factor.sel(rpm=4000, relief_um=10)) == study.sweep.dynamic_factor[1, 2]
    assert data.rpm.attrs['units'] == '1/min' and data.attrs['case'] == GEARED
    data = study.static.to_xarray()
    assert data.tau_xy_mpa.sel(side='coast').shape == study.static.tau_xy_mpa.shape[:2]
    for table in study:
        data = table.to_xarray()
        for name, dims in table.dims.items():
            assert data[name].dims == dims
            np.testing.assert_array_equal(data[name], table[name])


def test_the_rows_at_a_place(study):
    """As picked by hand: by the closest value of an index column, or its word."""
    sweep, load, static = study.sweep, study.load, study.static
    assert sweep.at(rpm=4100, relief_um=9).dynamic_factor == sweep.dynamic_factor[1, 2]
    assert sweep.at(rpm=4000).dims['status'] == ('relief_um',) and sweep.at(rpm=4000).rpm.tolist() == [4000, 4000]
    np.testing.assert_array_equal(load.at(rpm=6100).dte_um, load.dte_um[load.rpm == 6000])
    np.testing.assert_array_equal(static.at(side='coast', relief_um=10).sigma_mpa, static.sigma_mpa[1, :, 1])
    for wrong, error in (({'side': 'left'}, "'left': must be one of 'drive', 'coast'"), ({'sde': 'drive'}, 'did you mean side')):
        with pytest.raises((ValueError, TypeError), match=error):
            static.at(**wrong)
