"""Thamba et al. 2020: two equal gears of 60 teeth, data/thamba.nml; `id` is that of another row."""

import itertools
import math

from . import ledger, quantities
from .cases import given, result
from .quantities import hertz_half_width, load, pair_stiffness, radius, static_error

CASE, WHOLE, RELIEF = 'thamba', 'thamba+whole', 'deflection_relief'


def printed(id):
    """The printed number of another row."""
    return ledger.find('thamba2020', id).value


# Geometry and material

def young():
    """Young's modulus, Pa."""
    return 1e9 * given(CASE, 'material', 'young_gpa')


def shear_modulus():
    return young() / (2 * (1 + given(CASE, 'material', 'poisson')))


def diameter(which):
    return 2 * radius(CASE, 1, which)


def addendum():
    return (diameter('tip') - diameter('reference')) / 2


def dedendum():
    return (diameter('reference') - diameter('root')) / 2


def root_constant():
    """The 2.5 in r_f = m/2 (z + 2 x - 2.5), without profile shift."""
    return given(CASE, 'pinion', 'teeth') - diameter('root') / given(CASE, 'pair', 'module_mm')


def gear_ratio():
    return given(CASE, 'gear', 'teeth') / given(CASE, 'pinion', 'teeth')


# Table 4

def between(k):
    """Diameter k of rows 3 to 8, if the roll angle grows by equal steps from row 2 to row 9."""
    first, last = (_roll(printed(f'd_{row}')) for row in (2, 9))
    return diameter('base') * math.hypot(1, first + (k - 2) / 7 * (last - first))


def relief(k):
    """Eq. 1: linear in the diameter from the pitch circle on, from the printed relief at the tip."""
    flank = result('relief_flank', f'{RELIEF}+from-pitch')
    ours = flank.relief_by_diameter_um[(flank.method == 'markovic_vrcan') & (flank.gear == 'pinion')]
    return printed('r_10') * ours[k - 1] / ours[-1]


def method_relief(method):
    """Relief of both gears by a method of the task deflection_relief, mm."""
    return 1e-3 * _method(method).pinion_relief_um


def method_error(method):
    """Peak-to-peak static transmission error with it, um."""
    return _method(method).ste_range_um


def method_row(method):
    """Relief, um, the same, and the largest dynamic factor over the speeds with it."""
    return [1e3 * method_relief(method), method_error(method), _method(method).worst_dynamic_factor]


def formula_over_elements():
    """The deflection by the formula over that by finite elements, per cent more."""
    return 100 * (method_relief('whole_flattening') / method_relief('finite_elements') - 1)


def _method(method):
    return result('deflection_relief', RELIEF).at(method=method)


def corrected_relief(share=0.5):
    """Eqs. 2 to 16 as corrected (doc/validation.md), mm: half the flattening and the bending of a tooth loaded at its tip."""
    z, m, b = (given(CASE, *key) for key in (('pinion', 'teeth'), ('pair', 'module_mm'), ('pair', 'face_width_mm')))
    base, root, r_p = (radius(CASE, 1, which) for which in ('base', 'root', 'tip'))
    yielding = load(CASE) * (1 - given(CASE, 'material', 'poisson')**2) / (b * 1e-6 * young())
    flattening = 2 / math.pi * yielding * (1.27 + 0.781 * math.log(m / hertz_half_width(CASE)))
    alpha_b = math.acos(base / r_p)                                              # Eq. 10
    phi = math.pi / (2 * z) + _involute(math.radians(given(CASE, 'pair', 'pressure_angle_deg')))   # Eq. 13
    y_p = r_p * math.cos(alpha_b - (math.tan(alpha_b) - phi)) - root             # Eqs. 8, 12
    a = -1.05 + 153 * z**-1.75
    b, c, d = 0.63 + 7.35 / z, 1.28 - 2.88 / z, -1.06 + 0.638 * math.log(m * z)
    return yielding * (a + b * math.exp(c * y_p / m) + d) + share * flattening   # Eqs. 3, 16


def times_corrected():
    """The printed relief over that."""
    return printed('r_10') / corrected_relief()


def literal_error():
    """Range of the static transmission error with the printed relief on both gears, linear in the diameter from the
    pitch circle on, um: half a base pitch from P two pairs carry, each with the relief of that diameter; at P one, without."""
    middle = math.hypot(radius(CASE, 1, 'base'), _tangent() + quantities.base_pitch(CASE) / 2)
    cut = printed('r_10') * (2 * middle - diameter('reference')) / (diameter('tip') - diameter('reference'))
    two, one = (static_error(CASE, 'P', shift) for shift in (0.5, 0))
    return 1000 * cut + two - one


