"""Prints what results.f and results.c print, line by line, by the package: python results.py CASE.nml NAME"""

import sys

import gearsweep


def shown(value):
    """In Fortran's form."""
    if value != value:
        return f'{"NaN":>25}'
    digits, power = f'{value:.16E}'.split('E')
    return f'{f"{digits}E{int(power):+04d}":>25}'


case = gearsweep.Case.read(sys.argv[1])
study = gearsweep.run(case, threads=2)
for table in study:
    frame = table.to_pandas()
    for column in table:
        if not table.is_reproducible[column]:
            print(f'{table.name}.{column}')
        for value in frame[column] if table.is_reproducible[column] else ():
            print(f'{table.name}.{column},{value if isinstance(value, str) else shown(value)}')
print(study.report(), end='')
again = gearsweep.run(case.changed(case={'title': 'again'}), threads=1, earlier=study)
print('resume = x: a single run is no longer resumed from a file: a run that is stopped keeps its finished tables, and a long study '
      'goes on from the store of `gearsweep many`')  # fmt: skip
print(again.log, end='')
print(*again.write('written', sys.argv[2]), sep='\n')
rows = gearsweep.run_rows(case.changed(case={'tasks': 'mesh'}), ['relief.amount_um', 'dynamics.damping_ratio'],
                          [[5, 0.25], [-1, 0.25]], ['motion.natural_frequency_hz'], earlier=study)  # fmt: skip
print('1 of 2 rows of values lack results; their code and message say why')
print(rows.messages[1])
for value in rows.columns['motion.natural_frequency_hz'].ravel():
    print(f'rows of motion.natural_frequency_hz,{shown(value)}')
