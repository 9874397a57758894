"""Robust relief and crowning: the candidate with the least quantile of a number over gears as built, such as the largest dynamic factor, or
over a scatter of keys, such as misalignment.
"""

from __future__ import annotations

import os
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..core.case import Case
from ..core.library import Error, PartialWarning
from . import cluster_quantiles
from .criteria import CRITERIA, INEXACT, NOMINAL, SAMPLE, Criterion, criterion
from .inputs import Input
from .plan import Plan
from .reading import failures
from .run import Progress, run

if TYPE_CHECKING:
    import xarray
    from matplotlib.figure import Figure

Reals = NDArray[np.float64]
#: Candidates are compared draw by draw, as they have the same draws.
_SAME = ('deviations.draws', 'deviations.seed', 'deviations.assembly')


@dataclass(frozen=True, eq=False)
class Robust:
    """Candidates, nominal, and as built or with scatter.

    Attributes
    ----------
    table : Dataset
        A row for each `candidate`, with the keys that are varied as coordinates.

        - `nominal`: value of the criterion, such as the largest dynamic factor over the speeds, without deviations or with the scattered
          keys at their medians
        - `median`, `value`: median and requested quantile of this number over the draws
        - `lower`, `upper`: band of `value`; NaN where there are too few draws for this end
        - `worse`, `worse_lower`, `worse_upper`: by how much `value` is above that of the best candidate, with the band of this difference,
          NaN where one of the two bands lacks an end
        - `best_share`: in which share of samples of the draws the candidate is the best; NaN where a band lacks an end

        `attrs` have the criterion, quantile, confidence, draws, assemblies, and the omitted draws and candidates.
    factors : DataArray
        Values of the criterion, from which all results follow, over load, candidate, draw and assembly.
    plan : Plan
        Plan of the computation.
    """

    table: xarray.Dataset
    factors: xarray.DataArray
    plan: Plan

    @property
    def best(self) -> xarray.Dataset:
        """Row of the candidate with the smallest quantile over the draws."""
        return self._row('value')

    @property
    def nominal(self) -> xarray.Dataset:
        """Row of the candidate that is nominally best, and its value over the draws."""
        return self._row('nominal')

    @property
    def alike(self) -> xarray.Dataset:
        """Rows that these draws cannot distinguish from the best, including it: the band of the difference contains 0, or is not
        known.
        """
        return self.table.isel(candidate=np.flatnonzero(~(self.table['worse_lower'].values > 0)))

    def case(self, candidate: int | None = None) -> Case:
        """Returns the case of a candidate, by default of the best, with the first load and seed, and scattered keys at their medians."""
        seeds = self.plan.n // (self.factors.sizes['load'] * self.factors.sizes['candidate'])
        return self.plan.case(seeds * (int(self.best['candidate']) if candidate is None else candidate))

    def plot(self, figure: Figure | None = None) -> Figure:
        """Draws the valley with `robust_pictures.plot_valley`."""
        from .robust_pictures import plot_valley

        return plot_valley(self, figure)

    def _row(self, column: str) -> xarray.Dataset:
        values = self.table[column].values
        if np.isnan(values).all():
            raise Error('robust: no candidate has a nominal result')
        return self.table.isel(candidate=int(np.nanargmin(values)))

    def __str__(self) -> str:
        return _report(self)

    __repr__ = __str__


