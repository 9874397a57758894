"""Outlines of both gears and their contact, from the tables `outline`, `gears` and `contact_points`."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .study import Study

Reals = NDArray[np.float64]


def contact_path(study: Study, s: Reals) -> Reals:
    """Returns points x, y (mm) of the path of contact from the pinion's centre; the gear's centre is straight above it."""
    angle = np.radians(study.geometry.working_angle_deg)
    along = (s - study.contact_points.at(point='P').s) * study.geometry.base_pitch_mm
    pitch = study.gears.at(gear='pinion').base_diameter_mm / 2 / np.cos(angle)
    return np.column_stack((along * np.cos(angle), pitch + along * np.sin(angle)))


def flank_angle(study: Study, gear: str, radius: float) -> float:
    """Returns the angle (rad) from the axis of the first tooth to its drive flank at this radius (mm), from the outline."""
    tooth = first_tooth(study, gear)
    radii, angles = np.hypot(*tooth.T), np.arctan2(*tooth.T)
    flank = slice(np.flatnonzero(radii > radii.max() * (1 - 1e-9))[-1], None)  # from the tip downwards
    return float(np.interp(radius, radii[flank][::-1], angles[flank][::-1]))


def outline_of(study: Study, gear: str) -> Reals:
    """Returns the outline x, y (mm) of a gear about its centre: all its teeth or, if there are more than 500, the first one."""
    points = study.outline.at(gear=gear)
    return np.column_stack((points.x_mm, points.y_mm))


def first_tooth(study: Study, gear: str) -> Reals:
    """Returns the part of the outline with the first tooth and the space after it."""
    outline = outline_of(study, gear)
    return outline[: len(outline) // study.case.get(gear, 'teeth') or len(outline)]


def mesh_angle(study: Study, gear: str, touch: Reals) -> float:
    """Returns the angle (rad, clockwise) by which the outline turns until the first tooth's drive flank passes the point
    `touch`.
    """
    return float(np.arctan2(*touch) - flank_angle(study, gear, float(np.hypot(*touch))))


def rotated(points: Reals, clockwise: float) -> Reals:
    cos, sin = np.cos(clockwise), np.sin(clockwise)
    return points @ np.array([[cos, -sin], [sin, cos]])
