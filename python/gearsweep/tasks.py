"""One function for each task, and `run` for all that a case asks for.

`work` is what `prepare` gives: the pair stiffness, the costly part of most cases. It serves all cases with
the same gears, material, section and load. `threads` is for sweeps; 0 takes all, and the answer is the same
for any number. Any number of threads may call at once; a call does not hold Python's lock.
"""

from __future__ import annotations

import dataclasses
import os
import warnings
from collections.abc import Callable
from typing import Any

import numpy as np

from . import _border, results
from ._border import Code, Error
from ._watch import bar
from .case import Case

_VERSION = _border.version()
_MESH_TASKS = ('mesh', 'static', 'load', 'sweep', 'optimum')


def run(
    case: Case,
    *,
    threads: int = 0,
    work: np.ndarray | None = None,
    progress: Callable[[int, int], object] | bool = False,
    keep: str | os.PathLike = '',
    resume: str | os.PathLike = '',
) -> results.Study:
    """Everything that the case asks for.

    Parameters
    ----------
    case : Case
        What to compute.
    threads : int
        For the sweep; 0: all.
    work : array, optional
        From `prepare`.
    progress : callable or bool
        Called now and then with the number of operating points that are done, and of all. True shows a bar on
        stderr, by tqdm where it is installed. An exception that it raises ends the run and comes out.
    keep : path, optional
        File that is written where the run is interrupted, by Ctrl-C or by `progress`, with what is done by then.
    resume : path, optional
        Such a file: the run goes on from there, to the same bits as if it had not been interrupted. One of another
        case or version is refused. Interrupted again, it is written anew, unless `keep` names another file.

    Returns
    -------
    Study

    Raises
    ------
    Error
        The case is not usable, a file is missing, or a method failed. Operating points without an answer are
        no error: they are NaN, and a `PartialWarning` tells how many. An `UnusedWarning` names keys that none of
        the case's tasks uses.

    Examples
    --------
    >>> import gearsweep
    >>> case = gearsweep.Case('''&case tasks = 'mesh', 'modal' / &pair module_mm = 3 face_width_mm = 20 /
    ...     &pinion teeth = 21 / &gear teeth = 34 / &load torque_nm = 100 / &section elements_across = 4 /''')
    >>> study = gearsweep.run(case)
    >>> study.modal.frequency_hz.shape, study.sweep
    ((10,), None)
    >>> study
    <gearsweep.Study
      geometry:  contact ratio 1.6248; centre distance 82.5 mm; working angle 20 deg
      motion:    load 3378.3 N; mean mesh stiffness 456.4 N/um; natural frequency 7591.3 Hz
      mesh:      STE at 0 um 4.751 um peak-to-peak; largest share 1.0000
      harmonics: peak-to-peak 4.751 um at 0 um of relief
      modal:     natural frequencies 63... Hz>
    """
    _check(case)
    if case.unused:
        keys = ''.join(f'\n  for {line}' for line in case.unused)
        warnings.warn(f'keys that no task of this case uses:{keys}', _border.UnusedWarning, stacklevel=2)
    return study(case, _numbers(case, case.text, case.folder, threads, work, progress, keep, resume))


def _numbers(case: Case, text: str, folder: str, threads: int, work, progress=False, keep='', resume='') -> dict[str, dict]:
    """The numbers of the tasks in `text`, a text of this case; in pieces that Ctrl-C ends."""
    resume, keep = os.fspath(resume), os.fspath(keep or resume)
    shown = bar() if progress is True else progress or None
    try:
        numbers, *_, error = _border.run(
            text, folder, _given(work), threads, room(case), progress=shown, resume=resume, keep=keep
        )
    finally:
        if progress is True:
            shown.close()
    if error is not None and error.code == Code.INTERRUPTED and error.__cause__ is not None:
        raise error.__cause__
    if error is not None and error.code != Code.PARTIAL:
        raise error
    if error is not None:
        warnings.warn(str(error), _border.PartialWarning, stacklevel=3)
    return numbers


def room(case: Case) -> int:
    """Enough for all numbers of a case, unless it follows loads over many steps."""
    n = _sizes(case)
    per_relief = n['rows'] + n['reliefs'] * (n['harmonics'] + n['positions'] + n['speeds'] + 1)
    return 100_000 + 20 * (per_relief + n['tried'] + n['elements'] + n['nodes']) + 2 * n['nodes'] * n['modes']


def study(case: Case, numbers: dict[str, dict]) -> results.Study:
    """The results that hold these numbers, and the geometry."""
    found = {name: _result(getattr(results, name.capitalize()), case, values) for name, values in numbers.items()}
    if case.get('mesh', 'contact_ratio') is None:
        found['geometry'] = geometry(case)
    return results.Study(case, _VERSION, **found)


def _result(kind: type, case: Case, values: dict) -> Any:
    if 'element' in values:
        values['element'] = np.ascontiguousarray(values['element'].T) - 1
    whole = [field.name for field in dataclasses.fields(kind) if field.type == 'Integers']
    return kind(case, _VERSION, **values | {name: values[name].astype(np.int32) for name in whole})


def report(case: Case, *, threads: int = 0, work: np.ndarray | None = None) -> str:
    """The whole answer as text, as the program prints it."""
    _check(case)
    return _border.report(case.text, case.folder, _given(work), threads)


def prepare(case: Case) -> np.ndarray:
    """The pair stiffness, by finite elements where the case says so, as `work` for the other functions.

    It serves all cases that differ in reliefs, speeds, masses, damping, friction, backlash or tasks; another
    case is refused.
    """
    case = _with_mesh(case)
    return _border.prepare(case.text, case.folder, _sizes(case)['nwork'])


