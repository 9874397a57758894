"""The valley of robust reliefs: the criterion, such as the dynamic factor, over the amount of relief or crowning, nominal and over
the draws.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..core.texts import escaped
from ..plots.as_built import NOMINAL
from ..plots.look import ACCENT, GREY, HALO, INK, MM, PAGE, legends_above, style
from .criteria import CRITERIA
from .pictures import ACROSS, _axis, _words

if TYPE_CHECKING:
    import xarray

    from .robust import Robust


def plot_valley(found: Robust, figure: Figure | None = None, *, along: str | None = None) -> Figure:
    """Draws the criterion, such as the largest dynamic factor, over one of the varied keys: the nominal value, and median and
    quantile of the draws with its band. The best candidate over the draws is marked, and the best nominal one with its value over them. Each
    combination of the other keys has a panel.

    Parameters
    ----------
    found : Robust
        Result of `many.robust`.
    figure : Figure, optional
        Where to draw; otherwise one is made.
    along : str, optional
        The key to draw over, as in 'relief.amount_um'; otherwise the first that has numbers.

    Returns
    -------
    Figure

    Raises
    ------
    ValueError
        No such key is varied.
    """
    table, label = found.table, CRITERIA[found.table.attrs['judged']].label
    keys = [str(name) for name in table.coords if name != 'candidate']
    numbers = [name for name in keys if table[name].dtype.kind in 'if']
    along = along or next(iter(numbers), None)
    if along not in numbers:
        raise ValueError(f'along = {along!r}: must be one of {", ".join(numbers) or "no key, as none has numbers"}')
    others = [name for name in keys if name != along]
    words = np.array([', '.join(f'{_words(name)} {table[name].values[at]}' for name in others) for at in range(table.sizes['candidate'])])
    panels = list(dict.fromkeys(words.tolist()))
    with style():
        if figure is None:
            from matplotlib import pyplot

            figure = pyplot.figure(figsize=(PAGE, 70 * MM * -(-len(panels) // ACROSS)), layout='constrained')
        across = min(ACROSS, len(panels))
        axes = figure.subplots(-(-len(panels) // across), across, sharex=True, sharey=True, squeeze=False).ravel()
        for ax, title in zip(axes, panels):
            _panel(ax, table.isel(candidate=np.flatnonzero(words == title)).sortby(along), along)
            ax.tick_params(labelbottom=True)  # also if there is no panel below
            ax.set_xlabel(_axis(_words(along), table[along].attrs))
            ax.set_title(escaped(title), loc='right')
        for ax in axes[len(panels) :]:
            ax.set_axis_off()
        for best, column, color, va in (('value', 'value', ACCENT, 'bottom'), ('nominal', 'nominal', INK, 'top'), ('nominal', 'value', INK, 'bottom')):
            at = int(np.nanargmin(table[best].values))
            _mark(axes[panels.index(words[at])], float(table[along][at]), float(table[column][at]), color, va)
        entries = max((ax.get_legend_handles_labels()[0] for ax in axes), key=len)
        legends_above(axes[0], ('', entries), gap=1.5 * bool(others))
        for ax in axes[::across]:
            ax.set_ylabel(label)
    return figure


def _panel(ax: Axes, table: xarray.Dataset, along: str) -> None:
    """Draws the curves of candidates that differ in one key."""
    x, of = table[along].values, table.attrs
    state = CRITERIA[of['judged']].state
    ax.plot(x, table['value'], '.-', color=ACCENT, label=f'{100 * of["quantile"]:g} % {state}')
    known = np.isfinite(table['lower'].values + table['upper'].values)
    if (known[1:] & known[:-1]).any():  # a single candidate has no curve
        ax.fill_between(x, table['lower'], table['upper'], color=ACCENT, alpha=0.25, linewidth=0, label=f'its {100 * of["confidence"]:g} % band')
    ax.plot(x, table['median'], color=GREY, label=f'median {state}')
    ax.plot(x, table['nominal'], label='nominal', **NOMINAL)
    ax.margins(x=0.1, y=0.12)  # space for the labels of the marks


def _mark(ax: Axes, x: float, y: float, color: str, va: str) -> None:
    """Marks the best candidate of a kind."""
    ax.plot(x, y, 'D', color=color, markersize=4)
    ax.annotate(f'{x:g}: {y:.4g}', (x, y), (0, 4 if va == 'bottom' else -4), textcoords='offset points', va=va, ha='center', color=color,
                path_effects=HALO)  # fmt: skip
