"""Puts the latest tables of results/bench into doc/performance.md, between its markers, the pictures that
it shows beside it, and what the README shows of them into the README.

    python bench/doc.py
"""
import re
import shutil

from pictures import draw
from report import BENCH, RESULTS, machine


def between(begin, end, text, content):
    return re.sub(rf'({begin}\n).*?({end})', lambda match: f'{match[1]}{content}\n{match[2]}', text, flags=re.DOTALL)


page = BENCH.parent / 'doc' / 'performance.md'
text = page.read_text()
for name in re.findall(r'<!-- begin (\w+) -->', text):
    table = (RESULTS / f'{name}.md').read_text().strip()
    text = between(f'<!-- begin {name} -->', f'<!-- end {name} -->', text, table)
page.write_text(text)
for name in re.findall(r'\(bench_(\w+)\.svg\)', text):
    draw(name)
    shutil.copyfile(RESULTS / f'{name}.svg', page.with_name(f'bench_{name}.svg'))

readme = BENCH.parent / 'README.md'
lines = ''.join((RESULTS / f'{name}.readme.md').read_text() for name in ('dynamics', 'honesty', 'elastic'))
readme.write_text(between('<!-- performance: begin, by sh bench/run.sh doc -->', '<!-- performance: end -->', readme.read_text(),
                          f'{machine()}, one thread unless said:\n\n{lines}'.rstrip()))
