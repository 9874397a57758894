"""What the runner writes: a page, a table, lines for the screen and for the README."""

import base64
import csv
import datetime
import html
import pathlib
import platform
import re
import string
import struct

import gearsweep

from . import check, ledger

TEMPLATE = pathlib.Path(__file__).with_name('report_template.html')
TITLES = ledger.PAPERS | ledger.CHECKS
PIXELS = 2.5  # of a picture in one of the page: all are shown to the same scale
COLUMNS = ('place', 'quantity', 'unit', 'printed', 'ours', 'deviation', 'verdict', 'inputs', 'tolerance',
           'ours by', 'remarks')


def number(value, digits=6):
    """A value as text: true or false, a number, or nothing."""
    if value is None:
        return ''
    return str(value).lower() if isinstance(value, bool) else f'{value:.{digits}g}'


def deviation(outcome):
    """Relative where the printed value is not 0, else absolute."""
    if outcome.deviation is None:
        return ''
    if outcome.deviation == 0:
        return '0'
    if outcome.row.value == 0:
        return f'{outcome.deviation:+.3g}'
    return f'{100 * outcome.deviation / abs(outcome.row.value):+.3g} %'


COUNTED = ('results', 'within tolerance, from stated inputs', 'with an inferred input', 'deviating', 'fitted', 'not reproducible', 'open',
           'from its own numbers')


def summary(outcomes):
    """Header and rows of the counts by paper, with a line for all."""
    return _summary('paper', [(title, [o for o in outcomes if o.row.paper == paper]) for paper, title in ledger.PAPERS.items()],
                    ('rows', 'inputs', 'repeats'))


def summary_of_results(outcomes):
    """The same of results and conclusions, by kind, without inputs and repeats."""
    results = [o for o in outcomes if o.verdict not in ('input', 'repeat')]
    return _summary('what', [(sort, [o for o in results if o.row.sort == sort]) for sort in ledger.SORT_NAMES], ())


def _summary(what, parts, more):
    parts = [(title, part) for title, part in parts if part]
    parts.append(('all', [o for _, part in parts for o in part]))
    return (what, *more, *COUNTED), [(title, *_counts(part, more)) for title, part in parts]


def _counts(outcomes, more):
    n = check.counts(outcomes)
    within = [o.row for o in outcomes if o.verdict == 'within']
    own = sum(row.by == 'printed' for row in within)
    stated = sum(row.by != 'printed' and row.inputs == 'stated' for row in within)
    results = (stated, len(within) - own - stated, n['deviates'] + n['failed'], n['fitted'], n['not reproducible'], n['open'])
    front = {'rows': len(outcomes), 'inputs': n['input'], 'repeats': n['repeat']}
    return (*(front[name] for name in more), sum(results), *results, own)


def counts_text(header, rows):
    """Counts as an aligned table for the screen."""
    short = {'within tolerance, from stated inputs': 'stated', 'with an inferred input': 'inferred', 'not reproducible': 'not repr.',
             'from its own numbers': 'own numbers'}
    table = [tuple(short.get(name, name) for name in header)] + [tuple(map(str, row)) for row in rows]
    width = [max(map(len, column)) for column in zip(*table)]
    return '\n'.join(row[0].ljust(width[0]) + ''.join(cell.rjust(w + 2) for cell, w in zip(row[1:], width[1:]))
                     for row in table)


def what_is_counted(outcomes):
    """The number of rows in a sentence."""
    n, all_rows = check.counts(outcomes), len(outcomes)
    return (f'{all_rows} rows are all numbers and number words that the texts print, but for those left out on purpose: {n["input"]} are inputs '
            f'of the papers, {n["repeat"]} repeat a number, {all_rows - n["input"] - n["repeat"]} are results and conclusions.')


