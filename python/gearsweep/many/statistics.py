"""Statistics of the variants, with bands that are valid for the kind of their points."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..core.library import Error, PartialWarning
from .cluster_quantiles import ranks
from .points import FEWEST_SCRAMBLES
from .store import VARIANT

if TYPE_CHECKING:
    import xarray

Reals = NDArray[np.float64]
#: Number of samples for the band of an index.
_RESAMPLES = 999


def quantiles(
    data: xarray.DataArray, q: float | Sequence[float] = (0.05, 0.25, 0.5, 0.75, 0.95), *, confidence: float = 0.95,
    nan: str = 'refuse', points: str | None = None, scrambles: int | None = None,
) -> xarray.Dataset:  # fmt: skip
    """Returns quantiles over the variants, each with a band that contains the true one with this confidence.

    For independent points the band lies between order statistics, by the binomial distribution, as in `scipy.stats.quantile_test`:
    it is valid for any distribution. A Latin hypercube has the same band, which is rather too wide than too narrow. For Sobol'
    points, the band follows from the scatter of the scrambles (Student's distribution).

    Parameters
    ----------
    data : DataArray
        A column of a result of `run` or `open`, or computed from one; over `variant` and any other dimensions.
    q : float or several
        Probabilities, between 0 and 1.
    confidence : float
        Confidence of the band of each quantile, both ends together.
    nan : {'refuse', 'drop'}
        Treatment of variants without a number: an error, or their omission, with a `PartialWarning`.
    points, scrambles : optional
        Kind of points ('random', 'lhs', 'sobol'), and number of scrambles; by default those in the column's `attrs`.

    Returns
    -------
    Dataset
        `value`, `lower` and `upper` over `q` and the dimensions other than `variant`. A band is NaN if there are too few points for
        it, or if a scramble has no number, which a `PartialWarning` reports.

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
    dims = [dim for dim in data.dims if dim != VARIANT]
    values = data.transpose(VARIANT, *dims).values.astype(float)
    count = int(scrambles or data.attrs.get('scrambles', 0)) if kind == 'sobol' else 1
    if kind == 'sobol' and count < FEWEST_SCRAMBLES:
        raise Error(f'quantiles: scrambles = {count}: must be at least {FEWEST_SCRAMBLES} for a band of Sobol\' points')
    selected = _with_numbers(values, 'quantiles', nan)
    values, group = values[selected], (np.arange(len(values)) % count)[selected]
    value = np.quantile(values, wanted, axis=0)
    lower, upper = (_scramble_band(values, group, count, wanted, value, confidence) if kind == 'sobol'
                    else _order_band(values, wanted, confidence))  # fmt: skip
    coords: dict[Any, Any] = {'q': wanted} | {dim: data[dim] for dim in dims if dim in data.coords}
    arrays = {name: (('q', *dims), one) for name, one in (('value', value), ('lower', lower), ('upper', upper))}
    return xarray.Dataset(arrays, coords, {**data.attrs, 'name': str(data.name), 'variants': len(values), 'confidence': confidence})


def with_band(value: float, lower: float, upper: float) -> str:
    """Formats a number with its band; a question mark for an end with too few points."""
    ends = ' to '.join('?' if np.isnan(end) else f'{end:.5g}' for end in (lower, upper))
    return f'{value:.5g} ({ends})'


def check_column(data: Any, who: str) -> None:
    """Refuses anything but a column, such as a data set, and a column without variants."""
    import xarray

    if not isinstance(data, xarray.DataArray):
        raise Error(f'{who}: must be a column, such as data["sweep_worst.worst_dynamic_factor"], not a {type(data).__name__}')
    if not data.size:
        raise Error(f'{who}: the column has no variant, or no number of each')


def _with_numbers(values: Reals, who: str, nan: str, each: int = 1) -> NDArray[np.bool_]:
    """Selects the variants, or base points of `each` variants, with all of their numbers."""
    if nan not in ('refuse', 'drop'):
        raise Error(f"{who}: nan = {nan!r}: must be 'refuse' or 'drop'")
    finite = np.isfinite(values.reshape(len(values), -1)).all(axis=1)
    selected = np.asarray(finite.reshape(-1, each).all(axis=1))
    missing = int((~selected).sum())
    text = f'{who}: {missing} of {len(selected)} {"variants" if each == 1 else "base points"} have no number'
    if missing and nan == 'refuse':
        raise Error(f"{text}; a run of the first one's case, variant={finite.argmin()} of the column, has the reason, and many.failures(store) those of all; "
                    "nan='drop' omits them")  # fmt: skip
    if not selected.any():
        raise Error(f'{who}: no {"variant" if each == 1 else "base point"} has a number')
    if missing:
        warnings.warn(f'{text} and are omitted', PartialWarning, stacklevel=3)
    return selected


def _order_band(values: Reals, q: Reals, confidence: float) -> tuple[Reals, Reals]:
    """Order statistics that enclose the quantiles of independent points with this confidence; NaN if there is none."""
    n = len(values)
    ordered = np.sort(values, axis=0)
    none = np.full((1, *ordered.shape[1:]), np.nan)
    low, high = ranks(n, q, confidence)
    ordered = np.concatenate([none, ordered, none])
    return ordered[low], ordered[high]


def _scramble_band(values: Reals, group: NDArray[np.int_], count: int, q: Reals, value: Reals, confidence: float) -> tuple[Reals, Reals]:
    """Computes the band from the scatter, over the scrambles, of the share of points at or below the quantile: a share is unbiased,
    while quantiles of few points are not. The band of the share is converted to numbers by all points (Woodruff 1952, Journal of
    the American Statistical Association 47). Scrambles that fill the cube alike have the same share up to one point of a scramble:
    half of it is added.
    """
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
    """Returns quantiles of ordered columns, each at its own probabilities, as in NumPy; NaN beyond the ends."""
    place = np.clip(q, 0, 1) * (len(ordered) - 1)
    below = np.minimum(place.astype(int), len(ordered) - 2) if len(ordered) > 1 else place.astype(int)
    low, high = (np.take_along_axis(ordered, at, axis=0) for at in (below, np.minimum(below + 1, len(ordered) - 1)))
    return np.where((q < 0) | (q > 1), np.nan, low + (place - below) * (high - low))


def sensitivity(data: xarray.DataArray, *, confidence: float = 0.95, nan: str = 'refuse', seed: int = 0) -> xarray.Dataset:
    """Computes Sobol' indices of first and total order, the parts of a number's variance due to each key, with bands.

    S1 by Saltelli et al. (2010, Computer Physics Communications 181, table 2 b), ST by Jansen (1999), both as in
    `scipy.stats.sobol_indices`. Bands are percentiles of resampled base points; the points are assumed to be independent there, so
    that the bands are rather too wide than too narrow.

    Parameters
    ----------
    data : DataArray
        A column of a run of `Plan.saltelli`; over `variant` and any other dimensions.
    confidence : float
        Of each band.
    nan : {'refuse', 'drop'}
        Treatment of variants without a number: an error, or omission of base points with all their variants, which a
        `PartialWarning` reports.
    seed : int
        Seed of the resampling, at least 0.

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
    dims = [dim for dim in data.dims if dim != VARIANT]
    values = data.transpose(VARIANT, *dims).values.astype(float)
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
    coords: dict[Any, Any] = {'input': names} | {dim: data[dim] for dim in dims if dim in data.coords}
    arrays: dict[Any, Any] = {name: (('input', *dims), one) for name, one in found.items()}
    return xarray.Dataset(arrays, coords, {**data.attrs, 'name': str(data.name), 'base_points': len(base), 'confidence': confidence})


def _indices(base: Reals, weights: Reals) -> Reals:
    """Returns S1 and ST from rows A, A with a column of B in turn, B, for each row of weights of the base points: (weights, 2,
    d, ...).
    """
    a, b, mixed = base[:, 0], base[:, -1], base[:, 1:-1]
    middle = base[:, [0, -1]].mean(axis=(0, 1))  # the estimates have less variance about it
    a, b, mixed = a - middle, b - middle, mixed - middle
    moments = np.concatenate([b[:, None] * (mixed - a[:, None]), 0.5 * (a[:, None] - mixed) ** 2,
                              0.5 * (a + b)[:, None], 0.5 * (a**2 + b**2)[:, None]], axis=1)  # fmt: skip
    means = np.tensordot(weights, moments, 1)
    d = mixed.shape[1]
    variance = means[:, -1] - means[:, -2] ** 2
    return np.stack([means[:, :d], means[:, d : 2 * d]], axis=1) / variance[:, None, None]
