"""The outlines of both gears as a drawing for CAD."""

from __future__ import annotations

import os

import numpy as np

from ..core.files import replacing
from ..core.outline import contact_path, first_tooth, mesh_angle, rotated
from ..core.study import Study


def write_dxf(study: Study, path: str | os.PathLike) -> None:
    """Writes the outlines of both gears in mesh as a drawing: a DXF file in mm, with a layer for each gear.

    The pinion's centre is the origin, that of the gear straight above it; the drive flanks touch in the middle of the path of contact. An
    outline is a closed polyline through the points of the table `outline`; a bore is a circle. Of helical gears it is the transverse
    section.

    Parameters
    ----------
    study : Study
        With the table `outline`, of the task `geometry`.
    path : path
        The file; an existing one is replaced when the new one is complete.

    Raises
    ------
    ImportError
        The package ezdxf is missing, which `pip install 'gearsweep[drawings]'` installs.
    AttributeError
        The study has no such table.
    Error
        The file cannot be written.
    """
    import ezdxf

    centre = np.array([0, study.geometry.centre_distance_mm])
    touch = contact_path(study, np.array([study.geometry.contact_ratio / 2]))[0]
    drawing = ezdxf.new('R2000', units=ezdxf.units.MM)
    space = drawing.modelspace()
    # The gear is drawn upside down, with its first tooth below its centre.
    for gear, place, way, point in (('pinion', np.zeros(2), 1, touch), ('gear', centre, -1, centre - touch)):
        drawing.layers.add(gear)
        teeth = study.case.get(gear, 'teeth')
        tooth = rotated(first_tooth(study, gear), mesh_angle(study, gear, point))
        outline = np.concatenate([rotated(tooth, 2 * np.pi * k / teeth) for k in range(teeth)])
        space.add_lwpolyline((place + way * outline).tolist(), close=True, dxfattribs={'layer': gear})
        bore = study.case.get(gear, 'bore_mm')
        if bore:
            space.add_circle(place.tolist(), bore / 2, dxfattribs={'layer': gear})
    with replacing(path) as new:
        drawing.saveas(new)
