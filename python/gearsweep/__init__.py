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

Keys of a case are described in doc/case.md, this package in doc/python.md. Names of numbers end in their unit. matplotlib,
pandas and xarray are loaded on first use.
"""

import importlib

from .core import library
from .core.case import Case
from .core.library import Code, Error, PartialWarning, UnusedWarning
from .core.rexs import read_rexs
from .core.study import Rows, Study, read, run, run_rows
from .core.table import Table
from .report.drawing import write_dxf
from .report.page import write as _write_report
from .report.sound import write_sound

__version__ = library.version()
Study.write_report = _write_report

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
    'read_rexs',
    'run',
    'run_rows',
    'write_dxf',
    'write_sound',
]


for _one in (Code, Error, PartialWarning, UnusedWarning, Rows, Study, Table, Case):
    _one.__module__ = __name__  # names in tracebacks are the public ones

#: Names in `gearsweep.plots`, which is loaded on the first access.
_PLOTS = (
    'plot_as_built',
    'plot_assemblies',
    'plot_attractors',
    'plot_basins',
    'plot_body_campbell',
    'plot_body_modes',
    'plot_branches',
    'plot_campbell',
    'plot_contact_pattern',
    'plot_deflection_relief',
    'plot_dte',
    'plot_dte_sweep',
    'plot_face_load',
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
    'plot_optimum_map',
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
    'plot_torques',
    'plot_transient',
    'plot_transient_peaks',
    'plot_turn',
    'plot_turn_loads',
    'plot_waterfall',
    'plots',
)

#: New names of renamed functions of earlier versions.
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
    'section': "run(case, 'modal').section",
    'stability_map': "run(case, 'stability').stability, with speeds and damping ratios in &stability",
    'stress': "run(case, 'static').stress, with &static field_position",
    'strobe': "run(case, 'poincare').poincare, with its speeds in &poincare",
}


def __dir__() -> list[str]:
    return sorted((*__all__, *_PLOTS, '__version__'))


def __getattr__(name: str):
    """Returns a plot function; the first one loads matplotlib: `gearsweep.plots`, and from it `gearsweep.plot_sweep` and the
    others.
    """
    if name in _PLOTS:
        plots = importlib.import_module('.plots', __name__)
        return plots if name == 'plots' else getattr(plots, name)
    now = f': it is {_NOW[name]} now' if name in _NOW else ''
    raise AttributeError(f'module {__name__!r} has no attribute {name!r}{now}')
