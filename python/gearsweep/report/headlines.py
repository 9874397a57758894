"""Main numbers of a study, a few of each task, for the panel and the report."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from ..core.names import NUMBERS
from ..core.study import Study
from ..core.table import Table


@dataclass(frozen=True)
class Headline:
    """A number with its name and a note; its task, and the panel's picture that shows it."""

    task: str
    picture: str
    name: str
    value: str
    more: str = ''


def headlines(study: Study) -> list[Headline]:
    """Returns the main numbers of all tasks in a study."""
    return [one for table, found in _ALL if table in study and study[table].rows for one in found(study)]


def as_json(study: Study) -> list[dict[str, Any]]:
    return [asdict(one) for one in headlines(study)]


def shown(value: float, digits: int = 4) -> str:
    """Formats a number for readers: to this number of digits, without trailing zeros."""
    if not np.isfinite(value):
        return '–'
    if float(value).is_integer() and abs(value) < 1e7:
        return str(int(value)).replace('-', '−')
    rounded = float(f'{value:.{digits}g}')
    plain = 1e-3 <= abs(value) < 1e6
    return (repr(rounded).removesuffix('.0') if plain else f'{value:.{digits - 1}e}').replace('-', '−')


def _most(values: Any) -> float:
    known = np.ravel(values)[np.isfinite(np.ravel(values))]
    return float(known.max()) if known.size else np.nan


def _least(values: Any) -> float:
    return -_most(-np.asarray(values))


def _geometry(study: Study) -> Iterator[Headline]:
    geometry = study.geometry
    yield Headline('mesh', 'share', 'Contact ratio', shown(geometry.contact_ratio), f'centre distance {shown(geometry.centre_distance_mm, 5)} mm')


def _motion(study: Study) -> Iterator[Headline]:
    motion = study.motion
    yield Headline('sweep', 'sweep', 'Resonance', f'{shown(motion.resonance_rpm, 5)} 1/min', f'natural frequency {shown(motion.natural_frequency_hz, 5)} Hz')


def _mesh(study: Study) -> Iterator[Headline]:
    range_um, reliefs = (study.transmission_error._read(name) for name in ('peak_to_peak_um', 'relief_um'))
    best = int(range_um.argmin())
    yield Headline('mesh', 'ste', 'Transmission error', f'{shown(range_um[best])} µm',
                   f'peak to peak, relief {shown(reliefs[best])} µm')  # fmt: skip


def _sweep(study: Study) -> Iterator[Headline]:
    best = study.sweep_summary
    other = f', in the other direction {shown(best.other_dynamic_factor, 5)}' if 'points_with_two_motions' in best and best.points_with_two_motions > 0 else ''
    at = f'at {shown(best.rpm, 5)} 1/min'
    if len(np.atleast_1d(study.sweep.relief_um)) > 1:
        yield Headline('sweep', 'sweep', 'Best of the list', f'{shown(best.best_relief_um, 5)} µm',
                       f'largest dynamic factor {shown(best.worst_dynamic_factor, 5)} {at}{other}')  # fmt: skip
    else:
        yield Headline('sweep', 'sweep', 'Largest dynamic factor', shown(best.worst_dynamic_factor, 5), at + other)
    if 'seen_dynamic_factor' in best and np.isfinite(best.seen_dynamic_factor):
        number = {status: int(best[f'points_{status}']) for status in ('chaotic', 'transient', 'unstable')}
        words = ', '.join(f'{count} {status}' for status, count in number.items() if count) or 'only in the other direction'
        yield Headline('sweep', 'sweep', 'Motions that do not repeat', f'{words} of {best.points} points',
                       f'dynamic factor at least {shown(best.seen_dynamic_factor, 5)}, seen over {best.seen_periods} mesh periods')  # fmt: skip


#: Column of the criterion, its words, unit and digits.
_CRITERIA = {
    'dynamic_factor': ('worst_dynamic_factor', 'the largest dynamic factor', '', 5),
    'ste_peak_to_peak': ('ste_peak_to_peak_um', 'the peak-to-peak STE', ' µm', 4),
    'mesh_harmonic': ('mesh_harmonic_um', 'the mesh harmonic of the STE', ' µm', 4),
    'dte_rms': ('dte_rms_um', 'the rms of the DTE', ' µm', 4),
}


