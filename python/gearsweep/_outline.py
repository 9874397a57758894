"""The outlines of both gears and where they touch, off the tables `outline`, `gears` and `contact_points`."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .study import Study

Reals = NDArray[np.float64]


def contact_path(study: Study, s: Reals) -> Reals:
    """Points x, y (mm) of the path of contact from the pinion's centre, the gear's centre straight above it."""
    angle = np.radians(study.geometry.working_angle_deg)
    along = (s - study.contact_points.at(point='P').s) * study.geometry.base_pitch_mm
    pitch = study.gears.at(member='pinion').base_diameter_mm / 2 / np.cos(angle)
    return np.column_stack((along * np.cos(angle), pitch + along * np.sin(angle)))


def flank_angle(study: Study, member: str, radius: float) -> float:
    """From the axis of the first tooth to its drive flank at this radius (mm), off the outline; rad."""
    tooth = first_tooth(study, member)
    radii, angles = np.hypot(*tooth.T), np.arctan2(*tooth.T)
    flank = slice(np.flatnonzero(radii > radii.max() * (1 - 1e-9))[-1], None)  # from the tip downwards
    return float(np.interp(radius, radii[flank][::-1], angles[flank][::-1]))


def whole(study: Study, member: str) -> Reals:
    """The outline x, y (mm) of a gear about its centre: all its teeth, or where there are more than 500 the first."""
    points = study.outline.at(member=member)
    return np.column_stack((points.x_mm, points.y_mm))


def first_tooth(study: Study, member: str) -> Reals:
    """The part of the outline of the first tooth and the space behind it."""
    outline = whole(study, member)
    return outline[: len(outline) // study.case.get(member, 'teeth') or len(outline)]


def turn_to(study: Study, member: str, touch: Reals) -> float:
    """By how much (rad, clockwise) the outline turns until the first tooth's drive flank goes through the point `touch`."""
    return float(np.arctan2(*touch) - flank_angle(study, member, float(np.hypot(*touch))))


def rotated(points: Reals, clockwise: float) -> Reals:
    cos, sin = np.cos(clockwise), np.sin(clockwise)
    return points @ np.array([[cos, -sin], [sin, cos]])
