"""Many variants of a case: scatter, sensitivity, on one machine and on many.

>>> import gearsweep
>>> from gearsweep import many
>>> from scipy.stats import norm
>>> case = gearsweep.Case('''&case tasks = 'sweep' / &pinion teeth = 25 effective_mass_kg = 0.8 / &gear effective_mass_kg = 0.8 /
...     &load normal_force_n = 7000 / &mesh model = 'polynomial' contact_ratio = 1.6 coefficients = 400, 0, -120 /
...     &sweep rpm_first = 8000 rpm_last = 16000 rpm_step = 500 /''')
>>> plan = many.Plan.random(case, n=100, seed=1, load={'normal_force_n': norm(7000, 300)}, relief={'amount_um': norm(15, 1.5)})
>>> data = many.run(plan, 'sweep_worst.worst_dynamic_factor')
>>> data['sweep_worst.worst_dynamic_factor'].shape, many.counts(data)
((100,), {'ok': 100})

doc/many.md has it with processes, Dask, stores, statistics and pictures. It needs `pip install 'gearsweep[many]'`.
"""

import importlib

from . import needs as _needs
from .plan import Plan
from .reading import case_of, counts, failures, open
from .robust import Robust, robust
from .run import run
from .statistics import quantiles, sensitivity
from .status import Status

_needs.check()
PENDING, OK, PARTIAL, REFUSED, FAILED, CRASHED, LATE = Status

__all__ = [
    'CRASHED',
    'FAILED',
    'LATE',
    'OK',
    'PARTIAL',
    'PENDING',
    'REFUSED',
    'Plan',
    'Robust',
    'Status',
    'case_of',
    'counts',
    'failures',
    'open',
    'plot_band',
    'plot_distribution',
    'plot_indices',
    'plot_scatter',
    'quantiles',
    'robust',
    'run',
    'sensitivity',
]

_PLOTS = ('plot_band', 'plot_distribution', 'plot_indices', 'plot_scatter')


def __getattr__(name: str):
    """Pictures, which load matplotlib."""
    if name in _PLOTS:
        return getattr(importlib.import_module('..plots.many', __name__), name)
    raise AttributeError(f'module {__name__!r} has no attribute {name!r}')
