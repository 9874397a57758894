"""A study as one page of HTML that stands alone: case, answer, pictures, small tables."""

from __future__ import annotations

import html
import io
import re

from ..study import Study
from ..table import Table

#: Tables with more rows are for files.
_LONGEST = 40
_STYLE = """body { font: 15px/1.45 system-ui, sans-serif; max-width: 62rem; margin: 2rem auto; padding: 0 1rem; color: #222 }
h1 { font-size: 1.5rem } h2 { font-size: 1.1rem; margin-top: 2rem } pre { background: #f5f5f3; padding: .8rem; overflow-x: auto; font-size: .8rem }
table { border-collapse: collapse; font-size: .85rem } td, th { padding: .15rem .7rem .15rem 0; text-align: left; vertical-align: top }
th { border-bottom: 1px solid #999 } figure { margin: 1rem 0; overflow-x: auto } svg { max-width: 100%; height: auto }
figcaption, .meaning { color: #555 } td.number { text-align: right; font-variant-numeric: tabular-nums }
.scroll { overflow-x: auto }"""


def drawings(study: Study, *formats: str) -> dict[str, dict[str, bytes]]:
    """Each picture in these formats, by the table that it mainly shows; none where matplotlib is not installed."""
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


def report(study: Study, drawn: dict[str, dict[str, bytes]]) -> str:
    """The page, with these pictures, of which it takes the SVG."""
    title = study.case.get('case', 'title') or 'A spur-gear pair'
    parts = [
        '<!doctype html>', '<html lang="en"><head><meta charset="utf-8">', f'<title>{html.escape(title)}</title>',
        f'<style>{_STYLE}</style></head><body>', f'<h1>{html.escape(title)}</h1>',
        f'<p class="meaning">Computed by gearsweep {study.version}.</p>', '<h2>Answer</h2>',
        f'<pre>{html.escape(study.report())}</pre>', *_pictures(study, drawn), *map(_table, study),
        '<h2>Case</h2>', f'<pre>{html.escape(study.case.text)}</pre>', '</body></html>',
    ]  # fmt: skip
    return '\n'.join(part for part in parts if part)


def _pictures(study: Study, drawn: dict[str, dict[str, bytes]]) -> list[str]:
    found = []
    for table, files in drawn.items():
        drawing = files['svg'].decode()
        # Names inside the drawings would clash on one page.
        drawing = re.sub(r'(id="|xlink:href="#|href="#|url\(#)', rf'\g<1>{table}-', drawing[drawing.index('<svg') :])
        found.append(f'<figure>{drawing}<figcaption>{html.escape(study[table].meaning)}</figcaption></figure>')
    return ['<h2>Pictures</h2>', *found] if found else ['<p class="meaning">Pictures need matplotlib, and a task that has some.</p>']


def _table(table: Table) -> str:
    """A small table; of one row, its columns below each other."""
    if table.rows == 0 or table.rows > _LONGEST:
        return ''
    columns = {name: table._read(name).tolist() for name in table}
    if table.rows == 1:
        lines = [f'<tr><td>{name}</td>{_cell(values[0])}<td>{html.escape(table.units[name])}</td>'
                 f'<td class="meaning">{html.escape(table.meanings[name])}</td></tr>' for name, values in columns.items()]  # fmt: skip
    else:
        head = ''.join(f'<th title="{html.escape(table.meanings[name])}">{name}</th>' for name in columns)
        rows = (f'<tr>{"".join(map(_cell, row))}</tr>' for row in zip(*columns.values()))
        lines = [f'<tr>{head}</tr>', *rows]
    body = ''.join(lines)
    return f'<h2>{table.name}</h2><p class="meaning">{html.escape(table.meaning)}</p><div class="scroll"><table>{body}</table></div>'


def _cell(value: object) -> str:
    if isinstance(value, str):
        return f'<td>{html.escape(value)}</td>'
    return f'<td class="number">{value:.6g}</td>' if value == value else '<td class="number">–</td>'
