"""Root stress over the frequency of the load, and the speeds at which harmonics of the mesh frequency meet natural frequencies."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from ..study import Study
from ..table import Table
from .look import ACCENT, FAINT, FINE, GREY, INK, canvas, legends_above, line_styles
from .over_speed import curve
from .reliefs import Reals, one_of, study_of, table_of


def plot_frequency_response(response: Study | Table, ax: Axes | None = None, *, tangent_deg: float | None = None) -> Axes:
    """Amplitude of the stress along both fillets at one point over the frequency of the load, for each place of the load.

    Parameters
    ----------
    response : Study or Table
        A study, or its table `harmonic`.
    ax : Axes, optional
        Where to draw; otherwise a figure is made.
    tangent_deg : float, optional
        One of the case's points of the fillets in `&harmonic`; otherwise the first.

    Returns
    -------
    Axes

    Raises
    ------
    ValueError
        The case has no such point.
    """
    table = table_of(response, 'harmonic')
    tangent = one_of(table.tangent_deg, tangent_deg, 'tangent_deg')
    point = np.abs(table.tangent_deg - tangent).argmin()
    styles = line_styles(len(table.s))
    with canvas(ax) as ax:
        for stress, look in zip(table.stress_mpa[:, point], styles):
            for side, more in zip(stress, ({}, FINE)):
                curve(ax, table.frequency_hz / 1000, side, {**look, **more})
        lines = [Line2D([], [], label=f'load at s = {s:.3g} base pitches', **look) for s, look in zip(table.s, styles)]
        lines += [Line2D([], [], color=GREY, label='drive side'), Line2D([], [], color=GREY, label='coast side', **FINE)]
        ax.set_yscale('log')
        legends_above(ax, ('', lines))
        ax.set_xlabel('Frequency of the load (kHz)')
        ax.set_ylabel(f'Stress at the {tangent:g}° tangents (MPa)')
    return ax


def plot_campbell(campbell: Study | Table, ax: Axes | None = None) -> Axes:
    """Harmonics of the mesh frequency over speed, and the natural frequencies that they meet.

    Beside those of the section and of both gears on the mesh stand, where the study has the task `body_modes`, those of the whole
    gear. A wave of n nodal diameters that runs round the turning gear has, beside what stands still, its frequency plus or minus
    n times that of rotation.

    The speeds reach to twice that at which the mesh excites the gears on the mesh, or to twice the highest of the sweep where that is
    more; the frequencies to those of the harmonics there. What lies above is named in the legend.

    Parameters
    ----------
    campbell : Study or Table
        A study, or its table `campbell`.
    ax : Axes, optional
        Where to draw; otherwise a figure is made.

    Returns
    -------
    Axes
    """
    study = study_of(campbell)
    table = table_of(campbell, 'campbell')
    highest = 2 * max(table.rpm[(table.harmonic == 1) & (table.system == 'gears')].max(), study.case.get('sweep', 'rpm_last') or 0)
    rpm = np.array([0, highest])
    per_rpm = (table.frequency_hz / table.rpm / table.harmonic)[0]
    reach = min(1.1 * table.frequency_hz.max(), table.harmonic.max() * per_rpm * highest)
    looks: dict[str, dict[str, Any]] = {'gears': {'color': INK}, 'section': {'color': ACCENT}, 'body': {'color': GREY, 'linewidth': 0.5}}
    named = {'gears': 'gears on the mesh', 'section': 'section', 'body': 'whole gear'}
    frequencies = {system: table.frequency_hz[table.system == system] for system in dict.fromkeys(table.system)}
    with canvas(ax) as ax:
        for harmonic in dict.fromkeys(table.harmonic):
            ax.plot(rpm / 1000, harmonic * per_rpm * rpm / 1000, color=FAINT, linewidth=0.8)
        for system, natural in frequencies.items():
            for frequency in dict.fromkeys(natural):
                ax.axhline(frequency / 1000, **looks[system])
            speeds = table.rpm[table.system == system]
            ax.plot(speeds / 1000, natural / 1000, 'o', markersize=2.5, **looks[system])
        if 'body_modes' in study:
            frequencies['body'] = study.body_modes.frequency_hz
            for waves in _waves(study, rpm):
                ax.plot(rpm / 1000, waves / 1000, **looks['body'])
        ax.set_xlim(0, highest / 1000)
        ax.set_ylim(0, reach / 1000)
        lines = [Line2D([], [], color=FAINT, linewidth=0.8, label='mesh harmonics')]
        for system, natural in frequencies.items():
            above = f', from {natural.min() / 1000:.3g} kHz' if natural.min() > reach else ''
            lines.append(Line2D([], [], label=named[system] + above, **looks[system]))
        legends_above(ax, ('', lines))
        ax.set_xlabel('Speed of the pinion (1000/min)')
        ax.set_ylabel('Frequency (kHz)')
    return ax


def _waves(study: Study, rpm: Reals) -> list[Reals]:
    """Frequencies (Hz) of the whole gear's modes beside what stands still, over the speed of the pinion."""
    turns = rpm / 60
    if np.ravel(study.gear_body.member)[0] == 'gear':
        turns = turns * study.case.get('pinion', 'teeth') / study.case.get('gear', 'teeth')
    modes = study.body_modes
    ways = ((f, n, way) for f, n in zip(modes.frequency_hz, modes.nodal_diameter) for way in ((-1, 1) if n else (1,)))
    return [frequency + way * waves * turns for frequency, waves, way in ways]
