"""Stress on the section."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.ticker import MaxNLocator
from matplotlib.tri import Triangulation

from ..core.study import Study
from ..core.table import Table
from .body import edges, grid_of
from .look import INK, MM, canvas, in_mm
from .reliefs import Reals, table_of

#: Triangles of an eight-node element, by its nodes.
TRIANGLES = np.array([(0, 4, 7), (4, 1, 5), (5, 2, 6), (6, 3, 7), (4, 5, 7), (5, 6, 7)])


def plot_stress(stress: Study | Table, ax: Axes | None = None) -> Axes:
    """Draws the stress around the loaded tooth: the principal stress of larger magnitude.

    Lines are full in tension and dashed in compression. The scale ends with the largest stress below the form circle; larger
    stresses, such as those under the load, have the colour of its end. The arrow is the load.

    Parameters
    ----------
    stress : Study or Table
        A study, or its table `stress`.
    ax : Axes, optional
        Axes to draw into; otherwise a figure is made.

    Returns
    -------
    Axes
    """
    stress = table_of(stress, 'stress')
    study, load = stress.study, stress.study.stress_load
    which = study.case.get('section', 'gear')
    gear = study.gears.at(gear=which)
    tip, root, form = (diameter / 2 for diameter in (gear.tip_diameter_mm, gear.root_diameter_mm, gear.form_diameter_mm))
    value = principal(stress.sigma_x_mpa, stress.sigma_y_mpa, stress.tau_xy_mpa)
    nodes, element = grid_of(study)
    most = np.abs(value[np.hypot(*nodes.T) < form]).max()
    levels = np.array(MaxNLocator(14, symmetric=True).tick_values(-most, most))
    labelled = levels[levels.size // 2 % 2 :: 2]  # every second one, including 0
    levels = levels[levels != 0]  # a line between weak tension and weak compression has no meaning
    net = Triangulation(nodes[:, 0], nodes[:, 1], element[:, TRIANGLES].reshape(-1, 3))
    with canvas(ax, height=55 * MM) as ax:
        fill = ax.tricontourf(net, value, levels, cmap='RdBu_r', extend='both')
        ax.tricontour(net, value, levels, colors=INK, linewidths=0.25)
        outer = edges(nodes, element)[1]
        ax.add_collection(LineCollection([*outer], colors=INK, linewidths=0.7))
        ax.figure.colorbar(fill, ax=ax, label='Principal stress (MPa)', ticks=labelled, spacing='proportional')
        _arrow(ax, study, which, outer)
        in_mm(ax)
        ax.set_title(f'{100 * load.load_share:.3g} % of the load, tip relief {load.relief_um:g} µm,\nat s = {load.s:.3g} base pitches')
        _look_at_tooth(ax, nodes, tip, root)
    return ax


def principal(x: Reals, y: Reals, xy: Reals) -> Reals:
    """Returns the principal stress of larger magnitude."""
    mean = (x + y) / 2
    return mean + np.copysign(np.hypot((x - y) / 2, xy), mean)


def _arrow(ax: Axes, study: Study, gear: str, outer: Reals) -> None:
    """Draws the load as an arrow, along the line of action, onto the drive flank of the loaded tooth."""
    load, base = study.stress_load, study.gears.at(gear=gear).base_diameter_mm / 2
    flank = flank_angle(study, gear, outer, load.radius_mm)
    along = flank - np.arccos(min(1, base / load.radius_mm))
    point = load.radius_mm * np.array([np.sin(flank), np.cos(flank)])
    tail = 28 * np.array([np.cos(along), -np.sin(along)])  # printer's points
    arrow = {'arrowstyle': '-|>', 'color': INK, 'linewidth': 0.9, 'shrinkA': 0, 'shrinkB': 0, 'mutation_scale': 7}
    ax.annotate('', (point[0], point[1]), (tail[0], tail[1]), textcoords='offset points', arrowprops=arrow)


def flank_angle(study: Study, gear: str, outer: Reals, radius: float) -> float:
    """Returns the angle (rad) from y to the loaded tooth's drive flank at this radius (mm), from the boundary of the grid.

    The loaded tooth is the middle one of the section; for an even number, the one left of the middle.
    """
    teeth = study.case.get(gear, 'teeth')
    axis = 0.0 if (study.case.get('section', 'teeth') or teeth) % 2 else -np.pi / teeth
    first, last = outer[:, :-1].reshape(-1, 2), outer[:, 1:].reshape(-1, 2)
    rise = np.hypot(*first.T) - radius, np.hypot(*last.T) - radius
    crosses = (rise[0] <= 0) != (rise[1] <= 0)
    part = (rise[0] / (rise[0] - rise[1]))[crosses, None]
    found = np.arctan2(*(first[crosses] + part * (last - first)[crosses]).T) - axis
    return axis + float(found[(found > 0) & (found < np.pi / teeth)].max())


def _look_at_tooth(ax: Axes, nodes: Reals, tip: float, root: float) -> None:
    """Sets limits around the loaded tooth and the body below it, or the complete section if that is smaller."""
    height = tip - root
    low, high = nodes.min(axis=0), nodes.max(axis=0)
    ax.set_xlim(max(low[0], -2 * height), min(high[0], 2 * height))
    ax.set_ylim(max(low[1], root - 1.2 * height), tip + 0.1 * height)
