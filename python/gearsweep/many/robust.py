"""Robust relief: the candidate whose gears as built have the least quantile of a worst number, such as the largest dynamic factor."""

from __future__ import annotations

import os
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .._library import Error, PartialWarning
from ..case import Case
from . import clusters
from .judged import INEXACT, LACKS, NOMINAL, SAMPLE, find
from .plan import Plan
from .reading import failures
from .run import Progress, run

if TYPE_CHECKING:
    import xarray
    from matplotlib.figure import Figure

Reals = NDArray[np.float64]
#: Candidates are compared draw by draw, of which they have the same.
_SAME = ('deviations.draws', 'deviations.seed', 'deviations.assembly')


@dataclass(frozen=True, eq=False)
class Robust:
    """Candidates, nominal and as built.

    Attributes
    ----------
    table : Dataset
        A row for each `candidate`, with the keys that are varied as coordinates.

        - `nominal`: the judged number, such as the largest dynamic factor over the speeds, without deviations
        - `median`, `value`: the median and the wanted quantile of the same as built
        - `lower`, `upper`: band of `value`; NaN where there are too few draws for this end
        - `worse`, `worse_lower`, `worse_upper`: by how much `value` is above that of the best candidate, with the band of this difference,
          NaN where one of the two bands lacks an end
        - `best_share`: in which share of samples of the draws the candidate is the best; NaN where a band lacks an end

        `attrs` have what is judged, quantile, confidence, draws, assemblies, and draws and candidates that are left out.
    factors : DataArray
        The judged numbers that all follow from, over load, candidate, draw and assembly.
    plan : Plan
        What was computed.
    """

    table: xarray.Dataset
    factors: xarray.DataArray
    plan: Plan

    @property
    def best(self) -> xarray.Dataset:
        """The row of the candidate with the least quantile as built."""
        return self._row('value')

    @property
    def nominal(self) -> xarray.Dataset:
        """The row of the candidate that is best without deviations, and what it is worth as built."""
        return self._row('nominal')

    @property
    def alike(self) -> xarray.Dataset:
        """The rows that these draws cannot tell from the best, which is among them: the band of the difference has 0 in it, or is not known."""
        return self.table.isel(candidate=np.flatnonzero(~(self.table['worse_lower'].values > 0)))

    def case(self, candidate: int | None = None) -> Case:
        """The case of a candidate, of the best where none is given, with the first load and seed."""
        seeds = self.plan.n // (self.factors.sizes['load'] * self.factors.sizes['candidate'])
        return self.plan.case(seeds * (int(self.best['candidate']) if candidate is None else candidate))

    def plot(self, figure: Figure | None = None) -> Figure:
        """The valley, as `gearsweep.plots.robust.plot_valley` draws it."""
        from ..plots.robust import plot_valley

        return plot_valley(self, figure)

    def _row(self, column: str) -> xarray.Dataset:
        values = self.table[column].values
        if np.isnan(values).all():
            raise Error('robust: no candidate has a result without deviations at all speeds')
        return self.table.isel(candidate=int(np.nanargmin(values)))

    def __str__(self) -> str:
        from .robust_report import report

        return report(self)

    __repr__ = __str__


