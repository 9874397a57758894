"""Root stress over the frequency of the load, and the speeds at which harmonics of the mesh frequency meet natural frequencies."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from ..core.case import Case
from ..core.study import Study
from ..core.table import Table, select_value
from .look import ACCENT, FAINT, FINE, GREY, HALO, INK, MM, PAGE, canvas, in_khz, legends_above, line_styles
from .over_speed import curve
from .reliefs import study_of, table_of


def plot_frequency_response(response: Study | Table, ax: Axes | None = None, *, tangent_deg: float | None = None) -> Axes:
    """Draws the amplitude of the stress along both fillets at one point over the frequency of the load, for each place of the
    load.

    Parameters
    ----------
    response : Study or Table
        A study, or its table `harmonic`.
    ax : Axes, optional
        Axes to draw into; otherwise a figure is made.
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
    tangent = select_value(table.tangent_deg, tangent_deg, 'tangent_deg')
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
    """Draws harmonics of the mesh frequency (1x, 2x ...) over the speeds of the case, and the natural frequencies of the section
    and of both gears on the mesh, with a dot at each intersection.

    The frequency axis extends to the harmonics, and at least to the lowest natural frequency; the title names those above. The
    range below the least speed of the case is grey.

    Parameters
    ----------
    campbell : Study or Table
        A study, or its table `campbell`.
    ax : Axes, optional
        Axes to draw into; otherwise a figure is made.

    Returns
    -------
    Axes
    """
    study, table = study_of(campbell), table_of(campbell, 'campbell')
    slope = (table.frequency_hz / table.rpm / table.harmonic)[0]
    styles: dict[str, dict[str, Any]] = {'gears': {'color': INK}, 'section': {'color': ACCENT}}
    modes = {}
    for system, mode, frequency in zip(table.system, table.mode, table.frequency_hz):
        name = 'gears on the mesh' if system == 'gears' else f'section, mode {mode}'
        modes[system, mode] = Mode(name, frequency, styles[system])
    with canvas(ax, height=80 * MM, width=PAGE) as ax:
        shown = diagram(ax, study, slope, table.harmonic.max(), list(modes.values()))
        for rpm, system, mode in zip(table.rpm, table.system, table.mode):
            if modes[system, mode] in shown:
                ax.plot(rpm / 1000, modes[system, mode].frequency_hz / 1000, 'o', markersize=3, **styles[system])
    return ax


def plot_body_campbell(campbell: Study | Table, ax: Axes | None = None) -> Axes:
    """Draws harmonics of the mesh frequency over the speeds of the case, and the modes of a complete gear that they excite.

    The gear rotates relative to the load: for a mode of n nodal diameters, thin lines on both sides of harmonic k of the mesh
    frequency (1x, 2x ...) are k z + n and k z - n excitations per revolution of the gear with z teeth. A dot is a resonance: a line
    of n meets a mode of n. Otherwise like `plot_campbell`.

    Parameters
    ----------
    campbell : Study or Table
        A study, or its table `body_campbell`.
    ax : Axes, optional
        Axes to draw into; otherwise a figure is made.

    Returns
    -------
    Axes
    """
    study, table = study_of(campbell), table_of(campbell, 'body_campbell')
    slope = (table.frequency_hz / table.rpm / table.per_turn)[0]
    modes, waves = study.body_modes, dict.fromkeys(sorted(study.body_modes.nodal_diameter))
    styles = dict(zip(waves, line_styles(len(waves))))
    listed = [Mode(name, hz, styles[n]) for name, hz, n in zip(modes.mode_name, modes.frequency_hz, modes.nodal_diameter)]
    with canvas(ax, height=100 * MM, width=PAGE) as ax:
        shown = diagram(ax, study, slope * np.ravel(study.gear_body.sectors)[0], table.harmonic.max(), listed)
        for mode, one in enumerate(listed, 1):
            mask = table.mode == mode
            if one in shown:
                ax.plot(table.rpm[mask] / 1000, table.frequency_hz[mask] / 1000, 'o', markersize=3, color=one.look['color'])
        seen = {n for one, n in zip(listed, modes.nodal_diameter) if one in shown}
        right = ax.get_xlim()[1]
        for n, per_turn in dict.fromkeys(zip(table.nodal_diameter, table.per_turn)):
            if n in seen:
                ax.plot((0, right), (0, per_turn * slope * right), linewidth=0.4, alpha=0.7, color=styles[n]['color'])
        legends_above(ax, ('Nodal diameters', [Line2D([], [], label=f'{n}', **styles[n]) for n in styles if n in seen]))
    return ax