def _optimum(study: Study) -> Iterator[Headline]:
    best = study.optimum
    column, words, unit, digits = _CRITERIA[str(np.ravel(best.judged)[0])]
    design = study.optimum_design if 'optimum_design' in study else None
    value = (design or best)._read(column)[0]
    more = f'judged by {words} {shown(value, digits)}{unit}'
    if 'optimum_loads' in study:
        torques = [shown(torque) for torque in study.optimum_loads._read('torque_nm')]
        which = {'worst': 'worst over torques', 'weighted': 'weighted mean over torques'}[str(np.ravel(best.over_torques)[0])]
        more += f', {which if len(torques) > 1 else "under"} {", ".join(torques)} N m'
    if design is None and column == 'worst_dynamic_factor' and str(np.ravel(best.over_torques)[0]) == 'worst':
        more += f', at {shown(best.rpm, 5)} 1/min'
    if design is not None:
        yield Headline('optimum', 'optimum', 'Best design', f'{shown(design.pinion_relief_um)} and {shown(design.gear_relief_um)} µm', more)
    else:
        yield Headline('optimum', 'optimum', 'Best single amount', f'{shown(best.relief_um)} µm', more)


def _deflection_relief(study: Study) -> Iterator[Headline]:
    found = study.deflection_relief
    best = int(np.argmin(np.nan_to_num(found.worst_dynamic_factor, nan=np.inf)))
    yield Headline('deflection_relief', 'relief_search', 'Relief of the least DF', f'{shown(found.pinion_relief_um[best])} µm',
                   f'largest dynamic factor {shown(found.worst_dynamic_factor[best], 5)}')  # fmt: skip


def _load(study: Study) -> Iterator[Headline]:
    points = study.load_points
    yield from _largest('load', 'load', 'Dynamic factor in motion', points._read('dynamic_factor'), points._read('rpm'))


def _largest(task: str, picture: str, name: str, values: np.ndarray, rpm: np.ndarray, unit: str = '') -> Iterator[Headline]:
    """Returns the largest of the values, and its speed."""
    if np.isfinite(values).any():
        at = int(np.nanargmax(values))
        yield Headline(task, picture, name, shown(values[at]) + unit, f'at {shown(rpm[at], 5)} 1/min')


def _rating(study: Study) -> Iterator[Headline]:
    rating, factors, of = study.rating, study.dynamic_factors, study.rating_factors
    rated, of_relief = _best_rated(study)
    least = {name: rating._read(column)[rated] for name, column in (('S_H', 'contact_safety'), ('S_F', 'root_safety'))}
    known = [f'{name} {shown(_least(values))}' for name, values in least.items() if np.isfinite(values).any()]

    def or_not_computed(factor: float) -> str:
        return shown(factor) if factor > 1 else '1 (not computed)'

    def once(values: Any) -> list[Any]:
        return list(dict.fromkeys(value for value in np.ravel(values) if value and value == value))

    materials = once(of.material_name)
    teeth = f'{", ".join(materials)} of grade {of.material_grade[0]}' if materials else 'limits as stated'
    limits = ', '.join(f'{sign} {" and ".join(map(shown, once(values)))} MPa' for sign, values in
                       (('sigma_HG', of.contact_limit_mpa), ('sigma_FG', of.root_limit_mpa)) if once(values))  # fmt: skip
    ground = (f'K_v by Method {" or ".join(sorted(name.upper() for name in once(rating._read("method"))))}; '
              f'K_A {shown(of.application_factor[0])}, K_H_beta {or_not_computed(of.face_load_factor[0])}, '
              f'K_H_alpha and K_F_alpha {or_not_computed(of.transverse_load_factor[0])}; accuracy grade {shown(of.accuracy_grade[0])}; {teeth}: {limits}')  # fmt: skip
    if known:
        yield Headline('rating', 'rating', 'Least safety', ', '.join(known), of_relief + ground)
    contact, root = (shown(_most(rating._read(column))) for column in ('contact_stress_mpa', 'root_stress_mpa'))
    yield Headline('rating', 'rating', 'Largest stress', f'{contact} and {root} MPa', 'on the flanks and at the roots')
    by_a, by_b = (_most(factors._read(f'dynamic_factor_{method}')) for method in 'ab')
    yield Headline('rating', 'rating', 'Largest K_v', shown(max(by_a, by_b)), f'Method A {shown(by_a)}, Method B {shown(by_b)}')


