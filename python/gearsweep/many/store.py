"""The store: one Zarr group with an array for each input and output, written block by block, the statuses of a block last.

A block is a chunk of each array and a file of its own, which Zarr replaces as a whole: what a status calls done is done. Several
processes may write different blocks.
"""

from __future__ import annotations

import builtins
import contextlib
import json
import os
import platform
import re
import shutil
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._library import Code, Error
from .outputs import Output, Reduce, Taken
from .plan import Begun, Plan, mark_of
from .rows import Block
from .status import ANSWERED, Status

Reals = NDArray[np.float64]
FORMAT = 1
#: Bytes of a message.
_LETTERS = 512
#: So many blocks are read at once, as one by one takes several times longer.
_TOGETHER = 64
STATUS, MESSAGE, VARIANT = 'status', 'message', 'variant'


class Damaged(Error):
    """Values of a store cannot be read."""

    def __init__(self, path: str, name: str):
        super().__init__(f'cannot read {path}: values of {name} are damaged or missing; the same run computes them again', Code.FILE)


class Store:
    """What a run writes into and goes on from.

    Attributes
    ----------
    group : zarr.Group
    path : str
        Empty: in memory.
    """

    def __init__(self, group: Any, path: str):
        self.group, self.path = group, path
        self.size, self.n = int(self.about['size']), int(self.about['n'])

    about = property(lambda self: self.group.attrs['gearsweep'])

    @property
    def taken(self) -> Taken:
        """What the store takes of each variant."""
        about = self.about
        outputs = [[Output(one['name'], tuple(one['dims']), tuple(one['shape']), one['unit'], one['meaning']) for one in about[what]]
                   for what in ('columns', 'reduced')]  # fmt: skip
        coordinates = {name: (one['table'], self.along(name), one['unit']) for name, one in about['coordinates'].items()}
        return Taken(tuple(outputs[0]), tuple(outputs[1]), coordinates)

    def along(self, dim: str) -> NDArray[Any]:
        """The values of an index column; words stand in the attributes, as Zarr has no lasting form for them."""
        words = self.about['coordinates'][dim]['words']
        return self.values(dim) if words is None else np.array(words)

    def outputs(self) -> list[dict[str, Any]]:
        """What is told of each column and of each number of `reduce`."""
        return [*self.about['columns'], *self.about['reduced']]

    def blocks(self, part: tuple[int, int]) -> Iterator[tuple[int, int]]:
        """First variant and the one behind the last of each block, of part k of m."""
        for at in range(part[0] - 1, -(-self.n // self.size), part[1]):
            yield at * self.size, min((at + 1) * self.size, self.n)

    def status(self) -> NDArray[np.int8]:
        return self.values(STATUS)

    def values(self, name: str, key: Any = slice(None)) -> NDArray[Any]:
        """Values of an array.

        Raises
        ------
        Damaged
            They cannot be read, or are not there although the status of their variants says so.
        """
        try:
            found = self.group[name].oindex[key]
        except OSError as error:
            raise Error(f'cannot read {self.path}: {name}: {error.strerror or error}', Code.FILE) from error
        except Exception as error:  # of whichever codec
            raise Damaged(self.path, name) from error
        if self.path and name not in (STATUS, MESSAGE) and name not in self.about['coordinates']:
            rows = np.arange(self.n)[key[0] if isinstance(key, tuple) else key]
            for block in np.unique(rows // self.size):
                self._check_there(name, int(block))
        return found

    def _check_there(self, name: str, block: int) -> None:
        """Statuses come last, so that of a variant with numbers all chunks are there; else Zarr would give NaN."""
        array = self.group[name]
        file = os.path.join(self.path, name, array.metadata.encode_chunk_key((block, *[0] * (array.ndim - 1))))
        if os.path.exists(file):
            return
        status = self.values(STATUS, slice(block * self.size, (block + 1) * self.size))
        if np.isin(status, ANSWERED).any() and not os.path.exists(file):
            raise Damaged(self.path, name)

    def usable(self) -> NDArray[np.int8]:
        """The statuses; pending where something of a block is damaged."""
        names = (*self.about['names'], *(one['name'] for one in self.outputs()), MESSAGE)
        found = np.zeros(self.n, np.int8)

        def look(first: int, stop: int) -> None:
            rows = slice(first, stop)
            try:
                status = self.values(STATUS, rows)
                if self.path and status.any():
                    for name in names:
                        self.values(name, rows)
            except Damaged:
                blocks = -(-(stop - first) // self.size)
                if blocks > 1:
                    middle = first + blocks // 2 * self.size
                    look(first, middle)
                    look(middle, stop)
            else:
                found[rows] = status

        span = _TOGETHER * self.size
        for first in range(0, self.n, span):
            look(first, min(first + span, self.n))
        return found

    def put(self, first: int, values: Reals, block: Block) -> None:
        """Writes a whole block.

        Raises
        ------
        Error
            It cannot be written, as where the disk is full; what was there before is as it was.
        """
        import zarr

        stop = first + len(values)
        try:
            with zarr.config.set({'array.write_empty_chunks': True}):  # what is not there is damage
                self._put(first, stop, values, block)
        except OSError as error:
            raise Error(f'cannot write {self.path}: {error.strerror or error}', Code.FILE) from error

    def _put(self, first: int, stop: int, values: Reals, block: Block) -> None:
        for at, name in enumerate(self.about['names']):
            self.group[name][first:stop] = values[:, at]
        for name, column in block.columns.items():
            self.group[name][first:stop] = column
        if any(block.messages):
            self.group[MESSAGE][first:stop] = _letters(block.messages)
        self.group[STATUS][first:stop] = block.status

    @contextlib.contextmanager
    def held(self, part: tuple[int, int]) -> Iterator[None]:
        """Keeps other runs of the whole from computing the same; those of parts may be several.

        Raises
        ------
        Error
            Another process does.
        """
        if not self.path or os.name != 'posix':
            yield
            return
        import fcntl

        how = fcntl.LOCK_EX if part == (1, 1) else fcntl.LOCK_SH
        with contextlib.ExitStack() as stack:
            try:
                file = stack.enter_context(builtins.open(os.path.join(self.path, 'zarr.json'), 'r+'))
            except OSError as error:
                raise Error(f'cannot write {self.path}: {error.strerror}', Code.FILE) from error
            try:
                fcntl.flock(file, how | fcntl.LOCK_NB)
            except BlockingIOError as error:
                raise Error(f'{self.path}: another run writes into it', Code.FILE) from error
            except OSError:  # a file system without locks
                pass
            yield


def _letters(messages: list[str]) -> NDArray[np.uint8]:
    found = np.zeros((len(messages), _LETTERS), np.uint8)
    for at, message in enumerate(messages):
        words = np.frombuffer(message.encode('utf-8', 'replace')[:_LETTERS], np.uint8)
        found[at, : len(words)] = words
    return found


def message(letters: NDArray[np.uint8]) -> str:
    return letters.tobytes().rstrip(b'\0').decode('utf-8', 'replace')


def read(path: str | os.PathLike) -> Store:
    """Opens a store that is there.

    Raises
    ------
    Error
        There is none, or it is none of ours.
    """
    import zarr

    path = os.fspath(path)
    try:
        group: Any = zarr.open_group(path, mode='r+')
        if group.attrs['gearsweep']['format'] != FORMAT:
            raise Error(f'cannot read {path}: its format is not known to this version', Code.FILE)
        about = group.attrs['gearsweep']
    except PermissionError as error:
        raise Error(f'cannot read {path}: {error.strerror}', Code.FILE) from error
    except (OSError, KeyError, TypeError, ValueError) as error:
        reason = 'No such file or directory' if not os.path.exists(path) else 'is no store of gearsweep.many, or its zarr.json is damaged'
        raise Error(f'cannot read {path}: {reason}', Code.FILE) from error
    name = 'zarr.json'
    try:
        kept = Store(group, path)
        shapes = dict.fromkeys((*about['names'], STATUS), (kept.n,)) | {one['name']: (kept.n, *one['shape']) for one in kept.outputs()}
        if kept.size < 1 or kept.n < 1 or not {'kind', 'seed', 'version', 'case'} <= {*about['plan']}:
            raise ValueError
        for name, shape in (shapes | {MESSAGE: (kept.n, _LETTERS)}).items():
            if group[name].shape != shape:
                raise ValueError
        for name in about['coordinates']:
            values = kept.along(name)
            if values.dtype.kind == 'f' and np.isnan(values).all():
                raise ValueError
    except (OSError, KeyError, TypeError, ValueError, AttributeError, Damaged) as error:
        why = error.strerror if isinstance(error, OSError) and error.strerror else 'is damaged or missing'
        raise Error(f'cannot read {path}: {name} {why}; where it is moved away, the same run makes a new store', Code.FILE) from error
    return kept


def check(store: Store, begun: Begun, take: list[str], reduce: Reduce | None) -> None:
    """Raises an `Error` where the store is of another plan, version or kernel, or has other columns or numbers of another `reduce`."""
    about = store.about
    if about['mark'] != mark_of(begun.told):
        here, there = json.loads(json.dumps(begun.told)), about['plan']
        off = [f'{name} is {_short(there.get(name))}, here {_short(here[name])}' for name in here if there.get(name) != here[name]]
        hint = '; set OPENBLAS_CORETYPE' if there.get('OpenBLAS kernel') != here['OpenBLAS kernel'] else ''
        raise Error(f'{store.path}: is of another plan: {"; ".join(off)}{hint}', Code.FILE)
    names = [one['name'] for one in about['columns']]
    if names != take:
        raise Error(f'{store.path}: has the columns {", ".join(names) or "none"}; take asks for {", ".join(take) or "none"}', Code.FILE)
    there = about.get('reduce', 'one of an earlier version' if about['reduced'] else 'None')
    if there != _name(reduce):
        raise Error(f'{store.path}: was begun with reduce = {there}, here {_name(reduce)}', Code.FILE)


def _name(reduce: Any) -> str:
    """The name of a function by which it is known again; of one with some arguments given (`functools.partial`), without these."""
    one = getattr(reduce, 'func', reduce)
    return 'None' if one is None else f'{one.__module__}.{getattr(one, "__qualname__", type(one).__name__)}'


def _short(value: Any) -> str:
    said = value if isinstance(value, str) else json.dumps(value)
    return said if len(said) <= 60 else 'another'


def make(path: str | os.PathLike | None, begun: Begun, taken: Taken, size: int, reduce: Reduce | None) -> Store:
    """Makes a store under another name, which it gets when it is complete; in memory without a path.

    Raises
    ------
    Error
        It cannot be written.
    """
    import zarr
    from zarr.storage import MemoryStore

    if path is None:
        return Store(_filled(zarr.create_group(MemoryStore()), begun, taken, size, reduce), '')
    path = os.fspath(path)
    new = f'{path.rstrip("/")}.{platform.node()}-{os.getpid()}.new'
    try:
        _filled(zarr.create_group(new, overwrite=True), begun, taken, size, reduce)
        try:
            os.rename(new, path)
        except OSError:
            if not os.path.isdir(path):
                raise
            # Another part was faster.
        return read(path)
    except OSError as error:
        raise Error(f'cannot write {path}: {error.strerror or error}', Code.FILE) from error
    finally:
        shutil.rmtree(new, ignore_errors=True)


def _filled(group: Any, begun: Begun, taken: Taken, size: int, reduce: Reduce | None) -> Any:
    """The group with its arrays, which have no values yet."""
    import scipy

    def add(name: str, shape: tuple[int, ...], kind: str, dims: tuple[str, ...], fill: float, **attributes: Any) -> Any:
        if not _can_be_named(name):
            raise Error(f'reduce: {name!r}: cannot name an array of a store; a name is a word without / and \\, and does not begin with . or __')
        if name in group or name == VARIANT:
            raise Error(f'{name}: is the name of something else in a store; reduce must give it another, or take leave it out')
        chunks = (min(size, shape[0]), *shape[1:]) if dims[0] == VARIANT else shape
        array = group.create_array(name, shape=shape, chunks=chunks, dtype=kind, fill_value=fill, dimension_names=dims)
        array.attrs.update(attributes)
        return array

    plan: Plan = begun.plan
    n = plan.n
    words = {name: values.tolist() if values.dtype.kind == 'U' else None for name, (_, values, _) in taken.coordinates.items()}
    for name, (_, values, _) in taken.coordinates.items():
        if words[name] is not None:
            continue
        add(name, values.shape, 'float64', (name,), np.nan)[:] = values
    units = {f'{one["group"]}.{one["name"]}': one for one in _declared()}
    for one in plan.inputs:
        add(one.name, (n,), 'float64', (VARIANT,), np.nan, units=units[one.name]['unit'], long_name=units[one.name]['meaning'])
    points = {'points': plan.kind, 'scrambles': plan.scrambles, 'inputs': list(plan.names)}
    for out in (*taken.columns, *taken.reduced):
        add(out.name, (n, *out.shape), 'float64', (VARIANT, *out.dims), np.nan, units=out.unit, long_name=out.meaning, **points)
    add(MESSAGE, (n, _LETTERS), 'uint8', (VARIANT, 'letter'), 0)
    add(STATUS, (n,), 'int8', (VARIANT,), 0, flag_values=[int(one) for one in Status],
        flag_meanings=' '.join(one.name.lower() for one in Status))  # fmt: skip
    group.attrs['gearsweep'] = {
        'format': FORMAT, 'mark': mark_of(begun.told), 'plan': begun.told, 'n': int(n), 'size': size, 'folder': plan.base.folder,
        'names': list(plan.names), 'reduce': _name(reduce),
        'keys': [{'group': key.group, 'key': key.key, 'whole': key.whole, 'choices': key.choices} for key in plan.keys],
        'columns': [_told(one) for one in taken.columns], 'reduced': [_told(one) for one in taken.reduced],
        'coordinates': {name: {'table': table, 'words': words[name], 'unit': unit} for name, (table, _, unit) in taken.coordinates.items()},
        'host': platform.platform(), 'numpy': np.__version__, 'scipy': scipy.__version__,
    }  # fmt: skip
    return group


def _can_be_named(name: Any) -> bool:
    """Does a folder of the store take this name, and Zarr too?"""
    return isinstance(name, str) and name.isprintable() and not re.search(r'^$|^\.|^__|^zarr\.json$|[/\\]', name)


def _declared() -> list[dict[str, Any]]:
    from .._library import declared

    return declared()['keys']


def _told(one: Output) -> dict[str, Any]:
    return {'name': one.name, 'dims': one.dims, 'shape': one.shape, 'unit': one.unit, 'meaning': one.meaning}