@dataclass(frozen=True, eq=False)
class Mode:
    """A natural frequency with its name and line style."""

    name: str
    frequency_hz: float
    look: dict[str, Any]


def diagram(ax: Axes, study: Study, slope: float, most: int, modes: list[Mode]) -> list[Mode]:
    """Draws lines for harmonics 1 to `most`, the first of frequency `slope` (Hz) at 1/min, over the speeds of the case, and the
    modes that are not above them, with their names; returns these modes.
    """
    low, high = speeds_of(study.case) or (0, 1.2 * min(mode.frequency_hz for mode in modes) / slope)
    reach = 1.05 * max(most * slope * high, min(mode.frequency_hz for mode in modes))
    shown = [mode for mode in sorted(modes, key=lambda mode: mode.frequency_hz) if mode.frequency_hz < reach]
    if low > 0:
        ax.axvspan(0, low / 1000, color=FAINT, alpha=0.35, linewidth=0)
    for k in range(1, most + 1):
        ax.plot((0, high / 1000), (0, k * slope * high / 1000), color=GREY, linewidth=0.9, zorder=1)
        ax.annotate(f'{k}x', (high / 1000, k * slope * high / 1000), (-2, 1), textcoords='offset points', ha='right', va='center',
                    color=GREY, path_effects=HALO)  # fmt: skip
    for mode in shown:
        ax.axhline(mode.frequency_hz / 1000, **{**mode.look, 'linewidth': 0.9})
    ax.set_xlim(0, high / 1000)
    ax.set_ylim(0, reach / 1000)
    names_beside(ax, [(mode.frequency_hz / 1000, f'{mode.name}, {in_khz(mode.frequency_hz)}', mode.look['color']) for mode in shown])
    if above := [mode for mode in modes if mode not in shown]:
        least = min(above, key=lambda mode: mode.frequency_hz)
        ax.set_title(f'Above: {len(above)} more, from {least.name}, {in_khz(least.frequency_hz)}', loc='right', color=GREY)
    ax.set_xlabel('Speed of the pinion (1000/min)')
    ax.set_ylabel('Frequency (kHz)')
    return shown


def names_beside(ax: Axes, lines: list[tuple[float, str, Any]]) -> None:
    """Writes names (position on the vertical axis, words, colour) to the right of the axes, in ascending order, moved apart where
    they would overlap; only the lowest ones if there is not enough space.
    """
    gap = 9.5 / (72 * ax.bbox.height / ax.figure.dpi)  # height of a line of text, as a part of the axes
    lines = lines[: int(1 / gap)]
    top = ax.get_ylim()[1]
    places = [place / top for place, *_ in lines]
    for i in range(1, len(places)):
        places[i] = max(places[i], places[i - 1] + gap)
    room = 1.0
    for i in reversed(range(len(places))):
        places[i] = min(places[i], room)
        room = places[i] - gap
    for (at, words, color), place in zip(lines, places):
        ax.annotate(words, (1, at / top), (1.03, place), 'axes fraction', 'axes fraction', va='center', color=color, annotation_clip=False,
                    arrowprops={'arrowstyle': '-', 'color': FAINT, 'linewidth': 0.5, 'shrinkA': 0, 'shrinkB': 0})  # fmt: skip


def speeds_of(case: Case) -> tuple[float, float] | None:
    """Returns the least and the largest speed (1/min) of a case, of its sweep or else of its lists of speeds."""
    asked = [case.get('sweep', 'rpm_first'), case.get('sweep', 'rpm_last')]
    if None in asked:
        asked = [case.get('sweep', 'load_rpm'), *(case.get(group, 'rpm') for group in ('rating', 'flank', 'transient', 'life'))]
    speeds = [speed for one in asked if one is not None for speed in np.ravel(one)]
    return (min(speeds), max(speeds)) if speeds else None