def relief_shift(amount_mm):
    """By how much relief raises the frequency of a disc that twists, per cent: half of what the moment of inertia loses.
    A wedge on each flank, from the pitch circle to the tip, off a disc as large as the reference circle."""
    tip, reference = (radius(CASE, 1, which) for which in ('tip', 'reference'))
    teeth = given(CASE, 'pinion', 'teeth')
    wedges = 2 * teeth * amount_mm * (tip - reference) / 2 * ((2 * tip + reference) / 3)**2
    return 50 * wedges / (math.pi / 2 * reference**4)


def relief_for_load():
    """Deflection of one pair at D under the whole load, mm."""
    return 1e-3 * load(CASE) / pair_stiffness(CASE, 'D')


# Deformation and stress

def disc_deflection():
    """Half the static transmission error at P, where one pair carries, on whole discs that turn about their bores, m."""
    return 0.5e-6 * static_error(WHOLE, 'P')


def root_tension():
    """Largest root stress, Pa."""
    return 1e6 * quantities.root_tension(CASE)


def hertz():
    """Contact pressure at the pitch point, Pa."""
    return 1e6 * quantities.hertz(CASE)


def alternating(cycles):
    """Stress, MPa, on the usual S-N curve of structural steel (ASME BPV VIII-2, 5-110.1), by logarithms between points."""
    curve = ((1e4, 262), (2e4, 214), (1e5, 138))
    (n1, s1), (n2, s2) = next(ends for ends in itertools.pairwise(curve) if ends[0][0] <= cycles <= ends[1][0])
    return s1 * (s2 / s1)**(math.log(cycles / n1) / math.log(n2 / n1))


# What the printed numbers say of each other

def grew(quantity, where):
    return printed(f'{quantity}_modified_{where}') > printed(f'{quantity}_involute_{where}')


def fell(quantity, where):
    return printed(f'{quantity}_modified_{where}') < printed(f'{quantity}_involute_{where}')


def deformation_up():
    """It grew everywhere, most at the root."""
    growth = {where: printed(f'deformation_modified_{where}') / printed(f'deformation_involute_{where}')
              for where in ('tip', 'pitch', 'root')}
    return min(growth.values()) > 1 and max(growth, key=growth.get) == 'root'


def stress_down():
    return all(fell('stress', where) for where in ('tip', 'pitch', 'root'))


def millimetres(id):
    return 1e3 * printed(id)


def difference():
    """Of the deformations that section 3.4 takes, mm."""
    return printed('tip_modified') - printed('tip_involute')


def theta():
    """Difference of the deformations over the tip radius, rad."""
    return difference() / (diameter('tip') / 2)


def omega():
    return math.pi * printed('speed') / 30


def power():
    return printed('torque') * omega()


def d_power():
    return printed('torque') * printed('theta')


def d_efficiency():
    """Per cent of the input power."""
    return 100 * d_power() / power()


def life_gain():
    return 100 * (printed('life_modified') / printed('life_involute') - 1)


def change(frequency):
    return 100 * (printed(f'{frequency}_modified') / printed(f'{frequency}_involute') - 1)


def angles(which):
    """Least and largest Delta / r, rad, of the radii and differences that the paper prints."""
    found = [delta / (printed(d) / 2) for delta in (difference(), printed('difference')) for d in ('root', 'pitch', 'tip')]
    return {'least': min, 'largest': max}[which](found)


def _tangent():
    """From the base circle to the pitch point along the line of action, mm."""
    return radius(CASE, 1, 'base') * math.tan(quantities.working_angle(CASE))


def _involute(angle):
    return math.tan(angle) - angle


def _roll(diameter_mm):
    """Roll angle of a point on the flank, rad."""
    return math.sqrt((diameter_mm / diameter('base'))**2 - 1)


# What friction in the mesh costs, which the paper leaves out

def friction_loss(relief):
    """With a coefficient of friction of 0.05 and this relief (um), per cent of the input power."""
    return 100 * (1 - quantities.losses(f'{CASE}+six-um+losses', 'efficiency', relief))


def no_change():
    """Does relief change the friction loss by less than a tenth?"""
    return abs(friction_loss(6) / friction_loss(0) - 1) < 0.1