def write_csv(path, outcomes):
    """All rows with our values to 15 digits."""
    with open(path, 'w', newline='', encoding='utf-8') as file:
        writer = csv.writer(file, lineterminator='\n')
        writer.writerow(('paper', 'id', 'place', 'quantity', 'unit', 'printed', 'ours', 'deviation',
                         'verdict', 'message', 'kind', 'inputs', 'reason', 'by', 'function', 'tolerance', 'allowed',
                         'origin', 'comment'))
        for o in outcomes:
            r = o.row
            allowed = '' if r.allowed is None else f'{r.allowed:.3g}'
            writer.writerow((r.paper, r.id, r.place, r.quantity, r.unit, r.printed, number(o.ours, 15), deviation(o),
                             o.verdict, o.message, r.kind, r.inputs, r.reason, r.by, r.ours, r.tolerance, allowed,
                             r.origin, r.comment))


def write_page(path, outcomes, pictures, first=()):
    """The report as one page. `first`: sentences above the counts. `pictures`: (title, caption, PNG bytes), in their order."""
    text = string.Template(TEMPLATE.read_text(encoding='utf-8')).substitute(
        made=html.escape(made()),
        first='\n'.join(f'<li>{html.escape(one)}</li>' for one in first),
        summary='\n'.join((_table(*summary(outcomes), 'summary'), _table(*summary_of_results(outcomes), 'summary'))),
        pictures='\n'.join(map(_figure, pictures)) or '<p>None: matplotlib is not installed.</p>',
        papers='\n'.join(_paper(paper, outcomes) for paper in TITLES if any(o.row.paper == paper for o in outcomes)))
    pathlib.Path(path).write_text(text, encoding='utf-8')


def made():
    """What the report was made with, and when: version, date, machine, Python."""
    return (f'gearsweep {gearsweep.__version__}, {datetime.date.today()}, {_processor()}, {platform.system()} '
            f'{platform.machine()}, Python {platform.python_version()}')


def _processor():
    try:
        found = re.search(r'model name\s*: (.*)', pathlib.Path('/proc/cpuinfo').read_text(encoding='utf-8'))
    except OSError:
        found = None
    return found[1] if found else platform.processor() or 'unknown processor'


def _table(header, rows, kind):
    head = ''.join(f'<th>{html.escape(str(cell))}</th>' for cell in header)
    body = '\n'.join('<tr>' + ''.join(f'<td>{html.escape(str(cell))}</td>' for cell in row) + '</tr>' for row in rows)
    return f'<table class="{kind}"><thead><tr>{head}</tr></thead><tbody>\n{body}\n</tbody></table>'


def _figure(picture):
    title, caption, png = picture
    data = base64.b64encode(png).decode()
    width = struct.unpack('>I', png[16:20])[0] / PIXELS
    return (f'<figure style="width: {width:.0f}px"><img alt="{html.escape(title)}" src="data:image/png;base64,{data}">'
            f'<figcaption><b>{html.escape(title)}.</b> {html.escape(caption)}</figcaption></figure>')


def _paper(paper, outcomes):
    head = ''.join(f'<th>{cell}</th>' for cell in COLUMNS)
    body = '\n'.join(_line(o) for o in outcomes if o.row.paper == paper)
    return (f'<section id="{paper}"><h2>{html.escape(TITLES[paper])}</h2>'
            f'<table class="rows"><thead><tr>{head}</tr></thead><tbody>\n{body}\n</tbody></table></section>')


def _line(outcome):
    row = outcome.row
    remarks = '; '.join(filter(None, (outcome.message, row.reason, row.comment)))
    tolerance = f'{row.tolerance} ({row.origin})' if row.tolerance else ''
    how = f'same as {row.repeats}' if row.repeats else f'{row.by}: {row.ours}' if row.ours else ''
    cells = (row.place, row.quantity, row.unit, row.printed, number(outcome.ours), deviation(outcome), outcome.verdict,
             row.inputs or row.kind, tolerance, how, remarks)
    kind = outcome.verdict.replace(' ', '-')
    body = ''.join(f'<td>{html.escape(cell)}</td>' for cell in cells)
    return f'<tr class="{kind}" title="{row.id}">{body}</tr>'
