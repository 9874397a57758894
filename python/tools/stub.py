"""Writes python/gearsweep/core/named.pyi, by which editors complete tables and columns: python python/tools/stub.py

The names, units and meanings are those of the tables of a study with all tasks, as the installed library makes them.
"""

import json
import warnings
from pathlib import Path
from typing import Any

import gearsweep
from gearsweep.core import library

ROOT = Path(__file__).parents[2]
STUB = ROOT / 'python/gearsweep/core/named.pyi'
HEAD = '''"""The tables of studies and their columns, for editors. Made by python/tools/stub.py: change that one."""

from numpy import float64, int64, str_
from numpy.typing import NDArray

from .table import Table

'''
KINDS = {'real': ('float', 'NDArray[float64]'), 'integer': ('int', 'NDArray[int64]'), 'text': ('str', 'NDArray[str_]')}


def studies() -> list[gearsweep.Study]:
    """Together they have every table: of all tasks on coarse grids, and printed values beside ours."""
    tasks = json.loads(library.describe('tasks'))
    tasks = [task if isinstance(task, str) else task['name'] for task in tasks]
    coarse: dict[str, dict[str, Any]] = {'section': {'elements_across': 3}, 'static': {'positions': 2, 'field_position': 0}, 'modal': {'modes': 1}, 'relief': {'amount_um': 0},
              'sweep': {'rpm_step': 19000, 'load_rpm': 1600, 'load_torque': True, 'direction': 'all'}, 'poincare': {'settling_periods': 0, 'kept_periods': 1},
              'hysteresis': {'ramp_rpm_s': 1e6}, 'attractors': {'starts': 1},
              'branches': {'first': 3000, 'last': 4000, 'seeds': 1, 'points': 10, 'most_periods': 1},
              'optimum': {'with_length': True}, 'sensitivity': {'rpm': 1600},
              'precision': {'most_steps': 50, 'most_samples': 32, 'most_elements': 4, 'modes': 1},
              'flank': {'rpm': 1600},
              'transient': {'rpm': 1600, 'modes': 2, 'samples': 2}, 'harmonic': {'frequency_hz': [0, 1e5], 'modes': 2},
              'face_load': {'misalignment_um': [0, 10]}, 'life': {'rpm': 1600, 'duration_h': 1}, 'rating': {'rpm': 1600, 'material': 'C45', 'life_h': 1000}, 'pinion': {'bore_mm': 20},
              'body_modes': {'nodal_diameters': 1, 'elements_across': 2, 'shapes': 1},
              'as_built': {'waterfall': True, 'with_ste': True, 'with_root_stress': True}, 'deviations': {'pinion_class': 6}}  # fmt: skip
    whole = gearsweep.run(gearsweep.Case.read(ROOT / 'data/case1.nml').changed(**coarse), tasks)
    printed = gearsweep.Case.read(ROOT / 'data/hassan.nml').changed(case={'tasks': 'geometry'})
    helical = whole.case.changed(case={'tasks': ['geometry', 'rating']}, pair={'helix_angle_deg': 15})
    with warnings.catch_warnings():
        warnings.simplefilter('ignore', gearsweep.UnusedWarning)
        return [whole, gearsweep.run(printed), gearsweep.run(helical)]


def text() -> str:
    """What the stub should hold."""
    # Of tables with one name that with the most columns: helical gears add some.
    tables: dict[str, gearsweep.Table] = {}
    for table in (table for study in studies() for table in study):
        if table.name not in tables or len(table._about['columns']) >= len(tables[table.name]._about['columns']):
            tables[table.name] = table
    lines = []
    for name, table in tables.items():
        lines.append(f'class {title(name)}(Table):\n    """{table.meaning}"""\n')
        for column in table._about['columns']:
            kind = KINDS[column['kind']][bool(table.dims[column['name']])]
            unit = f'{column["unit"]}: ' if column['unit'] else ''
            lines.append(f'    {column["name"]}: {kind}\n    """{unit}{column["meaning"]}"""')
        lines.append('')
    lines.append('class Named:')
    lines += [f'    @property\n    def {name}(self) -> {title(name)}: ...' for name in tables]
    return HEAD + '\n'.join(lines) + '\n'


def title(name: str) -> str:
    return ''.join(part.capitalize() for part in name.split('_')) + 'Table'


if __name__ == '__main__':
    STUB.write_text(text(), encoding='utf-8')
