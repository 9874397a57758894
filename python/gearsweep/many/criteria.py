"""Criteria of `robust`: for each pair of gears and assembly one number to be minimised."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..core.library import Error
from ..core.study import Study

#: Names in `reduce`: the number without deviations, the number of speeds without a result for each draw and assembly, the number of
#: dynamic factors that are `inexact`, and the error of quick ones in a sample.
NOMINAL, LACKS, INEXACT, SAMPLE = 'nominal', 'speeds_without_result', 'points_inexact', 'sample_error'


@dataclass(frozen=True)
class Criterion:
    """A criterion.

    Attributes
    ----------
    words, label : str
        Name in a sentence, and at an axis.
    unit : str
    digits : int
        Digits after the decimal point in print.
    columns : tuple of str
        The number is the largest of these, over speeds and gears.
    nominal : tuple of str
        The same columns of gears without deviations.
    keys : dict
        Keys of `&as_built` that it requires.
    at_rest : bool
        True if no motion is needed.
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
        """Returns the function `reduce` of `many.run` for it."""
        return partial(_reduced, columns=self.nominal, at_rest=self.at_rest)

    def worst(self, data: Any, lacks: NDArray[Any]) -> NDArray[np.float64]:
        """Returns the numbers from the data of `many.run`, (variant, draw, assembly); NaN if the motion has no result at some
        speed.
        """
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


def criterion(name: str) -> Criterion:
    """Returns the criterion with this name.

    Raises
    ------
    Error
        There is none.
    """
    if not isinstance(name, str) or name not in CRITERIA:
        raise Error(f'robust: judged = {name!r}: must be one of {", ".join(CRITERIA)}')
    return CRITERIA[name]


_GEARS = ('pinion_root_stress_mpa', 'gear_root_stress_mpa')
CRITERIA = {
    'dynamic_factor': Criterion('Largest dynamic factor over the speeds', 'Largest dynamic factor (–)', '', 4,
                               ('as_built_worst.dynamic_factor',), ('as_built.nominal_factor',)),
    'dynamic_transmission_error': Criterion('Largest peak-to-peak dynamic transmission error over the speeds', 'Largest peak-to-peak DTE (µm)',
                                           'um', 3, ('as_built.dte_peak_to_peak_um',), ('as_built.nominal_dte_peak_to_peak_um',)),
    'static_transmission_error': Criterion('Peak-to-peak static transmission error over the turn', 'Peak-to-peak STE (µm)', 'um', 3,
                                          ('as_built_worst.ste_peak_to_peak_um',), ('as_built_worst.nominal_ste_peak_to_peak_um',),
                                          {'with_ste': True}, at_rest=True),
    'mesh_harmonic': Criterion('Amplitude of the mesh frequency in the static transmission error', 'Mesh harmonic of the STE (µm)', 'um', 3,
                              ('as_built_worst.ste_harmonic_um',), ('as_built_worst.nominal_ste_harmonic_um',), {'ste_harmonic': 1},
                              at_rest=True),
    'root_stress': Criterion('Largest root stress at the speed of the largest dynamic factor', 'Largest root stress (MPa)', 'MPa', 1,
                            tuple(f'as_built_worst.{name}' for name in _GEARS), tuple(f'as_built_worst.nominal_{name}' for name in _GEARS),
                            {'with_root_stress': True}),
}  # fmt: skip
