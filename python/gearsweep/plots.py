"""Pictures of the results, by matplotlib."""

from __future__ import annotations

import os

import matplotlib.pyplot as plt

from .results import Study, Sweep


def draw_all(study: Study, folder: str | os.PathLike, name: str = 'gearsweep') -> list[str]:
    """Draws everything that the study has into files `name.sweep.png` and so on; their paths."""
    paths = []
    if study.sweep is not None:
        figure, axes = plt.subplots()
        plot_sweep(study.sweep, axes)
        paths.append(os.path.join(folder, f'{name}.sweep.png'))
        figure.savefig(paths[-1])
        plt.close(figure)
    return paths


def plot_sweep(sweep: Sweep, ax=None):
    """Dynamic factor over speed, a curve for each relief."""
    ax = plt.gca() if ax is None else ax
    for relief, curve in zip(sweep.relief_um, sweep.dynamic_factor.T):
        ax.plot(sweep.rpm, curve, label=f'{relief:g} um')
    ax.set_xlabel('speed of the pinion, 1/min')
    ax.set_ylabel('dynamic factor')
    ax.legend(title='tip relief')
    return ax
