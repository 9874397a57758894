"""Load over the face width: contact pattern, load over the face, face load factors over misalignment."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.colors import Colormap, ListedColormap
from numpy.typing import NDArray

from ..core.outline import contact_path
from ..core.study import Study
from ..core.table import Table, select_value
from .look import ACCENT, ASIDE, FAINT, GREY, HALO, MM, VERMILION, canvas, legends_above
from .reliefs import table_of

Reals = NDArray[np.float64]

#: Looks of the columns of the table `face_load_summary`.
LOOKS: dict[str, dict[str, Any]] = {
    'worst_face_load_factor': {'color': VERMILION, 'linestyle': (0, (6, 2))},
    'face_load_factor': {'color': ACCENT},
    'root_face_load_factor': {'color': GREY, 'linestyle': (0, (6, 1.5, 1, 1.5))},
    'iso_face_load_factor': {**ASIDE, 'linewidth': 0.9},
}
MODULE: dict[str, Any] = {'linewidth': 2.5, 'solid_capstyle': 'butt', 'path_effects': HALO}


def plot_contact_pattern(
    load: Study | Table, ax: Axes | None = None, *, relief_um: float | None = None, gear: str = 'pinion'
) -> Axes:
    """Draws the contact pattern on a flank, for comparison with that of marking compound: the face width across, and upwards the
    diameters that touch, from root to tip, with the points of the path of contact.

    The colour is Hertz's pressure as the contact passes, the darker the higher; where the flanks do not touch it is white. It is that of a
    slice of the face, and between two phases the mean. The scale is that of all reliefs.

    Parameters
    ----------
    load : Study or Table
        A study, or its table `face_load`.
    ax : Axes, optional
        Axes to draw into; otherwise a figure is made.
    relief_um : float, optional
        One of the case's reliefs; otherwise the first.
    gear : str
        'pinion' or 'gear', on whose flank it is.

    Returns
    -------
    Axes

    Raises
    ------
    ValueError
        The case has no such relief, or there is no such gear.
    """
    if gear not in ('pinion', 'gear'):
        raise ValueError(f'gear = {gear!r}: must be pinion or gear')
    load = table_of(load, 'face_load')
    study = load.study
    relief, bounds, phase, s, (pressure,) = _lines(load, relief_um, 'pressure_mpa')
    # Along the path of one pair; where the number of pairs changes, s has both sides. Oblique lines cross the face while they move.
    order = np.lexsort((np.arange(len(s)), np.round(s[:, 0] - phase)))
    pressure, s = pressure[order], s[order]
    between = (pressure[1:] + pressure[:-1]) / 2
    middle = (bounds[1:] + bounds[:-1]) / 2
    lag = (s[:, :1] - s[:, -1:]) / (middle[-1] - middle[0])
    place = np.clip(s[:, :1] - lag * (bounds - middle[0]), *study.contact_points.s[[0, -1]])
    with canvas(ax, height=70 * MM) as ax:
        shades = ax.pcolormesh(np.broadcast_to(bounds, place.shape), _diameter(study, gear, place), np.ma.masked_equal(between, 0),
                               cmap=_compound(), vmin=0, vmax=load.pressure_mpa.max(), rasterized=True)  # fmt: skip
        for name, place in zip(study.contact_points.point, _diameter(study, gear, study.contact_points.s)):
            if name not in 'AE':
                ax.axhline(place, color=FAINT, linewidth=0.5)
            ax.annotate(name, (1, place), (3, 0), xycoords=ax.get_yaxis_transform(), textcoords='offset points', va='center')
        ax.spines[:].set_visible(True)
        bar = ax.figure.colorbar(shades, ax=ax, label='Hertz pressure (MPa)', pad=0.06, aspect=25)
        bar.outline.set_linewidth(0.6)
        ax.set_title(_title(load, relief), loc='left')
        ax.set_xlabel('Place z over the face width (mm)')
        ax.set_ylabel(f'Diameter of the {gear} (mm)')
    return ax


def plot_face_load(load: Study | Table, ax: Axes | None = None, *, relief_um: float | None = None) -> Axes:
    """Draws the load of all pairs over the face width at the worst phase and in the middle of contact of the fewest pairs, of helical
    gears the mean over the mesh period, with the mean.

    A bar one module wide is the largest load on a module of the face: its ratio to the mean is K_H_beta. Otherwise like
    `plot_contact_pattern`.
    """
    load = table_of(load, 'face_load')
    relief, bounds, _, _, (line_load,) = _lines(load, relief_um, 'line_load_n_mm')
    summary, phases = load.study.face_load_summary.at(relief_um=relief), load.study.face_load_phases
    mine = np.isclose(phases.relief_um, relief)
    pairs, labels = phases.pairs[mine], _labels(load.study)
    totals = np.add.reduceat(line_load, np.append(0, np.cumsum(pairs)[:-1]))
    fewest = np.flatnonzero(pairs == pairs.min())
    shown = {
        'worst_face_load_factor': totals[phases.face_load_factor[mine].argmax()],
        'face_load_factor': totals[(fewest[0] + fewest[-1]) // 2],
    }
    if _is_helical(load.study):
        shown['face_load_factor'] = np.diff(phases.mesh_phase[mine]) @ (totals[1:] + totals[:-1]) / 2
    module = load.case.get('pair', 'module_mm')
    with canvas(ax) as ax:
        for column, total in shown.items():
            look = LOOKS[column]
            ax.stairs(total, bounds, baseline=None, **look, linewidth=1.1, label=f'{labels[column]} = {summary[column]:.3f}')
            ax.plot(*_largest_on(bounds, total, module), color=look['color'], **MODULE)
        mean = np.dot(total, np.diff(bounds)) / (bounds[-1] - bounds[0])
        ax.plot([], [], color=GREY, label='largest on one module', **MODULE)
        ax.plot(bounds[[0, -1]], [mean, mean], **ASIDE, label=f'mean: {mean:.4g} N/mm')
        ax.set_xlim(bounds[0], bounds[-1])
        ax.set_ylim(0, None)
        ax.set_xlabel('Place z over the face width (mm)')
        ax.set_ylabel('Load per face width (N/mm)')
        legends_above(ax, (_title(load, relief), ax.get_legend_handles_labels()[0]))
    return ax


def compare_face_loads(studies: Study | Sequence[Study], ax: Axes | None = None, *, relief_um: float | None = None) -> Axes:
    """Draws K_H_beta and K_F_beta over the misalignment, with that of ISO 6336-1 method C.

    Parameters
    ----------
    studies : Study or sequence of Study
        One study with a list of misalignments, `&face_load misalignment_um`, or one study for each misalignment, as of
        `case.changed(face={'misalignment_um': 20})`. A study without a list is one point.
    ax : Axes, optional
        Axes to draw into; otherwise a figure is made.
    relief_um : float, optional
        One of the cases' reliefs; otherwise the first.

    Returns
    -------
    Axes

    Raises
    ------
    ValueError
        A case has no such relief.
    """
    studies = [studies] if isinstance(studies, Study) else list(studies)
    found = []
    for study in studies:
        relief = select_value(np.atleast_1d(study.case.get('relief', 'amount_um', 0)), relief_um, 'relief_um')
        if 'face_misalignments' in study:
            table = study.face_misalignments
            found += [table.at(relief_um=relief, misalignment_um=one) for one in np.unique(table.misalignment_um)]
        else:
            found.append(study.face_load_summary.at(relief_um=relief))
    found.sort(key=lambda row: row.misalignment_um)
    with canvas(ax) as ax:
        for column, label in _labels(studies[0]).items():
            ax.plot([one.misalignment_um for one in found], [one[column] for one in found], **LOOKS[column], label=label,
                    marker='.' if len(found) < 20 else '')  # fmt: skip
        ax.set_ylim(1, None)
        ax.set_xlabel('Misalignment (µm)' if 'face_misalignments' in studies[0] else 'Misalignment with lead slopes (µm)')
        ax.set_ylabel('Face load factor (–)')
        legends_above(ax, (_title(studies[0].face_load_summary, relief), ax.get_legend_handles_labels()[0]))
    return ax


def _lines(load: Table, relief_um: float | None, *columns: str) -> tuple[float, Reals, Reals, Reals, list[Reals]]:
    """Returns the relief; the bounds of the slices (mm); the phase of each line of contact; and path coordinate and columns by line and slice."""
    relief = select_value(load.relief_um, relief_um, 'relief_um')
    mine = np.isclose(load.relief_um, relief)
    slices = len(np.unique(load.z_mm[mine]))
    width = load.slice_mm[mine][:slices]
    bounds = np.append(0, np.cumsum(width))
    values = [load[column][mine].reshape(-1, slices) for column in ('mesh_phase', 's', *columns)]
    return relief, bounds, values[0][:, 0], values[1], values[2:]


def _largest_on(bounds: Reals, line_load: Reals, length: float) -> tuple[Reals, Reals]:
    """Returns the ends of the part of this length with the largest mean load, and that load at each."""
    force = np.append(0, np.cumsum(line_load * np.diff(bounds)))
    starts = np.clip(np.concatenate((bounds, bounds - length)), bounds[0], bounds[-1] - length)
    means = (np.interp(starts + length, bounds, force) - np.interp(starts, bounds, force)) / length
    start = starts[means.argmax()]
    return np.array([start, start + length]), np.full(2, means.max())


def _diameter(study: Study, gear: str, s: Reals) -> Reals:
    """Returns the diameters (mm) of a gear that touch at these places of the path of contact."""
    centre = 0 if gear == 'pinion' else study.geometry.centre_distance_mm
    return 2 * np.hypot(*(contact_path(study, s.ravel()) - [0, centre]).T).reshape(s.shape)


def _is_helical(study: Study) -> bool:
    """True for helical gears, whose K_H_beta is that of the mean load."""
    return bool(study.case.get('pair', 'helix_angle_deg', 0))


def _labels(study: Study) -> dict[str, str]:
    """Names the columns of `LOOKS`."""
    fewest = 'single contact' if study.face_load_phases.pairs.min() == 1 else 'fewest pairs'
    if _is_helical(study):
        fewest = 'mean of the period'
    return dict(zip(LOOKS, ('worst phase, $K_{Hβ}$', f'{fewest}, $K_{{Hβ}}$', 'root, $K_{Fβ}$', 'ISO 6336-1 method C, $K_{Hβ}$')))


def _compound() -> Colormap:
    """From light to dark, so that it prints in grey, too; the least pressure differs from white paper."""
    return ListedColormap(colormaps['viridis_r'](np.linspace(0.12, 1, 256)))


def _title(load: Table, relief: float) -> str:
    """Title of the legend: the relief where there are several, or one that is not 0."""
    return f'Tip relief {relief:g} µm' if np.any(load.case.get('relief', 'amount_um', 0)) else ''
