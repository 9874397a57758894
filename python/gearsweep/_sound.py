"""The transmission error of gears as built as a sound."""

from __future__ import annotations

import os
import wave

import numpy as np
from numpy.typing import NDArray

from ._files import replacing
from .study import Study
from .table import one_of

#: Samples a second; the value at full scale; seconds that there may be at most.
RATE, FULL, LONGEST = 44100, 32767, 600


def write_sound(
    study: Study, path: str | os.PathLike, *, relief_um: float | None = None, rpm: float | None = None, seconds: float = 3
) -> float:
    """Writes the dynamic transmission error of gears as built over time as a sound: a WAV file, mono, 16 bit, 44 100 samples a second.

    The motion over the turn is repeated; its mean is taken off, and what is above half of the rate, which no sample can hold.

    Parameters
    ----------
    study : Study
        With the table `as_built_turn`, of the task `as_built`.
    path : path
        The file; one that is there is replaced when the new one is complete.
    relief_um : float, optional
        One of the case's reliefs; otherwise the first.
    rpm : float, optional
        One of the speeds (1/min) at which the motion is followed; otherwise the first of this relief.
    seconds : float
        How long it is: above 0 and at most 600.

    Returns
    -------
    float
        The scale: how many um of the transmission error the largest sample, 32767, stands for.

    Raises
    ------
    KeyError
        The study has no such table.
    ValueError
        There is no such relief or speed, or `seconds` is not as it must be.
    Error
        The file cannot be written.
    """
    table = study['as_built_turn']
    if not 0 < seconds <= LONGEST:
        raise ValueError(f'seconds = {seconds}: must be above 0 and at most {LONGEST}')
    relief = one_of(table.relief_um, relief_um, 'relief_um')
    moving = np.isclose(table.relief_um, relief) & (table.rpm > 0)
    speed = one_of(table.rpm[moving], rpm, 'rpm')
    rows = moving & np.isclose(table.rpm, speed)
    tau, error = table.tau[rows], table.transmission_error_um[rows]
    periods = np.ceil(tau[-1])  # mesh periods after which it repeats
    duration = periods * 60 / speed * table.pinion_angle_deg[rows][-1] / 360 / tau[-1]
    samples = _repeated(np.interp(np.arange(8 * tau.size) / (8 * tau.size) * periods, tau, error, period=periods), duration, seconds)
    scale = float(np.abs(samples).max())
    whole = np.round(samples / (scale or 1) * FULL).astype('<i2')
    with replacing(path) as new, wave.open(new, 'wb') as file:
        file.setnchannels(1)
        file.setsampwidth(2)
        file.setframerate(RATE)
        file.writeframes(whole.tobytes())
    return scale


def _repeated(once: NDArray[np.float64], duration: float, seconds: float) -> NDArray[np.float64]:
    """Samples of what repeats after a duration (s), of which there are values at equal distances: without mean and what is too high."""
    parts = np.fft.rfft(once)
    parts[0] = 0
    parts[np.arange(parts.size) >= duration * RATE / 2] = 0
    times = np.arange(max(1, round(seconds * RATE))) / RATE
    return np.interp(times, np.arange(once.size) / once.size * duration, np.fft.irfft(parts, once.size), period=duration)
