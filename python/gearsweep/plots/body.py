"""The finite-element grid of a section, and its modes."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection

from ..core.study import Study
from ..core.table import Table
from .look import ACCENT, GREY, INK, MM, canvas, in_khz, in_mm
from .reliefs import Integers, Reals, study_of

#: Number of lines above which they are drawn as pixels also in a vector file.
MANY = 3000


def plot_section(section: Study | Table, ax: Axes | None = None) -> Axes:
    """Draws the finite-element grid of a section: of a study or any of its tables."""
    nodes, element = grid_of(section)
    with canvas(ax, height=80 * MM) as ax:
        _draw_grid(ax, nodes, element, INK)
        in_mm(ax)
    return ax


def plot_modal(modal: Study | Table, ax: Axes | None = None, *, mode: int = 1) -> Axes:
    """Draws a mode shape: the deformed grid over the undeformed one, to no scale.

    Parameters
    ----------
    modal : Study or Table
        A study, or its table `modal`.
    ax : Axes, optional
        Axes to draw into; otherwise a figure is made.
    mode : int
        Number of the mode, from 1 for the lowest.

    Returns
    -------
    Axes
    """
    study = study_of(modal)
    modal = study.modal
    if not 1 <= mode <= modal.rows:
        raise ValueError(f'mode = {mode}: must be from 1 to {modal.rows}')
    nodes, element = grid_of(study)
    shape = np.column_stack([study.mode_shapes[axis][mode - 1] for axis in ('shape_x', 'shape_y')])
    scale = 0.05 * np.linalg.norm(np.ptp(nodes, axis=0)) / np.linalg.norm(shape, axis=1).max()
    with canvas(ax, height=80 * MM) as ax:
        ax.add_collection(LineCollection([*edges(nodes, element)[1]], colors=GREY, linewidths=0.5))
        _draw_grid(ax, nodes + scale * shape, element, ACCENT)
        ax.set_axis_off()
        ax.set_anchor('N')
        ax.set_title(f'{mode}: {in_khz(modal.frequency_hz[mode - 1])}\nerror est. {100 * modal.error_estimate[mode - 1]:.1g} %')
    return ax


def grid_of(result: Study | Table) -> tuple[Reals, Integers]:
    """Returns nodes (x and y in mm), and those of each element, counted from 0."""
    study = study_of(result)
    element = np.column_stack([study.elements[f'node_{corner}'] for corner in range(1, 9)]) - 1
    return np.column_stack((study.nodes.x_mm, study.nodes.y_mm)), element


def edges(nodes: Reals, element: Integers) -> tuple[Reals, Reals]:
    """Returns curves (edge, point, axis) of all edges of eight-node elements, and of those on the boundary."""
    corner = np.arange(4)
    sides = element[:, np.stack((corner, corner + 4, (corner + 1) % 4), axis=1)].reshape(-1, 3)
    _, first, count = np.unique(np.sort(sides[:, ::2], axis=1), axis=0, return_index=True, return_counts=True)
    t = np.linspace(-1, 1, 5)
    functions = np.stack((t * (t - 1) / 2, 1 - t**2, t * (t + 1) / 2))
    curves = np.einsum('ijk,jl->ilk', nodes[sides[first]], functions)
    return curves, curves[count == 1]


def _draw_grid(ax: Axes, nodes: Reals, element: Integers, color: str) -> None:
    """Draws the grid in thin lines, as pixels also in vector graphics if they are many; its boundary in a stronger line."""
    every, outer = edges(nodes, element)
    thin: dict[str, Any] = {'linewidths': 0.2, 'alpha': 0.6, 'rasterized': len(every) > MANY}
    ax.add_collection(LineCollection([*every], colors=color, **thin))
    ax.add_collection(LineCollection([*outer], colors=color, linewidths=0.8))
    ax.autoscale_view()
    ax.set_aspect('equal')
