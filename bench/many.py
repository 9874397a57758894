"""Many variants of case 1 with 327 speeds: run time by executor, and what the process costs that hands out blocks and writes the store.

    python bench/many.py PROGRAMS [VARIANTS [KEYS]]     (bench/run.sh many does this, with 10000)

PROGRAMS is not used. KEYS: 'load', 'relief'; both without. Two processes compute; each plan runs once more with a twentieth of the variants in this process, for the same bits.
"""
import os
import pathlib
import resource
import shutil
import sys
import tempfile
import time

import numpy as np
from report import BENCH, Report, machine
from scipy.stats import norm, truncnorm, uniform

import gearsweep
from gearsweep import many

WORKERS = 2
TAKE = ['sweep_worst.worst_dynamic_factor', 'sweep.dynamic_factor']
CASE = gearsweep.Case.read(BENCH.parent / 'data/case1.nml').changed(case={'tasks': 'sweep', 'published': None}, sweep={'load_rpm': None})
KEYS = {
    'relief': dict(dynamics={'damping_ratio': uniform(0.1, 0.14)}, relief={'amount_um': truncnorm(-3, 3, 15, 1.5)}),
    'load': dict(load={'line_load_n_mm': norm(276, 15)}, dynamics={'damping_ratio': uniform(0.1, 0.14)},
                 relief={'amount_um': truncnorm(-3, 3, 15, 1.5)}),
}


def dask():
    from distributed import Client

    return Client(n_workers=WORKERS, threads_per_worker=1, dashboard_address=None)


def measure(plan, executor, store):
    """Dataset, seconds, and of these how much of a processor this process took, with Dask the scheduler too."""
    began, used = time.perf_counter(), time.process_time()
    data = many.run(plan, TAKE, executor=executor, store=store)
    took = time.perf_counter() - began
    return data, took, (time.process_time() - used) / took


def main():
    n = int(sys.argv[2]) if len(sys.argv) > 2 else 10000
    report = Report('many', f'{n} variants of case 1 with 327 speeds, {WORKERS} processes')
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for keys, groups in KEYS.items():
            if keys not in (sys.argv[3:] or KEYS):
                continue
            plan = many.Plan.random(CASE, n, 2026, **groups)
            few = many.Plan.random(CASE, max(1, n // 20), 2026, **groups)
            here, alone, _ = measure(few, None, None)
            for name in ('processes', 'Dask'):
                store = os.path.join(folder, 'store.zarr')
                if name == 'Dask':
                    with dask() as client:
                        data, took, share = measure(plan, client, store)
                else:
                    data, took, share = measure(plan, WORKERS, store)
                same = all(np.array_equal(here[one], data[one][: few.n], equal_nan=True) for one in TAKE)
                files = [path for path in pathlib.Path(store).rglob('*') if path.is_file()]
                size = sum(path.stat().st_size for path in files) / 1e6
                rows.append((', '.join(one.partition('.')[2] for one in plan.names), name, f'{took:.1f}', f'{1e3 * took / n:.2f}', f'{1e3 * alone / few.n:.2f}', f'{100 * share:.0f}',
                             f'{size:.0f}, {len(files)}', str(many.counts(data).get('ok', 0)), 'yes' if same else 'NO'))
                shutil.rmtree(store)
    report.table(('varied', 'over', 's', 'ms a variant', 'ms on one thread', '% of a processor here', 'store: MB, files', 'ok', 'same bits'), rows)
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3
    report.add(f'This process took {memory:.0f} MB at most, a worker {resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1e3:.0f} MB.\n')
    report.add(f'{machine()}; by `sh bench/run.sh many`\n')
    report.save()


if __name__ == '__main__':
    main()
