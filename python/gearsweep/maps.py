"""Stability, branches and chaos: what a sweep does not show.

The functions take the speeds of the case's sweep where none are given, and need only what the mesh needs
otherwise. `work` is what `prepare` gives.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _border
from .case import Case
from .results import Contact, Integers, Reals, Result, Status, _field, _words
from .tasks import _VERSION, _ready, _with_mesh


@dataclass(frozen=True, eq=False, repr=False)
class StabilityMap(Result):
    """Stability of the motion with all pairs in contact, over speed and damping; load and relief drop out.

    Attributes
    ----------
    rpm, damping_ratio : array
        As asked for.
    modulus : array (rpm, damping_ratio)
        Largest of the Floquet multipliers, what remains of a disturbance after a mesh period: the motion
        is unstable above 1. NaN where the speed is too low.
    sense : array (rpm, damping_ratio)
        Sign of that multiplier where it is real, 0 for a complex pair. Beyond 1, a motion with 1 does not
        return, one with -1 doubles its period.
    closing_ratio, closing_rpm : array (tongue)
        Damping ratio from which a tongue of instability is closed (NaN: above 1), and the speed of its last
        point; from the highest speed on.
    edge_rpm : array (side, damping_ratio, tongue)
        Between these speeds the motion is unstable; NaN where the tongue is closed.
    """

    rpm: Reals = _field('1/min', 'rpm')
    damping_ratio: Reals = _field('', 'damping_ratio')
    modulus: Reals = _field('', 'rpm', 'damping_ratio')
    sense: Integers = _field('', 'rpm', 'damping_ratio')
    closing_ratio: Reals = _field('', 'tongue')
    closing_rpm: Reals = _field('1/min', 'tongue')
    edge_rpm: Reals = _field('1/min', 'side', 'damping_ratio', 'tongue')

    labels = {'side': ['lower', 'upper']}
    rows = ('rpm', 'damping_ratio')


@dataclass(frozen=True, eq=False, repr=False)
class Hysteresis(Result):
    """The steady motions that a slow run up and one down meet, and the speeds at which they change.

    Attributes
    ----------
    rpm : array (rpm)
        Speed of the pinion, ascending.
    dynamic_factor, estimate, status, contact, floquet_modulus, periods : array (direction, rpm)
        As in `Sweep`.
    x_um, v_mm_s : array (direction, rpm)
        Dynamic transmission error and its rate as a new pair enters: the motion can be continued from them.
    change_direction : array (change)
        1 for up, -1 for down; changes in the order met.
    change_rpm, change_factor, change_status, change_periods : array (change, end)
        Before and after, in the direction of travel: the speeds, very close to each other, and the motions there.
    """

    rpm: Reals = _field('1/min', 'rpm')
    dynamic_factor: Reals = _field('', 'direction', 'rpm')
    estimate: Reals = _field('', 'direction', 'rpm')
    status: Integers = _field('', 'direction', 'rpm')
    contact: Integers = _field('', 'direction', 'rpm')
    floquet_modulus: Reals = _field('', 'direction', 'rpm')
    periods: Integers = _field('', 'direction', 'rpm')
    x_um: Reals = _field('um', 'direction', 'rpm')
    v_mm_s: Reals = _field('mm/s', 'direction', 'rpm')
    change_direction: Integers = _field('', 'change')
    change_rpm: Reals = _field('1/min', 'change', 'end')
    change_factor: Reals = _field('', 'change', 'end')
    change_status: Integers = _field('', 'change', 'end')
    change_periods: Integers = _field('', 'change', 'end')

    labels = {'direction': ['up', 'down'], 'end': ['before', 'after']}
    rows = ('direction', 'rpm')

    @property
    def status_name(self) -> NDArray[np.str_]:
        """`status` in words, as in the tables."""
        return _words(Status)[self.status]

    @property
    def contact_name(self) -> NDArray[np.str_]:
        """`contact` in words, as in the tables."""
        return _words(Contact)[self.contact]

    @property
    def change_name(self) -> NDArray[np.str_]:
        """Each change in a word: `doubling` and `halving` of the period, or a `jump` to another motion.

        Where there is no answer before or after, the status there.
        """
        return np.array([_name(*ends) for ends in zip(self.change_status, self.change_periods)], dtype=np.str_)


def _name(status: Sequence[int], periods: Sequence[int]) -> str:
    for one in reversed(status):
        if one >= Status.UNSTABLE:
            return Status(one).name.lower()
    if periods[1] == 2 * periods[0]:
        return 'doubling'
    return 'halving' if periods[0] == 2 * periods[1] else 'jump'


@dataclass(frozen=True, eq=False, repr=False)
class Strobe(Result):
    """The motion seen once a mesh period, as a new pair enters.

    One point where it repeats with the mesh, n points where it repeats after n periods, a cloud where it
    never does.

    Attributes
    ----------
    rpm : array (rpm)
        Speed of the pinion, in the order followed.
    x_um, v_mm_s : array (period, rpm)
        Dynamic transmission error and its rate; NaN where the speed is too low.
    exponent : array (rpm)
        Largest Lyapunov exponent, of a mesh period: the mean logarithm by which a disturbance grows. Below 0
        where the motion repeats, above 0 where it is chaotic.
    status : array (rpm)
        `Status.OK`, `SUBHARMONIC`, `CHAOTIC`; `APERIODIC` where it neither repeats nor is surely chaotic within
        what was kept; `UNRESOLVED`, `CHATTER`.
    periods : array (rpm)
        Mesh periods until the motion repeats, to 1e-4 static deflections; 0 where it does not.
    """

    rpm: Reals = _field('1/min', 'rpm')
    x_um: Reals = _field('um', 'period', 'rpm')
    v_mm_s: Reals = _field('mm/s', 'period', 'rpm')
    exponent: Reals = _field('', 'rpm')
    status: Integers = _field('', 'rpm')
    periods: Integers = _field('', 'rpm')

    rows = ('rpm', 'period')

    @property
    def status_name(self) -> NDArray[np.str_]:
        """`status` in words, as in the tables."""
        return _words(Status)[self.status]


def stability_map(
    case: Case,
    rpm: ArrayLike | None = None,
    damping_ratio: ArrayLike | None = None,
    *,
    tongues: int = 10,
    work: np.ndarray | None = None,
) -> StabilityMap:
    """Floquet multipliers over speed and damping while all pairs stay in contact, and the tongues of instability.

    Parameters
    ----------
    case : Case
        Its load, reliefs and damping do not matter.
    rpm : array, optional
        Speeds of the pinion, ascending.
    damping_ratio : array, optional
        0 to 0.2 unless given.
    tongues : int
        How many to find, from the highest speed on.

    Examples
    --------
    >>> import gearsweep
    >>> case = gearsweep.Case('''&pinion teeth = 25 effective_mass_kg = 0.8 / &gear effective_mass_kg = 0.8 /
    ...     &load normal_force_n = 7000 / &mesh model = 'polynomial' contact_ratio = 1.6 coefficients = 400 /''')
    >>> stability = gearsweep.stability_map(case, [15000, 30000], [0, 0.05], tongues=2)
    >>> stability.modulus.round(3)
    array([[1.367, 0.998],
           [1.339, 1.145]])
    >>> stability.closing_ratio.round(4)
    array([0.0941, 0.0499])
    """
    case = _with_mesh(case)
    rpm = _speeds(case, rpm)
    damping_ratio = _border.reals('damping_ratio', np.linspace(0, 0.2, 101) if damping_ratio is None else damping_ratio)
    found = _border.stability(case.text, _ready(case, work), rpm, damping_ratio, tongues)
    return StabilityMap(case, _VERSION, rpm, damping_ratio, *found)


def hysteresis(
    case: Case,
    rpm: ArrayLike | None = None,
    *,
    relief: int = 0,
    jump: float = 0.02,
    closeness: float = 1e-6,
    work: np.ndarray | None = None,
) -> Hysteresis:
    """The steady motions that a slow run up through the speeds and one down meet, and where they change.

    Between two speeds the steps are so small that the dynamic factor changes by less than `jump` in each; where
    it does not, between speeds closer than `closeness` (relative), the motion has changed.

    Parameters
    ----------
    case : Case
        Its `direction` does not matter.
    rpm : array, optional
        Speeds of the pinion, ascending.
    relief : int
        Which of the case's, by its index.

    Examples
    --------
    >>> import gearsweep
    >>> case = gearsweep.Case('''&pinion teeth = 25 effective_mass_kg = 0.8 / &gear effective_mass_kg = 0.8 /
    ...     &load normal_force_n = 7000 / &dynamics damping_ratio = 0.05 /
    ...     &mesh model = 'polynomial' contact_ratio = 1.6 coefficients = 400, 0, -110 /''')
    >>> both = gearsweep.hysteresis(case, [10000, 11000, 12000])
    >>> print(both.dynamic_factor.round(2))
    [[1.11 1.3  1.99]
     [2.54 2.24 1.99]]
    >>> for name, direction, rpm in zip(both.change_name, both.change_direction, both.change_rpm):
    ...     print(name, direction, rpm.round())
    jump 1 [11600. 11600.]
    """
    case = _with_mesh(case)
    rpm, work = _speeds(case, rpm), _ready(case, work)
    if np.any(np.diff(rpm) <= 0):
        raise _border.Error('rpm: must ascend')
    ways = [_border.follow(case.text, work, relief + 1, way, jump, closeness) for way in (rpm, rpm[::-1])]
    changes = [np.concatenate([way[k] for way in ways]) for k in range(4)]
    sense = np.repeat([1, -1], [len(way[0]) for way in ways]).astype(np.int32)
    curves = [np.array([ways[0][k], ways[1][k][::-1]]) for k in range(4, len(ways[0]))]
    return Hysteresis(case, _VERSION, rpm, *curves, sense, *changes)


def strobe(
    case: Case,
    rpm: ArrayLike | None = None,
    *,
    relief: int = 0,
    start: tuple[float, float] = (np.nan, np.nan),
    settle: int = 500,
    keep: int = 400,
    work: np.ndarray | None = None,
) -> Strobe:
    """The motion seen once a mesh period, and its largest Lyapunov exponent.

    At each further speed it starts where it was at the one before: so it is followed up where the speeds
    ascend, and down where they descend.

    Parameters
    ----------
    rpm : array, optional
        Speeds of the pinion, in any order.
    relief : int
        Which of the case's, by its index.
    start : (float, float)
        `x_um` and `v_mm_s` of the motion to begin with, as from `hysteresis`; otherwise at rest.
    settle, keep : int
        Mesh periods passed over at each speed, and kept after them.

    Examples
    --------
    >>> import gearsweep
    >>> case = gearsweep.Case('''&pinion teeth = 25 effective_mass_kg = 0.8 / &gear effective_mass_kg = 0.8 /
    ...     &load normal_force_n = 7000 / &dynamics damping_ratio = 0.02 /
    ...     &mesh model = 'polynomial' contact_ratio = 1.6 coefficients = 400 /''')
    >>> seen = gearsweep.strobe(case, [6040, 7200, 12000])
    >>> print(seen.status_name, seen.periods)
    ['subharmonic' 'chaotic' 'ok'] [2 0 1]
    """
    case = _with_mesh(case)
    rpm = _speeds(case, rpm)
    found = _border.strobe(case.text, _ready(case, work), relief + 1, rpm, start, settle, keep)
    return Strobe(case, _VERSION, rpm, *found)


def _speeds(case: Case, rpm: ArrayLike | None) -> Reals:
    """The speeds given, or those of the case's sweep."""
    if rpm is not None:
        return _border.reals('rpm', rpm)
    first, last, step = (case.get('sweep', f'rpm_{key}') for key in ('first', 'last', 'step'))
    if first is None:
        raise _border.Error('rpm: not given, and the case has no sweep')
    return first + step * np.arange(1 + int((last - first) / step + 1e-9))