def robust(
    case: Case, /, *, judged: str = 'dynamic_factor', spectrum: Mapping[str, Mapping[float, float]] | None = None, seeds: int = 1,
    quantile: float = 0.95, confidence: float = 0.95, nan: str = 'refuse', executor: Any = None, store: str | os.PathLike | None = None, seconds: float | None = None,
    progress: Progress | bool = False, **groups: Mapping[str, Sequence[Any]],
) -> Robust:  # fmt: skip
    """Which of some reliefs, or values of any other keys, stands the deviations of its gears best.

    All candidates have the same gears, drawn at random as the case's `&deviations` say (class, `draws`, `seed`), so that they are compared
    in pairs. With `assembly = 'all'` each pair of gears is put together in each way. The number of each is its largest dynamic factor
    over the speeds, or what else is `judged`, and the candidate with the least quantile over draws, assemblies and loads is the best.

    The band of a quantile runs between order statistics, by the binomial distribution, as `quantiles` has it. Assemblies of one pair
    of gears and its loads are not independent: they count as so many independent points as the scatter of the draws' shares below
    the quantile says, at least the number of draws (Korn and Graubard 1998, Survey Methodology 24). Bands of differences are
    percentiles of samples of whole draws, the same draws for both candidates. Each holds for one comparison.

    Parameters
    ----------
    case : Case
        Gears, speeds and deviations.
    judged : str
        'dynamic_factor' : the largest over the speeds.

        'dynamic_transmission_error' : its largest peak-to-peak over the speeds, um.

        'static_transmission_error' : its peak-to-peak over the turn, um. Run-out and pitches count.

        'root_stress' : the largest nominal stress sigma_F0 of ISO 6336-3 at the root of any tooth of either gear over the turn, in
        motion at the speed of the largest dynamic factor, MPa.
    spectrum : dict, optional
        One key of `&load` with its loads and their shares of the time, as in `{'torque_nm': {80: 0.7, 120: 0.3}}`.
    seeds : int
        Above 1: so many variants of each candidate, for many workers, each with the case's `draws` of a seed of its own, from the case's on.
    quantile : float
        Its probability.
    confidence : float
        Of each band, both ends together.
    nan : {'refuse', 'drop'}
        What to do where a motion has no result at some speed: an error; or to leave out candidates without any result, and then draws,
        whole and for all candidates, which a `PartialWarning` tells. What has no result is rarely the best, so that the quantiles
        may be too low then.
    executor, store, seconds, progress : optional
        As of `run`; a candidate with one load and one seed is a variant.
    **groups
        Keys with lists of values, as in `relief={'amount_um': [8, 10, 12], 'shape': ['linear', 'parabolic']}`: each combination is a
        candidate.

    Returns
    -------
    Robust

    Raises
    ------
    Error
        There are no candidates or no drawn gears, a case is not usable, or numbers are missing. A warning tells how many dynamic factors
        are inexact.
    """
    quantity = find(judged)
    for name, value in (('quantile', quantile), ('confidence', confidence)):
        if not 0 < value < 1:
            raise Error(f'robust: {name} = {value}: must be between 0 and 1')
    if nan not in ('refuse', 'drop'):
        raise Error(f"robust: nan = {nan!r}: must be 'refuse' or 'drop'")
    if not isinstance(case, Case):
        raise TypeError(f'case: must be a gearsweep.Case, not {type(case).__name__}')
    if not groups:
        raise Error("robust: there are no candidates; give lists, such as relief={'amount_um': [8, 10, 12]}")
    loads, shares = _spectrum(spectrum, groups)
    case = case.changed(case={'tasks': 'as_built'}, as_built=quantity.keys)
    plan = Plan.grid(case, **loads, **_seeded(case, groups, seeds))
    _check(plan, nan, seeds)
    data = run(plan, quantity.columns, reduce=quantity.reduce, executor=executor, store=store, seconds=seconds, progress=progress)
    _warn_of_inexact(data[INEXACT].values, data[SAMPLE].values)
    nominal, factors = _factors(data, plan, shares if loads else None, seeds, judged)
    kept, draws = _kept(factors.values, nan, partial(_cause, data, plan, judged, store))
    table = _table(nominal[kept], factors.isel(candidate=kept, draw=draws), shares, quantile, confidence)
    table.attrs |= {'judged': judged, 'draws_left_out': int((~draws).sum()), 'candidates_left_out': int((~kept).sum())}
    return Robust(table, factors, plan)


