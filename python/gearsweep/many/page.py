"""Report of a store as one self-contained page of HTML: counts, keys, quantiles or indices, pictures, and failed variants."""

from __future__ import annotations

import html
import io
import os
import re
import warnings
from collections.abc import Iterator, Sequence
from datetime import date
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..core.files import replacing
from ..core.library import Error
from ..report.page import STYLE
from . import reading
from . import store as stores
from .inputs import described
from .statistics import quantiles, sensitivity, with_band
from .store import STATUS, VARIANT

if TYPE_CHECKING:
    import xarray
    from matplotlib.figure import Figure

#: Largest number of failed variants in the list.
_LISTED = 100
#: Columns with more numbers are omitted: a page does not read gigabytes.
_LARGEST = 30_000_000
_Q = (0.05, 0.5, 0.95)


def write(store: str | os.PathLike, path: str | os.PathLike) -> None:
    """Writes the page of a store to a file.

    Raises
    ------
    Error
        There is no such store, or the file cannot be written.
    """
    with replacing(path) as new:
        Path(new).write_text(page(store), 'utf-8', 'replace')


def stamp(store: str | os.PathLike[str]) -> object:
    """Returns a mark that changes with each written block: files, sizes and times of the statuses, which are written last."""
    found = []
    for folder in (os.fspath(store), os.path.join(store, STATUS, 'c')):
        try:
            with os.scandir(folder) as entries:
                found += [(one.path, seen.st_size, seen.st_mtime_ns, seen.st_ino) for one in entries if one.is_file() for seen in (one.stat(),)]
        except OSError:
            continue
    return sorted(found)


def page(store: str | os.PathLike) -> str:
    """Builds the page of a store, also while it is written; with pictures if matplotlib is installed."""
    data = reading.open(store)
    large = [str(name) for name, one in data.data_vars.items() if one.size > _LARGEST]
    data = data.drop_vars(large).load()
    about = stores.read(store).about
    title = html.escape(f'{os.path.basename(os.fspath(store).rstrip("/"))}: {data.sizes[VARIANT]} variants')
    counts = reading.counts(data)
    attributes = data.attrs
    origin = f'Computed by gearsweep {attributes["version"]}; plan {attributes["kind"]}, seed {attributes["seed"]}, OpenBLAS kernel {attributes["OpenBLAS kernel"]}'
    omitted = [f'<p class="warning">Not on this page, as they have more than {_LARGEST:.0e} numbers each: {html.escape(", ".join(large))}.</p>'] if large else []
    return '\n'.join([
        '<!doctype html>', '<html lang="en"><head><meta charset="utf-8">',
        '<meta name="viewport" content="width=device-width, initial-scale=1">', f'<title>{title}</title>',
        f'<style>{STYLE}</style></head><body>', f'<h1>{title}</h1>',
        f'<p class="meaning">{html.escape(origin)}; written on {date.today().isoformat()}.</p>',
        '<h2>Variants</h2>', _table(('status', 'variants'), list(counts.items())),
        '<h2>Keys</h2>', _table(('key', 'values'), [(one['name'], described(one)) for one in about['plan']['keys'] if 'name' in one]),
        '<h2>Results</h2>', *omitted, *_results(data, 'pending' in counts),
        '<h2>Pictures</h2>', *_pictures(data),
        '<h2>Without a plain result</h2>', *_failures(store),
        '<h2>Case</h2>', f'<pre>{html.escape(about["plan"]["case"])}</pre>', '</body></html>',
    ])  # fmt: skip


def _results(data: xarray.Dataset, pending: bool) -> Iterator[str]:
    """Formats quantiles with bands of columns of one number, or Sobol' indices."""
    rows: list[tuple[Any, ...]] = []
    if pending:
        yield '<p class="warning">The run is not complete; numbers appear at its end.</p>'
        return
    saltelli = data.attrs['kind'] == 'saltelli'
    for column in _columns(data, 0):
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter('always')
            try:
                if saltelli:
                    found = sensitivity(column, nan='drop')
                    rows += [(column.name, name, *(_band(found.sel(input=name), index, f'{index}_lower', f'{index}_upper') for index in ('S1', 'ST')))
                             for name in found.input.values]  # fmt: skip
                else:
                    found = quantiles(column, _Q, nan='drop')
                    rows.append((column.name, *(_band(found.sel(q=q), 'value', 'lower', 'upper') for q in _Q)))
            except Error as error:
                yield f'<p class="meaning">{html.escape(str(error))}</p>'
        yield from (f'<p class="warning">{html.escape(str(one.message))}</p>' for one in caught)
    if rows:
        yield _table(('column', 'key', 'first order', 'total') if saltelli else ('column', *(f'{100 * q:g} %' for q in _Q)), rows)