def robust(
    case: Case, /, *, judged: str = 'dynamic_factor', spectrum: Mapping[str, Mapping[float, float]] | None = None,
    scatter: Mapping[str, Mapping[str, Any]] | None = None, seeds: int = 1,
    quantile: float = 0.95, confidence: float = 0.95, nan: str = 'refuse', executor: Any = None, store: str | os.PathLike | None = None, seconds: float | None = None,
    progress: Progress | bool = False, **groups: Mapping[str, Sequence[Any]],
) -> Robust:  # fmt: skip
    """Finds which of several reliefs, or values of other keys, is the least sensitive to the deviations of its gears, or which crowning to
    the scatter of misalignment.

    All candidates have the same gears, drawn at random by the case's `&deviations` (class, `draws`, `seed`), so that they are
    compared in pairs. With `assembly = 'all'` each pair of gears is assembled in each possible way. The criterion is the largest
    dynamic factor over the speeds, or another one by `judged`, and the candidate with the smallest quantile over draws, assemblies
    and loads is the best.

    The band of a quantile lies between order statistics, by the binomial distribution, as in `quantiles`. Assemblies and loads of
    one pair of gears are not independent: their effective number of independent points follows from the scatter of the draws'
    shares below the quantile, and is at least the number of draws (Korn and Graubard 1998, Survey Methodology 24). Bands of
    differences are percentiles of samples of complete draws, the same draws for both candidates. Each band is valid for one
    comparison.

    Parameters
    ----------
    case : Case
        Gears, speeds and deviations.
    judged : str
        'dynamic_factor' : the largest over the speeds.

        'dynamic_transmission_error' : its largest peak-to-peak over the speeds, um.

        'static_transmission_error' : its peak-to-peak over the turn, um. Run-out and pitches count.

        'mesh_harmonic' : the amplitude of the mesh frequency in it, um.

        'root_stress' : the largest nominal stress sigma_F0 of ISO 6336-3 at the root of any tooth of either gear over the turn, in
        motion at the speed of the largest dynamic factor, MPa.
        'face_load_factor', 'root_face_load_factor' : K_H_beta in the middle of contact of the fewest pairs, and K_F_beta, over `scatter`.
    spectrum : dict, optional
        One key of `&load` with its loads and their shares of the time, as in `{'torque_nm': {80: 0.7, 120: 0.3}}`.
    scatter : dict, optional
        For face load factors: keys with their distributions of `scipy.stats` or lists of equally likely values, as in
        `{'face': {'misalignment_um': norm(0, 10)}}`. All candidates have the same values, independent and drawn at random with the seed of
        `&deviations`.
    seeds : int
        Number of variants of each candidate: with `scatter` each is a draw; else, for many workers, each has the case's `draws` and a seed
        of its own, counted from the case's.
    quantile : float
        Probability of the quantile.
    confidence : float
        Confidence of each band, both ends together.
    nan : {'refuse', 'drop'}
        Treatment of motions without a result at some speed: an error; or omission of candidates without any result, and then of
        each draw without one, for all candidates, with a `PartialWarning`. Motions without a result are rarely the best, so that
        the quantiles may then be too low.
    executor, store, seconds, progress : optional
        As in `run`; a candidate with one load and one seed is a variant.
    **groups
        Keys with lists of values, as in `relief={'amount_um': [8, 10, 12], 'shape': ['linear', 'parabolic']}`: each combination is a
        candidate.

    Returns
    -------
    Robust

    Raises
    ------
    Error
        There are no candidates or no drawn gears, a case is not usable, or numbers are missing. A warning reports the number of
        inexact dynamic factors.
    """
    quantity = criterion(judged)
    for name, value in (('quantile', quantile), ('confidence', confidence)):
        if not 0 < value < 1:
            raise Error(f'robust: {name} = {value}: must be between 0 and 1')
    if nan not in ('refuse', 'drop'):
        raise Error(f"robust: nan = {nan!r}: must be 'refuse' or 'drop'")
    if not isinstance(case, Case):
        raise TypeError(f'case: must be a gearsweep.Case, not {type(case).__name__}')
    if not groups:
        raise Error("robust: there are no candidates; add lists, such as relief={'amount_um': [8, 10, 12]}")
    loads, shares = _spectrum(spectrum, groups)
    _check_seeds(seeds, quantity, scatter)
    case = case.changed(case={'tasks': quantity.task}, as_built=quantity.keys)
    if scatter is None:
        plan, each = Plan.grid(case, **loads, **_seeded(case, groups, seeds)), seeds
        inner = ['deviations.seed'] if seeds > 1 else []
    else:
        outer = Plan.grid(case, **loads, **groups)
        plan, each = _scattered(outer, seeds, scatter), seeds + 1
        inner = [name for name in plan.names if name not in outer.names]
    _check(plan, nan, each, quantity)
    data = run(plan, quantity.columns, reduce=quantity.reduce, executor=executor, store=store, seconds=seconds, progress=progress)
    if quantity.is_as_built:
        _warn_of_inexact(data[INEXACT].values, data[SAMPLE].values)
    nominal, factors = _factors(data, plan, shares if loads else None, each, inner, judged)
    selected, draws = _select_complete(factors.values, nan, partial(_cause, data, plan, judged, store))
    table = _table(nominal[selected], factors.isel(candidate=selected, draw=draws), shares, quantile, confidence)
    table.attrs |= {'judged': judged, 'draws_left_out': int((~draws).sum()), 'candidates_left_out': int((~selected).sum())}
    return Robust(table, factors, plan)


