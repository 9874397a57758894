"""What several papers print: geometry, load and contact of a case by its name; mm, N, MPa."""

import math

import numpy as np

from .cases import given, result


def radius(name, member, which):
    """Radius of a circle of member 1 or 2: tip, reference, root, base of the drive flanks."""
    geometry = result('geometry', name)
    which = 'drive base' if which == 'base' else which
    return geometry.radius_mm[geometry.labels['circle'].index(which), member - 1]


def pitch_radius(name, member):
    """Radius of the working pitch circle."""
    return radius(name, member, 'base') / math.cos(working_angle(name))


def working_angle(name):
    """Of the drive flanks, rad."""
    return math.radians(result('geometry', name).working_angle_deg[0])


def contact_ratio(name):
    return result('geometry', name).contact_ratio


def base_pitch(name):
    return result('geometry', name).base_pitch_mm


def point(name, letter):
    """Distance of a point of the path of contact from A."""
    return _at(name, letter) * base_pitch(name)


def point_radius(name, letter):
    """Radius at which the pinion touches there."""
    geometry = result('geometry', name)
    return geometry.point_radius_mm[geometry.labels['place'].index(letter), 0]


def line_of_action(name):
    """Its length between the base circles."""
    return (radius(name, 1, 'base') + radius(name, 2, 'base')) * math.tan(working_angle(name))


def load(name):
    """Static load on the line of action."""
    return result('motion', name).load_n


def pair_stiffness(name, letter):
    """Of one pair at a point of the path of contact, N/um."""
    mesh = result('mesh', name)
    return np.interp(_at(name, letter), mesh.s, mesh.pair_n_um)


def static_error(name, letter):
    """Static transmission error while a pair touches at a point of the path of contact, um."""
    mesh = result('mesh', name)
    return np.interp(_at(name, letter), mesh.s, mesh.ste_um)


def hertz(name):
    """Largest contact pressure at the pitch point, where one pair carries the whole load."""
    curvature = [radius(name, member, 'base') * math.tan(working_angle(name)) for member in (1, 2)]
    reduced = curvature[0] * curvature[1] / sum(curvature)
    modulus = 1e3 * given(name, 'material', 'young_gpa') / (2 * (1 - given(name, 'material', 'poisson')**2))
    return math.sqrt(load(name) / given(name, 'pair', 'face_width_mm') * modulus / (math.pi * reduced))


def iso_root_stress(name):
    """sigma_F0 by ISO 6336-3."""
    return result('static', name).iso_mpa


def root_tension(name):
    """Largest stress in the fillets."""
    return result('static', name).tension_mpa[0]


def mode(name, k):
    """Natural frequency of the section, Hz."""
    return result('modal', name).frequency_hz[k - 1]


def _at(name, letter):
    """Path coordinate of a point, base pitches from A."""
    geometry = result('geometry', name)
    return geometry.point[geometry.labels['place'].index(letter)]
