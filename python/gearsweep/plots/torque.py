"""Transmitted torque over time, and its harmonics."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes

from ..core.study import Study
from ..core.table import Table, select_value
from .along_path import harmonic_bars
from .look import ASIDE, FAINT, canvas
from .reliefs import Reliefs, table_of, unanswered

#: Number of mesh periods shown of a motion that repeats after one.
SHOWN = 2


def plot_torque(
    torque: Study | Table, ax: Axes | None = None, *, rpm: float | None = None, gear: str = 'pinion', periods: int | None = None
) -> Axes:
    """Draws the torque of the mesh on the pinion or the gear over time at one speed; dashed its mean with the first relief.

    Of a study or its table `torque`; `ax`, `rpm` and reliefs without a result are as in `plot_load`.

    Parameters
    ----------
    gear : str
        'pinion' or 'gear'.
    periods : int, optional
        How many mesh periods to show; otherwise two, or those after which the motion repeats.

    Returns
    -------
    Axes

    Raises
    ------
    ValueError
        The case has no such speed, there is no such gear, or `periods` is below 1.
    """
    torque = table_of(torque, 'torque')
    rpm = select_value(torque.rpm, rpm, 'rpm')
    _check(gear)
    if periods is not None and periods < 1:
        raise ValueError(f'periods = {periods}: must be at least 1')
    reliefs = Reliefs(torque.case)
    missing: list[str] = []
    column = torque[f'{gear}_torque_nm']
    known = np.isclose(torque.rpm, rpm) & np.isfinite(column)
    shown = periods or max(SHOWN, round(np.max(torque.tau[known], initial=0)))
    with canvas(ax) as ax:
        for amount in np.unique(torque.relief_um):
            mask = known & (torque.relief_um == amount)
            if not mask.any():
                missing.append(f'{amount:g}')
                continue
            repeats = round(torque.tau[mask].max())
            tau = np.concatenate([torque.tau[mask] + i * repeats for i in range(-(-shown // repeats))])
            ax.plot(tau, np.resize(column[mask], tau.size), **reliefs.style(amount))
        points = torque.study.torque_points
        mean = points[f'{gear}_mean_nm'][:, np.isclose(points.rpm, rpm)]
        for level in mean[np.isfinite(mean)][:1]:
            ax.axhline(level, **ASIDE, zorder=0)
        for period in range(shown + 1):
            ax.axvline(period, color=FAINT, linewidth=0.5, zorder=0)
        ax.set_xlim(0, shown)
        ax.set_xlabel('Time (mesh periods)')
        ax.set_ylabel(f'{gear.capitalize()} torque at {rpm:g} 1/min (N m)')
        reliefs.legend(ax, unanswered(missing))
    return ax


def plot_torque_harmonics(
    harmonics: Study | Table, ax: Axes | None = None, *, rpm: float | None = None, gear: str = 'pinion'
) -> Axes:
    """Draws the amplitudes of the harmonics of the torque of the pinion or the gear at one speed, a bar for each relief: of a
    study or its table `torque_harmonics`; otherwise like `plot_motion_harmonics` and `plot_torque`.

    A thin line across the end of a bar shows its estimated error where that is wide enough to be seen.
    """
    _check(gear)
    label = f"Amplitude of the {gear}'s torque (N m)"
    table = table_of(harmonics, 'torque_harmonics')
    return harmonic_bars(table, ax, rpm, f'{gear}_amplitude_nm', label, f'{gear}_error_nm')


def _check(gear: str) -> None:
    if gear not in ('pinion', 'gear'):
        raise ValueError(f'gear = {gear!r}: must be pinion or gear')
