"""Points in the unit cube, the same for any division into blocks."""

from __future__ import annotations

import functools

import numpy as np
from numpy.typing import NDArray

Reals = NDArray[np.float64]
#: Least number of scrambles for a band: with 2, one for 95 % held 75 to 91 % of the time.
FEWEST_SCRAMBLES = 4
#: Bits of a coordinate; half of the last one is added, so that it is neither 0 nor 1.
_BITS = 30


class Sobol:
    """Scrambled Sobol' points (Owen's scrambling as in `scipy.stats.qmc`), of several scrambles in turn.

    Point i is the point i // scrambles of the scramble i % scrambles, so that the first points stay the same where more are taken.
    """

    def __init__(self, d: int, seed: int, scrambles: int):
        from scipy.stats import qmc

        seeds = [np.random.SeedSequence(seed, spawn_key=(one,)) for one in range(scrambles)]
        self.engines = [qmc.Sobol(d, scramble=True, bits=_BITS, rng=np.random.default_rng(one)) for one in seeds]

    def __call__(self, first: int, stop: int) -> Reals:
        count = len(self.engines)
        found = np.empty((stop - first, self.engines[0].d))
        for one, engine in enumerate(self.engines):
            begin, end = (-((one - at) // count) for at in (first, stop))
            if end > begin:
                found[begin * count + one - first :: count] = self._points(engine, begin, end)
        return found + 2.0 ** -(_BITS + 1)

    @staticmethod
    def _points(engine, begin: int, end: int) -> Reals:
        """Returns the points begin to end of a scramble; the engine is reset if it has passed them."""
        import warnings

        if engine.num_generated > begin:
            engine.reset()
        if engine.num_generated < begin:
            engine.fast_forward(begin - engine.num_generated)
        with warnings.catch_warnings():
            warnings.simplefilter('ignore', UserWarning)  # a block need not be a power of 2; all points are
            return engine.random(end - begin)


def random(first: int, stop: int, d: int, seed: int) -> Reals:
    """Returns independent points, by a counter-based generator (Philox)."""
    each = -(-d // 4)  # it draws four numbers at a time
    source = np.random.Philox(np.random.SeedSequence(seed))
    source.advance(first * each)
    drawn = np.random.Generator(source).random((stop - first, 4 * each))[:, :d]
    return np.maximum(drawn, 2.0**-54)


@functools.lru_cache(maxsize=2)
def lhs(n: int, d: int, seed: int) -> Reals:
    """Returns a Latin hypercube: in each direction one point in each of n equal parts. All of it is computed, as its parts
    depend on each other.
    """
    found = np.empty((n, d))
    for one in range(d):
        source = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(one,)))
        found[:, one] = (source.permutation(n) + np.maximum(source.random(n), 2.0**-30)) / n
    found = np.minimum(found, 1 - 2.0**-53)
    found.setflags(write=False)
    return found


def saltelli(points: Sobol, first: int, stop: int, d: int) -> Reals:
    """Rows for Sobol' indices, in SALib's order: for each base point its row A, then A with each column of B in turn, then B.

    `points` has the dimension 2 d: the columns of A, then those of B.
    """
    each = d + 2
    begin, end = first // each, -(-stop // each)
    both = points(begin, end)
    rows = np.repeat(both[:, None, :d], each, axis=1)
    for one in range(d):
        rows[:, 1 + one, one] = both[:, d + one]
    rows[:, -1] = both[:, d:]
    return rows.reshape(-1, d)[first - begin * each : stop - begin * each]
