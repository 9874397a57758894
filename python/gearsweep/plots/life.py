"""Life of the tooth roots under a load spectrum."""

from __future__ import annotations

from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.ticker import LogLocator, NullFormatter

from ..core.study import Study
from ..core.table import Table
from .look import GREY, HOLLOW, INK, canvas
from .reliefs import Reliefs, study_of

#: Marks of pinion and gear.
MARKS = ('o', 's')
LOOK = {**HOLLOW, 'markersize': 4.5, 'markerfacecolor': 'none'}


def plot_life(life: Study | Table, ax: Axes | None = None) -> Axes:
    """Draws the S-N curve, and stress amplitude and number of engagements of each part of the load spectrum in one pass, for
    each relief.

    A mark to the left of the curve is a part that alone would last longer than one pass. Amplitudes are converted to the stress
    ratio of the curve.

    Parameters
    ----------
    life : Study or Table
        A study, or its table `life_parts`.
    ax : Axes, optional
        Axes to draw into; otherwise a figure is made.

    Returns
    -------
    Axes
    """
    study = study_of(life)
    parts, curve = study.life_parts, study.life_curve
    reliefs = Reliefs(study.case)
    with canvas(ax) as ax:
        for gear in dict.fromkeys(curve.gear):
            own = curve.gear == gear
            ax.loglog(curve.failure_cycles[own], curve.stress_mpa[own], color=INK, linestyle='--' if gear == 'gear' else '-')
        for amount, often, amplitude in zip(parts.relief_um, parts.engagements, parts.equivalent_amplitude_mpa):
            for gear, mark in enumerate(MARKS):
                ax.plot(often[:, gear], amplitude[:, gear], **LOOK, marker=mark, markeredgecolor=reliefs.style(amount)['color'])
        more = [Line2D([], [], color=INK, label=f'S-N curve: {curve.curve[0].replace("_", " ")}')]
        more += [Line2D([], [], **LOOK, markeredgecolor=GREY, marker=mark, label=label) for mark, label in zip(MARKS, parts.gear)]
        reliefs.legend(ax, more, filled=True)
        # Few stresses are printed as plain numbers, as a decade may have no tick of its own.
        ax.yaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
        ax.yaxis.set_major_formatter('{x:g}')
        ax.yaxis.set_minor_formatter(NullFormatter())
        ax.set_xlabel('Load cycles: marks in one pass, curve to failure (–)')
        ax.set_ylabel('Amplitude of the root stress (MPa)')
    return ax
