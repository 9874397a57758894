"""What the tests share: cases, and the program that the package must agree with."""

import importlib.util
import os
import re
import subprocess
from pathlib import Path

import numpy as np
import pytest

import gearsweep

ROOT = Path(__file__).parents[2]

GEARED = """! A small pair on coarse grids, all tasks.
&case tasks = 'geometry', 'mesh', 'static', 'modal', 'load', 'sweep', 'optimum' /
&pair module_mm = 3 face_width_mm = 20 /
&pinion teeth = 21 profile_shift = 0.2 effective_mass_kg = 0.5 /
&gear
  teeth = 34   ! as many as fit
  effective_mass_kg = 0.9
/
&load normal_force_n = 4000 /
&relief amount_um = 0, 10 /
&mesh model = 'fe' /
&section elements_across = 4 /
&static positions = 5 /
&modal modes = 3 /
&sweep rpm_first = 3000 rpm_last = 9000 rpm_step = 500 load_rpm = 4000, 6000 /
"""
PRESCRIBED = """&case tasks = 'mesh', 'load', 'sweep', 'optimum' /
&pinion teeth = 25 effective_mass_kg = 0.8 / &gear effective_mass_kg = 0.9 /
&load normal_force_n = 6858 / &relief amount_um = 0, 15 /
&mesh model = 'polynomial' contact_ratio = 1.6 coefficients = 400, 0, -120 /
&dynamics damping_ratio = 0.1 /
&sweep rpm_first = 2000 rpm_last = 16000 rpm_step = 1000 load_rpm = 3000 /
"""
# Too few steps at the lowest speed: points without an answer.
PARTIAL = """&case tasks = 'sweep' /
&pinion teeth = 25 effective_mass_kg = 0.8 / &gear effective_mass_kg = 0.9 /
&load normal_force_n = 6858 /
&mesh model = 'polynomial' contact_ratio = 1.6 coefficients = 400, 0, -120 /
&numerics steps_per_period = 20 / &sweep rpm_first = 1 rpm_last = 6001 rpm_step = 1000 /
"""
# Little damping: with no relief, motions that do not repeat.
CHAOTIC = """&case tasks = 'sweep' /
&pinion teeth = 25 effective_mass_kg = 1.6 / &gear effective_mass_kg = 1.6 /
&load normal_force_n = 7000 / &relief amount_um = 0, 10 /
&mesh model = 'polynomial' contact_ratio = 1.6 coefficients = 400 /
&dynamics damping_ratio = 0.01 /
&sweep rpm_first = 2000 rpm_last = 2300 rpm_step = 50 direction = 'each' /
"""

# How numbers on a page may differ from what a command makes.
_spec = importlib.util.spec_from_file_location('compare', ROOT / 'test' / 'properties' / 'extreme' / 'compare.py')
assert _spec is not None and _spec.loader is not None
compare = importlib.util.module_from_spec(_spec)
_spec.loader.exec_module(compare)


def alike(text, other, least=compare.LEAST):
    """Texts that are the same but for what another processor makes of numbers, all of them below `least`, and for the width of
    columns, which follows from that.
    """
    return compare.alike(re.sub(' +', ' ', text), re.sub(' +', ' ', other), least)


def pytest_configure(config):
    config.addinivalue_line('markers', 'long: takes more than ten seconds of the processor, and belongs to test/run.sh --all')


def bits(study):
    """All that a study holds and that is the same in every run."""
    return {
        (table.name, name): np.asarray(table[name]).tobytes()
        for table in study
        for name in table
        if table.is_reproducible[name]
    }


def grid_of(study):
    """Nodes (x and y in mm) of the section's grid, and those of each element, counted from 0."""
    element = np.column_stack([study.elements[f'node_{corner}'] for corner in range(1, 9)]) - 1
    return np.column_stack((study.nodes.x_mm, study.nodes.y_mm)), element


@pytest.fixture(scope='session')
def chaotic():
    with pytest.warns(gearsweep.PartialWarning):
        return gearsweep.run(gearsweep.Case(CHAOTIC))


@pytest.fixture(scope='session')
def program():
    """Runs the Fortran program with these words, in this folder."""
    path = os.environ.get('GEARSWEEP_PROGRAM', ROOT / 'build/run/gearsweep')
    if not os.access(path, os.X_OK):
        pytest.fail(f'no program at {path}; sh test/run.sh builds it')

    def run(*words, cwd):
        return subprocess.run([path, *words], cwd=cwd, capture_output=True, text=True, timeout=300, check=False)

    return run