def _best_rated(study: Study) -> tuple[np.ndarray, str]:
    """Returns the rows of the rating with the best relief over the speeds, and a text that names it; all rows without a sweep."""
    relief = study.rating._read('relief_um')
    if len(set(relief)) == 1:
        return np.ones(relief.size, bool), ''
    best = study.sweep_summary.best_relief_um if 'sweep_summary' in study else np.nan
    if not np.isclose(relief, best).any():
        return np.ones(relief.size, bool), 'of all reliefs; '
    return np.isclose(relief, best), f'relief {shown(best, 5)} µm; '


def _flank(study: Study) -> Iterator[Headline]:
    losses = study.flank_losses
    read = {name: losses._read(name) for name in ('largest_flash_k', 'largest_pressure_mpa', 'least_film_um', 'efficiency', 'friction_loss_w')}
    yield Headline('flank', 'flash', 'Flash temperature', f'{shown(_most(read["largest_flash_k"]))} K',
                   f'pressure {shown(_most(read["largest_pressure_mpa"]))} MPa, film {shown(_least(read["least_film_um"]))} µm')  # fmt: skip
    yield Headline('flank', 'pressure', 'Efficiency', f'{shown(100 * _least(read["efficiency"]))} %',
                   f'friction losses at most {shown(_most(read["friction_loss_w"]))} W')  # fmt: skip


def _face_load(study: Study) -> Iterator[Headline]:
    summary = study.face_load_summary
    factor, root, worst = (_most(summary._read(f'{name}face_load_factor')) for name in ('', 'root_', 'worst_'))
    yield Headline('face_load', 'contact_pattern', 'K_H_beta', shown(factor), f'at its worst phase {shown(worst)}, K_F_beta {shown(root)}')


def _static(study: Study) -> Iterator[Headline]:
    stress = study.root_stress
    iso = f', by ISO 6336-3 {shown(study.root_rating.iso_mpa)}' if 'root_rating' in study else ''
    yield Headline('static', 'root', 'Root stress', f'{shown(_most(stress.tension_mpa))} MPa', f'tension{iso}')


def _transient(study: Study) -> Iterator[Headline]:
    peaks = study.transient_peaks
    yield from _largest('transient', 'transient_peaks', 'Root stress in motion', peaks._read('tension_mpa'),
                        peaks._read('rpm'), ' MPa')  # fmt: skip


def _harmonic(study: Study) -> Iterator[Headline]:
    peaks = study.section_resonances
    at = int(np.argmax(peaks._read('amplification')))
    yield Headline('harmonic', 'frequency', 'Largest amplification', shown(peaks._read('amplification')[at]),
                   f'at {shown(peaks._read("peak_frequency_hz")[at] / 1000)} kHz')  # fmt: skip


def _life(study: Study) -> Iterator[Headline]:
    parts: list[tuple[str, Table, str, str]] = [('roots', study.life_curve, 'life_h', 'damage')]
    if 'contact_curve' in study:
        parts.append(('flanks', study.contact_curve, 'contact_life_h', 'contact_damage'))
    for what, curve, hours, damage in parts:
        least, cycles, stress = np.min(study.life._read(hours)), curve._read('failure_cycles'), curve._read('stress_mpa')
        yield Headline('life', 'life', f'Life of the {what}', f'{shown(least)} h' if np.isfinite(least) else 'no damage',
                       f'damage of one pass {shown(_most(study.life._read(damage)))}; S-N curve {curve._read("curve")[0]}: '
                       f'{shown(stress[-2])} MPa at {cycles[-2]:.3g}, {shown(stress[-1])} MPa at {cycles[-1]:.3g} cycles')  # fmt: skip


def _modal(study: Study) -> Iterator[Headline]:
    yield Headline('modal', 'modes', 'First mode of the section', f'{shown(study.modal._read("frequency_hz")[0] / 1000)} kHz')


def _body_modes(study: Study) -> Iterator[Headline]:
    first, name = (study.body_modes._read(column)[0] for column in ('frequency_hz', 'mode_name'))
    yield Headline('body_modes', 'body_campbell', 'First mode of the body', f'{shown(first / 1000)} kHz', str(name))


