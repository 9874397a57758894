"""Quantiles of clustered samples, and the candidate with the smallest quantile under common draws."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Reals = NDArray[np.float64]
#: Number of samples of complete draws for bands of differences, and how many are computed at a time.
RESAMPLES, _AT_ONCE = 999, 37
#: Tolerance for sums of shares, which have rounding errors.
_ROUNDING = 1e-9


def compare(values: Reals, shares: Reals, q: float, confidence: float) -> dict[str, Reals]:
    """Returns the columns of `Robust.table` that depend on gears as built.

    Parameters
    ----------
    values : array (candidate, draw, point)
        The same draws for all candidates.
    shares : array (point,)
        Weight of each number of a draw; the sum is 1.
    q, confidence : float
        Probability of the quantile, and confidence of each band.
    """
    draws = values.shape[1]
    once = np.ones((1, draws))
    value = np.array([quantile(one, shares, q, once)[0] for one in values])
    bands = np.array([band(one, shares, q, confidence) for one in values])
    drawn = np.random.default_rng(0).multinomial(draws, np.full(draws, 1 / draws), RESAMPLES).astype(float)
    samples = np.array([quantile(one, shares, q, drawn) for one in values])
    best = int(value.argmin())
    lower, upper = np.quantile(samples - samples[best], [(1 - confidence) / 2, (1 + confidence) / 2], axis=1)
    known = np.isfinite(bands).all(axis=1)
    lower[~(known & known[best])] = upper[~(known & known[best])] = np.nan  # too few draws to sample
    is_best = np.arange(len(values))[:, None] == samples.argmin(axis=0)
    return {'median': np.array([quantile(one, shares, 0.5, once)[0] for one in values]),
            'value': value, 'lower': bands[:, 0], 'upper': bands[:, 1],
            'worse': value - value[best], 'worse_lower': lower, 'worse_upper': upper,
            'best_share': is_best.mean(axis=1) if known.all() else np.full(len(values), np.nan)}  # fmt: skip


def quantile(values: Reals, shares: Reals, q: float, drawn: Reals) -> Reals:
    """Returns the smallest number with at least the share `q` of the weights at or below it.

    Parameters
    ----------
    values : array (draw, point)
    shares : array (point,)
    q : float
    drawn : array (sample, draw)
        Count of each draw in each sample.

    Returns
    -------
    array (sample,)
    """
    order = np.argsort(values, axis=None, kind='stable')
    ordered, draw = values.ravel()[order], np.arange(len(values)).repeat(len(shares))[order]
    weight = np.tile(shares, len(values))[order]
    found = [
        (np.cumsum(some[:, draw] * weight, axis=1) >= q * len(values) - _ROUNDING).argmax(axis=1)
        for some in np.array_split(drawn, -(-len(drawn) // _AT_ONCE))
    ]
    return ordered[np.concatenate(found)]


def band(values: Reals, shares: Reals, q: float, confidence: float) -> tuple[float, float]:
    """Returns order statistics that enclose the quantile with this confidence; NaN if there are too few draws.

    The share of points at or below the quantile scatters over the draws. The effective number of points is the number of independent
    ones with the same scatter (Korn and Graubard 1998, Survey Methodology 24); it lies between the number of draws and that of all
    points. With one point in each draw the band is that of `scipy.stats.quantile_test`.
    """
    draws, once = len(values), np.ones((1, len(values)))
    share = (values <= quantile(values, shares, q, once)[0]) @ shares
    variance = share.var(ddof=1) / draws
    most = draws / float(shares @ shares)
    points = int(np.clip(q * (1 - q) / variance, draws, most)) if variance > 0 else int(most)
    low, high = ranks(points, q, confidence)
    lower = quantile(values, shares, low / points, once)[0] if low > 0 else np.nan
    upper = quantile(values, shares, high / points, once)[0] if high <= points else np.nan
    return lower, upper


def ranks(n: int, q: Any, confidence: float) -> tuple[Any, Any]:
    """Returns the ranks, from 1, of the two of n independent numbers that enclose the quantile with this confidence; rank 0 or
    n + 1 means that there is none.

    The number of values below the quantile has a binomial distribution (Conover 1999, Practical Nonparametric Statistics, 3.1); the
    ranks are those of `scipy.stats.quantile_test`.
    """
    from scipy.stats import binom

    tail = (1 - confidence) / 2
    low, high = (np.asarray(one(tail, n, q)).astype(int) for one in (binom.ppf, binom.isf))
    return low, high + 1


def enough(q: float, confidence: float) -> int:
    """Returns the least number of draws for a band with both ends: so many that all lie on one side of the quantile with at most
    the probability of a tail.
    """
    return int(np.ceil(np.log((1 - confidence) / 2) / np.log(max(q, 1 - q))))
