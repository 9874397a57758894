"""The drawing of both gears, read again by the package ezdxf: circles and touching flanks as the gears have them."""

import ezdxf
import numpy as np
import pytest

import gearsweep
from gearsweep import Case

# The bore is for the drawing alone.
pytestmark = pytest.mark.filterwarnings('ignore::gearsweep.UnusedWarning')

CASE = Case.build(
    case={'tasks': 'geometry'},
    pair={'module_mm': 3, 'face_width_mm': 20},
    pinion={'teeth': 21, 'profile_shift': 0.3, 'bore_mm': 20},
    gear={'teeth': 34},
)


@pytest.fixture(scope='module')
def study():
    return gearsweep.run(CASE)


@pytest.fixture(scope='module')
def drawing(study, tmp_path_factory):
    path = tmp_path_factory.mktemp('drawing') / 'a pair.dxf'
    gearsweep.write_dxf(study, path)
    return ezdxf.readfile(path)


def outlines(drawing):
    """The points of each gear's outline, by its layer."""
    lines = {line.dxf.layer: line for line in drawing.modelspace().query('LWPOLYLINE')}
    assert all(line.closed for line in lines.values())
    return {layer: np.array(line.get_points('xy')) for layer, line in lines.items()}


def test_is_in_mm_and_without_faults(drawing):
    assert drawing.units == ezdxf.units.MM
    assert not drawing.audit().errors
    assert {layer.dxf.name for layer in drawing.layers} >= {'pinion', 'gear'}


@pytest.mark.parametrize('gear, place, turn', [('pinion', 0, 1), ('gear', 1, -1)])
def test_outline_of_a_gear(study, drawing, gear, place, turn):
    """Tip and root circles about its centre; each tooth as the next one; clockwise, with the area between both circles."""
    centre = np.array([0, place * study.geometry.centre_distance_mm])
    points = outlines(drawing)[gear] - centre
    row = study.gears.at(gear=gear)
    radii = np.hypot(*points.T)
    assert radii.max() == pytest.approx(row.tip_diameter_mm / 2, rel=1e-9)
    assert radii.min() == pytest.approx(row.root_diameter_mm / 2, rel=1e-9)
    teeth = CASE.get(gear, 'teeth')
    assert np.allclose(radii.reshape(teeth, -1), radii[: len(radii) // teeth], rtol=1e-12)
    angles = np.unwrap(np.arctan2(*points.T))
    assert angles[-1] - angles[0] == pytest.approx(2 * np.pi, rel=0.02)


def test_flanks_touch_and_do_not_overlap(study, drawing):
    """At the middle of the path both outlines pass one point; nowhere is a gear's point inside the pinion by more than the polylines'
    deviation from the involutes.
    """
    from matplotlib.path import Path

    pinion, gear = outlines(drawing)['pinion'], outlines(drawing)['gear']
    assert not Path(pinion).contains_points(gear, radius=-0.002).any()
    near = np.array([np.hypot(*(gear - point).T).min() for point in pinion])
    assert near.min() < 0.2


def test_bores(drawing):
    circles = drawing.modelspace().query('CIRCLE')
    assert [(circle.dxf.layer, circle.dxf.radius, tuple(circle.dxf.center)) for circle in circles] == [('pinion', 10, (0, 0, 0))]


def test_a_helical_pair_and_refusals(tmp_path):
    helical = gearsweep.run(CASE.changed(pair={'helix_angle_deg': 20}))
    gearsweep.write_dxf(helical, tmp_path / 'helical.dxf')
    points = outlines(ezdxf.readfile(tmp_path / 'helical.dxf'))['pinion']
    assert np.hypot(*points.T).max() == pytest.approx(helical.gears.at(gear='pinion').tip_diameter_mm / 2, rel=1e-9)
    with pytest.raises(AttributeError, match='outline'):
        gearsweep.write_dxf(gearsweep.run(CASE.changed(case={'tasks': 'mesh'}, load={'torque_nm': 100})), tmp_path / 'none.dxf')
    with pytest.raises(gearsweep.Error):
        gearsweep.write_dxf(helical, tmp_path / 'no folder' / 'a.dxf')
    assert not list(tmp_path.glob('none*'))
