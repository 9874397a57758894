"""Results in files and tables."""

import dataclasses
import os

import numpy as np
import pytest
from conftest import GEARED, PARTIAL

import gearsweep
from gearsweep import Case, Code, Error


@pytest.fixture(scope='module')
def study():
    return gearsweep.run(Case(GEARED, 'some/folder'))


def alike(one, two):
    assert type(one) is type(two) and one.case == two.case and one.version == two.version
    for name in one.units:
        a, b = getattr(one, name), getattr(two, name)
        assert type(a) is type(b), name
        assert np.asarray(a).dtype == np.asarray(b).dtype and np.shape(a) == np.shape(b), name
        assert np.asarray(a).tobytes() == np.asarray(b).tobytes(), name


def test_study_comes_back(study, tmp_path):
    study.save(tmp_path / 'all.npz')
    back = gearsweep.read(tmp_path / 'all.npz')
    assert isinstance(back, gearsweep.Study) and back.case == study.case
    for field in dataclasses.fields(study)[2:]:
        alike(getattr(study, field.name), getattr(back, field.name))
    assert os.listdir(tmp_path) == ['all.npz']
    with pytest.raises(ValueError):
        back.sweep.rpm[0] = 0


@pytest.mark.filterwarnings('ignore::gearsweep.PartialWarning')
def test_result_comes_back(tmp_path):
    """With its NaN, and a case of any bytes."""
    sweep = gearsweep.sweep(Case(PARTIAL + '! \u00fc \udcff\r\n'))
    path = str(tmp_path / 'sweep')
    sweep.save(path)
    back = gearsweep.read(path)
    alike(sweep, back)
    assert np.isnan(back.dynamic_factor).any() and not back.is_complete


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
    study.mesh.save(tmp_path / 'x')
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


def test_pandas(study):
    table = study.sweep.to_pandas()
    assert list(table.relief_um) == [0] * 13 + [10] * 13 and list(table.rpm[:13]) == list(study.sweep.rpm)
    np.testing.assert_array_equal(table.dynamic_factor, study.sweep.dynamic_factor.T.ravel())
    assert table.status[0] == 'ok' and table.attrs['units']['rpm'] == '1/min'
    assert table.attrs['case'] == GEARED and table.attrs['version'] == gearsweep.__version__
    table = study.static.to_pandas()
    assert list(table.columns) == ['side', 'relief_um', 's', 'radius_mm', 'share', 'sigma_mpa', 'tension_mpa',
                                   'tension_deg', 'compression_mpa', 'compression_deg', 'estimate']  # fmt: skip
    np.testing.assert_array_equal(table.sigma_mpa, study.static.sigma_mpa.transpose(2, 1, 0).ravel())
    assert len(study.mesh.to_pandas()) == len(study.mesh.s)
    assert study.optimum.to_pandas().attrs['best_um'] == study.optimum.best_um
    for part in (study.geometry, study.motion, study.load, study.section, study.modal):
        assert len(part.to_pandas()) > 0


def test_xarray(study):
    data = study.sweep.to_xarray()
    assert data.dynamic_factor.dims == ('rpm', 'relief_um')
    assert float(data.dynamic_factor.sel(rpm=4000, relief_um=10)) == study.sweep.dynamic_factor[2, 1]
    assert data.residual.attrs['units'] == 'static deflection' and data.attrs['case'] == GEARED
    data = study.static.to_xarray()
    assert data.parts_mpa.sel(part='xy', side='coast').shape == study.static.share.shape
    assert data.attrs['iso_mpa'] == study.static.iso_mpa
    for part in vars(study).values():
        if isinstance(part, gearsweep.Result):
            found = part.to_xarray()
            for name, dims in part.dims.items():
                if dims:
                    np.testing.assert_array_equal(found[name], getattr(part, name))