def _spectrum(spectrum: Any, groups: Mapping[str, Any]) -> tuple[dict[str, Any], Reals]:
    """The list of loads for the plan, and the share of each."""
    if spectrum is None:
        return {}, np.ones(1)
    if not isinstance(spectrum, Mapping) or len(spectrum) != 1:
        raise Error("spectrum: must be one key of &load with its loads and their shares, such as {'torque_nm': {80: 0.7, 120: 0.3}}")
    if 'load' in groups:
        raise Error('load: is varied by spectrum, and cannot tell candidates apart')
    ((key, loads),) = spectrum.items()
    shares = np.array(list(loads.values()), float) if isinstance(loads, Mapping) else np.zeros(0)
    with np.errstate(over='ignore'):
        if not (shares > 0).all() or not 0 < shares.sum() < np.inf:
            raise Error(f'spectrum: {key} = {loads!r}: must be loads with their shares, each above 0 and their sum finite')
    return {'load': {key: list(loads)}}, shares / shares.sum()


def _seeded(case: Case, groups: Mapping[str, Any], seeds: int) -> dict[str, Any]:
    """The groups with seeds, from the case's on, as the key that changes fastest."""
    if isinstance(seeds, bool) or not isinstance(seeds, int) or not 1 <= seeds <= 1_000_000:
        raise Error(f'robust: seeds = {seeds!r}: must be a whole number from 1 to 1000000')
    if seeds == 1:
        return dict(groups)
    deviations = groups.get('deviations', {})
    if 'seed' in deviations:
        raise Error('&deviations seed: is varied by seeds, and cannot tell candidates apart')
    drawn = case.get('deviations', 'seed', 1) + np.arange(seeds)
    try:
        case.changed(deviations={'seed': drawn[-1]}).complete()
    except Error as error:
        raise Error(f'robust: seeds = {seeds}, from &deviations seed = {drawn[0]} on: {error}') from None
    return {name: keys for name, keys in groups.items() if name != 'deviations'} | {'deviations': {**deviations, 'seed': drawn}}


def _check(plan: Plan, nan: str, seeds: int) -> None:
    """Refuses what no candidate may be, before anything is computed."""
    for one in plan.inputs:
        if one.name in _SAME and len(one.given) > (seeds if one.name == 'deviations.seed' else 1):
            raise Error(f'&deviations {one.key.key}: cannot tell candidates apart, as all have the same gears and assemblies; give one value')
    first = _usable(plan, nan, seeds)
    if not any(first.get('deviations', f'{gear}_class') for gear in ('pinion', 'gear')):
        raise Error('robust: the case draws no gears; give &deviations pinion_class or gear_class')
    if (draws := first.get('deviations', 'draws')) * seeds < 2:
        raise Error(f'robust: &deviations draws = {draws}: must be at least 2')
    if isinstance(amounts := first.get('relief', 'amount_um'), tuple):
        raise Error(f"robust: &relief amount_um has {len(amounts)} values; give them as relief={{'amount_um': [...]}}")


def _usable(plan: Plan, nan: str, seeds: int) -> Case:
    """The case of the first candidate that can be; all must be unless they may be left out."""
    cases: list[Case] = []
    errors: list[Error] = []
    for at in range(0, plan.n, seeds):
        try:
            cases.append(plan.case(at).complete())
        except Error as error:
            if nan == 'refuse':
                raise
            errors.append(error)
    if not cases:
        raise errors[0]
    return cases[0]


def _factors(data: xarray.Dataset, plan: Plan, shares: Reals | None, seeds: int, judged: str) -> tuple[Reals, xarray.DataArray]:
    """Nominal numbers (candidate, load), and those as built; NaN where the motion has no result at some speed."""
    import xarray

    quantity, lacks = find(judged), data[LACKS].values
    loads = 1 if shares is None else len(shares)
    candidates = plan.n // (loads * seeds)
    values = quantity.worst(data, lacks)
    coords: dict[str, Any] = {'share': ('load', np.ones(1) if shares is None else shares), 'candidate': np.arange(candidates)}
    # The load is the first key, and changes slowest; the seed is the last.
    for at, one in enumerate(plan.inputs):
        is_load = shares is not None and at == 0
        labels = [_label(one.key.written(value)) for value in plan.rows()[:, at]]
        if one.name != 'deviations.seed' or seeds == 1:
            labels = labels[:: candidates * seeds] if is_load else labels[: candidates * seeds : seeds]
            coords[one.name] = 'load' if is_load else 'candidate', labels, data[one.name].attrs
    factors = xarray.DataArray(values.reshape(loads, candidates, -1, lacks.shape[-1]), coords,
                               ('load', 'candidate', 'draw', 'assembly'), f'largest_{judged}', {'units': quantity.unit})  # fmt: skip
    nominal = data[NOMINAL].values.reshape(loads, candidates, seeds)[..., 0].T
    return nominal, factors.transpose('candidate', 'draw', 'assembly', 'load')


