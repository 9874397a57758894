"""Puts the latest tables of results/bench into doc/performance.md, between its markers.

    python bench/doc.py
"""
import re

from report import BENCH, RESULTS

page = BENCH.parent / 'doc' / 'performance.md'
text = page.read_text()
for name in re.findall(r'<!-- begin (\w+) -->', text):
    table = (RESULTS / f'{name}.md').read_text().strip()
    text = re.sub(rf'(<!-- begin {name} -->\n).*?(<!-- end {name} -->)', lambda match: f'{match[1]}{table}\n{match[2]}', text, flags=re.S)
page.write_text(text)
