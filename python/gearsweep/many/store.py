"""The store: one Zarr group with an array for each input and output, written block by block, the statuses of a block last.

A block is a chunk of each array and a file of its own, which Zarr replaces in one step: a block whose status is finished is
complete. Several processes may write different blocks. Each block has a digest of each of its chunks, which depends on plan, array
and block, so that neither a changed bit nor a foreign chunk is read as values.
"""

from __future__ import annotations

import builtins
import contextlib
import hashlib
import json
import os
import platform
import re
import shutil
import time
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..core.library import Code, Error, declared
from .outputs import Layout, Output, Reduce, qualified_name, reduce_digest
from .plan import Plan, Snapshot, digest_of
from .rows import Block
from .status import Status

Reals = NDArray[np.float64]
FORMAT = 2
#: Bytes of a message.
_LETTERS = 512
#: Number of blocks that are read at once; one by one takes several times longer.
_TOGETHER = 64
STATUS, MESSAGE, VARIANT, DIGEST = 'status', 'message', 'variant', 'digest'
#: Number of attempts to read a block that differs from its digest, and seconds between them, as another process may be writing it.
_READS, _PAUSE = 3, 0.05


class Damaged(Error):
    """Values of a store cannot be read."""

    def __init__(self, path: str, name: str):
        super().__init__(f'cannot read {path}: values of {name} are damaged or missing; the same run computes them again', Code.FILE)