def _stability(study: Study) -> Iterator[Headline]:
    ratio = np.ravel(study.tongues.closing_damping_ratio)
    if np.isfinite(ratio).any():
        yield Headline('stability', 'stability', 'Stable from damping ratio', shown(_most(ratio), 3), 'which closes the widest of the tongues found')


def _hysteresis(study: Study) -> Iterator[Headline]:
    changes = study.hysteresis_changes
    read = {name: changes._read(name) for name in ('kind', 'rpm_before', 'dynamic_factor_before', 'dynamic_factor_after')}
    height = np.where(read['kind'] == 'jump', np.abs(read['dynamic_factor_after'] - read['dynamic_factor_before']), np.nan)
    jumps = np.isfinite(height)
    largest = f'the largest at {shown(read["rpm_before"][np.nanargmax(height)], 5)} 1/min' if jumps.any() else ''
    yield Headline('hysteresis', 'hysteresis', 'Jumps', str(jumps.sum()), largest)


def _poincare(study: Study) -> Iterator[Headline]:
    motion = study.lyapunov
    chaotic = motion._read('status') == 'chaotic'
    yield Headline('poincare', 'poincare', 'Chaotic at', f'{chaotic.sum()} of {motion.rows} points')


def _attractors(study: Study) -> Iterator[Headline]:
    points = study.attractor_points
    yield Headline('attractors', 'attractors', 'Motions side by side', f'up to {shown(_most(points._read("motions")))}',
                   f'dynamic factor up to {shown(_most(points._read("largest_dynamic_factor")))}')  # fmt: skip


def _branches(study: Study) -> Iterator[Headline]:
    kinds = study.branch_changes._read('kind')
    yield Headline('branches', 'branches', 'Branches', str(study.branches.rows), f'{(kinds == "fold").sum()} folds, {(kinds == "doubling").sum()} doublings')


def _torque(study: Study) -> Iterator[Headline]:
    points = study.torque_points
    least, most = _least(points._read('pinion_least_nm')), _most(points._read('pinion_largest_nm'))
    yield Headline('torque', 'torque', 'Torque of the pinion', f'{shown(least)} to {shown(most)} N·m')


def _sensitivity(study: Study) -> Iterator[Headline]:
    slope = study.sensitivity._read('relative_slope')
    if np.isfinite(slope).any():
        at = int(np.nanargmax(np.abs(slope)))
        yield Headline('sensitivity', 'sensitivity', 'Changes DF most', NUMBERS[study.sensitivity._read('number')[at]],
                       f'{shown(slope[at], 3)} % for 1 % more')  # fmt: skip


def _as_built(study: Study) -> Iterator[Headline]:
    worst = study.as_built_worst
    factor, relief = worst._read('dynamic_factor'), worst._read('relief_um')
    if not np.isfinite(factor).any():
        return
    by_relief = {one: _most(factor[relief == one]) for one in dict.fromkeys(relief.tolist())}
    best = min(by_relief, key=lambda one: np.nan_to_num(by_relief[one], nan=np.inf))
    at = int(np.flatnonzero((relief == best) & (factor == by_relief[best]))[0])
    nominal = f'nominal {shown(worst._read("nominal_factor")[at])}, relief {shown(best)} µm, at {shown(worst._read("rpm")[at], 5)} 1/min'
    yield Headline('as_built', 'as_built', 'Largest dynamic factor as built', shown(factor[at]), nominal)


#: Functions by the tables that they need; results first, then the description of the pair.
_ALL = (
    ('optimum', _optimum), ('sweep_summary', _sweep), ('rating', _rating), ('flank_losses', _flank), ('deflection_relief', _deflection_relief),
    ('load_points', _load), ('torque_points', _torque), ('sensitivity', _sensitivity), ('as_built_worst', _as_built),
    ('face_load_summary', _face_load), ('root_stress', _static), ('life', _life),
    ('transient_peaks', _transient), ('section_resonances', _harmonic), ('modal', _modal), ('body_modes', _body_modes),
    ('tongues', _stability), ('hysteresis', _hysteresis), ('lyapunov', _poincare), ('attractor_points', _attractors), ('branches', _branches),
    ('transmission_error', _mesh), ('geometry', _geometry), ('motion', _motion),
)  # fmt: skip
