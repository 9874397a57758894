"""Quantiles of numbers that come in independent draws, several to a draw, and which of some candidates with the same draws has the least."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Reals = NDArray[np.float64]
#: Samples of whole draws that bands of differences are made of, and how many are computed at a time.
RESAMPLES, _AT_ONCE = 999, 37
#: Sums of shares are off by rounding.
_ROUNDING = 1e-9


def compare(values: Reals, shares: Reals, q: float, confidence: float) -> dict[str, Reals]:
    """The columns of `Robust.table` that come from gears as built.

    Parameters
    ----------
    values : array (candidate, draw, point)
        The same draws for all candidates.
    shares : array (point,)
        How much each number of a draw counts; their sum is 1.
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
    """The least of the numbers that have at least the share `q` at or below them.

    Parameters
    ----------
    values : array (draw, point)
    shares : array (point,)
    q : float
    drawn : array (sample, draw)
        How often each draw is in each sample.

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
    """Order statistics between which the quantile is with this confidence; NaN where there are too few draws.

    By the binomial distribution of so many independent points as have the same scatter of the share at or below the quantile (Korn and
    Graubard 1998, Survey Methodology 24): at least the draws, and at most all points. Of one point a draw that is exact, and as
    `scipy.stats.quantile_test` has it.
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
    """Which of n independent numbers in their order, from 1 on, have the quantile between them with this confidence; 0 and n + 1: none.

    k of n are below it with the probability of the binomial distribution (Conover 1999, Practical Nonparametric Statistics, 3.1); as
    `scipy.stats.quantile_test`: at least as many at or below the lower end as are too few with the probability of the tail.
    """
    from scipy.stats import binom

    tail = (1 - confidence) / 2
    low, high = (np.asarray(one(tail, n, q)).astype(int) for one in (binom.ppf, binom.isf))
    return low, high + 1


def enough(q: float, confidence: float) -> int:
    """How many draws are enough for both ends of a band: not all of so many lie on one side of the quantile, but with the tail's probability."""
    return int(np.ceil(np.log((1 - confidence) / 2) / np.log(max(q, 1 - q))))