class Store:
    """Storage of a run, from which it can continue.

    Attributes
    ----------
    group : zarr.Group
    path : str
        Empty: in memory.
    """

    def __init__(self, group: Any, path: str):
        self.group, self.path = group, path
        self.size, self.n = int(self.about['size']), int(self.about['n'])
        self._digested: tuple[int, int, NDArray[np.uint64]] = (0, 0, np.empty((0, 0), np.uint64))

    about = property(lambda self: self.group.attrs['gearsweep'])

    @property
    def layout(self) -> Layout:
        """Outputs of each variant in the store."""
        about = self.about
        outputs = [[Output(one['name'], tuple(one['dims']), tuple(one['shape']), one['unit'], one['meaning']) for one in about[what]]
                   for what in ('columns', 'reduced')]  # fmt: skip
        coordinates = {name: (one['table'], self.along(name), one['unit']) for name, one in about['coordinates'].items()}
        return Layout(tuple(outputs[0]), tuple(outputs[1]), coordinates)

    def along(self, dim: str) -> NDArray[Any]:
        """Returns the values of an index column; words are in the attributes, as Zarr has no stable format for them."""
        words = self.about['coordinates'][dim]['words']
        return self.values(dim) if words is None else np.array(words)

    def outputs(self) -> list[dict[str, Any]]:
        """Descriptions of each column and of each number of `reduce`."""
        return [*self.about['columns'], *self.about['reduced']]

    def blocks(self, part: tuple[int, int]) -> Iterator[tuple[int, int]]:
        """Lists the first variant of each block and the one after its last, for part k of m."""
        for at in range(part[0] - 1, -(-self.n // self.size), part[1]):
            yield at * self.size, min((at + 1) * self.size, self.n)

    def status(self) -> NDArray[np.int8]:
        return self.values(STATUS)

    def values(self, name: str, key: Any = slice(None)) -> NDArray[Any]:
        """Reads values of an array.

        Raises
        ------
        Damaged
            They cannot be read, or are missing although the status of their variants is finished.
        """
        if not self.path or name in self.about['coordinates']:
            return self._read(name, key)
        places = key if isinstance(key, tuple) else (key,)
        rows = np.arange(self.n)[places[0]]
        if rows.ndim == 0:
            return self.values(name, (rows[np.newaxis], *places[1:]))[0]
        blocks = np.unique(rows // self.size)
        found: list[NDArray[Any]] = []
        for some in np.split(blocks, np.flatnonzero((np.diff(blocks) != 1) | (np.arange(1, len(blocks)) % _TOGETHER == 0)) + 1) if len(blocks) else ():
            values = self._checked(name, int(some[0]), int(some[-1]) + 1)[np.sort(rows[np.isin(rows // self.size, some)]) - some[0] * self.size]
            for axis in reversed(range(1, len(places))):  # as in Zarr's oindex
                values = values[(slice(None),) * axis + (places[axis],)]
            found.append(values)
        if not found:
            return self._read(name, key)
        return np.concatenate(found)[np.argsort(np.argsort(rows, kind='stable'), kind='stable')]

    def _read(self, name: str, key: Any) -> NDArray[Any]:
        try:
            return self.group[name].oindex[key]
        except OSError as error:
            raise Error(f'cannot read {self.path}: {name}: {error.strerror or error}', Code.FILE) from error
        except Exception as error:  # of any codec
            raise Damaged(self.path, name) from error

    def _checked(self, name: str, first: int, stop: int) -> NDArray[Any]:
        """Reads values of complete blocks and checks their digests; an unfinished block has the array's initial values."""
        for read in range(_READS):
            if read:
                time.sleep(_PAUSE)
            values = self._read(name, slice(first * self.size, min(stop * self.size, self.n)))
            wrong = [at for at in range(first, stop) if _digest(self.about, name, at, self._of_block(values, at - first)) != self._stored_digest(name, at, first, stop, anew=read > 0)]
            if name == STATUS:
                wrong = [at for at in wrong if self._of_block(values, at - first).any()]
            elif wrong:
                pending = [at for at in wrong if not self._read(STATUS, slice(at * self.size, min((at + 1) * self.size, self.n))).any()]
                for at in pending:
                    self._of_block(values, at - first)[:] = self.group[name].fill_value
                wrong = [at for at in wrong if at not in pending]
            if not wrong:
                return values
        raise Damaged(self.path, name)

    def _of_block(self, values: NDArray[Any], at: int) -> NDArray[Any]:
        return values[at * self.size : (at + 1) * self.size]

    def _stored_digest(self, name: str, at: int, first: int, stop: int, anew: bool) -> int:
        """Returns the stored digest of a chunk; the digests of the same blocks are read once for all arrays."""
        if anew or self._digested[:2] != (first, stop):
            self._digested = first, stop, self._read(DIGEST, slice(first, stop))
        return int(self._digested[2][at - first, self.arrays().index(name)])

    def arrays(self) -> list[str]:
        """Names of all arrays with values of each variant, in the order of the digests."""
        return [*self.about['names'], *(one['name'] for one in self.outputs()), MESSAGE, STATUS]

    def usable(self) -> NDArray[np.int8]:
        """Returns the statuses; pending if a part of a block is damaged."""
        names = [name for name in self.arrays() if name != STATUS]
        found = np.zeros(self.n, np.int8)

        def visit(first: int, stop: int) -> None:
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
                    visit(first, middle)
                    visit(middle, stop)
            else:
                found[rows] = status

        span = _TOGETHER * self.size
        for first in range(0, self.n, span):
            visit(first, min(first + span, self.n))
        return found

    def put(self, first: int, values: Reals, block: Block) -> None:
        """Writes a complete block.

        Raises
        ------
        Error
            It cannot be written, for example because the disk is full; the earlier values remain.
        """
        import zarr

        stop = first + len(values)
        try:
            with zarr.config.set({'array.write_empty_chunks': True}):  # a missing file counts as damage
                self._put(first, stop, values, block)
        except OSError as error:
            raise Error(f'cannot write {self.path}: {error.strerror or error}', Code.FILE) from error

    def _put(self, first: int, stop: int, values: Reals, block: Block) -> None:
        at = first // self.size
        self._clear(at)
        chunks: dict[str, NDArray[Any]] = {name: values[:, one] for one, name in enumerate(self.about['names'])}
        chunks |= {name: np.asarray(column, float) for name, column in block.columns.items()}
        chunks |= {MESSAGE: _letters(block.messages), STATUS: np.asarray(block.status, np.int8)}
        for name, chunk in chunks.items():
            if name not in (MESSAGE, STATUS):
                self.group[name][first:stop] = chunk
        if any(block.messages):
            self.group[MESSAGE][first:stop] = chunks[MESSAGE]
        self.group[DIGEST][at : at + 1] = np.array([[_digest(self.about, name, at, chunks[name]) for name in self.arrays()]], np.uint64)
        self.group[STATUS][first:stop] = chunks[STATUS]

    def _clear(self, at: int) -> None:
        """Deletes the statuses and messages of a block before it is written again, statuses first, and anything that is no file
        in a chunk's place.
        """
        if not self.path:
            return
        for name in (STATUS, MESSAGE, *self.arrays(), DIGEST):
            array = self.group[name]
            file = os.path.join(self.path, name, array.metadata.encode_chunk_key((at, *[0] * (array.ndim - 1))))
            if os.path.isdir(file) and not os.path.islink(file):
                shutil.rmtree(file)
            elif name in (STATUS, MESSAGE) and os.path.lexists(file):
                os.remove(file)

    @contextlib.contextmanager
    def locked(self, part: tuple[int, int]) -> Iterator[None]:
        """Locks the store against other runs of all blocks; runs of parts may be several.

        Raises
        ------
        Error
            Another process holds the lock.
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


def _digest(about: dict[str, Any], name: str, block: int, values: NDArray[Any]) -> int:
    """Digest of the values of a block of an array, different for each array, block and plan."""
    one = hashlib.blake2b(f'{about["mark"]} {name} {block} {values.shape}'.encode('utf-8', 'surrogateescape'), digest_size=8)
    one.update(np.ascontiguousarray(values, values.dtype.newbyteorder('<')).tobytes())
    return int.from_bytes(one.digest(), 'little')


def _sum(data: Any) -> str:
    return hashlib.sha256(json.dumps(data, sort_keys=True).encode('utf-8', 'surrogateescape')).hexdigest()


def _descriptions(group: Any, names: list[str]) -> str:
    """Digest of the descriptions of the arrays."""
    return _sum([[name, array.shape, array.chunks, str(array.dtype), repr(array.fill_value), array.metadata.dimension_names, dict(array.attrs)]
                 for name in sorted(names) for array in (group[name],)])  # fmt: skip


def _letters(messages: list[str]) -> NDArray[np.uint8]:
    found = np.zeros((len(messages), _LETTERS), np.uint8)
    for at, message in enumerate(messages):
        words = np.frombuffer(message.encode('utf-8', 'replace')[:_LETTERS], np.uint8)
        found[at, : len(words)] = words
    return found


def message(letters: NDArray[np.uint8]) -> str:
    return letters.tobytes().rstrip(b'\0').decode('utf-8', 'replace')


def read(path: str | os.PathLike) -> Store:
    """Opens an existing store.

    Raises
    ------
    Error
        There is none, or the folder is no store of gearsweep.
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
        store = Store(group, path)
        shapes = dict.fromkeys((*about['names'], STATUS), (store.n,)) | {one['name']: (store.n, *one['shape']) for one in store.outputs()}
        if about['sum'] != _sum({key: value for key, value in about.items() if key != 'sum'}):
            raise ValueError
        shapes |= {MESSAGE: (store.n, _LETTERS), DIGEST: (-(-store.n // store.size), len(store.arrays()))}
        for name, shape in shapes.items():
            if group[name].shape != shape:
                raise ValueError
        for name, one in about['coordinates'].items():
            if one['words'] is None and one['digest'] != _digest(about, name, 0, store.along(name)):
                raise ValueError
        name = 'the description of an array'
        if about['arrays'] != _descriptions(group, _written(about, store.arrays())):
            raise ValueError
    except (OSError, KeyError, TypeError, ValueError, AttributeError, Damaged) as error:
        why = error.strerror if isinstance(error, OSError) and error.strerror else 'is damaged or missing'
        raise Error(f'cannot read {path}: {name} {why}; move it away, and the same run makes a new store', Code.FILE) from error
    return store


def _written(about: dict[str, Any], arrays: list[str]) -> list[str]:
    """Lists the arrays of a store."""
    return [*arrays, DIGEST, *(name for name, one in about['coordinates'].items() if one['words'] is None)]


def check(store: Store, snapshot: Snapshot, take: list[str], reduce: Reduce | None) -> None:
    """Raises an `Error` if the store is of another plan, version or kernel, or has other columns or numbers of another `reduce`."""
    about = store.about
    if about['mark'] != digest_of(snapshot.description):
        current, stored = json.loads(json.dumps(snapshot.description)), about['plan']
        off = [f'{name} is {_short(stored.get(name))}, here {_short(current[name])}' for name in current if stored.get(name) != current[name]]
        hint = '; set OPENBLAS_CORETYPE' if stored.get('OpenBLAS kernel') != current['OpenBLAS kernel'] else ''
        raise Error(f'{store.path}: is of another plan: {"; ".join(off)}{hint}', Code.FILE)
    names = [one['name'] for one in about['columns']]
    if names != take:
        raise Error(f'{store.path}: has the columns {", ".join(names) or "none"}; take asks for {", ".join(take) or "none"}', Code.FILE)
    stored = about.get('reduce', 'one of an earlier version' if about['reduced'] else 'None')
    if stored != qualified_name(reduce):
        raise Error(f'{store.path}: was begun with reduce = {stored}, here {qualified_name(reduce)}', Code.FILE)
    if about['reduce_sum'] != reduce_digest(reduce):
        also = '' if about['python'] == [*platform.python_version_tuple()[:2]] else f' (or the version of Python, which was {".".join(about["python"])})'
        raise Error(f'{store.path}: was begun with another reduce of the name {stored}: its code, a constant or an argument of it was changed since{also}',
                    Code.FILE)  # fmt: skip


def _short(value: Any) -> str:
    text = value if isinstance(value, str) else json.dumps(value)
    return text if len(text) <= 60 else 'another'


def make(path: str | os.PathLike | None, snapshot: Snapshot, layout: Layout, size: int, reduce: Reduce | None) -> Store:
    """Builds a store under a temporary name, and renames it when it is complete; in memory without a path.

    Raises
    ------
    Error
        It cannot be written.
    """
    import zarr
    from zarr.storage import MemoryStore

    if path is None:
        return Store(_with_arrays(zarr.create_group(MemoryStore()), snapshot, layout, size, reduce), '')
    path = os.fspath(path)
    new = f'{path.rstrip("/")}.{platform.node()}-{os.getpid()}.new'
    try:
        _with_arrays(zarr.create_group(new, overwrite=True), snapshot, layout, size, reduce)
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


def _with_arrays(group: Any, snapshot: Snapshot, layout: Layout, size: int, reduce: Reduce | None) -> Any:
    """Fills the group with its arrays, which have no values yet."""
    import scipy
    from zarr.codecs import ZstdCodec

    def add(name: str, shape: tuple[int, ...], kind: str, dims: tuple[str, ...], fill: float, **attributes: Any) -> Any:
        if not isinstance(name, str) or not name.isprintable() or re.search(r'^$|^\.|^__|^zarr\.json$|[/\\]', name):
            raise Error(f'reduce: {name!r}: cannot name an array of a store; a name is a word without / and \\, and does not begin with . or __')
        if name in group or name == VARIANT:
            raise Error(f'{name}: another array of the store has this name; use another name in reduce, or omit it from take')
        chunks = (min(size, shape[0]), *shape[1:]) if dims[0] == VARIANT else (1, *shape[1:]) if name == DIGEST else shape
        array = group.create_array(name, shape=shape, chunks=chunks, dtype=kind, fill_value=fill, dimension_names=dims,
                                   compressors=ZstdCodec(checksum=True))  # fmt: skip
        array.attrs.update(attributes)
        return array

    plan: Plan = snapshot.plan
    n = plan.n
    words = {name: values.tolist() if values.dtype.kind == 'U' else None for name, (_, values, _) in layout.coordinates.items()}
    for name, (_, values, _) in layout.coordinates.items():
        if words[name] is not None:
            continue
        add(name, values.shape, 'float64', (name,), np.nan)[:] = values
    units = {f'{one["group"]}.{one["name"]}': one for one in declared()['keys']}
    for one in plan.inputs:
        add(one.name, (n,), 'float64', (VARIANT,), np.nan, units=units[one.name]['unit'], long_name=units[one.name]['meaning'])
    points = {'points': plan.kind, 'scrambles': plan.scrambles, 'inputs': list(plan.names)}
    for out in (*layout.columns, *layout.reduced):
        add(out.name, (n, *out.shape), 'float64', (VARIANT, *out.dims), np.nan, units=out.unit, long_name=out.meaning, **points)
    add(MESSAGE, (n, _LETTERS), 'uint8', (VARIANT, 'letter'), 0)
    add(STATUS, (n,), 'int8', (VARIANT,), 0, flag_values=[int(one) for one in Status],
        flag_meanings=' '.join(one.name.lower() for one in Status))  # fmt: skip
    names = [*plan.names, *(out.name for out in (*layout.columns, *layout.reduced)), MESSAGE, STATUS]
    add(DIGEST, (-(-n // size), len(names)), 'uint64', ('block', 'array'), 0)
    about = {
        'format': FORMAT, 'mark': digest_of(snapshot.description), 'plan': snapshot.description, 'n': int(n), 'size': size, 'folder': plan.base.folder,
        'names': list(plan.names), 'reduce': qualified_name(reduce), 'reduce_sum': reduce_digest(reduce),
        'keys': [{'group': key.group, 'key': key.key, 'whole': key.integer, 'choices': key.choices} for key in plan.keys],
        'columns': [_output_json(one) for one in layout.columns], 'reduced': [_output_json(one) for one in layout.reduced],
        'coordinates': {name: {'table': table, 'words': words[name], 'unit': unit} for name, (table, _, unit) in layout.coordinates.items()},
        'host': platform.platform(), 'python': platform.python_version_tuple()[:2], 'numpy': np.__version__, 'scipy': scipy.__version__,
    }  # fmt: skip
    about = json.loads(json.dumps(about))  # in the form in which it is read
    for name, (_, values, _) in layout.coordinates.items():
        about['coordinates'][name]['digest'] = _digest(about, name, 0, np.asarray(values, float)) if words[name] is None else 0
    about['arrays'] = _descriptions(group, _written(about, names))
    group.attrs['gearsweep'] = about | {'sum': _sum(about)}
    return group


def _output_json(one: Output) -> dict[str, Any]:
    return {'name': one.name, 'dims': one.dims, 'shape': one.shape, 'unit': one.unit, 'meaning': one.meaning}
