"""Report of a study as one self-contained page of HTML: result, warnings, text, pictures, formulas, tables, input."""

from __future__ import annotations

import html
import io
import os
import re
from collections.abc import Iterator, Mapping
from datetime import date
from pathlib import Path

import numpy as np

from ..core import library
from ..core.assignments import assignments
from ..core.case import formatted
from ..core.files import replacing
from ..core.study import Study
from ..core.table import Table, summary
from .formulas import Formula, formulas
from .headlines import headlines

#: The first existing one of these pictures is shown at the top.
FIRST = ('sweep', 'dynamic_factors', 'optimum_curve', 'hysteresis', 'load', 'mesh')
#: Row counts above which tables are folded and shortened, and above which they are only written to files.
LONG, LONGEST = 40, 2000
#: Largest number of rows of a table that has its columns below each other where they are too many for the page.
FEW, WIDE = 5, 6
STYLE = """:root { color-scheme: light }
body { font: 15px/1.45 system-ui, sans-serif; max-width: 62rem; margin: 2rem auto; padding: 0 1rem; color: #222; background: #fff }
h1 { font-size: 1.5rem } h2 { font-size: 1.15rem; margin-top: 2rem; border-bottom: 1px solid #999 } h3 { font-size: 1rem; margin-top: 1.4rem }
pre { background: #f5f5f3; padding: .8rem; overflow-x: auto; font-size: .8rem }
table { border-collapse: collapse; font-size: .85rem } td, th { padding: .15rem .7rem .15rem 0; text-align: left; vertical-align: top }
th { border-bottom: 1px solid #999 } figure { margin: 1rem 0; overflow-x: auto } figure svg { max-width: 100%; height: auto }
figcaption, .meaning { color: #555 } td.number { text-align: right; font-variant-numeric: tabular-nums } #result td.number { font-weight: bold }
.scroll { overflow-x: auto } .formula { margin: .6rem 0 .6rem 1.5rem } .clause { color: #555; float: right }
.warning { border-left: 3px solid #b3261e; padding-left: .6rem }
@media print {
  body { font-size: 10pt; max-width: none; margin: 0; padding: 0 } h2, h3 { break-after: avoid } figure, .formula, tr { break-inside: avoid }
  pre { white-space: pre-wrap; overflow-wrap: anywhere } .scroll { overflow: visible } table { font-size: 7.5pt } td, th { padding-right: .3rem } th { overflow-wrap: anywhere } td.number, .rows td { white-space: nowrap }
  thead { display: table-header-group } details:not([open]) { display: none }
}"""


def write(study: Study, path: str | os.PathLike, pictures: bool = True) -> None:
    """Writes result, warnings, report, pictures, formulas with their values, tables and input to one self-contained page of HTML.

    Pictures need matplotlib; without it, or with `pictures=False`, the page has none.

    Raises
    ------
    Error
        The page cannot be written; an existing one remains unchanged.
    """
    with replacing(path) as new:
        Path(new).write_text(page(study, drawings(study, 'svg') if pictures else {}), 'utf-8', 'replace')


def drawings(study: Study, *formats: str) -> dict[str, dict[str, bytes]]:
    """Draws each picture in these formats, by its main table; none if matplotlib is not installed."""
    try:
        from ..plots import figures, save
    except ImportError:
        return {}
    found: dict[str, dict[str, bytes]] = {}
    for table, figure in figures(study):
        for ending in formats:
            buffer = io.BytesIO()
            save(figure, buffer, ending)
            found.setdefault(table, {})[ending] = buffer.getvalue()
    return found


def page(study: Study, drawn: Mapping[str, Mapping[str, bytes]]) -> str:
    """Builds the page, with the SVG of these pictures."""
    title = html.escape(study.case.get('case', 'title') or 'A gear pair')
    first = [name for name in FIRST if name in drawn][:1] or list(drawn)[:1]
    parts = [
        '<!doctype html>', '<html lang="en"><head><meta charset="utf-8">',
        '<meta name="viewport" content="width=device-width, initial-scale=1">', f'<title>{title}</title>',
        f'<style>{STYLE}</style></head><body>', f'<h1>{title}</h1>',
        f'<p class="meaning">Computed by gearsweep {html.escape(study.version)}, written on {date.today().isoformat()}.</p>',
        '<h2>Result</h2>', *_result(study), *_pictures({name: drawn[name] for name in first}),
        '<h2>Warnings</h2>', *_warnings(study),
        '<h2>Answer</h2>', f'<pre>{html.escape(study.report())}</pre>',
        '<h2>Pictures</h2>', *_pictures({name: files for name, files in drawn.items() if name not in first}),
        '' if drawn else '<p class="meaning">None: they need matplotlib, and a task that has some.</p>',
        *_formulas(study), '<h2>Tables</h2>', *map(_table, study),
        '<h2>Input</h2>', f'<pre>{html.escape(study.case.text)}</pre>', *_inputs(study), '</body></html>',
    ]  # fmt: skip
    return '\n'.join(parts)


def _result(study: Study) -> Iterator[str]:
    """Main numbers of the study."""
    rows = (f'<tr><td>{one.name}</td><td class="number">{html.escape(one.value)}</td><td>{html.escape(one.more)}</td></tr>'
            for one in headlines(study))  # fmt: skip
    yield f'<table id="result">{"".join(rows)}</table>'


