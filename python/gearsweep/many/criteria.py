"""Criteria of `robust`: for each draw, such as a pair of gears, and assembly one number to be minimised."""

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
    task : str
        The task that has the columns. Of gears as built a variant has several draws and its own nominal numbers; of another task it is
        a draw of the caller's scatter.
    """

    words: str
    label: str
    unit: str
    digits: int
    columns: tuple[str, ...]
    nominal: tuple[str, ...]
    keys: Mapping[str, Any] = field(default_factory=dict)
    at_rest: bool = False
    task: str = 'as_built'

    @property
    def is_as_built(self) -> bool:
        return self.task == 'as_built'

    @property
    def state(self) -> str:
        """What the draws are, in a sentence."""
        return 'as built' if self.is_as_built else 'with scatter'

    @property
    def reduce(self) -> Callable[[Study], dict[str, Any]] | None:
        """Returns the function `reduce` of `many.run` for it."""
        return partial(_reduced, columns=self.nominal, at_rest=self.at_rest) if self.is_as_built else None

    def worst(self, data: Any) -> NDArray[np.float64]:
        """Returns the numbers from the data of `many.run`, (variant, draw, assembly); NaN if the motion has no result at some
        speed.
        """
        lacks = data[LACKS].values if self.is_as_built else np.zeros((data.sizes['variant'], 1, 1))
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
    'face_load_factor': Criterion('K_H_beta in the middle of contact of the fewest pairs', 'Face load factor $K_{Hβ}$ (–)', '', 4,
                                 ('face_load_summary.face_load_factor',), (), task='face_load'),
    'root_face_load_factor': Criterion('K_F_beta', 'Face load factor of the root $K_{Fβ}$ (–)', '', 4,
                                      ('face_load_summary.root_face_load_factor',), (), task='face_load'),
}  # fmt: skip