def _spectrum(spectrum: Any, groups: Mapping[str, Any]) -> tuple[dict[str, Any], Reals]:
    """Returns the list of loads for the plan, and the share of each."""
    if spectrum is None:
        return {}, np.ones(1)
    if not isinstance(spectrum, Mapping) or len(spectrum) != 1:
        raise Error("spectrum: must be one key of &load with its loads and their shares, such as {'torque_nm': {80: 0.7, 120: 0.3}}")
    if 'load' in groups:
        raise Error('load: is varied by spectrum, and cannot distinguish candidates')
    ((key, loads),) = spectrum.items()
    shares = np.array(list(loads.values()), float) if isinstance(loads, Mapping) else np.zeros(0)
    with np.errstate(over='ignore'):
        if not (shares > 0).all() or not 0 < shares.sum() < np.inf:
            raise Error(f'spectrum: {key} = {loads!r}: must be loads with their shares, each above 0 and their sum finite')
    return {'load': {key: list(loads)}}, shares / shares.sum()


def _check_seeds(seeds: Any, quantity: Criterion, scatter: Any) -> None:
    """Refuses a number of variants that cannot be, and a scatter that is missing or for another criterion."""
    if isinstance(seeds, bool) or not isinstance(seeds, int) or not 1 <= seeds <= 1_000_000:
        raise Error(f'robust: seeds = {seeds!r}: must be a whole number from 1 to 1000000')
    if quantity.is_as_built and scatter is not None:
        raise Error('scatter: is for face load factors; gears as built scatter by &deviations')
    if not quantity.is_as_built and not scatter:
        raise Error("robust: needs the scatter of some keys, such as scatter={'face': {'misalignment_um': scipy.stats.norm(0, 10)}}")
    if not quantity.is_as_built and seeds < 2:
        raise Error(f'robust: seeds = {seeds}: must be at least 2 with scatter, as each is a draw')


def _scattered(outer: Plan, seeds: int, scatter: Mapping[str, Mapping[str, Any]]) -> Plan:
    """Returns a plan with, for each row of `outer`, the medians of the scattered keys and then the drawn values, the same for all rows."""
    drawn = Plan.random(outer.base, seeds, outer.base.get('deviations', 'seed', 1), **scatter)
    medians = np.column_stack([one.values(np.array([0.5])) for one in drawn.inputs])
    inner = np.vstack((medians, drawn.rows()))
    values = np.column_stack((np.repeat(outer.rows(), len(inner), axis=0), np.tile(inner, (outer.n, 1))))
    inputs = tuple(Input(key, key.choices or ()) for key in (*outer.keys, *drawn.keys))
    return Plan(outer.base, 'table', inputs, len(values), values=values)


def _seeded(case: Case, groups: Mapping[str, Any], seeds: int) -> dict[str, Any]:
    """Adds seeds to the groups, from that of the case on, as the key that changes fastest."""
    if seeds == 1:
        return dict(groups)
    deviations = groups.get('deviations', {})
    if 'seed' in deviations:
        raise Error('&deviations seed: is varied by seeds, and cannot distinguish candidates')
    drawn = case.get('deviations', 'seed', 1) + np.arange(seeds)
    try:
        case.changed(deviations={'seed': drawn[-1]}).complete()
    except Error as error:
        raise Error(f'robust: seeds = {seeds}, from &deviations seed = {drawn[0]} on: {error}') from None
    return {name: keys for name, keys in groups.items() if name != 'deviations'} | {'deviations': {**deviations, 'seed': drawn}}


def _check(plan: Plan, nan: str, each: int, quantity: Criterion) -> None:
    """Refuses unusable candidates, of so many variants each, before anything is computed."""
    for one in plan.inputs:
        if one.name in _SAME and len(one.distribution) > (each if one.name == 'deviations.seed' else 1):
            raise Error(f'&deviations {one.key.key}: cannot distinguish candidates, as all have the same gears and assemblies; use one value')
    first = _usable(plan, nan, each)
    if isinstance(amounts := first.get('relief', 'amount_um'), tuple):
        raise Error(f"robust: &relief amount_um has {len(amounts)} values; write them as relief={{'amount_um': [...]}}")
    if not quantity.is_as_built:
        return
    if not any(first.get('deviations', f'{gear}_class') for gear in ('pinion', 'gear')):
        raise Error('robust: the case draws no gears; set &deviations pinion_class or gear_class')
    if (draws := first.get('deviations', 'draws')) * each < 2:
        raise Error(f'robust: &deviations draws = {draws}: must be at least 2')


