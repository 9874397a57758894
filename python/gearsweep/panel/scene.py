"""The tooth pair as the page draws and turns it."""

from __future__ import annotations

from typing import Any

import numpy as np

from .._library import Error
from .._outline import contact_path, first_tooth, rotated, turn_to
from ..case import Case
from ..study import Study, run

#: Points of a tooth that are enough on a screen.
_ENOUGH = 80


def scene(case: Case) -> dict[str, Any] | None:
    """Outlines, path of contact and how both gears turn with it; None where a case has no teeth.

    Lengths in mm from the pinion's centre, the gear's centre straight above it at `centre`. `tooth` is one tooth with the space
    behind it, as it stands when contact begins at A (s = 0), the gear's so much thinner or thicker on its coast side that
    the gap is the backlash that the case states. While s grows by 1, the pinion turns by `turn` clockwise, the
    gear by its own the other way.
    """
    try:
        # The outline does not hang on the grid, and the least grid is the quickest. Its backlash is what the teeth leave.
        study = run(case.changed(section={'elements_across': 3}, pair={'backlash_um': None}), 'section')
    except Error:
        return None
    geometry = study.geometry
    centre = np.array([0, geometry.centre_distance_mm])
    path = contact_path(study, study.contact_points.s)
    start = contact_path(study, np.array([0.0]))[0]
    stated = case.get('pair', 'backlash_um')
    wider = 0 if stated is None else 1e-3 * (stated - geometry.backlash_um)
    return {
        'centre': float(geometry.centre_distance_mm),
        'angle': float(np.radians(geometry.working_angle_deg)),
        'base_pitch': float(geometry.base_pitch_mm),
        'contact_ratio': float(geometry.contact_ratio),
        'module': float(geometry.module_mm),
        'start': start.tolist(),
        'points': [
            {'name': str(name), 's': float(s), 'place': place.tolist()}
            for name, s, place in zip(study.contact_points.point, study.contact_points.s, path)
        ],
        'pinion': _gear(study, 'pinion', start, False),
        'gear': _gear(study, 'gear', centre - start, True, wider),
    }


def _gear(study: Study, member: str, touch: np.ndarray, is_above: bool, wider: float = 0) -> dict[str, Any]:
    """One gear about its own centre; the one above is its own picture turned by half a turn. Its coast flanks stand back by
    `wider` mm along the line of action."""
    radius = study.gears.at(member=member).base_diameter_mm / 2
    tooth = rotated(_stood_back(first_tooth(study, member), wider / radius), turn_to(study, member, touch))
    tooth = tooth[:: max(1, len(tooth) // _ENOUGH)]
    return {
        'tooth': np.round(-tooth if is_above else tooth, 6).tolist(),
        'teeth': int(study.case.get(member, 'teeth')),
        'turn': float(study.geometry.base_pitch_mm / radius),
        'working_radius': float(radius / np.cos(np.radians(study.geometry.working_angle_deg))),
    }


def _stood_back(tooth: np.ndarray, turn: float) -> np.ndarray:
    """The coast side of a tooth, which comes first, turned by `turn` (rad) towards the drive side: at most by a quarter of the tip."""
    radii, angles = np.hypot(*tooth.T), np.arctan2(*tooth.T)
    tip = np.flatnonzero(radii > radii.max() * (1 - 1e-9))
    most = (angles[tip[-1]] - angles[tip[0]]) / 4
    coast = slice(0, tip[0] + 1)
    moved = tooth.copy()
    moved[coast] = rotated(tooth[coast], float(np.clip(turn, -most, most)))
    return moved
