"""Pictures of many variants: bands over an index column, distributions, Sobol' indices, and a number over each varied key."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..core.library import declared
from ..plots.look import ACCENT, CROSS, FAINT, GREY, HALO, INK, MM, PAGE, VERMILION, canvas, legends_above, style
from .statistics import check_column, quantiles

if TYPE_CHECKING:
    import xarray

#: Quantiles: the first and the last bound the outer band of `plot_band`, and so on inwards.
BAND = (0.05, 0.25, 0.5, 0.75, 0.95)
#: Largest number of panels in a row.
ACROSS = 3
#: Keys whose names need their group.
NAMES = {'relief.amount_um': 'tip relief um'}


def plot_band(data: xarray.DataArray, ax: Axes | None = None, *, nan: str = 'refuse') -> Axes:
    """Draws quantiles of the variants over an index column, such as the dynamic factor over speed: the median, and the bands
    that contain 50 % and 90 % of the variants.

    Parameters
    ----------
    data : DataArray
        A column over `variant` and one more dimension.
    ax : Axes, optional
        Axes to draw into; otherwise a figure is made.
    nan : {'refuse', 'drop'}
        As of `many.quantiles`.

    Returns
    -------
    Axes
    """
    check_column(data, 'plot_band')
    (dim,) = _other_dims(data, 1)
    found = quantiles(data, BAND, nan=nan)
    x, value = found[dim].values, found['value'].values
    with canvas(ax, height=70 * MM, width=PAGE) as ax:
        ax.fill_between(x, value[0], value[-1], color=ACCENT, alpha=0.18, linewidth=0, label='5 to 95 %')
        ax.fill_between(x, value[1], value[-2], color=ACCENT, alpha=0.3, linewidth=0, label='25 to 75 %')
        ax.plot(x, value[2], color=ACCENT, label='median')
        ax.set_xlabel(_axis(dim, found[dim].attrs))
        ax.set_ylabel(_label(data))
        ax.legend(loc='upper left', title=f'{found.attrs["variants"]} variants')
    return ax


def plot_distribution(data: xarray.DataArray, ax: Axes | None = None, *, q: float = 0.95, nan: str = 'refuse') -> Axes:
    """Draws the distribution function of the variants, and one quantile with its band; if there are too few variants for one end
    of the band, that end is a question mark, and the band extends to the edge of the picture.

    Parameters
    ----------
    data : DataArray
        A column of one number for each variant.
    ax : Axes, optional
        Axes to draw into; otherwise a figure is made.
    q : float
        Probability of the quantile that is marked.
    nan : {'refuse', 'drop'}
        As of `many.quantiles`.

    Returns
    -------
    Axes
    """
    check_column(data, 'plot_distribution')
    _other_dims(data, 0)
    found = quantiles(data, q, nan=nan)
    lower, value, upper = (float(found[name][0]) for name in ('lower', 'value', 'upper'))
    ordered = np.sort(data.values[np.isfinite(data.values)])
    with canvas(ax) as ax:
        ax.step(ordered, np.arange(1, len(ordered) + 1) / len(ordered), where='post', color=ACCENT)
        if np.isfinite([lower, upper]).any():
            left, right = ax.get_xlim()  # an end that is not known lies beyond the picture
            ax.axvspan(left if np.isnan(lower) else lower, right if np.isnan(upper) else upper, color=FAINT, alpha=0.5, linewidth=0)
            ax.set_xlim(left, right)
        ax.plot([value, value], [0, q], color=INK, linewidth=0.7)
        ends = ' to '.join('?' if np.isnan(end) else f'{end:.4g}' for end in (lower, upper))
        words = f'{100 * q:g} %: {value:.4g}\n{100 * found.attrs["confidence"]:g} % sure: {ends}'
        ax.text(0.98, 0.06, words, ha='right', va='bottom', transform=ax.transAxes, path_effects=HALO)
        ax.set_ylim(0, 1)
        ax.set_xlabel(_label(data))
        ax.set_ylabel('Share of the variants (–)')
    return ax


def plot_indices(found: xarray.Dataset, ax: Axes | None = None) -> Axes:
    """Draws Sobol' indices of first and total order of each key, the largest on top, with whiskers over their bands.

    Parameters
    ----------
    found : Dataset
        Result of `many.sensitivity` for a column of one number for each variant.
    ax : Axes, optional
        Axes to draw into; otherwise a figure is made.

    Returns
    -------
    Axes
    """
    order = np.argsort(found['ST'].values)
    with canvas(ax) as ax:
        for name, color, off, words in (('S1', ACCENT, 0.2, 'first order'), ('ST', GREY, -0.2, 'total')):
            value, lower, upper = (found[end].values[order] for end in (name, f'{name}_lower', f'{name}_upper'))
            place = np.arange(len(order)) + off
            ax.barh(place, value, height=0.36, color=color, label=words)
            # A percentile of the samples may lie on the other side of the estimate.
            ends = np.maximum(0, [value - lower, upper - value])
            ax.errorbar(value, place, xerr=ends, fmt='none', ecolor=INK, elinewidth=0.7, capsize=2)
        ax.set_yticks(np.arange(len(order)), [_key(name) for name in found['input'].values[order]])
        ax.axvline(0, color=INK, linewidth=0.6)
        ax.set_xlabel("Sobol' index (–)")
        ax.set_ylabel('Input')
        legends_above(ax, ('', ax.get_legend_handles_labels()[0]))
    return ax


def plot_scatter(data: xarray.Dataset, name: str, figure: Figure | None = None) -> Figure:
    """Draws a number of each variant over each varied key; variants without one are crosses at the lower edge.

    Parameters
    ----------
    data : Dataset
        Result of `many.run` or `many.open`.
    name : str
        A column of one number for each variant.
    figure : Figure, optional
        Where to draw; otherwise one is made.

    Returns
    -------
    Figure
    """
    column = data[name]
    _other_dims(column, 0)
    inputs = list(data.attrs['inputs'])
    finite = np.isfinite(column.values)
    missing = ~finite & (data['status'].values != 0)
    with style():
        if figure is None:
            from matplotlib import pyplot

            rows = -(-len(inputs) // ACROSS)
            figure = pyplot.figure(figsize=(PAGE, 55 * MM * rows), layout='constrained')
        axes = figure.subplots(-(-len(inputs) // ACROSS), min(ACROSS, len(inputs)), sharey=True, squeeze=False).ravel()
        for ax, key in zip(axes, inputs):
            ax.plot(data[key].values[finite], column.values[finite], '.', color=ACCENT, markersize=2, alpha=0.5)
            if missing.any():
                ax.plot(data[key].values[missing], np.zeros(missing.sum()), color=VERMILION, transform=ax.get_xaxis_transform(),
                        clip_on=False, **CROSS)  # fmt: skip
            ax.set_xlabel(_axis(_words(key), data[key].attrs))
        for ax in axes[len(inputs) :]:
            ax.set_axis_off()
        for ax in axes[:: min(ACROSS, len(inputs))]:
            ax.set_ylabel(_label(column))
        if missing.any():
            axes[0].set_title(f'{missing.sum()} of {len(finite)} without a result', loc='left', color=VERMILION)
    return figure


def _other_dims(data: xarray.DataArray, wanted: int) -> list[str]:
    """Returns the dimensions other than that of the variants.

    Raises
    ------
    ValueError
        Their number differs from `wanted`.
    """
    dims = [str(dim) for dim in data.dims if dim != 'variant']
    if len(dims) != wanted or 'variant' not in data.dims:
        raise ValueError(f'{data.name}: has the dimensions {", ".join(map(str, data.dims))}; must have variant and {wanted} more')
    return dims


def _words(name: str) -> str:
    """Name of a column or key for readers."""
    return NAMES.get(name, name.rpartition('.')[2].replace('_', ' '))


def _key(name: str) -> str:
    """Name of a varied key, without its unit, with its group."""
    group, _, key = name.partition('.')
    unit = next((one['unit'] for one in declared()['keys'] if (one['group'], one['name']) == (group, key)), '')
    return f'{group}: {_axis(_words(key), {"units": unit}).rpartition(" (")[0].lower()}'


def _label(data: xarray.DataArray) -> str:
    words = _axis(_words(str(data.name)), data.attrs)
    return words[:1].upper() + words[1:]


def _axis(words: str, attributes: dict[Any, Any]) -> str:
    """Axis label with the unit in brackets, which is removed from the end of the name."""
    if words == 'rpm':
        return 'Speed of the pinion (1/min)'
    unit = attributes.get('units', '')
    words = words.replace('_', ' ')
    for between in (' ', ''):  # as in rpm_s and torque_nm
        words = words.removesuffix(' ' + re.sub('[/· ]', between, unit.lower()))
    return f'{words[:1].upper()}{words[1:]} ({unit.replace("um", "µm") or "–"})'