def _warnings(study: Study) -> list[str]:
    """Warnings that a reader must know before using a number."""
    found = []
    for table in study:
        if 'status' in table:
            status = np.atleast_1d(table.status)
            words, counts = np.unique(status[status != 'ok'], return_counts=True)
            counted = ', '.join(f'{count} {word}' for word, count in zip(words, counts))
            if counted:
                found.append(f'Table {table.name}: of {status.size} rows {counted}; the column status says what that means.')
    if not study.is_complete:
        found.append('Some operating points have no result.')
    found += [line.strip() for line in study.report().splitlines() if re.match(r'Caution {12}|  +caution: ', line)]
    found += [f'Set, but not used by the tasks of this case; it would have an effect for {line}.' for line in study.case.unused]
    return [f'<p class="warning">{html.escape(line)}</p>' for line in found] or ['<p>None: all rows have a plain result, and all keys have an effect.</p>']


def _inputs(study: Study) -> Iterator[str]:
    """All values in effect, with units, meanings and sources."""
    typed, values = assignments(study.case.text), study.case.values
    yield '<details open><summary>All values in effect</summary><div class="scroll"><table id="input"><thead>'
    yield '<tr><th>key</th><th>value</th><th>unit</th><th>from</th><th>meaning</th></tr></thead>'
    for key in library.declared()['keys']:
        group, name = key['group'], key['name']
        if name in values.get(group, {}):
            origin = 'case' if name in typed.get(group, {}) else 'default'
            cells = (f'&{group} {name}', formatted(values[group][name]), key['unit'], origin, key['meaning'])
            yield '<tr>' + ''.join(f'<td>{html.escape(cell)}</td>' for cell in cells) + '</tr>'
    yield '</table></div></details>'


def _formulas(study: Study) -> Iterator[str]:
    for i, (heading, found) in enumerate(formulas(study)):
        if i == 0:
            yield '<h2>Formulas</h2><p class="meaning">With the numbers of this case; all factors are in the table rating_factors.</p>'
        yield f'<h3>{html.escape(heading)}</h3>'
        yield from map(_formula, found)


def _formula(one: Formula) -> str:
    unit = f' {html.escape(one.unit)}' if one.unit else ''
    return (f'<p class="formula"><span class="clause">{one.clause}</span>{_maths(one.symbol)} = {_maths(one.expression)}<br>'
            f'= <span class="numbers">{_maths(one.numbers)}</span> = <b>{one.result:.6g}</b>{unit}</p>')  # fmt: skip


def _maths(words: str) -> str:
    """Symbols as the standard prints them: parts after underscores as subscripts, Greek letters."""

    def name(found: re.Match) -> str:
        if found[0] in ('sqrt', 'pi'):
            return {'sqrt': '&radic;', 'pi': '&pi;'}[found[0]]
        first, *below = (GREEK.get(part, part) for part in found[0].split('_'))
        return f'<i>{first}</i>' + (f'<sub>{"".join(below)}</sub>' if below else '')

    return re.sub(r'(?<![\w.])[A-Za-z]\w*', name, words).replace('*', '&middot;')


GREEK = {'cprime': 'c&prime;', 'sigma': '&sigma;', 'eps': '&epsilon;', 'alpha': '&alpha;', 'beta': '&beta;', 'gamma': '&gamma;'}


def _pictures(drawn: Mapping[str, Mapping[str, bytes]]) -> Iterator[str]:
    for table, files in drawn.items():
        drawing = files['svg'].decode()
        # Identical names inside several drawings would clash on one page.
        drawing = re.sub(r'(id="|xlink:href="#|href="#|url\(#)', rf'\g<1>{table}-', drawing[drawing.index('<svg') :])
        from ..plots import PICTURES  # imported here, as pictures need matplotlib

        yield f'<figure id="picture-{table}">{drawing}<figcaption>{html.escape(PICTURES[table].caption)}</figcaption></figure>'


def _table(table: Table) -> str:
    """Formats a table; one with a single row, a few long rows or very many rows has its columns below each other."""
    title = f'<h3 id="table-{table.name}">{table.name}</h3><p class="meaning">{html.escape(table.meaning)}: {table.rows} rows</p>'
    if 1 < table.rows <= LONG and not (table.rows <= FEW and len(list(table)) > WIDE):
        return title + _rows(table)
    if LONG < table.rows <= LONGEST:
        return f'{title}{_upright(table)}<details><summary>All rows</summary>{_rows(table)}</details>'
    return title + _upright(table)


def _rows(table: Table) -> str:
    columns = {name: table._read(name).tolist() for name in table}
    head = ''.join(f'<th title="{html.escape(table.meanings[name])}">{name}</th>' for name in columns)
    body = ''.join(f'<tr>{"".join(map(_cell, row))}</tr>' for row in zip(*columns.values()))
    return f'<div class="scroll"><table class="rows"><thead><tr>{head}</tr></thead>{body}</table></div>'


def _upright(table: Table) -> str:
    """Formats a table with a line for each column: its value in each of few rows, or the least and largest."""
    lines = ''.join(
        f'<tr><td>{name}</td>{_values(table, name)}'
        f'<td>{html.escape(table.units[name])}</td><td class="meaning">{html.escape(table.meanings[name])}</td></tr>'
        for name in table
    )
    return f'<div class="scroll"><table>{lines}</table></div>'


def _values(table: Table, name: str) -> str:
    if 1 <= table.rows <= FEW:
        return ''.join(map(_cell, table._read(name).tolist()))
    return f'<td>{html.escape(summary(table[name]))}</td>'


def _cell(value: object) -> str:
    if isinstance(value, str):
        return f'<td>{html.escape(value)}</td>'
    return f'<td class="number">{value:.6g}</td>' if value == value else '<td class="number">–</td>'
