"""Status of a variant."""

from __future__ import annotations

import enum


class Status(enum.IntEnum):
    """Status of a variant; the integers are those in the store."""

    PENDING = 0  #: not computed yet
    OK = 1
    PARTIAL = 2  #: some of its operating points have no result and are NaN
    REFUSED = 3  #: the case is not usable, or its results have another shape than the others
    FAILED = 4  #: a method, or the caller's `reduce`, failed
    CRASHED = 5  #: the process that computed it ended, also when it computed nothing else
    LATE = 6  #: it took longer than the time limit of a variant


#: Statuses of variants that have numbers.
ANSWERED = (Status.OK, Status.PARTIAL)
#: Statuses that may change in another run, as memory, time or a file was missing. The others depend only on the plan.
PASSING = (Status.FAILED, Status.CRASHED, Status.LATE)