def _usable(plan: Plan, nan: str, each: int) -> Case:
    """Returns the case of the first usable candidate; all must be usable unless they may be omitted."""
    cases: list[Case] = []
    errors: list[Error] = []
    for at in range(0, plan.n, each):
        try:
            cases.append(plan.case(at).complete())
        except Error as error:
            if nan == 'refuse':
                raise
            errors.append(error)
    if not cases:
        raise errors[0]
    return cases[0]


def _factors(
    data: xarray.Dataset, plan: Plan, shares: Reals | None, each: int, inner: Sequence[str], judged: str
) -> tuple[Reals, xarray.DataArray]:
    """Returns nominal numbers (candidate, load), and those of all draws; NaN if the motion has no result at some speed. Keys of `inner`
    distinguish the variants of a candidate.
    """
    import xarray

    quantity = criterion(judged)
    loads = 1 if shares is None else len(shares)
    candidates = plan.n // (loads * each)
    values = quantity.worst(data)
    values = values.reshape(loads, candidates, each, *values.shape[1:])
    if quantity.is_as_built:
        nominal = data[NOMINAL].values.reshape(loads, candidates, each)[..., 0]
    else:
        nominal, values = values[:, :, 0, 0, 0], values[:, :, 1:]
    coords: dict[str, Any] = {'share': ('load', np.ones(1) if shares is None else shares), 'candidate': np.arange(candidates)}
    # The load is the first key, and changes slowest; the seed, or what is scattered, is the last.
    for at, one in enumerate(plan.inputs):
        is_load = shares is not None and at == 0
        if one.name not in inner:
            labels = [_label(one.key.formatted(value)) for value in plan.rows()[:, at]]
            labels = labels[:: candidates * each] if is_load else labels[: candidates * each : each]
            coords[one.name] = 'load' if is_load else 'candidate', labels, data[one.name].attrs
    factors = xarray.DataArray(values.reshape(loads, candidates, -1, values.shape[-1]), coords,
                               ('load', 'candidate', 'draw', 'assembly'), f'largest_{judged}', {'units': quantity.unit})  # fmt: skip
    return nominal.T, factors.transpose('candidate', 'draw', 'assembly', 'load')


def _warn_of_inexact(inexact: Reals, sample: Reals) -> None:
    """Warns of inexact dynamic factors, by their number in each variant, and of the error of quick ones in a sample; NaN: not
    known.
    """
    if not (found := inexact > 0).any():
        return
    off = np.append(sample[np.isfinite(sample)], 0).max()
    quick = f'; with quick they are off by up to {off:.1g} in a sample' if off else ''
    warnings.warn(f'robust: {inexact[found].sum():.0f} dynamic factors, in {found.sum()} of {len(found)} variants, are inexact{quick}', stacklevel=3)


def _label(value: Any) -> Any:
    """Formats the value of a key as a label: a list as text."""
    return ', '.join(map(str, value)) if isinstance(value, tuple) else value


def _cause(data: xarray.Dataset, plan: Plan, judged: str, store: str | os.PathLike | None) -> str:
    """Describes the first variant without numbers by its keys, and the reason, if a store has it."""
    values = criterion(judged).worst(data)
    at = int(np.isfinite(values.reshape(plan.n, -1)).all(axis=1).argmin())
    keys = ', '.join(f'&{key.group} {key.key} = {_label(key.formatted(value))}' for key, value in zip(plan.keys, plan.rows(at, at + 1)[0]))
    if store is None:
        return f'the first is {keys}; a run of its case has the reason, and with a store many.failures(store) has those of all'
    return f'of the first, {keys}: {failures(store).set_index("variant")["message"].get(at, "")}'


