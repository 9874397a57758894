"""Table 3 of Hassan et al. 2009 beside ours: root stress under the moving load, for what the paper leaves open."""

import pathlib
import re

from . import hassan2009, page

PATH = pathlib.Path(__file__).parent.parent / 'doc/vibration.md'
BEGIN, END = '<!-- Table 3: begin, by python -m validation --pages -->', '<!-- Table 3: end -->'
SPEEDS = (360, 720, 1440, 1800)
COMPONENTS = ('sigma_x', 'sigma_y', 'tau_xy', 'mises')

# What the paper leaves open or contradicts itself in, by the variants of validation/cases.py.
WAYS = {
    'three modes, printed damping': '',
    'three modes, right damping': '+right-damping',
    'converged, printed damping': '+converged',
    'converged, right damping': '+converged+right-damping',
    'converged, printed damping, 1.719 mesh periods': '+converged+whole-passage',
}
# A coarse grid, whose errors are small beside the bands.
GRID = '+ten-across'


def block():
    """Von Mises stress over the speeds as printed and ours, as Markdown; then the components of the first way."""
    lines = [_row('von Mises stress at node 102, MPa', *(f'{speed} 1/min' for speed in SPEEDS)), '|---' * (1 + len(SPEEDS)) + '|',
             _row('printed', *(f'{hassan2009.printed(f"dynamic_{speed}_mises"):g}' for speed in SPEEDS))]
    for words, variant in WAYS.items():
        lines.append(_row(words, *(_band(speed, 'mises', variant) for speed in SPEEDS)))
    lines += ['', _row('three modes, printed damping', *(f'{speed} 1/min' for speed in SPEEDS)),
              '|---' * (1 + len(SPEEDS)) + '|']
    for component in COMPONENTS[:3]:
        lines.append(_row(f'{component}, printed',
                          *(f'{hassan2009.printed(f"dynamic_{speed}_{component}"):g}' for speed in SPEEDS)))
        lines.append(_row(f'{component}, ours', *(_band(speed, component, '') for speed in SPEEDS)))
    return '\n'.join(lines)


def current():
    """The block as the page holds it."""
    return _parts()[1].strip()


def same(text, other):
    return page.same(text, other)


def update():
    before, _, after = _parts()
    PATH.write_text(f'{before}{block()}\n{after}', encoding='utf-8')


def _band(speed, component, variant):
    """The load changing all along from node 70 to node 68; and the least and the most where it jumps."""
    name = hassan2009.MOVING + variant + GRID
    least, most = hassan2009.band(speed, component, name)
    return f'{hassan2009.largest(speed, component, name):.0f} ({least:.0f} to {most:.0f})'


def _row(*cells):
    return f'| {" | ".join(cells)} |'


def _parts():
    found = re.fullmatch(f'(.*{re.escape(BEGIN)}\n)(.*)({re.escape(END)}.*)', PATH.read_text(encoding='utf-8'), re.DOTALL)
    if not found:
        raise ValueError(f'{PATH} lacks {BEGIN} or {END}')
    return found.groups()
