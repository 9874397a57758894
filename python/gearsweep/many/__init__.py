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
import importlib.util

from .execution import NoWorkerWarning
from .functions import function as _function
from .plan import Plan
from .reading import case_of, counts, failures, open
from .robust import Robust, robust
from .run import run
from .statistics import quantiles, sensitivity
from .status import Status

# They are loaded on first use, which is not in the computing processes.
for _package in ('scipy', 'xarray', 'zarr'):
    if importlib.util.find_spec(_package) is None:
        raise ModuleNotFoundError(f"gearsweep.many needs {_package}, which is not installed: pip install 'gearsweep[many]'", name=_package)
Plan.function = _function
PENDING, OK, PARTIAL, REFUSED, FAILED, CRASHED, LATE = Status

__all__ = [
    'CRASHED',
    'FAILED',
    'LATE',
    'OK',
    'PARTIAL',
    'PENDING',
    'REFUSED',
    'NoWorkerWarning',
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
    """Returns a plot function, which loads matplotlib."""
    if name in _PLOTS:
        return getattr(importlib.import_module('.pictures', __name__), name)
    raise AttributeError(f'module {__name__!r} has no attribute {name!r}')
