"""Branches of periodic motions, attracting or not, over a number of the case."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from ..core.study import Study
from ..core.table import Table
from .kinds import KINDS, in_words
from .look import CROSS, GREY, HOLLOW, INK, MM, PAGE, canvas, legends_above
from .over_speed import DTE_LABELS
from .reliefs import study_of

#: Axis labels of the parameter.
PARAMETERS = {
    'rpm': 'Speed of the pinion (1/min)',
    'damping_ratio': 'Damping ratio (–)',
    'relief_um': 'Relief (µm)',
    'normal_force_n': 'Static load (N)',
}

#: Quantities of a motion in the diagram, and their axis labels.
QUANTITIES = {**DTE_LABELS, 'dynamic_factor': 'Dynamic factor (–)'}

#: Axes instead of the speed: their labels.
ACROSS = {'rpm': PARAMETERS['rpm'], 'mesh_frequency_hz': 'Mesh frequency (Hz)', 'frequency_ratio': 'Mesh frequency over natural frequency (–)'}

#: Ratio of the largest to the least value from which the axis is logarithmic.
DECADE = 10.0

#: Marks of special points.
CHANGES: dict[str, dict[str, Any]] = {
    'fold': {'linestyle': '', 'marker': 'o', 'color': INK, 'markersize': 3},
    'doubling': {**HOLLOW, 'marker': 'D', 'markersize': 3.5, 'markeredgecolor': INK},
    'grazing': {**CROSS, 'marker': '|', 'markersize': 5, 'markeredgecolor': GREY},
    'vertical': {**HOLLOW, 'marker': '^', 'markersize': 3.5, 'markeredgecolor': GREY},
    'unknown': {**CROSS, 'marker': 'x', 'markersize': 4, 'markeredgecolor': INK},
}
WORDS = {
    'fold': 'fold',
    'doubling': 'period doubles',
    'grazing': 'contact grazes',
    'vertical': 'a vertical line begins',
    'unknown': 'changes, not known how',
}

#: Line styles of attracting and repelling motions.
LINES: dict[bool, dict[str, Any]] = {
    True: {'linestyle': '-', 'linewidth': 1.0},
    False: {'linestyle': (0, (3, 1.5)), 'linewidth': 0.8},
}


def plot_branches(
    branches: Study | Table, ax: Axes | None = None, *, relief_um: float | None = None, quantity: str = 'dte_rms_um',
    across: str = 'rpm', limits: tuple[float | None, float | None] | None = None,
) -> Axes:  # fmt: skip
    """Draws the dynamic transmission error of all branches over their parameter, for one relief: a bifurcation diagram.

    Lines are solid if the motion attracts and dashed if it repels, in the colour of the number of mesh periods after which it
    repeats. Dots are folds, diamonds period doublings, ticks grazings, where a contact begins or ends.

    Parameters
    ----------
    branches : Study or Table
        A study, or its table `branches`.
    ax : Axes, optional
        Axes to draw into; otherwise a figure is made.
    relief_um : float, optional
        The relief; otherwise the first, and none where the relief is the parameter.
    quantity : {'dte_rms_um', 'dte_peak_to_peak_um', 'dynamic_factor'}
        What the diagram shows of each motion.
    across : {'rpm', 'mesh_frequency_hz', 'frequency_ratio'}
        Where the speed is the parameter: its axis.
    limits : (least, largest), optional
        Limits of the vertical axis, such as (0, 5); None: from the values. Without this argument the axis shows all motions, and is
        logarithmic if the largest value is more than ten times the least.

    Returns
    -------
    Axes

    Raises
    ------
    ValueError
        There is no such quantity, or no such axis with this parameter.
    """
    study = study_of(branches)
    if quantity not in QUANTITIES:
        raise ValueError(f'quantity = {quantity!r}: must be one of {", ".join(QUANTITIES)}')
    found, points, changes = study.branches, study.branch_points, study.branch_changes
    name = study.case.get('branches', 'parameter', 'rpm').lower()
    per = _per_parameter(study, name, across)
    amounts = reliefs_of(found)
    relief_um = amounts[0] if relief_um is None else relief_um
    shown = found.branch if relief_um is None else found.branch[found.relief_um == relief_um]
    with canvas(ax, height=90 * MM, width=PAGE) as ax:
        present: dict[int, list[int]] = {}
        for number in shown:
            mask = points.branch == number
            periods = int(points.mesh_periods[mask][0])
            kind = min(periods, 3)
            present.setdefault(kind, []).append(periods)
            place, value = per * points[name][mask], points[quantity][mask]
            attracts = points.stability[mask] != 'unstable'
            for solid, line in LINES.items():
                _segments(ax, place, value, attracts == solid, {'color': KINDS[kind], **line})
        entries = []
        for kind, all_periods in sorted(present.items()):
            entries.append(Line2D([], [], color=KINDS[kind], label=in_words(kind, np.array(all_periods))))
        entries.append(Line2D([], [], color=GREY, **LINES[False], label='repels'))
        for word, mark in CHANGES.items():
            chosen = (changes.kind == word) & np.isin(changes.branch, shown)
            if chosen.any():
                ax.plot(per * changes[name][chosen], changes[quantity][chosen], **mark, zorder=4)
                entries.append(Line2D([], [], **mark, label=WORDS[word]))
        legends_above(ax, ('' if relief_um is None else f'Tip relief {relief_um:g} µm', entries))
        ax.set_xlabel(ACROSS[across] if name == 'rpm' else PARAMETERS[name])
        ax.set_ylabel(QUANTITIES[quantity])
        _limit(ax, points[quantity][np.isin(points.branch, shown)], limits)
    return ax


def _per_parameter(study: Study, name: str, across: str) -> float:
    """Returns the values of the axis per unit of the parameter."""
    allowed = ACROSS if name == 'rpm' else ('rpm',)
    if across not in allowed:
        raise ValueError(f'across = {across!r}: must be one of {", ".join(allowed)} with {name} as the parameter')
    mesh_hz = int(study.case.get('pinion', 'teeth')) / 60 if across != 'rpm' else 1.0
    return mesh_hz / study.motion.natural_frequency_hz if across == 'frequency_ratio' else mesh_hz


def _limit(ax: Axes, values: np.ndarray, limits: tuple[float | None, float | None] | None) -> None:
    """Sets the requested limits; otherwise an axis on which motions of any size can be read."""
    if limits is not None:
        ax.set_ylim(*limits)
        return
    known = values[np.isfinite(values)]
    if known.size and known.min() > 0 and known.max() > DECADE * known.min():
        ax.set_yscale('log')
        ax.yaxis.set_major_formatter('{x:g}')


def reliefs_of(found: Table) -> list[float | None]:
    """Returns the reliefs of the branches; [None] if the relief is their parameter or there are none."""
    amounts = found.relief_um[np.isfinite(found.relief_um)]
    return [float(amount) for amount in dict.fromkeys(amounts)] or [None]


def _segments(ax: Axes, across: np.ndarray, factor: np.ndarray, wanted: np.ndarray, look: dict[str, Any]) -> None:
    """Draws the steps of a branch whose first point is selected."""
    runs = np.flatnonzero(np.diff(np.concatenate([[0], wanted[:-1].astype(int), [0]])))
    for first, last in zip(runs[::2], runs[1::2]):
        ax.plot(across[first : last + 1], factor[first : last + 1], **look)
