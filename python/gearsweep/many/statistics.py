"""Statistics of the variants, with bands that hold for the kind of their points."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .._library import Error, PartialWarning
from .clusters import ranks
from .store import VARIANT

if TYPE_CHECKING:
    import xarray

Reals = NDArray[np.float64]
#: Samples that a band of an index is made of.
_RESAMPLES = 999


def quantiles(
    data: xarray.DataArray, q: float | Sequence[float] = (0.05, 0.25, 0.5, 0.75, 0.95), *, confidence: float = 0.95,
    nan: str = 'refuse', points: str | None = None, scrambles: int | None = None,
) -> xarray.Dataset:  # fmt: skip
    """Quantiles over the variants, each with a band that has the true one with this confidence.

    Of independent points the band runs between order statistics, by the binomial distribution, as `scipy.stats.quantile_test` has it: it
    holds for any distribution. A Latin hypercube has the same band, which is too wide there rather than too narrow. Of Sobol' points,
    for which that does not hold, the scatter of the scrambles gives the band (Student's distribution).

    Parameters
    ----------
    data : DataArray
        A column of what `run` or `open` gives, or what is made of it; over `variant` and any other dimensions.
    q : float or several
        Probabilities, between 0 and 1.
    confidence : float
        Of the band of each quantile, both ends together.
    nan : {'refuse', 'drop'}
        What to do where variants have no number: an error, or to leave out these variants whole, which a `PartialWarning` tells.
    points, scrambles : optional
        The kind of points ('random', 'lhs', 'sobol'), and how many scrambles; by default as the column's `attrs` say.

    Returns
    -------
    Dataset
        `value`, `lower` and `upper` over `q` and the dimensions other than `variant`. A band is NaN where there are too few points for it,
        and where a scramble has no number, which a `PartialWarning` tells.

    Raises
    ------
    Error
        The points are no sample, or numbers are missing.
    """
    import xarray

    check_column(data, 'quantiles')
    kind = points or data.attrs.get('points')
    if kind not in ('random', 'lhs', 'sobol'):
        raise Error(f"quantiles: points = {kind!r}: must be 'random', 'lhs' or 'sobol', as those of a grid, a table or Saltelli's rows are no sample")
    wanted = np.atleast_1d(np.asarray(q, float))
    if not ((wanted > 0) & (wanted < 1)).all() or not 0 < confidence < 1:
        raise Error('quantiles: q and confidence must be between 0 and 1')
    rest = [dim for dim in data.dims if dim != VARIANT]
    values = data.transpose(VARIANT, *rest).values.astype(float)
    count = int(scrambles or data.attrs.get('scrambles', 0)) if kind == 'sobol' else 1
    if kind == 'sobol' and count < 2:
        raise Error(f'quantiles: scrambles = {count}: must be at least 2 for a band of Sobol\' points')
    kept = _with_numbers(values, 'quantiles', nan)
    values, group = values[kept], (np.arange(len(values)) % count)[kept]
    value = np.quantile(values, wanted, axis=0)
    lower, upper = (_of_scrambles(values, group, count, wanted, value, confidence) if kind == 'sobol'
                    else _of_order(values, wanted, confidence))  # fmt: skip
    coords: dict[Any, Any] = {'q': wanted} | {dim: data[dim] for dim in rest if dim in data.coords}
    arrays = {name: (('q', *rest), one) for name, one in (('value', value), ('lower', lower), ('upper', upper))}
    return xarray.Dataset(arrays, coords, {**data.attrs, 'name': str(data.name), 'variants': len(values), 'confidence': confidence})


def with_band(value: float, lower: float, upper: float) -> str:
    """A number with its band in words; a question mark for an end for which there are too few points."""
    ends = ' to '.join('?' if np.isnan(end) else f'{end:.5g}' for end in (lower, upper))
    return f'{value:.5g} ({ends})'


def check_column(data: Any, who: str) -> None:
    """Refuses what is no column, such as all of them, and one without variants."""
    import xarray

    if not isinstance(data, xarray.DataArray):
        raise Error(f'{who}: give a column, such as data["sweep_worst.worst_dynamic_factor"], not a {type(data).__name__}')
    if not data.size:
        raise Error(f'{who}: the column has no variant, or no number of each')


def _with_numbers(values: Reals, who: str, nan: str, each: int = 1) -> NDArray[np.bool_]:
    """Which variants, or base points of so many variants each, have all of their numbers."""
    if nan not in ('refuse', 'drop'):
        raise Error(f"{who}: nan = {nan!r}: must be 'refuse' or 'drop'")
    there = np.isfinite(values.reshape(len(values), -1)).all(axis=1)
    kept = np.asarray(there.reshape(-1, each).all(axis=1))
    missing = int((~kept).sum())
    said = f'{who}: {missing} of {len(kept)} {"variants" if each == 1 else "base points"} have no number'
    if missing and nan == 'refuse':
        raise Error(f"{said}; a run of the first one's case, variant={there.argmin()} of the column, tells why, and many.failures(store) of all; "
                    "nan='drop' leaves them out")  # fmt: skip
    if not kept.any():
        raise Error(f'{who}: no {"variant" if each == 1 else "base point"} has a number')
    if missing:
        warnings.warn(f'{said} and are left out', PartialWarning, stacklevel=3)
    return kept


def _of_order(values: Reals, q: Reals, confidence: float) -> tuple[Reals, Reals]:
    """Order statistics between which the quantiles of independent points lie with this confidence; NaN where there is none."""
    n = len(values)
    ordered = np.sort(values, axis=0)
    none = np.full((1, *ordered.shape[1:]), np.nan)
    low, high = ranks(n, q, confidence)
    ordered = np.concatenate([none, ordered, none])
    return ordered[low], ordered[high]


def _of_scrambles(values: Reals, group: NDArray[np.int_], count: int, q: Reals, value: Reals, confidence: float) -> tuple[Reals, Reals]:
    """From the scatter, over the scrambles, of the share of points that are at most as large as the quantile: a share has no bias, while
    quantiles of few points have one. The band of the share is carried over to the numbers by all points (Woodruff 1952, Journal of the
    American Statistical Association 47). Scrambles that fill the cube alike would have the same share up to one point of a scramble:
    half of it counts besides."""
    from scipy.stats import t

    if none := count - len(np.unique(group)):
        warnings.warn(f'quantiles: {none} of {count} scrambles have no number; there is no band', PartialWarning, stacklevel=3)
        return np.full_like(value, np.nan), np.full_like(value, np.nan)
    share = np.stack([(values[group == one] <= value[:, None]).mean(axis=1) for one in range(count)])
    error = t.isf((1 - confidence) / 2, count - 1) * share.std(axis=0, ddof=1) / np.sqrt(count)
    half = np.hypot(error, 0.5 * count / len(values))
    ordered = np.sort(values, axis=0)
    probability = q.reshape(-1, *[1] * (values.ndim - 1))
    return _at(ordered, probability - half), _at(ordered, probability + half)


def _at(ordered: Reals, q: Reals) -> Reals:
    """Quantiles of ordered columns, each at its own probabilities, as NumPy has them; NaN beyond the ends."""
    place = np.clip(q, 0, 1) * (len(ordered) - 1)
    below = np.minimum(place.astype(int), len(ordered) - 2) if len(ordered) > 1 else place.astype(int)
    low, high = (np.take_along_axis(ordered, at, axis=0) for at in (below, np.minimum(below + 1, len(ordered) - 1)))
    return np.where((q < 0) | (q > 1), np.nan, low + (place - below) * (high - low))


def sensitivity(data: xarray.DataArray, *, confidence: float = 0.95, nan: str = 'refuse', seed: int = 0) -> xarray.Dataset:
    """Sobol' indices of first and total order, by how much each key's scatter makes a number scatter, with bands.

    S1 by Saltelli et al. (2010, Computer Physics Communications 181, table 2 b), ST by Jansen (1999), both as `scipy.stats.sobol_indices`
    has them. Bands are percentiles of resampled base points; the points are taken as independent there, so that the bands are too wide
    rather than too narrow.

    Parameters
    ----------
    data : DataArray
        A column of a run of `Plan.saltelli`; over `variant` and any other dimensions.
    confidence : float
        Of each band.
    nan : {'refuse', 'drop'}
        What to do where variants have no number: an error, or to leave out base points with all their variants, which a
        `PartialWarning` tells.
    seed : int
        Of the resampling, at least 0.

    Returns
    -------
    Dataset
        `S1`, `ST`, and `S1_lower`, `S1_upper`, `ST_lower`, `ST_upper`, over `input` and the dimensions other than `variant`.

    Raises
    ------
    Error
        The variants are no rows of `Plan.saltelli`, numbers are missing, or all numbers are equal.
    """
    import xarray

    check_column(data, 'sensitivity')
    if data.attrs.get('points') != 'saltelli':
        raise Error(f"sensitivity: points = {data.attrs.get('points')!r}: must be those of Plan.saltelli")
    if not 0 < confidence < 1:
        raise Error(f'sensitivity: confidence = {confidence}: must be between 0 and 1')
    if isinstance(seed, bool) or not isinstance(seed, (int, np.integer)) or seed < 0:
        raise Error(f'sensitivity: seed = {seed!r}: must be a whole number of at least 0')
    names = list(data.attrs['inputs'])
    d = len(names)
    rest = [dim for dim in data.dims if dim != VARIANT]
    values = data.transpose(VARIANT, *rest).values.astype(float)
    if len(values) % (d + 2):
        raise Error(f'sensitivity: {len(values)} variants are no whole number of base points, which have {d + 2} each')
    base = values.reshape(-1, d + 2, *values.shape[1:])[_with_numbers(values, 'sensitivity', nan, d + 2)]
    if (np.ptp(base[:, [0, -1]], axis=(0, 1)) == 0).any():
        raise Error('sensitivity: all numbers are equal; no key changes them')
    n = len(base)
    drawn = np.random.default_rng(seed).multinomial(n, np.full(n, 1 / n), _RESAMPLES) / n
    found: dict[str, Reals] = {}
    lower, upper = np.quantile(_indices(base, drawn), [(1 - confidence) / 2, (1 + confidence) / 2], axis=0)
    for at, (name, value) in enumerate(zip(('S1', 'ST'), _indices(base, np.full((1, n), 1 / n))[0])):
        found |= {name: value, f'{name}_lower': lower[at], f'{name}_upper': upper[at]}
    coords: dict[Any, Any] = {'input': names} | {dim: data[dim] for dim in rest if dim in data.coords}
    arrays: dict[Any, Any] = {name: (('input', *rest), one) for name, one in found.items()}
    return xarray.Dataset(arrays, coords, {**data.attrs, 'name': str(data.name), 'base_points': len(base), 'confidence': confidence})


def _indices(base: Reals, weights: Reals) -> Reals:
    """S1 and ST of rows A, A with a column of B in turn, B, by each row of weights of the base points: (weights, 2, d, ...)."""
    a, b, mixed = base[:, 0], base[:, -1], base[:, 1:-1]
    middle = base[:, [0, -1]].mean(axis=(0, 1))  # the estimates scatter less about it
    a, b, mixed = a - middle, b - middle, mixed - middle
    moments = np.concatenate([b[:, None] * (mixed - a[:, None]), 0.5 * (a[:, None] - mixed) ** 2,
                              0.5 * (a + b)[:, None], 0.5 * (a**2 + b**2)[:, None]], axis=1)  # fmt: skip
    means = np.tensordot(weights, moments, 1)
    d = mixed.shape[1]
    variance = means[:, -1] - means[:, -2] ** 2
    return np.stack([means[:, :d], means[:, d : 2 * d]], axis=1) / variance[:, None, None]
