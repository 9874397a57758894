"""Puts the tables of results/bench into doc/performance.md, between its markers, with what they say in short above them,
and the pictures that it shows beside it. What was not measured stays as it is.

    python bench/doc.py
"""
import re
import shutil

from pictures import draw
from report import BENCH, RESULTS


def between(begin, end, text, content):
    return re.sub(rf'({begin}\n).*?({end})', lambda match: f'{match[1]}{content}\n{match[2]}', text, flags=re.DOTALL)


page = BENCH.parent / 'doc' / 'performance.md'
text = page.read_text()
for name in re.findall(r'<!-- begin ([\w.]+) -->', text):
    if (RESULTS / f'{name}.md').exists():
        text = between(f'<!-- begin {name} -->', f'<!-- end {name} -->', text, (RESULTS / f'{name}.md').read_text().strip())
page.write_text(text)
for name in re.findall(r'\(bench_(\w+)\.svg\)', text):
    if not (RESULTS / f'{name}.svg').exists():
        continue
    draw(name)
    shutil.copyfile(RESULTS / f'{name}.svg', page.with_name(f'bench_{name}.svg'))
