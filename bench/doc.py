"""Puts the latest tables of results/bench into doc/performance.md, between its markers, with what they say in
short above them, and the pictures that it shows beside it.

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
short = ''.join((RESULTS / f'{name}.short.md').read_text() for name in ('dynamics', 'honesty', 'elastic'))
text = between('<!-- performance: begin, by sh bench/run.sh doc -->', '<!-- performance: end -->', text,
               f'{machine()}, one thread unless said:\n\n{short}'.rstrip())
page.write_text(text)
for name in re.findall(r'\(bench_(\w+)\.svg\)', text):
    draw(name)
    shutil.copyfile(RESULTS / f'{name}.svg', page.with_name(f'bench_{name}.svg'))
