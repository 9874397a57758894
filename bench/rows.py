"""Many variants of one case: run one by one, and as rows of one call, in turn; each row must have the bits of its own run.
Processor time of one thread, so that a busy machine counts little.

    python bench/rows.py PROGRAMS           (bench/run.sh rows sets up and does this)
"""
import time
from statistics import median

import numpy as np
from report import BENCH, Report, machine

import gearsweep

ROUNDS, ROWS = 5, 40
NAMES = ['load.line_load_n_mm', 'dynamics.damping_ratio', 'relief.amount_um']
TAKE = 'sweep.dynamic_factor'
CASE = gearsweep.Case.read(BENCH.parent / 'data' / 'case1.nml').changed(
    case={'tasks': 'sweep', 'published': None}, relief={'amount_um': 15})
SCENES = {
    '327 speeds; load, damping, relief': (CASE, NAMES),
    '327 speeds; damping, relief': (CASE, NAMES[1:]),
    '3 speeds; load, damping, relief': (CASE.changed(sweep={'rpm_step': 9800}), NAMES),
    '3 speeds; damping, relief': (CASE.changed(sweep={'rpm_step': 9800}), NAMES[1:]),
    '3 speeds; face width': (CASE.changed(sweep={'rpm_step': 9800}), ['pair.face_width_mm']),
    '3 speeds; nothing': (CASE.changed(sweep={'rpm_step': 9800}), []),
}
MIDDLE = {'load.line_load_n_mm': 276, 'dynamics.damping_ratio': 0.12, 'relief.amount_um': 15, 'pair.face_width_mm': 25.4}


def values(names, seed):
    """Rows within 5 % of the middle."""
    spread = np.random.default_rng(seed).uniform(0.95, 1.05, (ROWS, len(names)))
    return spread * [MIDDLE[name] for name in names]


def one_by_one(case, names, rows, base):
    """Each row as a case of its own, from the study of the case."""
    start = time.process_time()
    found = []
    for row in rows:
        groups = {}
        for name, value in zip(names, row):
            group, key = name.split('.')
            groups.setdefault(group, {})[key] = value
        study = gearsweep.run(case.changed(**groups), 'sweep', threads=1, earlier=base)
        found.append(study.sweep.dynamic_factor.ravel())
    return np.array(found), time.process_time() - start


def in_rows(case, names, rows, base):
    """The same in one call, from the same study."""
    start = time.process_time()
    found = gearsweep.run_rows(case, names, rows, [TAKE], threads=1, earlier=base)
    return found.columns[TAKE], time.process_time() - start


report = Report('rows', 'Many variants of one case')
report.add(f'{machine()}, processor time of one thread for each variant, medians. `data/case1.nml` with the task sweep and one relief.\n')
table = []
for scene, (case, names) in SCENES.items():
    taken = []
    base = gearsweep.run(case, 'sweep', threads=1)
    for seed in range(ROUNDS):
        rows = values(names, seed)
        alone, slow = one_by_one(case, names, rows, base)
        together, fast = in_rows(case, names, rows, base)
        if not np.array_equal(alone, together):
            raise SystemExit(f'{scene}: rows differ from their own runs')
        taken.append((slow, fast))
    ms = [1000 * median(one) / ROWS for one in zip(*taken)]
    table.append([scene, *ms, ms[0] / ms[1]])
report.table(['scene', 'one by one, ms', 'rows of one call, ms', 'times'], table)
report.save()
