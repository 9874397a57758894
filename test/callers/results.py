"""Prints every number that gearsweep has for a case, a line each with its name and 17 digits, then the answer: what
results.f and results.c print, line by line: python results.py CASE.nml"""

import sys

import numpy as np

import gearsweep


def show(name, values):
    """In Fortran's order, and in its form."""
    for value in np.ravel(values, order='F'):
        if isinstance(value, np.integer):
            print(f'{name},{value:12d}')
        elif np.isnan(value):
            print(f'{name},{"NaN":>25}')
        else:
            digits, power = f'{value:.16E}'.split('E')
            print(f'{name},{f"{digits}E{int(power):+04d}":>25}')


def show_all(task, result, fields):
    for field in fields:
        show(f'{task}.{field}', getattr(result, field))


case = gearsweep.Case.read(sys.argv[1])
study = gearsweep.run(case, threads=2)
if study.geometry:
    outlines = ('pinion_outline_mm', 'gear_outline_mm')
    show_all('geometry', study.geometry, (field for field in study.geometry.units if field not in outlines))
    for field in outlines:
        show('outline.x_mm', getattr(study.geometry, field)[:, 0])
        show('outline.y_mm', getattr(study.geometry, field)[:, 1])
for task in ('motion', 'mesh', 'harmonics', 'load', 'sweep', 'optimum'):
    if result := getattr(study, task):
        show_all(task, result, (field for field in result.units if field != 'harmonic'))
    if task == 'sweep' and result:
        rpm, factor = result.resonances()
        show('resonances.peak_rpm', rpm)
        show('resonances.peak_factor', factor)
grid = ('x_mm', 'y_mm', 'element', 'tooth')
if study.section:
    show_all('section', study.section, grid[:2])
    show('section.element', study.section.element.T + 1)
    show('section.tooth', study.section.tooth)
if study.modal:
    show_all('modal', study.modal, (field for field in study.modal.units if field not in grid))
if study.static:
    show_all('static', study.static, study.static.units)
    positions, reliefs = study.static.share.shape
    stress = gearsweep.stress(case, positions - 1, reliefs - 1)
    show_all('stress', stress, (field for field in stress.units if field not in grid))
print(gearsweep.report(case), end='')
