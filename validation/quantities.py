"""What several papers print: geometry, load and contact of a case by its name; mm, N, MPa."""

import math

import numpy as np

from .cases import given, result


def radius(name, gear, which):
    """Radius of a circle of gear 1 or 2: tip, reference, root, base of the drive flanks."""
    return result('gears', name)[f'{which}_diameter_mm'][gear - 1] / 2


def pitch_radius(name, gear):
    """Radius of the working pitch circle."""
    return radius(name, gear, 'base') / math.cos(working_angle(name))


def working_angle(name):
    """Of the drive flanks, rad."""
    return math.radians(result('geometry', name).working_angle_deg)


def diameter(name, gear, which):
    """Of the circles of `radius`, and of `form`, where the involute begins; on `working` both gears roll."""
    return 2 * (pitch_radius(name, gear) if which == 'working' else radius(name, gear, which))


def working_angle_deg(name):
    return math.degrees(working_angle(name))


def tip_thickness(name, gear):
    """Of a tooth, on its tip circle, between its edge breaks."""
    return result('gears', name).tip_thickness_mm[gear - 1]


def chamfer(name, gear):
    """Height of the edge break."""
    return radius(name, gear, 'tip') - radius(name, gear, 'tip_form')


def span(name, gear, teeth):
    """Span measurement over some teeth."""
    gears = result('gears', name)
    return gears.span_mm[gear - 1] + (teeth - gears.span_teeth[gear - 1]) * base_pitch(name)


def contact_length(name):
    """Of the path of contact."""
    return contact_ratio(name) * base_pitch(name)


def contact_ratio(name):
    return result('geometry', name).contact_ratio


def base_pitch(name):
    return result('geometry', name).base_pitch_mm


def point(name, letter):
    """Distance of a point of the path of contact from A."""
    return _at(name, letter) * base_pitch(name)


def point_radius(name, letter):
    """Radius at which the pinion touches there."""
    return result('contact_points', name).at(point=letter).pinion_radius_mm


def line_of_action(name):
    """Its length between the base circles."""
    return (radius(name, 1, 'base') + radius(name, 2, 'base')) * math.tan(working_angle(name))


def load(name):
    """Static load on the line of action."""
    return result('motion', name).load_n


def pair_stiffness(name, letter):
    """Of one pair at a point of the path of contact, N/um."""
    mesh = result('mesh', name)
    return np.interp(_at(name, letter), mesh.s, mesh.pair_stiffness_n_um)


def static_error(name, letter, shift=0):
    """Static transmission error while a pair touches at a point of the path of contact, or base pitches behind it, um."""
    mesh = result('mesh', name)
    return np.interp(_at(name, letter) + shift, mesh.s, mesh.ste_um)


def peak_to_peak(name, relief):
    """Of the static transmission error with this relief, um."""
    table = result('transmission_error', name)
    return table.peak_to_peak_um[list(table.relief_um).index(relief)]


def worst_factor(name, relief):
    """Largest dynamic factor over all speeds with this relief."""
    table = result('sweep', name)
    return table.dynamic_factor[list(table.relief_um).index(relief)].max()


def tangential_load(name):
    """At the working pitch circle, N: torque over its radius."""
    return load(name) * math.cos(working_angle(name))


def radial_load(name):
    return load(name) * math.sin(working_angle(name))


def hertz(name, letter='P', share=1):
    """Largest contact pressure at a point of the path of contact, where one pair carries this share of the load."""
    first = math.sqrt(point_radius(name, letter)**2 - radius(name, 1, 'base')**2)
    reduced = first * (line_of_action(name) - first) / line_of_action(name)
    modulus = 1e3 * given(name, 'material', 'young_gpa') / (2 * (1 - given(name, 'material', 'poisson')**2))
    return math.sqrt(share * load(name) / given(name, 'pair', 'face_width_mm') * modulus / (math.pi * reduced))


def hertz_mean(name):
    return math.pi / 4 * hertz(name)


def hertz_half_width(name):
    """Half the width of the contact at the pitch point."""
    return 2 * load(name) / given(name, 'pair', 'face_width_mm') / (math.pi * hertz(name))


def losses(name, column, relief=0):
    """A column of what the mesh loses under the static load, with this relief: a factor, W, or um and MPa of an extreme."""
    table = result('flank_losses', name)
    here = (table.loading == 'static').ravel()
    return table[column][list(table.relief_um).index(relief), 0, list(here).index(True)]


def along_path(name, column, which):
    """The least or largest value of a column of the contact along the path, under the static load."""
    table = result('flank', name)
    return {'least': np.nanmin, 'largest': np.nanmax}[which](table[column][table.loading == 'static'])


def largest_sliding(name, gear):
    """Largest specific sliding of pinion or gear, without its sign."""
    return np.abs(result('flank', name)[f'{gear}_specific_sliding']).max()


def at_pitch_point(name, column):
    """The contact at the pitch point under the static load."""
    table = result('flank', name)
    here = table.loading == 'static'
    return np.interp(_at(name, 'P'), table.s[here], table[column][here])


def iso_root_stress(name):
    """sigma_F0 by ISO 6336-3."""
    return result('root_rating', name).iso_mpa


def iso_root_stress_working(name):
    """The same with the tangential force of the working pitch circle, where ISO 6336-3 takes that of the reference circle."""
    gear = 2 if given(name, 'section', 'gear') == 'gear' else 1
    return iso_root_stress(name) * radius(name, gear, 'reference') / pitch_radius(name, gear)


def form_factor(name, which):
    """Y_F, Y_S by ISO 6336-3."""
    return result('root_rating', name)[{'Y_F': 'iso_form_factor', 'Y_S': 'iso_stress_correction'}[which]]


def root_section(name, which):
    """Of ISO 6336-3: thickness_mm (s_Fn), lever_mm (h_Fe), radius_mm (rho_F), angle_deg (alpha_Fen)."""
    return result('root_rating', name)[f'iso_{which}']


def rating_factor(name, column):
    """A factor of the pinion's rating by ISO 6336."""
    return result('rating_factors', name)[column][0]


def dynamic_factor_b(name):
    """K_v by ISO 6336-1, Method B, at the first speed."""
    return result('dynamic_factors', name).dynamic_factor_b.ravel()[0]


def root_tension(name):
    """Largest stress in the fillets."""
    return result('root_stress', name).tension_mpa[0]


def mode(name, k):
    """Natural frequency of the section, Hz."""
    return result('modal', name).frequency_hz[k - 1]


def body_mode(name, k):
    """Natural frequency of a whole gear in three dimensions, Hz."""
    return result('body_modes', name).frequency_hz[k - 1]


def _at(name, letter):
    """Path coordinate of a point, base pitches from A."""
    return result('contact_points', name).at(point=letter).s
