"""Whole branches of periodic motions, attracting or not, over a number of the case."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from ..study import Study
from ..table import Table
from .kinds import KINDS, in_words
from .look import BLUE, CROSS, GREY, HOLLOW, INK, MM, ORANGE, PAGE, canvas, legends_above
from .reliefs import study_of

#: What the axis says of the parameter.
PARAMETERS = {
    'rpm': 'Speed of the pinion (1/min)',
    'damping_ratio': 'Damping ratio (–)',
    'relief_um': 'Relief (µm)',
    'normal_force_n': 'Static load (N)',
}

#: Marks of places where the motion changes its kind.
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

#: Curves on which these places lie over two numbers of the case.
CURVES: dict[str, dict[str, Any]] = {
    'fold': {'color': BLUE, 'linestyle': '-', 'linewidth': 1.2},
    'doubling': {'color': ORANGE, 'linestyle': (0, (4, 1.5)), 'linewidth': 1.2},
    'grazing': {'color': GREY, 'linestyle': (0, (1, 1.2)), 'linewidth': 0.9},
}

#: How motions that attract are drawn, and those that repel.
LINES: dict[bool, dict[str, Any]] = {
    True: {'linestyle': '-', 'linewidth': 1.0},
    False: {'linestyle': (0, (3, 1.5)), 'linewidth': 0.8},
}


def plot_branches(branches: Study | Table, ax: Axes | None = None, *, relief_um: float | None = None) -> Axes:
    """Dynamic factor of all branches over their parameter, for one relief: a bifurcation diagram.

    Solid where the motion attracts, dashed where it repels, in the colour of the mesh periods after which it
    repeats. Dots are folds, diamonds mark where the period doubles, ticks where a contact begins or ends
    (grazing).

    Parameters
    ----------
    branches : Study or Table
        A study, or its table `branches`.
    ax : Axes, optional
        Where to draw; otherwise a figure is made.
    relief_um : float, optional
        The relief; otherwise the first, and none where the relief is the parameter.

    Returns
    -------
    Axes
    """
    study = study_of(branches)
    found, points, changes = study.branches, study.branch_points, study.branch_changes
    name = study.case.get('branches', 'parameter', 'rpm').lower()
    amounts = reliefs_of(found)
    relief_um = amounts[0] if relief_um is None else relief_um
    shown = found.branch if relief_um is None else found.branch[found.relief_um == relief_um]
    with canvas(ax, height=90 * MM, width=PAGE) as ax:
        present: dict[int, list[int]] = {}
        for number in shown:
            here = points.branch == number
            periods = int(points.mesh_periods[here][0])
            kind = min(periods, 3)
            present.setdefault(kind, []).append(periods)
            across, factor = points[name][here], points.dynamic_factor[here]
            attracts = points.stability[here] != 'unstable'
            for solid, line in LINES.items():
                _segments(ax, across, factor, attracts == solid, {'color': KINDS[kind], **line})
        entries = []
        for kind, all_periods in sorted(present.items()):
            entries.append(Line2D([], [], color=KINDS[kind], label=in_words(kind, np.array(all_periods))))
        entries.append(Line2D([], [], color=GREY, **LINES[False], label='repels'))
        for word, mark in CHANGES.items():
            there = (changes.kind == word) & np.isin(changes.branch, shown)
            if there.any():
                ax.plot(changes[name][there], changes.dynamic_factor[there], **mark, zorder=4)
                entries.append(Line2D([], [], **mark, label=WORDS[word]))
        legends_above(ax, ('' if relief_um is None else f'Tip relief {relief_um:g} µm', entries))
        ax.set_xlabel(PARAMETERS[name])
        ax.set_ylabel('Dynamic factor (–)')
    return ax


def plot_branch_curves(branches: Study | Table, ax: Axes | None = None, *, relief_um: float | None = None) -> Axes:
    """Where folds, doublings and grazings lie over the parameter and the second one, for one relief.

    Across a curve of folds two motions appear or vanish, across one of doublings the period doubles, across one
    of grazings a contact begins or ends.

    Parameters
    ----------
    branches : Study or Table
        A study whose case asks for a `second` parameter, or its table `branch_curves`.
    ax : Axes, optional
        Where to draw; otherwise a figure is made.
    relief_um : float, optional
        The relief; otherwise the first. Where the relief is a parameter, all curves are drawn.

    Returns
    -------
    Axes
    """
    study = study_of(branches)
    curves = study.branch_curves
    first, second = (study.case.get('branches', key, 'rpm').lower() for key in ('parameter', 'second'))
    amounts = [None] if 'relief_um' in (first, second) else list(dict.fromkeys(curves.relief_um))
    relief_um = amounts[0] if relief_um is None and amounts else relief_um
    shown = np.ones(len(curves), bool) if relief_um is None else curves.relief_um == relief_um
    with canvas(ax, height=90 * MM, width=PAGE) as ax:
        for kind, line in CURVES.items():
            for number in dict.fromkeys(curves.curve[shown & (curves.kind == kind)]):
                here = curves.curve == number
                ax.plot(curves[first][here], curves[second][here], **line)
        entries = [Line2D([], [], label=WORDS[kind], **line) for kind, line in CURVES.items() if (shown & (curves.kind == kind)).any()]
        legends_above(ax, ('' if relief_um is None else f'Tip relief {relief_um:g} µm', entries))
        ax.set_xlabel(PARAMETERS[first])
        ax.set_ylabel(PARAMETERS[second])
    return ax


def reliefs_of(found: Table) -> list[float | None]:
    """The reliefs of the branches; [None] where the relief is their parameter or there are none."""
    amounts = found.relief_um[np.isfinite(found.relief_um)]
    return [float(amount) for amount in dict.fromkeys(amounts)] or [None]


def _segments(ax: Axes, across: np.ndarray, factor: np.ndarray, wanted: np.ndarray, look: dict[str, Any]) -> None:
    """Draws the steps of a branch whose first point is wanted."""
    runs = np.flatnonzero(np.diff(np.concatenate([[0], wanted[:-1].astype(int), [0]])))
    for first, last in zip(runs[::2], runs[1::2]):
        ax.plot(across[first : last + 1], factor[first : last + 1], **look)
