"""Hassan, Thanigaiyarasu, Ramamurti 2009: the three-tooth section of data/hassan.nml, and the tooth as a beam.

Lengths in mm, stress in MPa, as printed; `id` is that of another row.
"""

import functools
import math

import numpy as np

from . import ledger
from .cases import JUMPS, given, result
from .quantities import load, mode, radius

CASE = 'hassan'
COMMON_STEEL = 2.07e5, 7.8e-9  # Young's modulus, N/mm2, and density, N s2/mm4
MOVING = 'hassan_transient'
COAST = 1
COMPONENTS = {'x': 'sigma_x_mpa', 'y': 'sigma_y_mpa', 'xy': 'tau_xy_mpa'}


def printed(id):
    """The printed number of another row."""
    return ledger.find('hassan2009', id).value


def ratio(id, other):
    return printed(id) / printed(other)


def twice(id):
    return 2 * printed(id)


def angular(id):
    """A frequency in rad/s."""
    return 2 * math.pi * printed(id)


# Geometry, material and load of the case

def young():
    """Young's modulus, N/mm2."""
    return 1e3 * given(CASE, 'material', 'young_gpa')


def density():
    """Density, N s2/mm4."""
    return 1e-12 * given(CASE, 'material', 'density_kgm3')


def pitch_diameter():
    return 2 * radius(CASE, 1, 'reference')


def backup_ratio():
    """Rim over tooth height."""
    return given(CASE, 'section', 'rim_mm') / _height()


def tangential_force():
    return load(CASE) * math.cos(_angle())


def radial_force():
    return load(CASE) * math.sin(_angle())


# The tooth as a beam, as thick as on the reference circle; its length is the stated one, or `r_a-r_b`

def tip_over_base():
    """The length r_a - r_b, mm."""
    return radius(CASE, 1, 'tip') - radius(CASE, 1, 'base')


def common_steel():
    """E and rho, as one may take them for steel."""
    return COMMON_STEEL


def beam_frequency(length='stated', modulus=None, mass_density=None):
    """Eqs. 1 to 4: a spring 3 E I / l^3 and the whole mass, rad/s; by the stated inputs unless others are given."""
    length = _height() if length == 'stated' else tip_over_base()
    return _thickness() / (2 * length**2) * math.sqrt((modulus or young()) / (mass_density or density()))


def rayleigh_frequency():
    """Eqs. 5 and 6 by the stated inputs, rad/s."""
    shape = np.polynomial.Polynomial([4, -5, 0, 0, 0, 1])
    bending, motion = ((u**2).integ()(1) for u in (shape.deriv(2), shape))
    return _thickness() / _height()**2 * math.sqrt(young() / density() / 12 * bending / motion)


def rayleigh_above():
    return rayleigh_frequency() > beam_frequency()


def rayleigh_over_beam():
    return rayleigh_frequency() / beam_frequency()


def beam_sigma(direction, width=None, length='stated'):
    """Eqs. 7 and 8; face width of section II unless given; the stated length is that from the root to the reference circle."""
    width = width or given(CASE, 'pair', 'face_width_mm')
    length = radius(CASE, 1, 'reference') - radius(CASE, 1, 'root') if length == 'stated' else tip_over_base()
    if direction == 'x':
        return radial_force() / (width * _thickness())
    return tangential_force() * length / (width * _thickness()**2 / 6)


# The finite-element section

def mode_1_period():
    return 1 / mode(CASE, 1)


def step(name, k, component):
    """Size of a stress component on the compression side in a load step."""
    return abs(result('static', name)[COMPONENTS[component]][0, k - 1, COAST])


def worst_step(k):
    """The stress at the root is largest under this load step."""
    return k == 1 + np.argmax([step(CASE, other, 'y') for other in range(1, 10)])


def tangent_of(k):
    """Angle of a free surface to the y axis, deg, by the two printed stresses of a load step: sigma_x/sigma_y = tan^2."""
    return math.degrees(math.atan(math.sqrt(stress_ratio(k))))


def stress_ratio(k):
    """Sigma_x over sigma_y of a load step, as printed."""
    return printed(f'step_{k}_sigma_x_mpa') / printed(f'step_{k}_sigma_y_mpa')


def above_the_line(k):
    """Sigma_y of a full-load step by the line through the printed half-load steps, twice, over the printed one."""
    half = (1, 2, 3, 7, 8, 9)
    line = np.polyfit(half, [printed(f'step_{step}_sigma_y_mpa') for step in half], 1)
    return 2 * np.polyval(line, k) / printed(f'step_{k}_sigma_y_mpa')


# The tooth under the moving load

def largest(rpm, component, name=MOVING):
    """Size of a stress component at node 102 when it is largest; between nodes 70 and 68 the load changes all along."""
    points = result('transient_points', name)
    return abs(points[f'{component}_mpa'][0, list(points.rpm).index(rpm), 0, COAST])


@functools.cache
def band(rpm, component, name=MOVING):
    """The least and the most of it where the load jumps somewhere between two nodes instead."""
    values = [largest(rpm, component, f'{name}+{jump}') for jump in JUMPS]
    return min(values), max(values)


