"""A plan: the values of keys of a case in each variant."""

from __future__ import annotations

import functools
import hashlib
import json
import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from ..core import library
from ..core.assignments import assignments
from ..core.case import Case
from ..core.files import content
from ..core.library import Code, Error, declared, kernel
from . import points
from .inputs import Input, case_with, described, input_of, inputs_of

Reals = NDArray[np.float64]


@dataclass(frozen=True, eq=False, repr=False)
class Plan:
    """Variants of a case: each has other values of some of its keys.

    It is made by `sobol`, `random`, `lhs`, `saltelli`, `grid` or `table`. Groups of keys are written as for `Case.changed`; a value is a
    distribution of `scipy.stats` with its numbers (anything that has `ppf`), or a list, whose values are equally likely.

    Attributes
    ----------
    base : Case
        Case with the values of keys that are not varied.
    kind : str
    inputs : tuple of Input
    n : int
        Number of variants.
    seed : int
    scrambles : int
        Independent sets of Sobol' points among the variants, for the error of what is computed of them; 0: another kind of points.

    Examples
    --------
    >>> import gearsweep
    >>> from gearsweep import many
    >>> from scipy.stats import norm, randint
    >>> case = gearsweep.Case('&pair module_mm = 3  face_width_mm = 20 / &pinion teeth = 21 / &gear teeth = 34 /')
    >>> plan = many.Plan.random(case, n=1000, seed=1, gear={'teeth': randint(30, 40)}, load={'torque_nm': norm(100, 5)})
    >>> plan.names
    ('gear.teeth', 'load.torque_nm')
    >>> plan
    <gearsweep.many.Plan random: 1000 variants, seed 1
      gear.teeth      randint(30, 40)
      load.torque_nm  norm(100, 5)>
    >>> bool((plan.rows(0, 1000)[400:500] == plan.rows(400, 500)).all())
    True
    """

    base: Case
    kind: str
    inputs: tuple[Input, ...]
    n: int
    seed: int = 0
    scrambles: int = 0
    values: Reals | None = None

    #: `functions.function`, which runs plans: the front of this room sets it.
    function: ClassVar[Callable[..., Callable[[Reals], Reals]]]

    def __post_init__(self):
        if not isinstance(self.base, Case):
            raise TypeError(f'case: must be a gearsweep.Case, not {type(self.base).__name__}')
        names = [one.name for one in self.inputs]
        for name in names:
            if names.count(name) > 1:
                raise Error(f'{name}: is varied twice')
        for name, low in (('n', 1), ('seed', 0)):
            value = getattr(self, name)
            if isinstance(value, bool) or not isinstance(value, (int, np.integer)) or value < low:
                raise Error(f'{name} = {value!r}: must be a whole number of at least {low}')
        try:  # a run has a status of each variant, and a Latin hypercube is stored completely
            np.empty(self.n, np.int8) if self.kind != 'lhs' else np.empty((self.n, len(self.inputs)))
        except (ValueError, MemoryError) as error:
            raise Error(f'n: {self.n} variants do not fit into memory', Code.MEMORY) from error

    @classmethod
    def sobol(cls, case: Case, /, n: int, seed: int = 0, *, scrambles: int = 8, **groups: Mapping[str, Any]) -> Plan:
        """Sobol' points: means and quantiles converge faster than with independent points.

        Parameters
        ----------
        case : Case
        n : int
            Number of variants: `scrambles` times a power of 2.
        seed : int
            The same seed has the same points.
        scrambles : int
            Independent sets of n / scrambles points each, whose scatter gives the bands of `quantiles`; at least 4.
        **groups
            Keys with their distributions or lists.
        """
        _check_scrambles(n, scrambles)
        return cls(case, 'sobol', inputs_of(groups), n, seed, scrambles)

    @classmethod
    def random(cls, case: Case, /, n: int, seed: int = 0, **groups: Mapping[str, Any]) -> Plan:
        """Returns a plan of independent points."""
        return cls(case, 'random', inputs_of(groups), n, seed)

    @classmethod
    def lhs(cls, case: Case, /, n: int, seed: int = 0, **groups: Mapping[str, Any]) -> Plan:
        """Returns a Latin hypercube: for each key one value in each of n equally likely intervals."""
        return cls(case, 'lhs', inputs_of(groups), n, seed)

    @classmethod
    def saltelli(cls, case: Case, /, n: int, seed: int = 0, **groups: Mapping[str, Any]) -> Plan:
        """Returns a plan for `sensitivity`: n base points, a power of 2, each with as many rows as there are keys, and two
        more.

        The plan has n (d + 2) variants for d keys, in SALib's order without second order.
        """
        if not isinstance(n, (int, np.integer)) or n < 2 or n & (n - 1):
            raise Error(f'n = {n!r}: must be a power of 2 of at least 2')
        inputs = inputs_of(groups)
        return cls(case, 'saltelli', inputs, n * (len(inputs) + 2), seed)

    @classmethod
    def grid(cls, case: Case, /, **groups: Mapping[str, Sequence[Any]]) -> Plan:
        """Returns all combinations of lists; the key that is named last changes fastest.

        Name keys first that need a new stiffness (teeth, load, centre distance, face width): what neighbours share is computed once.
        """
        inputs = inputs_of(groups, only_lists=True)
        return cls(case, 'grid', inputs, int(np.prod([len(one.distribution) for one in inputs], dtype=object)))

    @classmethod
    def table(cls, case: Case, frame: Mapping[str, Sequence[Any]]) -> Plan:
        """Builds a plan from the rows of a table, such as a pandas DataFrame, whose columns are named 'group.key'."""
        columns = {str(name): list(frame[name]) for name in frame}
        lengths = {len(column) for column in columns.values()}
        if len(lengths) != 1 or lengths == {0}:
            raise Error('table: its columns must have the same number of rows, and at least one')
        inputs, values = [], []
        for name, column in columns.items():
            group, dot, key = name.partition('.')
            if not dot:
                raise Error(f"table: column {name}: must be called 'group.key', such as 'load.torque_nm'")
            numbers = all(isinstance(one, (int, float, np.number)) and not isinstance(one, bool) for one in column)
            one = input_of(group, key, column if numbers else list(dict.fromkeys(map(_fixed, column))))
            at = np.arange(len(column)) if numbers else np.array([one.distribution.index(_fixed(word)) for word in column])
            inputs.append(one)
            values.append(one.at(at))
        # For numbers the table has the values themselves.
        inputs = [Input(one.key, ()) if one.key.choices is None else one for one in inputs]
        return cls(case, 'table', tuple(inputs), lengths.pop(), values=np.column_stack(values))

    names = property(lambda self: tuple(one.name for one in self.inputs))
    keys = property(lambda self: tuple(one.key for one in self.inputs))

    def __len__(self) -> int:
        return self.n

    def __repr__(self) -> str:
        more = ''.join(f', {name} {value}' for name, value in (('seed', self.seed), ('scrambles', self.scrambles)) if value)
        wide = max((len(one.name) for one in self.inputs), default=0)
        lines = [f'\n  {one.name:{wide}}  {described(one.description())}' for one in self.inputs]
        return f'<gearsweep.many.Plan {self.kind}: {self.n} variants{more}{"".join(lines)}>'

    def rows(self, first: int = 0, stop: int | None = None) -> Reals:
        """Returns the values of the variants from `first` up to, not including, `stop`: a row each, a column for each of
        `names`.

        They are the same bits for any blocks. For a key with words or lists, a row has the index in its list.
        """
        stop = self.n if stop is None else stop
        if not 0 <= first <= stop <= self.n:
            raise Error(f'rows {first} to {stop}: must be from 0 to {self.n}')
        if self.values is not None:
            return self.values[first:stop].copy()
        if self.kind == 'grid':
            sizes = [len(one.distribution) for one in self.inputs]
            places = np.unravel_index(np.arange(first, stop), sizes)
            return np.column_stack([one.at(place) for one, place in zip(self.inputs, places)])
        u = self._unit(first, stop)
        return np.column_stack([one.values(u[:, at]) for at, one in enumerate(self.inputs)])

    def _unit(self, first: int, stop: int) -> Reals:
        """Returns the points in the unit cube."""
        d = len(self.inputs)
        if self.kind == 'random':
            return points.random(first, stop, d, self.seed)
        if self.kind == 'lhs':
            return points.lhs(self.n, d, self.seed)[first:stop]
        if self.kind == 'saltelli':
            return points.saltelli(self._sobol, first, stop, d)
        return self._sobol(first, stop)

    @functools.cached_property
    def _sobol(self) -> points.Sobol:
        d = len(self.inputs)
        return points.Sobol(2 * d, self.seed, 1) if self.kind == 'saltelli' else points.Sobol(d, self.seed, self.scrambles)

    def __getstate__(self) -> dict[str, Any]:
        return {name: value for name, value in self.__dict__.items() if name != '_sobol'}

    def case(self, i: int) -> Case:
        """Returns the case of a variant."""
        if not 0 <= i < self.n:
            raise Error(f'variant {i}: must be from 0 to {self.n - 1}')
        return case_with(self.base, self.keys, self.rows(i, i + 1)[0])

    def description(self) -> dict[str, Any]:
        """Returns all inputs of the numbers as JSON data. A store keeps them, and a later run compares its own with them."""
        inputs = [one.description() for one in self.inputs]
        if self.values is not None:
            inputs.append({'values': hashlib.sha256(self.values.tobytes()).hexdigest()})
        return {'version': library.version(), 'OpenBLAS kernel': kernel(), 'kind': self.kind, 'n': int(self.n), 'seed': int(self.seed),
                'scrambles': self.scrambles, 'case': self.base.text, 'files': self._files(), 'keys': inputs}  # fmt: skip

    def _files(self) -> dict[str, str]:
        """Returns the files that the case names, each with a digest of its content."""
        found = {}
        for name in self._names:
            path = os.path.join(self.base.folder, name)
            if os.path.isfile(path):
                found[name] = hashlib.sha256(content(path)).hexdigest()
        return found

    @functools.cached_property
    def _names(self) -> list[str]:
        """Returns the texts that may name a file."""
        return sorted({str(one) for keys in self._file_values().values() for one in keys})

    def file_stamps(self) -> list[tuple[int, ...]]:
        """Returns size, times and inode of each file that the case names, which show most changes."""
        found: list[tuple[int, ...]] = []
        for name in self._names:
            try:
                seen = os.stat(os.path.join(self.base.folder, name))
                found.append((seen.st_size, seen.st_mtime_ns, seen.st_ctime_ns, seen.st_ino))
            except (OSError, ValueError):
                found.append(())
        return found

    def _file_values(self) -> dict[str, list[str]]:
        """Returns the values of keys that may name a file, in the case and in the plan."""
        files = {(one['group'], one['name']) for one in declared()['keys'] if one['kind'] == 'text' and 'file' in one['meaning']}
        # Without quotes; a doubled one within the name is one.
        found = {f'{group}.{key}': [words[1:-1].replace(2 * words[0], words[0]) if words[:1] in ('"', "'") else words]
                 for group, keys in assignments(self.base.text).items() for key, words in keys.items() if (group, key) in files}  # fmt: skip
        for one in self.inputs:
            if (one.key.group, one.key.key) in files:
                found[one.name] = [str(word) for word in one.key.choices or ()]
        return found

    def mark(self) -> str:
        """SHA-256 of all data that the numbers depend on: case, files, keys, distributions, kind, n, seed, version, OpenBLAS's
        kernel.
        """
        return digest_of(self.description())


