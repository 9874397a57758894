"""The outlines of both gears in mesh."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, Polygon
from matplotlib.path import Path

from ..core.outline import contact_path, first_tooth, mesh_angle, outline_of, rotated
from ..core.study import Study
from ..core.table import Table
from .look import ACCENT, GREY, HALO, INK, MM, canvas, in_mm, legends_above
from .reliefs import Reals, study_of

#: Line style of the working pitch circles.
PITCH = (0, (8, 2, 2, 2))

FILL = {'pinion': '#dbe6ee', 'gear': '#ececec'}


def plot_geometry(study: Study | Table, ax: Axes | None = None) -> Axes:
    """Draws the teeth around the path of contact with its points A, B, P, D, E; the pinion below drives to the right.

    Of a study or any of its tables. Contact is in the middle of the path. Thin lines are the line of action and the working pitch circles. The
    gears are complete, so that `ax.autoscale()` shows all teeth; a gear with more than 500 teeth has only those nearby.
    """
    study = study_of(study)
    geometry = study.geometry
    centre = np.array([0, geometry.centre_distance_mm])
    touch = contact_path(study, np.array([geometry.contact_ratio / 2]))[0]
    pinion = _turned(study, 'pinion', touch)
    gear = centre - _turned(study, 'gear', centre - touch)
    path = contact_path(study, study.contact_points.s)
    with canvas(ax, height=60 * MM) as ax:
        for outline, fill in zip((pinion, gear), FILL.values()):
            ax.add_patch(Polygon(outline, facecolor=fill, edgecolor=INK, linewidth=0.7, joinstyle='round'))
        pitch = study.gears.base_diameter_mm / 2 / np.cos(np.radians(geometry.working_angle_deg))
        for place, radius in zip(((0.0, 0.0), (0.0, float(geometry.centre_distance_mm))), pitch):
            ax.add_patch(Circle(place, radius, fill=False, edgecolor=GREY, linewidth=0.5, linestyle=PITCH))
        ax.axline(path[0], path[-1], color=GREY, linewidth=0.5)
        ax.plot(*path.T, color=ACCENT, marker='o', markersize=3, markerfacecolor='white', markeredgewidth=0.7)
        for name, place, rise in zip(study.contact_points.point, path, (4, -10, 4, -10, 4)):
            ax.annotate(name, place, (0, rise), textcoords='offset points', ha='center', color=ACCENT, path_effects=HALO)
        in_mm(ax)
        reach = 1.1 * geometry.base_pitch_mm * max(1.6, geometry.contact_ratio)
        ax.set_xlim(touch[0] - reach, touch[0] + reach)
        ax.set_ylim(touch[1] - 0.55 * reach, touch[1] + 0.55 * reach)
        _names(ax, {'pinion': (pinion, np.zeros(2), 1), 'gear': (gear, centre, -1)})
        legends_above(ax, ('', [Line2D([], [], color=GREY, linewidth=0.5, label='line of action'),
                                Line2D([], [], color=GREY, linewidth=0.5, linestyle=PITCH, label='working pitch circles')]))  # fmt: skip
    return ax


def _names(ax: Axes, gears: dict[str, tuple[Reals, Reals, int]]) -> None:
    """Names each gear (outline, centre, turning clockwise: 1, else -1) at its edge of the picture and within its teeth, with an
    arrow for its rotation.
    """
    for (name, (outline, centre, way)), height in zip(gears.items(), (0.09, 0.91)):
        inside = Path(outline)
        place = ax.transAxes + ax.transData.inverted()
        for at in np.linspace(0.03, 0.7, 40):
            if inside.contains_points(place.transform([(at + x, height + y) for x in (0, 0.28) for y in (-0.06, 0.06)])).all():
                break
        ax.annotate(name, (at, height), xycoords='axes fraction', va='center', path_effects=HALO)
        begin, end = place.transform([(at + 0.15, height), (at + 0.28, height)])
        arm = begin - centre
        chord = np.linalg.norm(end - begin) * way * np.array([arm[1], -arm[0]]) / np.linalg.norm(arm)
        ax.annotate('', begin + chord, begin, arrowprops={'arrowstyle': '-|>', 'color': INK, 'linewidth': 0.8, 'mutation_scale': 7,
                                                          'shrinkA': 0, 'shrinkB': 0})  # fmt: skip


def _turned(study: Study, gear: str, touch: Reals) -> Reals:
    """Returns the outline about its centre, turned until the first tooth's drive flank passes the point `touch`."""
    outline = outline_of(study, gear)
    turn = mesh_angle(study, gear, touch)
    if len(first_tooth(study, gear)) < len(outline):
        return rotated(outline, turn)
    pitch = 2 * np.pi / study.case.get(gear, 'teeth')
    some = np.concatenate([rotated(outline, turn + k * pitch) for k in range(-4, 5)])
    return np.vstack((0.9 * some[0], some, 0.9 * some[-1]))
