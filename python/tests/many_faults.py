"""What goes wrong in workers: functions that these import, as test_many_faults.py has them computed."""

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
    """In 12 ms, or in as many seconds as the environment says."""
    time.sleep(float(os.environ.get('MANY_SLOW', '0.012')))
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
