"""What goes wrong in workers: functions that these import, as test_worker_faults.py has them computed."""

import contextlib
import os
import time

import numpy as np

#: The damping ratio above which a variant goes wrong.
LIMIT = 0.2345


def worst(study):
    return float(np.nanmax(study.sweep.dynamic_factor))


def poison(study):
    """Ends the process of one variant."""
    if study.case.get('dynamics', 'damping_ratio') > LIMIT:
        os._exit(7)
    return {'worst': worst(study)}


def slow(study):
    """In 12 ms, or in as many seconds as the environment says; while a file of this name is there it waits, for two minutes at most."""
    time.sleep(float(os.environ.get('MANY_SLOW', '0.012')))
    until = time.monotonic() + 120
    while os.path.exists(os.environ.get('MANY_HELD', '')) and time.monotonic() < until:
        time.sleep(0.02)
    return {'worst': worst(study)}


def endless(study):
    """Has no end for one variant, and does not let an exception end it."""
    while study.case.get('dynamics', 'damping_ratio') > LIMIT:
        with contextlib.suppress(Exception):
            time.sleep(0.001)
    return {'worst': worst(study)}


def once(study):
    """Ends its process the first time that it is asked, as where someone kills a worker."""
    mark = os.environ['MANY_ONCE']
    if study.case.get('dynamics', 'damping_ratio') > LIMIT and not os.path.exists(mark):
        open(mark, 'w').close()
        os._exit(7)
    return {'worst': worst(study)}


def fails(study):
    if study.case.get('dynamics', 'damping_ratio') > LIMIT:
        raise ValueError('no such number')
    return {'worst': worst(study)}