def history(rpm, name=MOVING):
    """Time (s) and sizes of the stress at node 102, of the motion and with the load at rest (MPa)."""
    table = result('transient', name)
    here = (table.rpm == rpm) & (table.side == 'coast')
    return 1e-3 * table.time_ms[here], np.abs(table.sigma_mpa[here]), np.abs(table.static_mpa[here])


def turns(rpm, name=MOVING):
    """Where the stress turns: times (s) and values (MPa) of its peaks and of the troughs behind them, by parabolas."""
    time, stress, _ = history(rpm, name)
    found = []
    for sign in (1, -1):
        y = sign * stress
        at = np.flatnonzero((y[1:-1] > y[:-2]) & (y[1:-1] >= y[2:])) + 1
        slope, bend = (y[at + 1] - y[at - 1]) / 2, y[at + 1] - 2 * y[at] + y[at - 1]
        found.append((time[at] - slope / bend * time[1], sign * (y[at] - slope**2 / (2 * bend))))
    return found


def counted_peaks(until):
    """Peaks of the stress at 1440 rpm up to a time (s)."""
    (time, _), _ = turns(1440)
    return int(np.sum(time <= until))


def time_of_peaks(count):
    """Time (s) of so many whole swings of the stress at 1440 rpm: of the trough behind that many peaks."""
    _, (time, _) = turns(1440)
    return time[count - 1]


def mean_over_static(name=MOVING):
    """Mean of each peak and the trough behind it over the stress at rest halfway, at 1440 rpm while two pairs carry."""
    (peak_time, peak), (trough_time, trough) = turns(1440, name)
    time, _, at_rest = history(1440, name)
    swings = range(int(np.sum(trough_time < time[-1] / 4)))
    return np.mean([(peak[i] + trough[i]) / 2 / np.interp((peak_time[i] + trough_time[i]) / 2, time, at_rest) for i in swings])


def mean_is_static():
    return abs(mean_over_static() - 1) < 0.1


def whole_band(component):
    """The least and the most over all speeds, however the load changes between nodes 70 and 68, on a coarse grid."""
    name = f'{MOVING}+ten-across'
    speeds = (360, 720, 1440, 1800)
    values = [value for rpm in speeds for value in (largest(rpm, component, name), *band(rpm, component, name))]
    return min(values), max(values)


def at_an_end(component, end):
    return whole_band(component)[end]


def grows():
    """The largest von Mises stress grows with every step of the speed, whether the load changes all along or jumps."""
    names = (MOVING, *(f'{MOVING}+{jump}' for jump in JUMPS))
    runs = [[largest(rpm, 'mises', name) for rpm in (360, 720, 1440, 1800)] for name in names]
    return all(values == sorted(values) for values in runs)


# Damping, time and stress from printed numbers

def rayleigh_beta():
    """Eq. 17 with xi omega of modes 1 and 3, and frequencies in Hz."""
    return 2 * (printed('xi_3') - printed('xi_1')) / (printed('mode_3_hz')**2 - printed('mode_1_hz')**2)


def rayleigh_alpha():
    return abs(2 * printed('xi_1') - rayleigh_beta() * printed('mode_1_hz')**2)


def angular_alpha():
    """Eq. 17 with its sign and frequencies in rad/s, as is right; likewise the next."""
    return 2 * printed('xi_1') - angular_beta() * printed('mode_1_rad_s')**2


def angular_beta():
    return 2 * (printed('xi_3') - printed('xi_1')) / (printed('mode_3_rad_s')**2 - printed('mode_1_rad_s')**2)


def tooth_period():
    return 60 / (printed('rpm') * printed('z1'))


def time_step():
    return 1 / (printed('divisor') * printed('mode_3_hz'))


def time_steps():
    return tooth_period() / time_step()


def steps_between():
    """Time steps from one loaded node to the next."""
    return printed('time_steps') / (printed('intervals') - 1)


def mises(rpm):
    """Von Mises stress of the printed components."""
    x, y, xy = (printed(f'dynamic_{rpm}_{component}') for component in ('sigma_x', 'sigma_y', 'tau_xy'))
    return math.sqrt(x * x - x * y + y * y + 3 * xy * xy)


def peak_frequency():
    return printed('peaks') / printed('period_peaks')


def peak_period():
    return 1 / peak_frequency()


def ratio_grows():
    """Largest dynamic over largest static stress, by speed, as printed."""
    static = printed('step_4_sigma_y_mpa')
    ratios = [printed(f'dynamic_{rpm}_sigma_y') / static for rpm in (360, 720, 1440, 1800)]
    return ratios == sorted(set(ratios))


def _height():
    return radius(CASE, 1, 'tip') - radius(CASE, 1, 'root')


def _thickness():
    """On the reference circle: half the pitch."""
    return math.pi * radius(CASE, 1, 'reference') / given(CASE, 'pinion', 'teeth')


def _angle():
    return math.radians(given(CASE, 'pair', 'pressure_angle_deg'))
