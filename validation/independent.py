"""Checks against other codes and other calculations; the functions that independent.csv names."""

from .quantities import (base_pitch, contact_ratio, hertz, iso_root_stress, line_of_action, load, mode, pitch_radius,  # noqa: F401
                         point, point_radius, radius)