def digest_of(description: dict[str, Any]) -> str:
    """Returns the `Plan.mark` of `Plan.description`."""
    return hashlib.sha256(json.dumps(description, sort_keys=True).encode('utf-8', 'surrogateescape')).hexdigest()


class Snapshot:
    """A plan at the start of a run: its description, with the digests of the files that its case names."""

    def __init__(self, plan: Plan):
        self.plan, self.file_stamps = plan, plan.file_stamps()  # sizes and times first, so that a change before the digests shows
        self.description = plan.description()

    def check(self) -> None:
        """Raises an `Error` if a file has changed."""
        file_stamps = self.plan.file_stamps()
        if file_stamps == self.file_stamps:
            return
        before, now = self.description['files'], self.plan.description()['files']
        for name in sorted({*before, *now}):
            if before.get(name) != now.get(name):
                raise Error(f'{os.path.join(self.plan.base.folder, name)}: was changed during the run; what was computed before is kept, '
                            'and with the file as it was the same call goes on', Code.FILE)  # fmt: skip
        self.file_stamps = file_stamps


def _fixed(word: Any) -> Any:
    return tuple(word) if isinstance(word, list) else word


def _check_scrambles(n: Any, scrambles: Any) -> None:
    if isinstance(scrambles, bool) or not isinstance(scrambles, int) or not points.FEWEST_SCRAMBLES <= scrambles <= 1000:
        raise Error(f'scrambles = {scrambles!r}: must be a whole number from {points.FEWEST_SCRAMBLES} to 1000, as the scatter of fewer gives no band')
    if not isinstance(n, (int, np.integer)) or n < scrambles or n % scrambles or (n // scrambles) & (n // scrambles - 1):
        below = 0
        if isinstance(n, (int, np.integer)) and n > scrambles:
            below = (int(n) // scrambles).bit_length() - 1
        near = f'such as {scrambles << below} or {scrambles << below + 1}'
        raise Error(f'n = {n!r}: must be {scrambles} (scrambles) times a power of 2, {near}')
