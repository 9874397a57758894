"""The transmission error of gears as built as a sound."""

from __future__ import annotations

import os
import wave

import numpy as np
from numpy.typing import NDArray

from ..core.files import replacing
from ..core.study import Study
from ..core.table import select_value

#: Samples per second; the value at full scale; largest duration in seconds.
RATE, FULL, LONGEST = 44100, 32767, 600


def write_sound(
    study: Study, path: str | os.PathLike, *, relief_um: float | None = None, rpm: float | None = None, seconds: float = 3
) -> float:
    """Writes the dynamic transmission error of gears as built over time as a sound: a WAV file, mono, 16 bit, 44 100 samples a second.

    The motion over the revolution is repeated; its mean and the frequencies above half of the sample rate are removed.

    Parameters
    ----------
    study : Study
        With the table `as_built_turn`, of the task `as_built`.
    path : path
        The file; an existing one is replaced when the new one is complete.
    relief_um : float, optional
        One of the case's reliefs; otherwise the first.
    rpm : float, optional
        One of the speeds (1/min) of the motion over a revolution; otherwise the first of this relief.
    seconds : float
        Duration: above 0 and at most 600.

    Returns
    -------
    float
        The scale: transmission error in um of the largest sample, 32767.

    Raises
    ------
    KeyError
        The study has no such table.
    ValueError
        There is no such relief or speed, or `seconds` is out of range.
    Error
        The file cannot be written.
    """
    table = study['as_built_turn']
    if isinstance(seconds, str) or not 0 < seconds <= LONGEST:
        raise ValueError(f'seconds = {seconds!r}: must be a number above 0 and at most {LONGEST}')
    relief = select_value(table.relief_um, relief_um, 'relief_um')
    moving = np.isclose(table.relief_um, relief) & (table.rpm > 0)
    speed = select_value(table.rpm[moving], rpm, 'rpm')
    rows = moving & np.isclose(table.rpm, speed)
    tau, error = table.tau[rows], table.transmission_error_um[rows]
    periods = np.ceil(tau[-1])  # mesh periods until it repeats
    duration = periods * 60 / speed * table.pinion_angle_deg[rows][-1] / 360 / tau[-1]
    samples = _resampled(np.interp(np.arange(8 * tau.size) / (8 * tau.size) * periods, tau, error, period=periods), duration, seconds)
    scale = float(np.abs(samples).max())
    pcm = np.round(samples / (scale or 1) * FULL).astype('<i2')
    with replacing(path) as new, open(new, 'wb') as raw, wave.open(raw, 'wb') as file:  # a Wave_write without a file complains at its end
        file.setnchannels(1)
        file.setsampwidth(2)
        file.setframerate(RATE)
        file.writeframes(pcm.tobytes())
    return scale


def _resampled(once: NDArray[np.float64], duration: float, seconds: float) -> NDArray[np.float64]:
    """Samples a periodic function of this duration (s) from values at equal distances: without its mean and too high
    frequencies.
    """
    parts = np.fft.rfft(once)
    parts[0] = 0
    parts[np.arange(parts.size) >= duration * RATE / 2] = 0
    times = np.arange(max(1, round(seconds * RATE))) / RATE
    return np.interp(times, np.arange(once.size) / once.size * duration, np.fft.irfft(parts, once.size), period=duration)
