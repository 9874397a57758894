"""The transmission error as a sound: tones of known frequency and amplitude, and refusals."""

import gc
import re
import sys
import wave

import numpy as np
import pytest

import gearsweep
from gearsweep import Case

#: Two pairs carry at all times, and are equally stiff everywhere: the mesh is one spring of 600 N/um between masses of 0.8 kg.
EVEN = Case("""&case tasks = 'as_built' / &pinion teeth = 20 effective_mass_kg = 0.8 / &gear teeth = 40 effective_mass_kg = 0.8 /
&load normal_force_n = 6000 / &mesh model = 'polynomial' contact_ratio = 2 coefficients = 300 /
&dynamics damping_ratio = 0.1 / &sweep rpm_first = 18000 rpm_last = 18000 rpm_step = 1 /
&as_built turn_rpm = 6000, 18000 / &deviations pinion_runout_um = 20 pinion_runout_phase_deg = 0 /""")
NATURAL_HZ = np.sqrt(600e6 / 0.4) / (2 * np.pi)


@pytest.fixture(scope='module')
def eccentric():
    return gearsweep.run(EVEN)


@pytest.fixture(scope='module')
def both():
    """The gear turns half as fast, and its run-out is three times as large."""
    return gearsweep.run(EVEN.changed(deviations={'gear_runout_um': 60, 'gear_runout_phase_deg': 30}))


def read(path):
    with wave.open(str(path), 'rb') as file:
        assert (file.getnchannels(), file.getsampwidth(), file.getframerate()) == (1, 2, 44100)
        return np.frombuffer(file.readframes(file.getnframes()), '<i2')


def tones(samples):
    """Amplitude (of 32767) at 0, 1, 2 ... Hz, of a sound of one second."""
    parts = np.abs(np.fft.rfft(samples)) / len(samples) * 2
    parts[0] /= 2
    return parts


def amplitude(half_runout_um, hz):
    """The mass on a spring whose foot moves, far below its resonance, where damping does not count."""
    return half_runout_um / (1 - (hz / NATURAL_HZ) ** 2)


@pytest.mark.parametrize('rpm, shaft_hz', [(6000, 100), (18000, 300)])
def test_an_eccentric_pinion_is_a_tone_of_its_shaft(eccentric, tmp_path, rpm, shaft_hz):
    scale = gearsweep.write_sound(eccentric, tmp_path / 'tone.wav', rpm=rpm, seconds=1)
    samples = read(tmp_path / 'tone.wav')
    assert len(samples) == 44100 and np.abs(samples).max() == 32767
    parts = tones(samples)
    assert parts.argmax() == shaft_hz
    assert scale == pytest.approx(amplitude(10, shaft_hz), rel=1e-3)
    assert parts[shaft_hz] / 32767 * scale == pytest.approx(amplitude(10, shaft_hz), rel=1e-3)
    others = np.delete(parts, shaft_hz)
    assert others.max() < 0.002 * 32767  # also no mean
    assert (np.diff(np.sign(samples[samples != 0].astype(int))) > 0).sum() in (shaft_hz - 1, shaft_hz)


def test_two_eccentric_gears_are_two_tones_as_their_run_outs(both, tmp_path):
    scale = gearsweep.write_sound(both, tmp_path / 'tones.wav', relief_um=0, rpm=18000, seconds=1)
    parts = tones(read(tmp_path / 'tones.wav')) / 32767 * scale
    assert set(np.argsort(parts)[-2:]) == {150, 300}
    assert parts[150] == pytest.approx(amplitude(30, 150), rel=1e-3)
    assert parts[150] / parts[300] == pytest.approx(amplitude(30, 150) / amplitude(10, 300), rel=1e-3)


