"""What became of a variant."""

from __future__ import annotations

import enum


class Status(enum.IntEnum):
    """What became of a variant; the numbers stand in the store."""

    PENDING = 0  #: not computed yet
    OK = 1
    PARTIAL = 2  #: some of its operating points have no result and are NaN
    REFUSED = 3  #: the case is not usable, or its results have another shape than those of the others
    FAILED = 4  #: a method, or the caller's `reduce`, did not deliver
    CRASHED = 5  #: the process that computed it ended, also where it was computed alone
    LATE = 6  #: it took longer than the seconds that a variant has


#: Variants that have numbers.
ANSWERED = (Status.OK, Status.PARTIAL)
#: What another run may end otherwise: memory, time or a file was lacking. The others depend on the plan alone.
PASSING = (Status.FAILED, Status.CRASHED, Status.LATE)
