"""Names of numbers, words of a case and tasks for readers: in pictures, panel and report."""

from __future__ import annotations

#: Numbers by which the dynamic factor is differentiated.
NUMBERS = {
    'rpm': 'speed',
    'normal_force_n': 'load',
    'damping_ratio': 'damping ratio',
    'friction': 'coefficient of friction',
    'pinion_mass_kg': 'mass of the pinion',
    'gear_mass_kg': 'mass of the gear',
    'stiffness_factor': 'stiffness',
    'pinion_relief_um': "pinion's relief",
    'gear_relief_um': "gear's relief",
    'pinion_relief_start': "start of the pinion's relief",
    'gear_relief_start': "start of the gear's relief",
    'profile_factor': 'profile error',
    'backlash_um': 'backlash',
}

#: Tasks by purpose.
TASKS = {
    'Design': ('geometry', 'mesh', 'sweep', 'optimum', 'deflection_relief', 'as_built', 'load', 'sensitivity'),
    'Strength': ('face_load', 'static', 'rating', 'flank', 'life', 'transient', 'harmonic'),
    'Vibration': ('modal', 'body_modes'),
    'Nonlinear motion': ('stability', 'hysteresis', 'poincare', 'attractors', 'branches'),
    'Accuracy': ('precision',),
}

#: Words of a case, and groups and tasks, that need another name; all others have blanks for underscores.
WORDS = {
    'fe': 'finite elements',
    'weber': 'Weber and Banaschek',
    'iso6336': 'ISO 6336-1',
    'hpstc': 'outer point of single contact',
    'rk4': 'Runge-Kutta',
    'rk4_equal': 'Runge-Kutta in equal steps',
    'constant': 'constant in each step',
    'march': 'marching',
    'each': 'each speed by itself',
    'rpm': 'speed',
    'relief_um': 'relief',
    'normal_force_n': 'load',
    'a': 'Method A',
    'b': 'Method B',
    'ml': 'ML',
    'mq': 'MQ',
    'me': 'ME',
    'poincare': 'Poincaré section',
    'deflection_relief': 'relief from deflection',
    'body_modes': 'modes of the body',
    'modal': 'modes of the section',
    'static': 'static root stress',
    'rating': 'rating by ISO 6336',
    'precision': 'precision of methods',
    'as_built': 'gears as built',
    'face_load': 'load over the face width',
}