def test_what_no_sample_can_hold_is_left_out(tmp_path):
    """Of waves of the orders 10 and 100, at 300 turns a second 3 and 30 kHz, the second would be heard as 14.1 kHz."""
    waves = {'pinion_wave_order': [10, 100], 'pinion_wave_um': [1, 1], 'pinion_wave_phase_deg': [0, 0], 'pinion_runout_um': None,
             'pinion_runout_phase_deg': None}  # fmt: skip
    study = gearsweep.run(EVEN.changed(deviations=waves, as_built={'turn_rpm': 18000, 'mesh_orders': 6}))
    orders = study.as_built_orders
    assert orders.dte_amplitude_um[orders.order == 100][0] > 1e-3
    scale = gearsweep.write_sound(study, tmp_path / 'waves.wav', seconds=1)
    parts = tones(read(tmp_path / 'waves.wav')) / 32767 * scale
    assert parts[3000] == pytest.approx(orders.dte_amplitude_um[orders.order == 10][0], rel=0.01)
    assert parts[14100] < 1e-4 * parts[3000]


def test_a_sound_lasts_as_long_as_is_said(eccentric, tmp_path):
    for seconds, samples in ((0.1, 4410), (2.5, 110250)):
        gearsweep.write_sound(eccentric, tmp_path / 'tone.wav', seconds=seconds)
        assert len(read(tmp_path / 'tone.wav')) == samples
    assert [path.name for path in tmp_path.iterdir()] == ['tone.wav']


def test_a_kept_study_sounds_alike(eccentric, tmp_path):
    eccentric.save(tmp_path / 'kept.npz')
    for name, study in (('a', eccentric), ('b', gearsweep.read(tmp_path / 'kept.npz'))):
        gearsweep.write_sound(study, tmp_path / name, seconds=0.1)
    assert (tmp_path / 'a').read_bytes() == (tmp_path / 'b').read_bytes()


def test_what_cannot_be_written_is_refused(eccentric, tmp_path, monkeypatch):
    path = tmp_path / 'tone.wav'
    for seconds in (0, -1, 601, float('nan'), float('inf'), '3'):
        with pytest.raises(ValueError, match=f'seconds = {seconds!r}: must be a number above 0 and at most 600'):
            gearsweep.write_sound(eccentric, path, seconds=seconds)
    for rpm in (0, 9000):  # 0 is at rest
        with pytest.raises(ValueError, match=f'rpm = {rpm}: must be one of 6000, 18000'):
            gearsweep.write_sound(eccentric, path, rpm=rpm)
    for wanted in ('6000', [6000]):
        with pytest.raises(ValueError, match=rf'rpm = {re.escape(repr(wanted))}: must be one of 6000, 18000'):
            gearsweep.write_sound(eccentric, path, rpm=wanted)
    with pytest.raises(ValueError, match='relief_um = 5: must be one of 0'):
        gearsweep.write_sound(eccentric, path, relief_um=5)
    without = gearsweep.run(EVEN.changed(case={'tasks': 'mesh'}, gear={'teeth': None}), 'mesh')
    with pytest.raises(KeyError, match='this study has no table as_built_turn'):
        gearsweep.write_sound(without, path)
    unheard = []
    monkeypatch.setattr(sys, 'unraisablehook', unheard.append)  # what an object's end complains of
    for place, why in ((tmp_path / 'nowhere' / 'tone.wav', 'No such file or directory'), ('', ''), (tmp_path / ('x' * 300), 'File name too long')):
        with pytest.raises(gearsweep.Error, match=f'cannot write .*: {why}'):
            gearsweep.write_sound(eccentric, place)
    gc.collect()
    assert not unheard
    assert not path.exists()
    with pytest.warns(gearsweep.PartialWarning):
        unanswered = gearsweep.run(EVEN.changed(as_built={'turn_rpm': None}, sweep={'rpm_first': 1, 'rpm_last': 1}, dynamics={'damping_ratio': 0.001},
                                                numerics={'steps_per_period': 20}))  # fmt: skip
    with pytest.raises(ValueError, match='rpm: there is none, as no point has a result'):
        gearsweep.write_sound(unanswered, path)
