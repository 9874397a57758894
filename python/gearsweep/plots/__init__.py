"""Pictures of the results, by matplotlib.

Each `plot_...` draws a result into the axes `ax` or into a new figure, and returns the axes. `draw_all` writes a file for each
picture of a study. All use the look of `style`, which applies only while they draw: no global setting is changed.

>>> import gearsweep
>>> case = gearsweep.Case('''&pinion teeth = 25 effective_mass_kg = 0.8 / &gear effective_mass_kg = 0.8 /
...     &load normal_force_n = 7000 / &relief amount_um = 0, 10 /
...     &mesh model = 'polynomial' contact_ratio = 1.6 coefficients = 400, 0, -120 /
...     &sweep rpm_first = 8000 rpm_last = 16000 rpm_step = 500 /''')
>>> ax = gearsweep.plot_sweep(gearsweep.run(case, 'sweep'), points=[(13700, 2.1)])
>>> ax.get_ylabel(), len(ax.lines[0].get_xdata())
('Dynamic factor (–)', 17)
"""

try:
    import matplotlib as _matplotlib  # noqa: F401
except ImportError as error:
    raise ImportError("gearsweep's pictures need matplotlib, which is not installed: pip install matplotlib") from error

from .along_path import (
    plot_dte,
    plot_harmonics,
    plot_load,
    plot_motion_harmonics,
    plot_sharing,
    plot_static,
    plot_ste,
    plot_stiffness,
)
from .as_built import plot_as_built, plot_assemblies, plot_orders, plot_turn, plot_turn_loads, plot_waterfall
from .attractors import plot_attractors, plot_basins
from .body import plot_modal, plot_section
from .body_modes import plot_body_modes
from .branches import plot_branches
from .deflection_relief import plot_deflection_relief, plot_relief_flank
from .face_load import compare_face_loads, plot_contact_pattern, plot_face_load
from .files import PICTURES, draw_all, figures, save
from .flank import plot_flank
from .frequency import plot_body_campbell, plot_campbell, plot_frequency_response
from .gears import plot_geometry
from .life import plot_life
from .look import style
from .over_speed import plot_dte_sweep, plot_optimum, plot_sweep
from .over_torque import plot_optimum_map, plot_torques
from .precision import plot_precision
from .rating import plot_rating
from .sensitivity import plot_sensitivity
from .stability import plot_hysteresis, plot_poincare, plot_stability
from .stress import plot_stress
from .studies import compare
from .torque import plot_torque, plot_torque_harmonics
from .transient import plot_transient, plot_transient_peaks

__all__ = [
    'PICTURES',
    'compare',
    'compare_face_loads',
    'draw_all',
    'figures',
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
    'save',
    'style',
]
