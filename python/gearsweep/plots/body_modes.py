"""Modes of a complete gear in three dimensions."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.tri import Triangulation

from ..core.study import Study
from ..core.table import Table
from .body import edges
from .look import GREY, INK, MM, canvas, in_khz
from .reliefs import Integers, Reals, study_of
from .stress import TRIANGLES


def plot_body_modes(modes: Study | Table, ax: Axes | None = None, *, mode: int = 1) -> Axes:
    """Draws a mode of the gear seen from the front, deformed to no scale over its undeformed outline.

    The colour is the axial displacement if that has most of the kinetic energy, red towards the viewer, otherwise the magnitude of
    the displacement in the plane.

    Parameters
    ----------
    modes : Study or Table
        A study, or its table `body_modes`.
    ax : Axes, optional
        Axes to draw into; otherwise a figure is made.
    mode : int
        Number of the mode, from 1 for the lowest, among those whose shapes the study has.

    Returns
    -------
    Axes
    """
    study = study_of(modes)
    modes = study.body_modes
    most = len(study.body_shapes.axial_cos)
    if not 1 <= mode <= most:
        raise ValueError(f'mode = {mode}: must be from 1 to {most}')
    nodes, element, moved = whole_gear(study, mode)
    is_axial = modes.axial_share[mode - 1] > 0.5
    value = moved[:, 2] if is_axial else np.hypot(moved[:, 0], moved[:, 1])
    largest = np.abs(value).max()
    scale = 0.08 * np.abs(nodes).max() / np.linalg.norm(moved, axis=1).max()
    place = nodes + scale * moved[:, :2]
    net = Triangulation(place[:, 0], place[:, 1], element[:, TRIANGLES].reshape(-1, 3))
    with canvas(ax, height=85 * MM) as ax:
        shades = ax.tripcolor(net, value / largest, shading='gouraud', rasterized=True, cmap='RdBu_r' if is_axial else 'YlGnBu',
                     vmin=-1 if is_axial else 0, vmax=1)  # fmt: skip
        ax.add_collection(LineCollection([*_outline(nodes, element)], colors=GREY, linewidths=0.3))
        ax.add_collection(LineCollection([*_outline(place, element, nodes)], colors=INK, linewidths=0.5))
        ax.set_aspect('equal')
        ax.set_axis_off()
        bar = ax.figure.colorbar(shades, ax=ax, shrink=0.7, aspect=30, pad=0.02, ticks=[-1, 0, 1] if is_axial else [0, 1],
                                 label=f'Displacement {"along the axis" if is_axial else "in the plane"} (of the largest)')  # fmt: skip
        bar.outline.set_linewidth(0.6)
        ax.set_title(f'{mode}: {modes.mode_name[mode - 1]}, {in_khz(modes.frequency_hz[mode - 1])}\n'
                     f'error est. {100 * modes.error_estimate[mode - 1]:.2g} %')  # fmt: skip
    return ax


def whole_gear(study: Study, mode: int) -> tuple[Reals, Integers, Reals]:
    """Returns nodes on the front of all sectors (x and y in mm), those of each element, counted from 0, and their displacements in
    x, y and z by a mode.
    """
    shapes, table = study.body_shapes, study.body_nodes
    sectors = int(np.ravel(study.gear_body.sectors)[0])
    waves = study.body_modes.nodal_diameter[mode - 1]
    parts = [[shapes[f'{way}_{part}'][mode - 1] for part in ('cos', 'sin')] for way in ('radial', 'tangential', 'axial')]
    element = np.column_stack([study.body_elements[f'node_{k}'] for k in range(1, 9)]) - 1
    turn = 2 * np.pi / sectors * np.arange(sectors)[:, None]
    angle = np.arctan2(table.y_mm, table.x_mm) + turn
    radius = np.hypot(table.x_mm, table.y_mm)
    radial, tangential, axial = (np.cos(waves * turn) * first - np.sin(waves * turn) * second for first, second in parts)
    moved = np.stack((radial * np.cos(angle) - tangential * np.sin(angle),
                      radial * np.sin(angle) + tangential * np.cos(angle), axial), axis=-1)  # fmt: skip
    nodes = np.stack((radius * np.cos(angle), radius * np.sin(angle)), axis=-1)
    every = element + len(radius) * np.arange(sectors)[:, None, None]
    return nodes.reshape(-1, 2), every.reshape(-1, 8), moved.reshape(-1, 3)


def _outline(place: Reals, element: Integers, rest: Reals | None = None) -> Reals:
    """Returns the curves of the boundary; without the cuts between sectors, which are radial in the undeformed gear."""
    rest = place if rest is None else rest
    _, outer = edges(rest, element)
    ends = outer[:, ::4]
    across = np.abs(ends[:, 0, 0] * ends[:, 1, 1] - ends[:, 0, 1] * ends[:, 1, 0])
    is_cut = across < 1e-6 * np.hypot(*ends[:, 0].T) * np.hypot(*ends[:, 1].T)
    return edges(place, element)[1][~is_cut]
