"""How much of their life the tooth roots spend."""

from __future__ import annotations

from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from ..study import Study
from ..table import Table
from .look import GREY, INK, canvas
from .reliefs import Reliefs, study_of

#: Of pinion and gear.
MARKS = ('o', 's')


def plot_life(life: Study | Table, ax: Axes | None = None) -> Axes:
    """The S-N curve, and how often each part of the load spectrum comes in one pass with which stress amplitude, for each relief.

    What lies left of the curve lasts longer than one pass. Amplitudes are those that do the same harm without mean stress.

    Parameters
    ----------
    life : Study or Table
        A study, or its table `life_parts`.
    ax : Axes, optional
        Where to draw; otherwise a figure is made.

    Returns
    -------
    Axes
    """
    study = study_of(life)
    parts, curve = study.life_parts, study.life_curve
    reliefs = Reliefs(study.case)
    with canvas(ax) as ax:
        ax.loglog(curve.failure_cycles, curve.amplitude_mpa, color=INK)
        for amount, often, amplitude in zip(parts.relief_um, parts.engagements, parts.equivalent_amplitude_mpa):
            for member, mark in enumerate(MARKS):
                ax.plot(often[:, member], amplitude[:, member], mark, color=reliefs.style(amount)['color'], markersize=4)
        more = [Line2D([], [], color=INK, label='S-N curve')]
        more += [Line2D([], [], color=GREY, linestyle='', marker=mark, label=label) for mark, label in zip(MARKS, parts.member)]
        reliefs.legend(ax, more, filled=True)
        ax.set_xlabel('Cycles, of one pass and to failure (–)')
        ax.set_ylabel('Stress amplitude (MPa)')
    return ax
