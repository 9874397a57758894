"""The tooth pair as data for the page, which draws and rotates it."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..core.case import Case
from ..core.library import Error
from ..core.outline import contact_path, first_tooth, mesh_angle, rotated
from ..core.study import Study, run

#: Number of points of a tooth for a screen.
_ENOUGH = 80


def scene(case: Case) -> dict[str, Any] | None:
    """Returns outlines, path of contact and the rotation of both gears along it; None for a case without teeth.

    Lengths in mm from the pinion's centre, the gear's centre straight above it at `centre`. `tooth` is one tooth with the space
    after it, in its position when contact begins at A (s = 0); the coast side of the gear's tooth is displaced so that the gap is
    the backlash of the case. While s grows by 1, the pinion turns by `turn` clockwise, the gear by its own angle in the opposite
    direction.
    """
    try:
        # The backlash of the outlines is that of the teeth.
        study = run(case.changed(pair={'backlash_um': None}), 'geometry')
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


def _gear(study: Study, gear: str, touch: np.ndarray, is_above: bool, wider: float = 0) -> dict[str, Any]:
    """Returns one gear about its own centre; the upper one is rotated by half a turn. Its coast flanks are displaced by `wider` mm
    along the line of action.
    """
    radius = study.gears.at(gear=gear).base_diameter_mm / 2
    tooth = rotated(_with_backlash(first_tooth(study, gear), wider / radius), mesh_angle(study, gear, touch))
    tooth = tooth[:: max(1, len(tooth) // _ENOUGH)]
    return {
        'tooth': np.round(-tooth if is_above else tooth, 6).tolist(),
        'teeth': int(study.case.get(gear, 'teeth')),
        'turn': float(study.geometry.base_pitch_mm / radius),
        'working_radius': float(radius / np.cos(np.radians(study.geometry.working_angle_deg))),
    }


def _with_backlash(tooth: np.ndarray, turn: float) -> np.ndarray:
    """Turns the coast side of a tooth, which comes first, by `turn` (rad) towards the drive side: at most by a quarter of the tip."""
    radii, angles = np.hypot(*tooth.T), np.arctan2(*tooth.T)
    tip = np.flatnonzero(radii > radii.max() * (1 - 1e-9))
    most = (angles[tip[-1]] - angles[tip[0]]) / 4
    coast = slice(0, tip[0] + 1)
    moved = tooth.copy()
    moved[coast] = rotated(tooth[coast], float(np.clip(turn, -most, most)))
    return moved
