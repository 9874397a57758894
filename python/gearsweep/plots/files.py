"""Pictures of all results of a study, as files."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import nullcontext
from dataclasses import dataclass
from math import ceil
from textwrap import wrap
from typing import BinaryIO

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.legend import Legend

from ..core.files import replacing
from ..core.study import Study
from ..core.texts import escaped
from .along_path import (
    plot_dte,
    plot_harmonics,
    plot_load,
    plot_motion_harmonics,
    plot_sharing,
    plot_static,
    plot_ste,
    plot_stiffness,
)
from .as_built import plot_as_built, plot_assemblies, plot_orders, plot_turn, plot_turn_loads, plot_waterfall
from .attractors import plot_attractors, plot_basins
from .body import plot_modal, plot_section
from .body_modes import plot_body_modes
from .branches import plot_branches, reliefs_of
from .deflection_relief import LABELS, plot_deflection_relief, plot_relief_flank
from .face_load import compare_face_loads, plot_contact_pattern, plot_face_load
from .flank import plot_flank
from .frequency import plot_body_campbell, plot_campbell, plot_frequency_response
from .gears import plot_geometry
from .life import plot_life
from .look import COLUMN, GREY, MM, PAGE, style
from .over_speed import DTE_LABELS, plot_dte_sweep, plot_optimum, plot_sweep
from .over_torque import plot_optimum_map, plot_torques
from .precision import PANELS, plot_precision
from .rating import plot_rating
from .sensitivity import plot_sensitivity
from .stability import plot_hysteresis, plot_poincare, plot_stability
from .stress import plot_stress
from .torque import plot_torque, plot_torque_harmonics
from .transient import plot_transient, plot_transient_peaks


@dataclass(frozen=True)
class Picture:
    """Caption of a picture, and the function that draws it."""

    caption: str
    draw: Callable[[Study], Figure]
    table: str = ''  #: main table, if its name differs
    has_some: Callable[[Study], bool] = lambda study: True  #: true if there is something to draw


#: Largest number of panels in a picture, which reports the full number.
MOST = 20


def draw_all(
    study: Study, folder: str | os.PathLike, stem: str = 'gearsweep', formats: Sequence[str] = ('png', 'svg')
) -> list[str]:
    """Draws all results of a study into files named after the tables: `stem.sweep.png` and so on.

    Parameters
    ----------
    study : Study
        From `gearsweep.run`.
    folder : path
        Where the files go; it is made if missing.
    stem : str
        How their names begin.
    formats : sequence of str
        Endings, of those that matplotlib knows, such as 'png', 'svg' and 'pdf'.

    Returns
    -------
    list of str
        Paths of the files.
    """
    os.makedirs(folder, exist_ok=True)
    paths = []
    for name, figure in figures(study, stem=stem):
        for ending in formats:
            paths.append(os.path.join(folder, f'{stem}.{name}.{ending}'))
            save(figure, paths[-1], ending)
    return paths


def figures(study: Study, *names: str, stem: str = '') -> Iterator[tuple[str, Figure]]:
    """Draws the pictures that `draw_all` writes, or those named; returns the name of the main table and the figure of each.

    Each has the title of the case at the top, or else `stem`.
    """
    for name, picture in PICTURES.items():
        if (picture.table or name) in study and (not names or name in names) and picture.has_some(study):
            with style():
                figure = picture.draw(study)
                _entitle(figure, study.case.get('case', 'title') or stem)
            yield name, figure


def _entitle(figure: Figure, title: str) -> None:
    """Writes the title in the upper right corner."""
    across = int(figure.get_figwidth() / MM / 1.7)  # letters of this size
    if title:
        figure.suptitle('\n'.join(map(escaped, wrap(title, across))), x=0.99, ha='right', fontsize=7, color=GREY)


def save(figure: Figure, file: str | os.PathLike | BinaryIO, ending: str) -> None:
    """Writes a picture in this format; the same picture has the same bytes, as no date is written.

    An existing file is replaced when the new one is complete.

    Raises
    ------
    Error
        The file cannot be written.
    """
    dates = {'svg': {'Date': None}, 'pdf': {'CreationDate': None}}
    with style(), replacing(file) if isinstance(file, (str, os.PathLike)) else nullcontext(file) as new:
        figure.savefig(new, format=ending, metadata=dates.get(ending))


def _single(plot: Callable, height: float, width: float = COLUMN) -> Callable[[Study], Figure]:
    def draw(study: Study) -> Figure:
        figure = Figure((width, height * MM), layout='constrained')
        plot(study, figure.subplots())
        return figure

    return draw


def _reliefs(table: str, plot: Callable, height: float = 80) -> Callable[[Study], Figure]:
    """Draws panels below each other, one for each relief; a single one if the relief is no index."""

    def draw(study: Study) -> Figure:
        amounts = reliefs_of(study[table])
        figure, axes = _panels(len(amounts), 'reliefs', 1, height)
        for ax, amount in zip(axes, amounts):
            plot(study, ax, relief_um=amount)
        return figure

    return draw


def _sensitivity(study: Study) -> Figure:
    """Draws a panel for each relief and speed."""
    points = list(dict.fromkeys(zip(study.sensitivity.relief_um, study.sensitivity.rpm)))
    figure, axes = _panels(len(points), 'operating points', 2, 70)
    for ax, (amount, rpm) in zip(axes, points):
        plot_sensitivity(study, ax, rpm=rpm, relief_um=amount)
    _one_scale(axes)
    return figure


def _mesh(study: Study) -> Figure:
    """Draws stiffness, sharing and transmission error below each other."""
    figure = Figure((COLUMN, 150 * MM), layout='constrained')
    axes = figure.subplots(3, sharex=True)
    for plot, ax in zip((plot_stiffness, plot_sharing, plot_ste), axes):
        plot(study, ax)
        ax.label_outer()
    _one_legend(axes)
    return figure


def _dte_sweep(study: Study) -> Figure:
    """Draws rms and peak to peak below each other."""
    figure = Figure((PAGE, 130 * MM), layout='constrained')
    axes = figure.subplots(2, sharex=True)
    for ax, quantity in zip(axes, DTE_LABELS):
        plot_dte_sweep(study, ax, quantity=quantity)
        ax.label_outer()
    for legend in axes[1].findobj(Legend):
        legend.remove()
    return figure


def _relief_curve(study: Study) -> Figure:
    """Draws transmission error and dynamic factor below each other."""
    figure = Figure((COLUMN, 115 * MM), layout='constrained')
    axes = figure.subplots(2, sharex=True)
    for ax, quantity in zip(axes, LABELS):
        plot_deflection_relief(study, ax, quantity=quantity)
        ax.label_outer()
    for legend in axes[1].findobj(Legend):
        legend.remove()
    return figure


def _torques(study: Study) -> Figure:
    """Draws curves over torque next to the map."""
    figure = Figure((PAGE, 75 * MM), layout='constrained')
    left, right = figure.subplots(1, 2)
    plot_torques(study, left)
    plot_optimum_map(study, right)
    return figure


def _relief_flank(study: Study) -> Figure:
    """Draws a panel for each gear."""
    figure, axes = _panels(2, 'gears', 2, 70)
    for ax, gear in zip(axes, ('pinion', 'gear')):
        plot_relief_flank(study, ax, gear=gear)
    return figure


def _speeds(table: str, plot: Callable) -> Callable[[Study], Figure]:
    """Draws a panel for each speed."""

    def draw(study: Study) -> Figure:
        speeds = list(dict.fromkeys(study[table].rpm))
        figure, axes = _panels(len(speeds), 'speeds', 2, 60)
        for ax, rpm in zip(axes, speeds):
            plot(study, ax, rpm=rpm)
        _one_legend(axes)
        return figure

    return draw


def _loads(study: Study) -> Figure:
    """Draws a row for each speed: load of a pair, and transmission error."""
    speeds = list(dict.fromkeys(study.load.rpm))
    figure, axes = _panels(2 * len(speeds), 'panels', 2, 60)
    for left, right, rpm in zip(axes[::2], axes[1::2], speeds):
        plot_load(study, left, rpm=rpm)
        plot_dte(study, right, rpm=rpm)
    _one_legend(axes)
    return figure


def _flank(study: Study) -> Figure:
    """Draws pressure, sliding, flash temperature and film below each other, a column for each of at most two speeds."""
    speeds = list(dict.fromkeys(study.flank.rpm))
    shown = speeds[:2]
    figure = Figure((COLUMN if len(shown) == 1 else PAGE, 190 * MM), layout='constrained')
    rows = figure.subplots(4, len(shown), sharex=True, squeeze=False)
    for axes, quantity in zip(rows, ('pressure_mpa', 'sliding_m_s', 'flash_temperature_k', 'film_thickness_um')):
        for ax, rpm in zip(axes, shown):
            plot_flank(study, ax, quantity=quantity, rpm=rpm)
    for axes in rows[:-1]:
        for ax in axes:
            ax.set_xlabel('')
    for ax in rows.flat[1:]:
        for legend in ax.findobj(Legend):
            legend.remove()
    if len(shown) < len(speeds):
        figure.supxlabel(f'The first {len(shown)} of {len(speeds)} speeds')
    return figure


def _as_built(study: Study) -> Figure:
    """Draws a panel for each relief, all to one scale."""
    figure = _reliefs('as_built', plot_as_built, 70)(study)
    _one_scale(figure.axes, 'y')
    return figure


def _assemblies(study: Study) -> Figure:
    """Draws a panel for each relief, all to one scale."""
    amounts = reliefs_of(study.as_built_worst)
    figure, axes = _panels(len(amounts), 'reliefs', 2, 65)
    for ax, amount in zip(axes, amounts):
        plot_assemblies(study, ax, relief_um=amount)
        ax.margins(y=0)
    _one_scale(axes, 'y')
    least, largest = axes[0].get_ylim()
    room = 0.35 * (largest - least)  # for the labels of the least and the largest value
    for ax in axes:
        ax.set_ylim(least - room, largest + room)
    return figure


def _over_face(plot: Callable) -> Callable[[Study], Figure]:
    """Draws a panel for each relief, all of one scale."""

    def draw(study: Study) -> Figure:
        amounts = list(dict.fromkeys(study.face_load.relief_um))
        figure, axes = _panels(len(amounts), 'reliefs', 2, 75)
        for ax, amount in zip(axes, amounts):
            plot(study, ax, relief_um=amount)
        _one_scale(axes, 'y')
        return figure

    return draw


def _turn(study: Study) -> Figure:
    """Draws the transmission error above the loads of the pairs, for each relief and speed; static only if a relief did not
    converge.
    """
    loads = study.as_built_loads
    points = list(dict.fromkeys(zip(loads.relief_um, loads.rpm)))
    alone = [amount for amount in dict.fromkeys(study.as_built_turn.relief_um) if amount not in loads.relief_um]
    figure, axes = _panels(2 * len(points) + len(alone), 'panels', 1, 50)
    for above, below, (amount, rpm) in zip(axes[::2], axes[1::2], points):
        plot_turn(study, above, relief_um=amount, rpm=rpm)
        above.set_xlabel('')
        plot_turn_loads(study, below, relief_um=amount, rpm=rpm)
    for ax, amount in zip(axes[2 * len(points) :], alone):
        plot_turn(study, ax, relief_um=amount)
    return figure


def _orders(study: Study) -> Figure:
    """Draws a panel for each relief and speed."""
    points = list(dict.fromkeys(zip(study.as_built_orders.relief_um, study.as_built_orders.rpm)))
    figure, axes = _panels(len(points), 'operating points', 1, 90)
    for ax, (amount, rpm) in zip(axes, points):
        plot_orders(study, ax, relief_um=amount, rpm=rpm)
    return figure


def _body_modes(study: Study) -> Figure:
    """Draws a panel for each mode that has a shape."""
    count = len(study.body_shapes.axial_cos)
    figure, axes = _panels(count, 'modes', 2, 85)
    for mode, ax in enumerate(axes, 1):
        plot_body_modes(study, ax, mode=mode)
    return figure


def _precision(study: Study) -> Figure:
    """Draws a panel for each kind of computation."""
    shown = {title: names for title, names in PANELS.items() if np.isin(names, study.precision.quantity).any()}
    figure, axes = _panels(len(shown), 'quantities', 2, 75)
    for ax, (title, names) in zip(axes, shown.items()):
        plot_precision(study, ax, quantities=[name for name in names if name in study.precision.quantity], title=title)
    return figure


def _modes(study: Study) -> Figure:
    """Draws a panel for each mode."""
    aspect = np.ptp(study.nodes.y_mm) / np.ptp(study.nodes.x_mm)
    figure, axes = _panels(study.modal.rows, 'modes', 4, 5 + 42 * aspect)
    for i, ax in enumerate(axes):
        plot_modal(study, ax, mode=i + 1)
    return figure


def _panels(n: int, what: str, across: int, height: float) -> tuple[Figure, list[Axes]]:
    """Returns a figure with n panels of this height (mm), or as many as are allowed."""
    shown = min(n, MOST)
    rows = ceil(shown / across)
    columns = ceil(shown / rows)
    figure = Figure((PAGE * columns / across, rows * height * MM), layout='constrained')
    axes = list(figure.subplots(rows, columns, squeeze=False).flat)
    for ax in axes[shown:]:
        ax.remove()
    if shown < n:
        figure.supxlabel(f'The first {shown} of {n} {what}')
    return figure, axes[:shown]


def _one_scale(axes: Sequence[Axes], of: str = 'x') -> None:
    """Sets the same axis for panels whose values are compared."""
    ends = np.array([getattr(ax, f'get_{of}lim')() for ax in axes])
    for ax in axes:
        ax.set(**{f'{of}lim': (ends[:, 0].min(), ends[:, 1].max())})


def _one_legend(axes: Sequence[Axes]) -> None:
    """Keeps the legend of the reliefs in the first panel only."""
    for ax in axes[1:]:
        if (legend := ax.get_legend()) and legend.get_title().get_text():
            legend.remove()


#: All pictures, by their main tables.
PICTURES = {
    'outline': Picture('Both gears in mesh, the line of action with A, B, P, D, E, and the working pitch circles', _single(plot_geometry, 60)),
    'section': Picture('Finite-element grid', _single(plot_section, 80), 'elements'),
    'mesh': Picture('Along the path of contact: stiffness of all pairs and of one, load share, static transmission error', _mesh),
    'harmonics': Picture("Amplitudes of the static transmission error's harmonics", _single(plot_harmonics, 60)),
    'static': Picture('Root stress on both sides while the load moves; ISO 6336-3 and Lewis', _single(plot_static, 65)),
    'stress': Picture('Principal stress around the tooth, with the load at one place', _single(plot_stress, 55)),
    'modal': Picture('Mode shapes over the outline at rest, with their frequencies', _modes),
    'contact_pattern': Picture("Contact pattern on the pinion's flank: Hertz pressure over face width and diameter",
                               _over_face(plot_contact_pattern), 'face_load'),
    'face_load': Picture('Load over the face width at the worst phase and in contact of the fewest pairs, with K_H_beta', _over_face(plot_face_load)),
    'face_misalignments': Picture('K_H_beta and K_F_beta over the misalignment, with K_H_beta of ISO 6336-1', _over_face(compare_face_loads)),
    'load': Picture('Load of one pair along its path, and dynamic transmission error, a row for each speed', _loads),
    'motion_harmonics': Picture("Amplitudes of the dynamic transmission error's harmonics, a panel for each speed",
                                _speeds('motion_harmonics', plot_motion_harmonics)),
    'torque': Picture('Torque that the mesh takes from the pinion over time, its mean dashed, a panel for each speed',
                      _speeds('torque', plot_torque)),
    'torque_harmonics': Picture("Amplitudes of the harmonics of the pinion's torque, a panel for each speed",
                                _speeds('torque_harmonics', plot_torque_harmonics)),
    'sweep': Picture('Dynamic factor over speed, a curve for each relief', _single(plot_sweep, 80, PAGE)),
    'dte_sweep': Picture('Dynamic transmission error over speed: root mean square, and peak to peak', _dte_sweep, 'sweep'),
    'optimum_curve': Picture('What the search for the best relief judged, over relief, the least marked', _single(plot_optimum, 60)),
    'optimum_map': Picture('What the search judged over torque for some reliefs, and over torque and relief, with the best relief of each torque', _torques,
                           has_some=lambda study: len(study.optimum_map.torque_nm) > 1),
    'relief_curve': Picture('Static transmission error and dynamic factor over relief, with the reliefs of each method', _relief_curve),
    'relief_flank': Picture('Relief over the diameter of both flanks by each method', _relief_flank),
    'stability': Picture('Largest Floquet multiplier over speed and damping, tongues of instability and the damping that closes them',
                         _single(plot_stability, 80, PAGE)),
    'hysteresis': Picture('Dynamic factor on a slow run up and on one down, jumps with their speeds, doubled periods',
                          _reliefs('hysteresis', plot_hysteresis)),
    'poincare': Picture('Transmission error once a mesh period over speed: what repeats, with doubled periods, chaos',
                        _reliefs('lyapunov', plot_poincare)),
    'attractors': Picture('Dynamic factors of all attracting motions over speed, the more starts lead to one the larger',
                          _reliefs('attractor_points', plot_attractors)),
    'basins': Picture('Which starts lead to which motion at one speed', _reliefs('basins', plot_basins)),
    'branches': Picture('Bifurcation diagram: transmission error (rms) or dynamic factor of all branches over speed, mesh frequency or frequency '
                        'ratio, solid where the motion attracts, dashed where it repels, with folds, doublings and grazing', _reliefs('branches', plot_branches, 90)),
    'sensitivity': Picture('By how many per cent the dynamic factor changes with one per cent of each number of the motion', _sensitivity),
    'precision': Picture("Relative error over run time, a curve for each method, and the methods' own estimates", _precision),
    'flank': Picture("Pressure, sliding, flash temperature and film along the path of contact, under the motion's load and, fine, the static one",
                     _flank),
    'dynamic_factors': Picture('Dynamic factor over speed by Method A of ISO 6336-1, the motion, and by Method B', _single(plot_rating, 65)),
    'transient': Picture('Stress along both fillets over time while the load passes, and, fine, under the same load at rest; a panel for each speed',
                         _speeds('transient', plot_transient)),
    'transient_peaks': Picture('Largest tension and compression of the fillets over speed', _single(plot_transient_peaks, 65)),
    'harmonic': Picture('Amplitude of the stress along both fillets over the frequency of the load', _single(plot_frequency_response, 75)),
    'campbell': Picture('Harmonics of the mesh frequency over the speeds of the case, and the natural frequencies that they meet',
                        _single(plot_campbell, 80, PAGE)),
    'life_parts': Picture('S-N curve, with the stress amplitude and number of engagements of each part of the load spectrum',
                          _single(plot_life, 65)),
    'body_modes': Picture('Modes of a whole gear seen from the front, with the displacement along the axis or in the plane', _body_modes),
    'body_campbell': Picture('Speeds at which the mesh excites the modes of a whole gear as it turns past the load',
                             _single(plot_body_campbell, 100, PAGE)),
    'as_built': Picture('Dynamic factor over speed of gears as built, median and band of all pairs of gears and assemblies, and that of '
                        'nominal gears', _as_built),
    'as_built_worst': Picture('Largest dynamic factor of each assembly, best and worst named', _assemblies,
                              has_some=lambda study: max(len(study.as_built_worst.draw), len(study.as_built_worst.assembly)) > 1),
    'as_built_turn': Picture('Transmission error over the turn in motion and, fine, at rest; below it the largest load of each pair of teeth', _turn),
    'as_built_orders': Picture('Orders of the dynamic transmission error and, hollow, of the static one, with the names of the largest', _orders),
    'as_built_waterfall': Picture('Amplitude of the dynamic transmission error over speed and order', _single(plot_waterfall, 90, PAGE)),
}  # fmt: skip
