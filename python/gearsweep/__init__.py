"""How a spur-gear pair behaves: stiffness, transmission error, dynamic factor, root stress.

>>> import gearsweep
>>> case = gearsweep.Case.build(
...     pair={'module_mm': 3, 'face_width_mm': 20},
...     pinion={'teeth': 21},
...     gear={'teeth': 34},
...     load={'torque_nm': 100},
...     relief={'amount_um': [0, 10]},
...     sweep={'rpm_first': 4000, 'rpm_last': 8000, 'rpm_step': 1000},
... )
>>> sweep = gearsweep.sweep(case)
>>> sweep.dynamic_factor.shape
(5, 2)

A case's keys are described in doc/case.md, this package in doc/python.md. Names of numbers end in their
unit. Pictures, pandas and xarray are loaded when they are asked for.
"""

import importlib

from . import _border
from ._border import Code, Error, PartialWarning, UnusedWarning
from .case import Case
from .maps import Hysteresis, StabilityMap, Strobe, hysteresis, stability_map, strobe
from .results import (
    Contact,
    Geometry,
    Harmonics,
    Load,
    Mesh,
    Modal,
    Motion,
    Optimum,
    Result,
    Section,
    Static,
    Status,
    Stress,
    Study,
    Sweep,
)
from .store import read
from .tasks import geometry, harmonics, load, mesh, modal, motion, optimum, prepare, report, run, section, static, stress, sweep

__version__ = _border.version()

__all__ = [
    'Case',
    'Code',
    'Contact',
    'Error',
    'Geometry',
    'Harmonics',
    'Hysteresis',
    'Load',
    'Mesh',
    'Modal',
    'Motion',
    'Optimum',
    'PartialWarning',
    'Result',
    'Section',
    'StabilityMap',
    'Static',
    'Status',
    'Stress',
    'Strobe',
    'Study',
    'Sweep',
    'UnusedWarning',
    'geometry',
    'harmonics',
    'hysteresis',
    'load',
    'mesh',
    'modal',
    'motion',
    'optimum',
    'prepare',
    'read',
    'report',
    'run',
    'section',
    'stability_map',
    'static',
    'stress',
    'strobe',
    'sweep',
]


for _one in (Code, Error, PartialWarning, UnusedWarning):
    _one.__module__ = __name__  # a traceback names them as people do

#: In `gearsweep.plots`, which is loaded with the first of them.
_PLOTS = (
    'plot_geometry',
    'plot_harmonics',
    'plot_hysteresis',
    'plot_load',
    'plot_modal',
    'plot_optimum',
    'plot_section',
    'plot_sharing',
    'plot_stability',
    'plot_static',
    'plot_ste',
    'plot_stiffness',
    'plot_stress',
    'plot_strobe',
    'plot_sweep',
    'plots',
)


def __dir__() -> list[str]:
    return sorted((*__all__, *_PLOTS, '__version__'))


def __getattr__(name: str):
    """Pictures, which load matplotlib: `gearsweep.plots`, and from there `gearsweep.plot_sweep` and its like."""
    if name in _PLOTS:
        plots = importlib.import_module('.plots', __name__)
        return plots if name == 'plots' else getattr(plots, name)
    raise AttributeError(f'module {__name__!r} has no attribute {name!r}')
