"""What `robust` can judge candidates by: of each pair of gears and assembly one number, the less the better."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._library import Error
from ..study import Study

#: What `reduce` gives: the number without deviations, at how many speeds each draw and assembly has no result, how many dynamic factors are
#: `inexact`, and by how much quick ones are off in a sample.
NOMINAL, LACKS, INEXACT, SAMPLE = 'nominal', 'speeds_without_result', 'points_inexact', 'sample_error'


@dataclass(frozen=True)
class Quantity:
    """One of them.

    Attributes
    ----------
    words, label : str
        What it is, in a sentence and at an axis.
    unit : str
    digits : int
        Behind the decimal point in print.
    columns : tuple of str
        The number is the largest of these, over speeds and gears.
    nominal : tuple of str
        The same columns of gears without deviations.
    keys : dict
        Of `&as_built`, without which it is not computed.
    at_rest : bool
        No motion has to be found.
    """

    words: str
    label: str
    unit: str
    digits: int
    columns: tuple[str, ...]
    nominal: tuple[str, ...]
    keys: Mapping[str, Any] = field(default_factory=dict)
    at_rest: bool = False

    @property
    def reduce(self) -> Callable[[Study], dict[str, Any]]:
        """What `many.run` makes of a study beside the columns."""
        return partial(_reduced, columns=self.nominal, at_rest=self.at_rest)

    def worst(self, data: Any, lacks: NDArray[Any]) -> NDArray[np.float64]:
        """The numbers of what `many.run` gives, (variant, draw, assembly); NaN where the motion lacks a result at some speed."""
        largest = np.max([data[name].values.reshape(*lacks.shape, -1).max(axis=-1) for name in self.columns], axis=0)
        return np.where(lacks == 0, largest, np.nan)


def _reduced(study: Study, columns: tuple[str, ...], at_rest: bool) -> dict[str, Any]:
    lacks = np.isnan(study.as_built.dynamic_factor[0]).sum(axis=-1)
    names = [name.split('.') for name in columns]
    nominal = np.max([study[table][column][0, 0, 0].max() for table, column in names])
    if at_rest:
        lacks[:] = 0
    elif np.isnan(study.as_built.nominal_factor[0, 0, 0]).any():
        nominal = np.nan
    inexact = 0 if at_rest else (study.as_built.status == 'inexact').sum()
    return {NOMINAL: nominal, LACKS: lacks, INEXACT: inexact, SAMPLE: study.as_built_summary.sample_error[0]}


def find(name: str) -> Quantity:
    """The quantity of this name.

    Raises
    ------
    Error
        There is none.
    """
    if not isinstance(name, str) or name not in QUANTITIES:
        raise Error(f'robust: judged = {name!r}: must be one of {", ".join(QUANTITIES)}')
    return QUANTITIES[name]


_GEARS = ('pinion_root_stress_mpa', 'gear_root_stress_mpa')
QUANTITIES = {
    'dynamic_factor': Quantity('Largest dynamic factor over the speeds', 'Largest dynamic factor (–)', '', 4,
                               ('as_built_worst.dynamic_factor',), ('as_built.nominal_factor',)),
    'dynamic_transmission_error': Quantity('Largest peak-to-peak dynamic transmission error over the speeds', 'Largest peak-to-peak DTE (µm)',
                                           'um', 3, ('as_built.dte_peak_to_peak_um',), ('as_built.nominal_dte_peak_to_peak_um',)),
    'static_transmission_error': Quantity('Peak-to-peak static transmission error over the turn', 'Peak-to-peak STE (µm)', 'um', 3,
                                          ('as_built_worst.ste_peak_to_peak_um',), ('as_built_worst.nominal_ste_peak_to_peak_um',),
                                          {'with_ste': True}, at_rest=True),
    'root_stress': Quantity('Largest root stress at the speed of the largest dynamic factor', 'Largest root stress (MPa)', 'MPa', 1,
                            tuple(f'as_built_worst.{name}' for name in _GEARS), tuple(f'as_built_worst.nominal_{name}' for name in _GEARS),
                            {'with_root_stress': True}),
}  # fmt: skip