def _band(found: xarray.Dataset, value: str, lower: str, upper: str) -> str:
    return with_band(*(float(found[name]) for name in (value, lower, upper)))


def _columns(data: xarray.Dataset, more: int) -> Iterator[xarray.DataArray]:
    """Lists outputs over the variants and `more` further dimensions."""
    for column in data.data_vars.values():
        if 'points' in column.attrs and column.dims[0] == VARIANT and column.ndim == 1 + more:
            yield column


def _pictures(data: xarray.Dataset) -> Iterator[str]:
    try:
        from .pictures import ACROSS, plot_band, plot_distribution, plot_indices, plot_scatter
    except ImportError:
        yield '<p class="meaning">None: they need matplotlib.</p>'
        return
    rows = -(-len(data.attrs['inputs']) // ACROSS)
    drawn: list[tuple[str, Any, int]] = []  # and the number of rows of pictures
    for column in _columns(data, 0):
        drawn.append((f'{column.name} over each key', lambda figure, name=column.name: plot_scatter(data, name, figure), rows))
        if data.attrs['kind'] == 'saltelli':
            drawn.append((f"Sobol' indices of {column.name}", lambda figure, one=column: plot_indices(sensitivity(one, nan='drop'), figure.subplots()), 1))
        else:
            drawn.append((f'Distribution of {column.name}', lambda figure, one=column: plot_distribution(one, figure.subplots(), nan='drop'), 1))
    for column in _columns(data, 1):
        if data[column.dims[1]].dtype.kind == 'f':
            drawn.append((f'{column.name} over {column.dims[1]}', lambda figure, one=column: plot_band(one, figure.subplots(), nan='drop'), 1))
    for at, (caption, draw, rows) in enumerate(drawn):
        try:
            yield f'<figure>{_svg(draw, at, rows)}<figcaption>{html.escape(caption)}</figcaption></figure>'
        except Error:  # points that are no sample, or too few; reported above
            continue


def _svg(draw: Any, at: int, rows: int) -> str:
    """Draws a picture whose names do not clash with those of others on the page."""
    from matplotlib.figure import Figure

    from ..plots import save, style
    from ..plots.look import MM, PAGE

    with warnings.catch_warnings(), style():
        warnings.simplefilter('ignore')  # reported above
        figure: Figure = Figure(figsize=(PAGE, 60 * MM * rows), layout='constrained')
        draw(figure)
        buffer = io.BytesIO()
        save(figure, buffer, 'svg')
    drawing = buffer.getvalue().decode()
    return re.sub(r'(id="|xlink:href="#|href="#|url\(#)', rf'\g<1>many{at}-', drawing[drawing.index('<svg') :])


def _failures(store: str | os.PathLike) -> Iterator[str]:
    found = reading.failures(store)
    if not len(found):
        yield '<p>None.</p>'
        return
    if len(found) > _LISTED:
        yield f'<p class="meaning">{_LISTED} of {len(found)}; many.failures has all.</p>'
    yield _table(tuple(found.columns), [tuple(row) for row in found.head(_LISTED).itertuples(index=False)])


def _table(heads: Sequence[str], rows: Sequence[Sequence[Any]]) -> str:
    def cell(value: Any) -> str:
        return html.escape(f'{value:.8g}' if isinstance(value, (float, np.floating)) else str(value))

    body = ''.join('<tr>' + ''.join(f'<td>{cell(value)}</td>' for value in row) + '</tr>' for row in rows)
    return f'<div class="scroll"><table><thead><tr>{"".join(f"<th>{html.escape(str(one))}</th>" for one in heads)}</tr></thead>{body}</table></div>'
