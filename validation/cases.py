"""The cases of the papers, variants of them, and the tables of their results, computed once."""

import functools
import pathlib

import gearsweep

DATA = pathlib.Path(__file__).parent.parent / 'data'

# The task that fills a table, where it has another name.
TASKS = {'gears': 'geometry', 'contact_points': 'geometry', 'motion': 'mesh', 'transmission_error': 'mesh', 'harmonics': 'mesh',
         'root_stress': 'static', 'flank_losses': 'flank', 'root_rating': 'static', 'rating_factors': 'rating', 'dynamic_factors': 'rating', 'transient_points': 'transient',
         'transient_peaks': 'transient', 'resonances': 'sweep', 'optimum_curve': 'optimum', 'relief_flank': 'deflection_relief'}

_NO_SECTION = {'teeth': None, 'fixed': None, 'plane': None}

# What a paper leaves open, taken otherwise, and other views of a case: `case1+weber` is case1 with the
# Weber-Banaschek stiffness.
VARIANTS = {
    'weber': {'mesh': {'model': 'weber'}, 'section': _NO_SECTION},
    'iso6336': {'mesh': {'model': 'iso6336'}, 'section': _NO_SECTION, 'material': {'poisson': None}},
    'one-tooth': {'section': {'teeth': 1}},
    'plane-stress': {'section': {'plane': 'stress'}},
    'friction-0.05': {'dynamics': {'friction': 0.05}},
    'whole': {'section': {'teeth': 60, 'rim_mm': None, 'fixed': 'rim', 'plane': 'stress', 'elements_across': 16},
              'modal': {'modes': 1}},
    'gear': {'section': {'gear': 'gear'}},
    # FZG C14: 14 mm wide, tips shortened by what the profile shifts exceed the widened centre distance.
    'c14': {'pair': {'face_width_mm': 14}, 'pinion': {'addendum': 0.980133}, 'gear': {'addendum': 0.980133},
            'load': {'torque_nm': 200},
            'flank': {'rpm': 1500, 'viscosity_mpa_s': 46.23, 'pressure_viscosity_1_gpa': 71.05, 'oil_factor': 0.85,
                      'roughness_um': 0.6}},
    # All pairs in contact carry the same.
    'half-shares': {'mesh': {'model': 'polynomial', 'coefficients': 400}},
    'losses': {'flank': {'rpm': 6700, 'friction_coefficient': 0.05, 'dynamic_load': False}},
    'six-um': {'relief': {'amount_um': (0, 6), 'start': 'hpstc'}},
    'from-pitch': {'relief': {'amount_um': 0, 'start': 'pitch'}},
    'no-edge-break': {'gear': {'tip_form_diameter_mm': None}},
    # STplus prints the span of teeth without their allowances.
    'no-allowance': {'pinion': {'generating_shift': None}, 'gear': {'generating_shift': None}},
    'corners': {'mesh': {'corner_contact': True}},
    'engineer': {'mesh': {'corner_contact': True, 'tooth_coupling': True, 'nonlinear_contact': True}},
    'pinion-only': {'relief': {'gear_fraction': 0}},
    'less-on-the-gear': {'relief': {'gear_fraction': 0.6}},
    # Hassan's moving load: Eq. 17 with its sign and frequencies in rad/s; many modes and what the others add at once; the path in as many mesh periods as the contact ratio has.
    'right-damping': {'transient': {'rayleigh_alpha_1_s': -10.004, 'rayleigh_beta_s': 6.58e-9}},
    'converged': {'transient': {'modes': 40, 'static_correction': True}},
    'ten-across': {'section': {'elements_across': 10}},
    'whole-passage': {'transient': {'passage_periods': None}},
    'rack-tip-0.25': {'pinion': {'rack_tip_radius': 0.25}, 'gear': {'rack_tip_radius': 0.25}},
    'rack-tip-0.38': {'pinion': {'rack_tip_radius': 0.38}, 'gear': {'rack_tip_radius': 0.38}},
    'coarse': {'section': {'elements_across': 6}},
}

# Pressure angles of the loaded flanks and of the others, as Karpat et al. compare them.
ANGLES = ((20, 20), (25, 20), (30, 20), (20, 25), (20, 30))
VARIANTS |= {f'angles-{drive}-{coast}': {'pair': {'pressure_angle_deg': drive, 'coast_angle_deg': coast}} for drive, coast in ANGLES}

# Where between two nodes of Hassan's the load doubles, which is not stated; without any of them it does so all along.
JUMPS = tuple(f'jump-{fifth}' for fifth in range(6))
VARIANTS |= {name: {'transient': {'jump_at': fifth / 5}} for fifth, name in enumerate(JUMPS)}


@functools.cache
def case(name):
    """The case of this name in data/, with the variants named behind each `+`."""
    name, *variants = name.split('+')
    case = gearsweep.Case.read(DATA / f'{name}.nml')
    for variant in variants:
        case = case.changed(**VARIANTS[variant])
    return case


def result(table, name):
    """A table of a case."""
    return study(TASKS.get(table, table), name)[table]


@functools.cache
def study(task, name):
    """The study of one task of a case."""
    return run(case(name), task)


def run(case, task):
    """The study of a task, which takes over what an earlier one found of the same gears, such as the stiffness."""
    found = gearsweep.run(case, task, earlier=_EARLIER.get(_gears(case)))
    _EARLIER[_gears(case)] = found
    return found


_EARLIER: dict[str, gearsweep.Study] = {}


def _gears(case):
    """What the costly products of a case hang on, at least."""
    return str([case.values.get(group) for group in ('pair', 'pinion', 'gear', 'material', 'mesh', 'section')])


def given(name, group, key, index=0):
    """A number as a case has it; of several, the one with this index from 0."""
    value = case(name).get(group, key)
    return value[index] if isinstance(value, tuple) else value