def _warn_of_inexact(inexact: Reals, sample: Reals) -> None:
    """Of each variant, how many dynamic factors are inexact, and by how much quick ones are off in a sample; NaN: not known."""
    if not (found := inexact > 0).any():
        return
    off = np.append(sample[np.isfinite(sample)], 0).max()
    quick = f'; with quick they are off by up to {off:.1g} in a sample' if off else ''
    warnings.warn(f'robust: {inexact[found].sum():.0f} dynamic factors, in {found.sum()} of {len(found)} variants, are inexact{quick}', stacklevel=3)


def _label(value: Any) -> Any:
    """The value of a key as a label: a list as text."""
    return ', '.join(map(str, value)) if isinstance(value, tuple) else value


def _cause(data: xarray.Dataset, plan: Plan, judged: str, store: str | os.PathLike | None) -> str:
    """The first variant that lacks numbers by its keys, and why, as far as a store knows it."""
    values = find(judged).worst(data, data[LACKS].values)
    at = int(np.isfinite(values.reshape(plan.n, -1)).all(axis=1).argmin())
    keys = ', '.join(f'&{key.group} {key.key} = {_label(key.written(value))}' for key, value in zip(plan.keys, plan.rows(at, at + 1)[0]))
    if store is None:
        return f'the first is {keys}; a run of its case tells why, and many.failures(store) of all where store is given'
    return f'of the first, {keys}: {failures(store).set_index("variant")["message"].get(at, "")}'


def _kept(values: Reals, nan: str, cause: Callable[[], str]) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Which candidates have any result, and which draws have all of theirs."""
    there: NDArray[np.bool_] = np.isfinite(values).reshape(*values.shape[:2], -1).min(axis=2)
    kept: NDArray[np.bool_] = there.max(axis=1)
    draws: NDArray[np.bool_] = there[kept].min(axis=0, initial=True)
    said = f'{(~kept).sum()} of {len(kept)} candidates have no result, {(~draws).sum()} of {len(draws)} draws lack some'
    complete = bool(kept.all() and draws.all())
    if nan == 'refuse' and not complete:
        raise Error(f"robust: {said}; nan='drop' leaves them out, and quantiles may be too low then; {cause()}")
    if not kept.any() or draws.sum() < 2:
        raise Error(f'robust: {said}; nothing is left to compare; {cause()}')
    if not complete:
        warnings.warn(f'robust: {said}; they are left out; {cause()}', PartialWarning, stacklevel=3)
    return kept, draws


def _table(nominal: Reals, factors: xarray.DataArray, shares: Reals, q: float, confidence: float) -> xarray.Dataset:
    """All numbers of all candidates."""
    import xarray

    candidates, draws, assemblies, _ = factors.shape
    columns = {'nominal': np.array([clusters.quantile(one[None], shares, q, np.ones((1, 1)))[0] for one in nominal])}
    columns |= clusters.compare(factors.values.reshape(candidates, draws, -1), np.tile(shares, assemblies) / assemblies, q, confidence)
    coords = {name: one for name, one in factors.coords.items() if one.dims == ('candidate',)}
    attributes = {'quantile': q, 'confidence': confidence, 'draws': draws, 'assemblies': assemblies, 'loads': len(shares)}
    return xarray.Dataset({name: ('candidate', column) for name, column in columns.items()}, coords, attributes)