def geometry(case: Case) -> results.Geometry:
    """Radii, path of contact and outlines of the pair.

    Examples
    --------
    >>> import gearsweep
    >>> geometry = gearsweep.geometry(gearsweep.Case('''&pair module_mm = 3 face_width_mm = 20 /
    ...     &pinion teeth = 21 / &gear teeth = 34 /'''))
    >>> geometry.distance_mm, round(geometry.contact_ratio, 3)
    (82.5, 1.625)
    """
    text = _naming(case, 'geometry').text
    outlines = [_border.outline(text, member) for member in (1, 2)]
    return results.Geometry(case, _VERSION, *_border.geometry(text), *outlines)


def motion(case: Case, *, work: np.ndarray | None = None) -> results.Motion:
    """Load, masses, mean mesh stiffness and natural frequency."""
    text, work = _with_mesh(case).text, _ready(case, work)
    return results.Motion(case, _VERSION, *_border.motion(text, work))


def mesh(case: Case, *, work: np.ndarray | None = None) -> results.Mesh:
    """Stiffness, load sharing and static transmission error of one pair along the path of contact."""
    named, work = _naming(case, 'mesh'), _ready(case, work)
    return results.Mesh(case, _VERSION, *_border.mesh(named.text, work, _sizes(named)['rows']))


def harmonics(case: Case, *, work: np.ndarray | None = None) -> results.Harmonics:
    """Harmonics of the static transmission error."""
    named, work = _naming(case, 'mesh'), _ready(case, work)
    n = _sizes(named)
    found = _border.harmonics(named.text, work, n['harmonics'], n['reliefs'])
    return results.Harmonics(case, _VERSION, np.arange(1, n['harmonics'] + 1, dtype=np.int32), *found)


def static(case: Case, *, work: np.ndarray | None = None) -> results.Static:
    """Root stress of one member while the load moves over the path."""
    named, work = _naming(case, 'static'), _ready(case, work)
    n = _sizes(named)
    return results.Static(case, _VERSION, *_border.root(named.text, work, n['positions'], n['reliefs']))


def stress(case: Case, position: int, relief: int = 0, *, work: np.ndarray | None = None) -> results.Stress:
    """Stress all over the section, for a picture, with the load at one of the positions of `static`.

    Parameters
    ----------
    case : Case
        What to compute.
    position, relief : int
        Which position of the load and which relief, counted from 0.
    work : array, optional
        From `prepare`.
    """
    named, work = _naming(case, 'static'), _ready(case, work)
    named = _naming(named, 'section')
    n = _sizes(named)
    grid = _border.section(named.text, n['nodes'], n['elements'])
    return results.Stress(case, _VERSION, *grid, *_border.stress(named.text, work, position, relief, n['nodes']))


def load(case: Case, *, work: np.ndarray | None = None) -> results.Load:
    """Dynamic load of one pair along its path, at the speeds `load_rpm`."""
    named, work = _naming(case, 'load'), _ready(case, work)
    return results.Load(case, _VERSION, *_border.load(named.text, work))


def sweep(
    case: Case,
    *,
    threads: int = 0,
    work: np.ndarray | None = None,
    progress: Callable[[int, int], object] | bool = False,
) -> results.Sweep:
    """Dynamic factor over speed and relief; `progress` as in `run`."""
    return _result(results.Sweep, case, _alone(case, 'sweep', threads, work, progress))


def optimum(
    case: Case,
    *,
    threads: int = 0,
    work: np.ndarray | None = None,
    progress: Callable[[int, int], object] | bool = False,
) -> results.Optimum:
    """The relief whose largest dynamic factor over all speeds is least; `progress` as in `run`."""
    return _result(results.Optimum, case, _alone(case, 'optimum', threads, work, progress))


def _alone(case: Case, task: str, threads: int, work: np.ndarray | None, progress) -> dict:
    """The numbers of one task, whatever else the case names."""
    _check(case)
    alone = case.changed(case={'tasks': task, 'published': None})
    return _numbers(alone, alone.text, alone.folder, threads, work, progress)[task]


def section(case: Case) -> results.Section:
    """Finite-element grid of a section of one member."""
    named = _naming(case, 'section')
    n = _sizes(named)
    return results.Section(case, _VERSION, *_border.section(named.text, n['nodes'], n['elements']))


def modal(case: Case) -> results.Modal:
    """Natural frequencies and mode shapes of the section."""
    named = _naming(_naming(case, 'modal'), 'section')
    n = _sizes(named)
    grid = _border.section(named.text, n['nodes'], n['elements'])
    return results.Modal(case, _VERSION, *grid, *_border.modes(named.text, n['modes'], n['nodes']))


def _check(case: Case) -> None:
    if not isinstance(case, Case):
        raise TypeError(f'case: must be a gearsweep.Case, not {type(case).__name__}')


def _naming(case: Case, task: str) -> Case:
    """The case with this task among its own, or alone where it lacks what its own need."""
    _check(case)
    try:
        tasks = case.tasks
    except Error:
        tasks = ()
    return case if task in tasks else case.changed(case={'tasks': (*tasks, task)})


def _with_mesh(case: Case) -> Case:
    """The case with at least one task that needs the mesh."""
    _check(case)
    try:
        named = not set(_MESH_TASKS).isdisjoint(case.tasks)
    except Error:
        named = False
    return case if named else _naming(case, 'mesh')


def _sizes(case: Case) -> dict[str, int]:
    return _border.sizes(case.text, case.folder)


def _given(work: np.ndarray | None) -> np.ndarray:
    return _border.NO_WORK if work is None else work


def _ready(case: Case, work: np.ndarray | None) -> np.ndarray:
    """The stiffness, prepared where it is not given: what reads the case's files."""
    return prepare(case) if work is None else work