def _select_complete(values: Reals, nan: str, cause: Callable[[], str]) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Selects the candidates with any result, and the draws with all of their results."""
    finite: NDArray[np.bool_] = np.isfinite(values).reshape(*values.shape[:2], -1).min(axis=2)
    selected: NDArray[np.bool_] = finite.max(axis=1)
    draws: NDArray[np.bool_] = finite[selected].min(axis=0, initial=True)
    text = f'{(~selected).sum()} of {len(selected)} candidates have no result, {(~draws).sum()} of {len(draws)} draws lack some'
    complete = bool(selected.all() and draws.all())
    if nan == 'refuse' and not complete:
        raise Error(f"robust: {text}; nan='drop' omits them, and quantiles may be too low then; {cause()}")
    if not selected.any() or draws.sum() < 2:
        raise Error(f'robust: {text}; nothing remains to compare; {cause()}')
    if not complete:
        warnings.warn(f'robust: {text}; they are omitted; {cause()}', PartialWarning, stacklevel=3)
    return selected, draws


def _table(nominal: Reals, factors: xarray.DataArray, shares: Reals, q: float, confidence: float) -> xarray.Dataset:
    """Builds the table of all numbers of all candidates."""
    import xarray

    candidates, draws, assemblies, _ = factors.shape
    columns = {'nominal': np.array([cluster_quantiles.quantile(one[None], shares, q, np.ones((1, 1)))[0] for one in nominal])}
    columns |= cluster_quantiles.compare(factors.values.reshape(candidates, draws, -1), np.tile(shares, assemblies) / assemblies, q, confidence)
    coords = {name: one for name, one in factors.coords.items() if one.dims == ('candidate',)}
    attributes = {'quantile': q, 'confidence': confidence, 'draws': draws, 'assemblies': assemblies, 'loads': len(shares)}
    return xarray.Dataset({name: ('candidate', column) for name, column in columns.items()}, coords, attributes)


def _report(found: Robust) -> str:
    """Formats the table and its conclusions in plain words."""
    table, of = found.table, found.table.attrs
    judged = CRITERIA[of['judged']]
    digits, unit = judged.digits, judged.unit and f' {judged.unit}'
    names = [str(name) for name in table.coords if name != 'candidate']
    each = [table.isel(candidate=at) for at in range(table.sizes['candidate'])]
    rows = [_heading(names, of), *(_row(one, names, digits) for one in each)]
    wide = [max(map(len, column)) for column in zip(*rows)]
    best = found.best
    others = [_name(one, names) for one in each if not float(one['worse_lower']) > 0 and int(one['candidate']) != int(best['candidate'])]
    lines = [_counts(of, judged), *('  '.join(cell.rjust(size) for cell, size in zip(row, wide)) for row in rows)]
    lines.append(f'Best {judged.state}: {_name(best, names)}: {float(best["value"]):.{digits}f}{unit}')
    if not np.isnan(table['nominal']).all():
        one = found.nominal
        lines.append(f'Best nominal: {_name(one, names)}: {float(one["nominal"]):.{digits}f}{unit}, {judged.state} {float(one["value"]):.{digits}f}{unit}')
    lines.append(f'Not distinguishable from the best by these draws: {"; ".join(others) or "none"}')
    if np.isnan([float(one[end]) for one in each for end in ('lower', 'upper')]).any():
        lines.append(f'?: too few draws for this quantile and confidence; {cluster_quantiles.enough(of["quantile"], of["confidence"])} are enough')
    return '\n'.join(lines)


def _counts(of: Mapping[Any, Any], judged: Criterion) -> str:
    draws = f'pairs of gears: {of["draws"]}, assemblies of each: {of["assemblies"]}' if judged.is_as_built else f'draws: {of["draws"]}'
    text = f'{judged.words}{judged.unit and f", {judged.unit}"}; {draws}'
    if of['loads'] > 1:
        text += f', loads: {of["loads"]}'
    if of['draws_left_out'] or of['candidates_left_out']:
        text += f'; omitted: {of["draws_left_out"]} draws, {of["candidates_left_out"]} candidates'
    return text


def _heading(names: Sequence[str], of: Mapping[Any, Any]) -> list[str]:
    sure = f'{100 * of["confidence"]:g} % sure'
    keys = [name.partition('.')[2] for name in names]
    return [*keys, 'nominal', 'median', f'{100 * of["quantile"]:g} %', sure, 'above the best', sure, 'best in']


def _row(one: xarray.Dataset, names: Sequence[str], digits: int) -> list[str]:
    value = {str(name): float(one[name]) for name in one.data_vars}
    share = value['best_share']
    numbers = [f'{value[name]:.{digits}f}' for name in ('nominal', 'median', 'value')]
    return [*(_value_text(one[name]) for name in names), *numbers, _range(value, '', f'.{digits}f'), f'{value["worse"]:+.{digits}f}',
            _range(value, 'worse_', f'+.{digits}f'), '?' if np.isnan(share) else f'{100 * share:.0f} %']  # fmt: skip


def _range(value: Mapping[str, float], prefix: str, digits: str) -> str:
    return ' to '.join('?' if np.isnan(value[f'{prefix}{end}']) else f'{value[f"{prefix}{end}"]:{digits}}' for end in ('lower', 'upper'))


def _value_text(value: Any) -> str:
    one = value.item()
    return one if isinstance(one, str) else f'{one:g}'


def _name(row: xarray.Dataset, names: Sequence[str]) -> str:
    """Describes a candidate by its keys."""
    return ', '.join(f'{name.partition(".")[2]} {_value_text(row[name])}' for name in names)
