"""What a result answers, in a few words: for its repr and for notebooks."""

from __future__ import annotations

import html
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from .results import Result, Study

Line = tuple[str, str]
MOST = 5  # numbers of one kind on a line


def lines(result: Result) -> list[Line]:
    """Each answer as what it is, and its value; none where there is nothing but the arrays."""
    tell = _TELL.get(type(result).__name__)
    return list(tell(result)) if tell else []


def sizes(result: Result) -> str:
    found = {d: n for name, dims in result.dims.items() for d, n in zip(dims, np.shape(getattr(result, name)))}
    return ', '.join(f'{n} {d}' for d, n in found.items())


def text(result: Result) -> str:
    """One line: the answer, then how much there is behind it."""
    answer = '; '.join(f'{what} {value}' for what, value in lines(result))
    return ' | '.join(part for part in (answer, sizes(result)) if part)


def table(result: Result) -> str:
    """The same for notebooks."""
    rows = [*lines(result), ('arrays', sizes(result))]
    return _html(f'gearsweep.{type(result).__name__}', rows)


def study_text(study: Study) -> str:
    return '\n'.join([_heading(study), *(f'  {name + ":":10} {_answer(part)}' for name, part in _parts(study))])


def study_table(study: Study) -> str:
    return _html(_heading(study), [(name, _answer(part)) for name, part in _parts(study)])


def _answer(result: Result) -> str:
    return '; '.join(f'{what} {value}' for what, value in lines(result)) or sizes(result)


def _heading(study: Study) -> str:
    title = study.case.get('case', 'title')
    return 'gearsweep.Study' + (f' of {title}' if title else '')


def _parts(study: Study) -> Iterator[tuple[str, Result]]:
    for name in study.tasks:
        yield name, getattr(study, name)


def _html(heading: str, rows: list[Line]) -> str:
    body = ''.join(
        f'<tr><td style="text-align:left">{html.escape(what)}</td>'
        f'<td style="text-align:left">{html.escape(value)}</td></tr>'
        for what, value in rows
    )
    return f'<table><thead><tr><th colspan="2" style="text-align:left">{html.escape(heading)}</th></tr></thead>{body}</table>'


def _list(values, digits: int = 6) -> str:
    """At most so many numbers, and that there are more."""
    words = [f'{value:.0f}' if 1e4 <= value < 1e9 else f'{value:.{digits}g}' for value in list(values)[:MOST]]
    return ', '.join(words) + (' ...' if len(values) > MOST else '')


def _sweep(sweep) -> Iterator[Line]:
    factor = sweep.dynamic_factor
    answered = np.isfinite(factor).any(axis=0)
    if answered.any():
        worst = np.where(answered, np.nanmax(np.where(np.isfinite(factor), factor, -np.inf), axis=0), np.inf)
        best = int(worst.argmin())
        at = sweep.rpm[np.nanargmax(factor[:, best])]
        what = 'best relief' if len(worst) > 1 else 'relief'
        yield what, f'{sweep.relief_um[best]:g} um: worst DF {worst[best]:.4f} at {at:g} rpm'
        least = int(sweep.relief_um.argmin())
        rpm, peak = sweep.resonances(least)
        if len(rpm):
            yield 'resonances', f'{_list(rpm.round())} rpm: DF {_list(peak, 4)} at {sweep.relief_um[least]:g} um'
    failed = int(np.isnan(factor).sum())
    if failed:
        yield 'without an answer', f'{failed} of {factor.size} points'


def _optimum(optimum) -> Iterator[Line]:
    if np.isnan(optimum.best_um):
        yield 'best relief', 'none: no relief has an answer'
    else:
        yield 'best relief', (
            f'{optimum.best_um:.4g} um (within {optimum.within_um:.2g}): '
            f'worst DF {optimum.best_factor:.4f} at {optimum.best_rpm:g} rpm'
        )


def _geometry(geometry) -> Iterator[Line]:
    yield 'contact ratio', f'{geometry.contact_ratio:.4f}'
    yield 'centre distance', f'{geometry.distance_mm:.6g} mm'
    yield 'working angle', f'{geometry.working_angle_deg[0]:.5g} deg'


def _motion(motion) -> Iterator[Line]:
    yield 'load', f'{motion.load_n:.5g} N'
    yield 'mean mesh stiffness', f'{motion.stiffness_n_um:.4g} N/um'
    yield 'natural frequency', f'{motion.frequency_hz:.5g} Hz'


def _mesh(mesh) -> Iterator[Line]:
    for relief in np.unique(mesh.relief_um)[:MOST]:
        ste = mesh.ste_um[mesh.relief_um == relief]
        yield f'STE at {relief:g} um', f'{np.ptp(ste):.4g} um peak-to-peak'
    yield 'largest share', f'{mesh.share.max():.4f}'


def _harmonics(harmonics) -> Iterator[Line]:
    yield 'peak-to-peak', f'{_list(harmonics.peak_to_peak_um, 4)} um at {_list(harmonics.relief_um)} um of relief'


def _load(load) -> Iterator[Line]:
    if np.isfinite(load.pair_load_n).any():
        at = int(np.nanargmax(load.pair_load_n))
        yield 'largest', f'{load.pair_load_n[at]:.5g} N at {load.rpm[at]:g} rpm, relief {load.relief_um[at]:g} um'
    failed = int(np.isnan(load.pair_load_n).sum())
    if failed:
        yield 'without an answer', f'{failed} points'


def _static(static) -> Iterator[Line]:
    yield 'largest tension', f'{_list(static.tension_mpa, 5)} MPa at {_list(static.relief_um)} um of relief'
    yield 'ISO 6336-3', f'{static.iso_mpa:.5g} MPa'


def _modal(modal) -> Iterator[Line]:
    yield 'natural frequencies', f'{_list(modal.frequency_hz, 5)} Hz'


def _hysteresis(found) -> Iterator[Line]:
    changes = [f'{name} at {rpm:.6g} rpm' for name, rpm in zip(found.change_name, found.change_rpm[:, 0])]
    yield 'changes', ', '.join(changes[:MOST]) + (' ...' if len(changes) > MOST else '') if changes else 'none'


def _stability(found) -> Iterator[Line]:
    yield 'unstable', f'{int((found.modulus > 1).sum())} of {found.modulus.size} points'


_TELL = {
    'Geometry': _geometry,
    'Harmonics': _harmonics,
    'Hysteresis': _hysteresis,
    'Load': _load,
    'Mesh': _mesh,
    'Modal': _modal,
    'Motion': _motion,
    'Optimum': _optimum,
    'StabilityMap': _stability,
    'Static': _static,
    'Sweep': _sweep,
}
