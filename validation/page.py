"""The part of doc/validation.md that sets printed numbers beside ours."""

import pathlib
import re

from . import ledger, report

PATH = pathlib.Path(__file__).parent.parent / 'doc' / 'validation.md'
BEGIN, END = '<!-- validation: begin, by python -m validation --pages -->', '<!-- validation: end -->'
FIRST, FIRST_END = '<!-- three checks: begin, by python -m validation --pages -->', '<!-- three checks: end -->'

NUMBER = re.compile(r'(?<![\w.])-?\d+(?:\.\d+)?(?:e[-+]?\d+)?')

# The rows that the page shows, in its order.
SHOWN = {
    'dogan2021': ('df_1', 'df1_15', 'df2_1', 'df2_15', 'n1_1', 'best_1', 'df1_28'),
    'hassan2009': ('mode_1_hz', 'mode_5_hz', 'step_1_sigma_x_mpa'),
    'thamba2020': ('f1_involute', 'f3_involute', 'r_10'),
}
NAMES = {'dogan2021': 'Dogan 2021', 'hassan2009': 'Hassan 2009', 'thamba2020': 'Thamba 2020'}


def block(outcomes):
    """The counts by paper and of the results by kind, and some rows, as Markdown."""
    by_name = {outcome.row.name: outcome for outcome in outcomes}
    rows = [_row(by_name[f'{paper}:{id}']) for paper, ids in SHOWN.items() for id in ids]
    some = markdown(('what', 'printed', 'gearsweep', 'inputs'), rows)
    counts = (f'{report.what_is_counted(outcomes)}\n\n{markdown(*report.summary(outcomes))}\n\n'
              f'Results and conclusions alone, by kind:\n\n{markdown(*report.summary_of_results(outcomes))}')
    return f'{counts}\n\nSome of them:\n\n{some}'


def current():
    """The block as the page holds it."""
    return parts(PATH, BEGIN, END)[1].strip()


def same(text, other):
    """Alike but for one unit of the last digit of any number, which may round otherwise on another processor."""
    if NUMBER.sub('#', text) != NUMBER.sub('#', other):
        return False
    pairs = zip(NUMBER.findall(text), NUMBER.findall(other))
    return all(abs(float(a) - float(b)) <= 1.001 * min(map(ledger.last_digit, (a, b))) for a, b in pairs)


def first_lines():
    """The three checks as the page has them."""
    return parts(PATH, FIRST, FIRST_END)[1].strip()


def update(outcomes, first):
    """`first`: the three checks, as Markdown."""
    for begin, end, text in ((FIRST, FIRST_END, first), (BEGIN, END, block(outcomes))):
        before, _, after = parts(PATH, begin, end)
        PATH.write_text(f'{before}{text}\n{after}', encoding='utf-8')


def parts(path, begin, end):
    """A page up to a block, the block, and the rest; the marks stay with the neighbours."""
    pattern = f'(.*{re.escape(begin)}\n)(.*)({re.escape(end)}.*)'
    found = re.fullmatch(pattern, path.read_text(encoding='utf-8'), re.DOTALL)
    if not found:
        raise ValueError(f'{path} lacks {begin} or {end}')
    return found.groups()


def _row(outcome):
    row = outcome.row
    unit = '' if row.unit == '-' else f' {row.unit}'
    reason = '' if row.inputs == 'stated' or row.reason.startswith('as ') else f': {row.reason}'
    return (f'{NAMES[row.paper]}: {row.quantity}', f'{row.printed}{unit}', f'{outcome.ours:.5g}', row.inputs + reason)


def markdown(header, rows):
    """A table."""
    lines = [header, ['---'] * len(header), *rows]
    return '\n'.join('| ' + ' | '.join(map(str, line)) + ' |' for line in lines)
