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
>>> study = gearsweep.run(case, 'sweep')
>>> study.sweep.dynamic_factor.shape
(2, 5)

A case's keys are described in doc/case.md, this package in doc/python.md. Names of numbers end in their
unit. Pictures, pandas and xarray are loaded when they are asked for.
"""

import importlib

from . import _library
from ._library import Code, Error, PartialWarning, UnusedWarning
from ._sound import write_sound
from .case import Case
from .study import Rows, Study, read, run, run_rows
from .table import Table

__version__ = _library.version()

__all__ = [
    'Case',
    'Code',
    'Error',
    'PartialWarning',
    'Rows',
    'Study',
    'Table',
    'UnusedWarning',
    'read',
    'run',
    'run_rows',
    'write_sound',
]


for _one in (Code, Error, PartialWarning, UnusedWarning, Rows, Study, Table, Case):
    _one.__module__ = __name__  # a traceback names them as people do

#: In `gearsweep.plots`, which is loaded with the first of them.
_PLOTS = (
    'plot_as_built',
    'plot_assemblies',
    'plot_attractors',
    'plot_basins',
    'plot_body_campbell',
    'plot_body_modes',
    'plot_branch_curves',
    'plot_branches',
    'plot_campbell',
    'plot_deflection_relief',
    'plot_dte',
    'plot_dte_sweep',
    'plot_flank',
    'plot_frequency_response',
    'plot_geometry',
    'plot_harmonics',
    'plot_hysteresis',
    'plot_life',
    'plot_load',
    'plot_modal',
    'plot_motion_harmonics',
    'plot_optimum',
    'plot_orders',
    'plot_poincare',
    'plot_precision',
    'plot_rating',
    'plot_relief_flank',
    'plot_section',
    'plot_sensitivity',
    'plot_sharing',
    'plot_stability',
    'plot_static',
    'plot_ste',
    'plot_stiffness',
    'plot_stress',
    'plot_sweep',
    'plot_torque',
    'plot_torque_harmonics',
    'plot_transient',
    'plot_transient_peaks',
    'plot_turn',
    'plot_turn_loads',
    'plot_waterfall',
    'plots',
)

#: What names of earlier versions are called now.
_NOW = {
    **{task: f"run(case, '{task}').{task}" for task in ('geometry', 'load', 'mesh', 'optimum', 'static', 'sweep')},
    'Contact': "the words in the column contact, such as 'full'",
    'Status': "the words in the column status, such as 'ok'",
    'harmonics': "run(case, 'mesh').harmonics",
    'hysteresis': "run(case, 'hysteresis').hysteresis, with its speeds in &hysteresis",
    'modal': "run(case, 'modal').modal",
    'motion': "run(case, 'mesh').motion",
    'plot_strobe': 'plot_poincare',
    'prepare': 'run(case, earlier=study)',
    'report': 'run(case).report()',
    'section': "run(case, 'section').section",
    'stability_map': "run(case, 'stability').stability, with speeds and damping ratios in &stability",
    'stress': "run(case, 'static').stress, with &static field_position",
    'strobe': "run(case, 'poincare').poincare, with its speeds in &poincare",
}


def __dir__() -> list[str]:
    return sorted((*__all__, *_PLOTS, '__version__'))


def __getattr__(name: str):
    """Pictures, which load matplotlib: `gearsweep.plots`, and from there `gearsweep.plot_sweep` and its like."""
    if name in _PLOTS:
        plots = importlib.import_module('.plots', __name__)
        return plots if name == 'plots' else getattr(plots, name)
    now = f': it is {_NOW[name]} now' if name in _NOW else ''
    raise AttributeError(f'module {__name__!r} has no attribute {name!r}{now}')
