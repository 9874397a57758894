"""The cases of the papers, variants of them, and each task's result, computed once."""

import functools
import pathlib

import gearsweep

DATA = pathlib.Path(__file__).parent.parent / 'data'

OF_THE_MESH = ('motion', 'mesh', 'harmonics', 'static', 'load', 'sweep', 'optimum')

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
    'gear': {'section': {'member': 'gear'}},
    # FZG C14: 14 mm wide, tips shortened by what the profile shifts exceed the widened centre distance.
    'c14': {'pair': {'face_width_mm': 14}, 'pinion': {'addendum': 0.980133}, 'gear': {'addendum': 0.980133},
            'load': {'torque_nm': 200}},
    'six-um': {'relief': {'amount_um': (0, 6), 'start': 'hpstc'}},
    'no-edge-break': {'gear': {'addendum': 0.9993}},
    'pinion-only': {'relief': {'gear_fraction': 0}},
    'less-on-the-gear': {'relief': {'gear_fraction': 0.6}},
    'rack-tip-0.25': {'pinion': {'rack_tip_radius': 0.25}, 'gear': {'rack_tip_radius': 0.25}},
    'rack-tip-0.38': {'pinion': {'rack_tip_radius': 0.38}, 'gear': {'rack_tip_radius': 0.38}},
    'coarse': {'section': {'elements_across': 6}},
    'tangent-20-deg': {'static': {'tangent_deg': 20}},
    'tangent-30-deg': {'static': {'tangent_deg': 30}},
}


@functools.cache
def case(name):
    """The case of this name in data/, with the variants named behind each `+`."""
    name, *variants = name.split('+')
    case = gearsweep.Case.read(DATA / f'{name}.nml')
    for variant in variants:
        case = case.changed(**VARIANTS[variant])
    return case


@functools.cache
def result(task, name):
    """The result of one task of a case."""
    function = getattr(gearsweep, task)
    return function(case(name), work=work(name)) if task in OF_THE_MESH else function(case(name))


@functools.cache
def work(name):
    """The pair stiffness of a case, for `work` of the tasks that take it."""
    return gearsweep.prepare(case(name))


def given(name, group, key, index=0):
    """A number as a case has it; of several, the one with this index from 0."""
    value = case(name).get(group, key)
    return value[index] if isinstance(value, tuple) else value
