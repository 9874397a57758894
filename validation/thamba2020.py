"""Thamba et al. 2020: two equal gears of 60 teeth, data/thamba.nml; `id` is that of another row."""

import math

from . import ledger, quantities
from .cases import given
from .quantities import load, pair_stiffness, radius, static_error

CASE, WHOLE = 'thamba', 'thamba+whole'


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
    """Eq. 1: linear in the diameter, from the printed relief at the tip."""
    return printed('r_10') * (printed(f'd_{k}') - diameter('reference')) / (diameter('tip') - diameter('reference'))


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


def _roll(diameter_mm):
    """Roll angle of a point on the flank, rad."""
    return math.sqrt((diameter_mm / diameter('base'))**2 - 1)
