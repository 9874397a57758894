"""Prints every number and word of every table that a case gives, a line each with its table and column, then the report:
what results.f and results.c print, line by line: python results.py CASE.nml"""

import json
import sys

import numpy as np

from gearsweep import _flat


def checked(*results):
    """All results but the last two, which are the code and the message of every call."""
    *found, info, message = results
    if info:
        sys.exit(f'info{info:2d}: {message.decode()}')
    return found


def text_of(study, what):
    room = np.array(b' ')
    room = np.array(b' ' * _flat.gs_text(study, what, room)[0])
    checked(*_flat.gs_text(study, what, room))
    return room.item().decode()


def shown(value):
    """In Fortran's form."""
    if np.isnan(value):
        return f'{"NaN":>25}'
    digits, power = f'{value:.16E}'.split('E')
    return f'{f"{digits}E{int(power):+04d}":>25}'


with open(sys.argv[1], 'rb') as file:
    case = file.read()
(study,) = checked(*_flat.gs_run(case, '', 2, 0, np.zeros(3, np.intc), '', ''))
for table in json.loads(text_of(study, 'tables')):
    for column in table['columns']:
        place = study, table['name'], column['name']
        rows, kind, width = checked(*_flat.gs_size(*place))
        if kind == 3:
            values = []
            for row in range(rows):
                word = np.array(b' ' * max(1, width))
                checked(*_flat.gs_words(*place, row + 1, word))
                values.append(word.item().decode().rstrip())
        else:
            values = map(shown, *checked(*_flat.gs_column(*place, rows)))
        for value in values:
            print(f'{place[1]}.{place[2]},{value}')
print(text_of(study, 'report'), end='')
sys.exit(_flat.gs_free(study))
