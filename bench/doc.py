"""Puts the tables of results/bench into bench/measured, what they say in short into doc/accuracy.md, between its markers, and the
pictures that it shows beside it. What was not measured stays as it is.

    python bench/doc.py
"""
import re
import shutil

from pictures import draw
from report import BENCH, RESULTS


def between(begin, end, text, content):
    return re.sub(rf'({begin}\n).*?({end})', lambda match: f'{match[1]}{content}\n{match[2]}', text, flags=re.DOTALL)


page = BENCH.parent / 'doc' / 'accuracy.md'
text = page.read_text()
for kept in sorted((BENCH / 'measured').glob('*.md')):
    if (RESULTS / kept.name).exists():
        kept.write_text((RESULTS / kept.name).read_text().strip() + '\n')
    text = between(f'<!-- begin {kept.stem} -->', f'<!-- end {kept.stem} -->', text, kept.read_text().strip())
page.write_text(text)
for name in re.findall(r'\(bench_(\w+)\.svg\)', text):
    if not (RESULTS / f'{name}.svg').exists():
        continue
    draw(name)
    shutil.copyfile(RESULTS / f'{name}.svg', page.with_name(f'bench_{name}.svg'))
