"""Results along the path of contact: stiffness, sharing, transmission error, load, root stress."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import floor
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from ..core.study import Study
from ..core.table import Table, select_value
from .look import ASIDE, FAINT, HALO, INK, VISIBLE, canvas
from .reliefs import Integers, Reals, Reliefs, paths, table_of, unanswered


def plot_stiffness(mesh: Study | Table, ax: Axes | None = None) -> Axes:
    """Draws the stiffness of all loaded pairs, and of one pair, along the path of contact: of a study or its table `mesh`."""
    mesh = table_of(mesh, 'mesh')
    with canvas(ax) as ax:
        _curves(ax, mesh, paths(mesh.s, mesh.mesh_stiffness_n_um, mesh.relief_um))
        s, one = paths(mesh.s, mesh.pair_stiffness_n_um)[0]
        ax.plot(s, one, **ASIDE)
        ax.set_ylim(bottom=0)
        finish(ax, mesh, 'Stiffness (N/µm)', [Line2D([], [], **ASIDE, label='one pair')])
    return ax


def plot_sharing(mesh: Study | Table, ax: Axes | None = None) -> Axes:
    """Draws the share of the static load on one pair along the path of contact: of a study or its table `mesh`."""
    mesh = table_of(mesh, 'mesh')
    with canvas(ax) as ax:
        _curves(ax, mesh, paths(mesh.s, mesh.load_share, mesh.relief_um))
        finish(ax, mesh, 'Load share (–)')
    return ax


def plot_ste(mesh: Study | Table, ax: Axes | None = None) -> Axes:
    """Draws the static transmission error along the path of contact of one pair: of a study or its table `mesh`."""
    mesh = table_of(mesh, 'mesh')
    with canvas(ax) as ax:
        _curves(ax, mesh, paths(mesh.s, mesh.ste_um, mesh.relief_um))
        finish(ax, mesh, 'Static transmission error (µm)')
    return ax


def plot_harmonics(harmonics: Study | Table, ax: Axes | None = None) -> Axes:
    """Draws the amplitudes of the harmonics of the static transmission error, a bar for each relief: of a study or its table
    `harmonics`.

    A thin line across the end of a bar shows its estimated error if that is wide enough to be seen.
    """
    harmonics = table_of(harmonics, 'harmonics')
    reliefs = Reliefs(harmonics.case)
    amplitude, error = harmonics.amplitude_um[:, 1:], harmonics.error_estimate_um[:, 0]  # 0 is the mean
    width = 0.84 / max(2, len(error))
    with canvas(ax) as ax:
        for i, look in enumerate(reliefs.styles):
            place = harmonics.harmonic[1:] + width * (i - (len(error) - 1) / 2)
            ax.bar(place, amplitude[i], 0.94 * width, color=look['color'])
            if error[i] > VISIBLE * amplitude.max():
                ax.errorbar(place, amplitude[i], error[i], color=INK, linestyle='', linewidth=0.7)
        ax.xaxis.set_major_locator(MaxNLocator(integer=True))
        ax.set_xlabel('Harmonic of the mesh frequency (–)')
        ax.set_ylabel('Amplitude of the STE (µm)')
        reliefs.legend(ax, [], filled=True)
    return ax


def plot_load(load: Study | Table, ax: Axes | None = None, *, rpm: float | None = None) -> Axes:
    """Draws the dynamic load of one pair along its path of contact, at one speed, and the static load.

    A relief without a converged result has no curve; the legend names it.

    Parameters
    ----------
    load : Study or Table
        A study, or its table `load`.
    ax : Axes, optional
        Axes to draw into; otherwise a figure is made.
    rpm : float, optional
        One of the case's `load_rpm`; otherwise the first.

    Returns
    -------
    Axes

    Raises
    ------
    ValueError
        The case has no such `load_rpm`.
    """
    return _motion(table_of(load, 'load'), ax, rpm, 'pair_load_n', 'Pair load at {:g} 1/min (N)')


def plot_dte(load: Study | Table, ax: Axes | None = None, *, rpm: float | None = None) -> Axes:
    """Draws the dynamic transmission error while a pair passes along its path of contact, at one speed; otherwise like
    `plot_load`.
    """
    return _motion(table_of(load, 'load'), ax, rpm, 'dte_um', 'DTE at {:g} 1/min (µm)')


def plot_motion_harmonics(harmonics: Study | Table, ax: Axes | None = None, *, rpm: float | None = None) -> Axes:
    """Draws the amplitudes of the harmonics of the dynamic transmission error at one speed, a bar for each relief: of a study or
    its table `motion_harmonics`; otherwise like `plot_load`.

    A motion that repeats after several mesh periods has parts between the harmonics of the mesh frequency.
    """
    return harmonic_bars(table_of(harmonics, 'motion_harmonics'), ax, rpm, 'dte_amplitude_um', 'Amplitude of the DTE (µm)')


def harmonic_bars(table: Table, ax: Axes | None, rpm: float | None, column: str, label: str, error: str | None = None) -> Axes:
    """Draws amplitudes of a periodic motion at one speed, a bar for each relief; across its end the estimated error, if that is
    wide enough to be seen.
    """
    rpm = select_value(table.rpm, rpm, 'rpm')
    mask = np.isclose(table.rpm, rpm) & (table.harmonic > 0) & np.isfinite(table[column])
    reliefs = Reliefs(table.case)
    count = len(reliefs.amounts)
    width = 0.84 / max(2, count) * min(1.0, np.min(table.harmonic[mask], initial=1.0))  # the first harmonic is 1 over the number of periods
    with canvas(ax) as ax:
        for i, amount in enumerate(reliefs.amounts):
            mine = mask & (table.relief_um == amount)
            place = table.harmonic[mine] + width * (i - (count - 1) / 2)
            ax.bar(place, table[column][mine], 0.94 * width, color=reliefs.styles[i]['color'])
            if error and (table[error][mine] > VISIBLE * np.max(table[column][mask])).any():
                ax.errorbar(place, table[column][mine], table[error][mine], color=INK, linestyle='', linewidth=0.7)
        ax.set_xlabel(f'Harmonic of the mesh frequency at {rpm:g} 1/min (–)')
        ax.set_ylabel(label)
        reliefs.legend(ax, [], filled=True)
    return ax


def _motion(load: Table, ax: Axes | None, rpm: float | None, column: str, label: str) -> Axes:
    """Draws a column of the motion along the path of a pair, at one speed."""
    rpm = select_value(load.rpm, rpm, 'rpm')
    mask = np.isclose(load.rpm, rpm) & np.isfinite(load[column])
    with canvas(ax) as ax:
        found = _curves(ax, load, paths(load.s[mask], load[column][mask], load.relief_um[mask]))
        missing = [f'{amount:g}' for i, amount in enumerate(Reliefs(load.case).amounts) if i not in found]
        if column == 'pair_load_n' and 'motion' in load.study:
            _level(ax, load.study.motion.load_n, 'static load')
        finish(ax, load, label.format(rpm), unanswered(missing))
    return ax


def plot_static(stress: Study | Table, ax: Axes | None = None) -> Axes:
    """Draws the stress at the fillet tangent of both sides while the load moves along the path of contact.

    Of a study or its table `static`. ISO 6336-3 and Lewis are for the full load at the outer point of single contact. A band shows
    the estimated error if it is wide enough to be seen.
    """
    stress = table_of(stress, 'static')
    reliefs = Reliefs(stress.case)
    order = np.argsort(stress.s, kind='stable')
    dots: dict[str, Any] = {'marker': 'o', 'markersize': 2.5} if order.size < 20 else {}
    with canvas(ax) as ax:
        for side, name, rise, va in ((0, 'drive side', 2, 'bottom'), (1, 'coast side', -2, 'top')):
            for relief, sigma in zip(stress.relief_um, stress.sigma_mpa[:, :, side]):
                ax.plot(stress.s[order], sigma[order], **reliefs.style(relief), **dots)
            ax.annotate(name, (stress.s.mean(), 0), (0, rise), textcoords='offset points', ha='center', va=va)
        _error_bands(ax, stress, order)
        ax.axhline(0, color=FAINT, linewidth=0.5, zorder=0)
        if 'root_rating' in stress.study:
            _level(ax, stress.study.root_rating.iso_mpa, 'ISO 6336-3')
            _level(ax, stress.study.root_rating.lewis_mpa, 'Lewis')
        finish(ax, stress, 'Root stress (MPa)')
    return ax


def _level(ax: Axes, value: float, name: str) -> None:
    """Draws a horizontal line, named at its left end, where the curves are low."""
    ax.axhline(value, **ASIDE)
    ax.annotate(name, (0, value), (8, 2), xycoords=ax.get_yaxis_transform(), textcoords='offset points', path_effects=HALO)
    ax.margins(y=0.09)


def contact_points(study: Study) -> dict[str, float]:
    """Returns A, B, P, D, E along the path, in base pitches; without P if a prescribed mesh does not state it."""
    if 'contact_points' in study:
        return dict(zip(study.contact_points.point, study.contact_points.s))
    ratio = study.case.get('mesh', 'contact_ratio')
    if ratio is None:  # a table alone
        return {}
    pitch = study.case.get('mesh', 'pitch_point')
    pairs = float(floor(ratio))
    return {'A': 0.0, 'B': ratio - pairs, **({} if pitch is None else {'P': pitch}), 'D': pairs, 'E': ratio}


def _error_bands(ax: Axes, stress: Table, order: Integers) -> None:
    """Draws the estimated error, if it is wide enough to be seen."""
    if 'root_stress' not in stress.study:
        return
    visible = VISIBLE * np.ptp(ax.get_ylim())
    for side in (0, 1):
        curves = stress.sigma_mpa[:, order, side]
        for curve, estimate, look in zip(curves, stress.study.root_stress.error_estimate, Reliefs(stress.case).styles):
            if (estimate * np.abs(curve) > visible).any():
                band = curve * (1 - estimate), curve * (1 + estimate)
                ax.fill_between(stress.s[order], *band, color=look['color'], alpha=0.25, linewidth=0)


def _curves(ax: Axes, table: Table, curves: Iterable[tuple[Reals, ...]]) -> set[int]:
    """Draws each (s, values, relief); returns the indices of these reliefs in the case."""
    reliefs = Reliefs(table.case)
    found = set()
    for s, values, relief in curves:
        ax.plot(s, values, **reliefs.style(relief[0]))
        found.add(reliefs.index(relief[0]))
    return found


def finish(ax: Axes, table: Table, label: str, more: Sequence[Artist] = ()) -> None:
    """Adds the points of contact, with one label for those that would overlap; axis labels and legend."""
    points = sorted(contact_points(table.study).items(), key=lambda point: point[1])
    length = points[-1][1] if points else np.nanmax(table.s)
    letters: dict[float, str] = {}
    for name, s in points:
        ax.axvline(s, color=FAINT, linewidth=0.5, zorder=0)
        near = next((place for place in letters if s - place < 0.035 * length), s)
        letters[near] = letters.get(near, '') + name
    for s, name in letters.items():
        ax.annotate(name, (s, 1), (0, 1), xycoords=ax.get_xaxis_transform(), textcoords='offset points', ha='center')
    ax.set_xlim(-0.02 * length, 1.02 * length)
    ax.set_xlabel('Path coordinate s (base pitches)')
    ax.set_ylabel(label)
    Reliefs(table.case).legend(ax, more, gap=1.6)
