"""Makes a notebook of a page whose examples are cases, runs it, and keeps what it printed and drew:
python doc/notebook.py PAGE NOTEBOOK
Each case of the page becomes a cell that runs it. The lines of output on the page are omitted, as the cell prints them. A comment
`<!-- its picture: plot_sweep(study) -->` of the page becomes a cell that draws the picture. Needs the package, nbformat, nbclient and ipykernel."""
import re
import sys
from pathlib import Path

import nbformat
from nbclient import NotebookClient
from nbformat import v4

BLOCK = re.compile(r'<!-- a case: (?P<name>\S+) -->\n```text\n(?P<case>.*?)```\n'
                   r'|(?P<shown>`gearsweep \S+` prints[^\n]*\n\s*<!-- from what it prints -->\n```text\n.*?```\n)'
                   r'|<!-- its picture: (?P<picture>.+?) -->\n', re.DOTALL)
RUN = 'study = gearsweep.run(gearsweep.Case("""{}"""))\nprint(study.report())'


def cells(page):
    """The cells of a page, in its order. Links lead to the site's pages beside the notebook."""
    text = re.sub(r'\]\((\w+)\.md(#[^)]*)?\)', r'](\1.html\2)', page)
    at, found = 0, []

    def said(words):
        if words.strip():
            found.append(v4.new_markdown_cell(words.strip()))

    for block in BLOCK.finditer(text):
        said(text[at:block.start()])
        at = block.end()
        if block['name']:
            found.append(v4.new_code_cell(RUN.format(block['case'])))
        elif block['picture']:
            found.append(v4.new_code_cell(f'figure = gearsweep.{block["picture"]}.figure'))
    said(text[at:])
    found.insert(1, v4.new_code_cell('import gearsweep\n%matplotlib inline'))
    return found


def notebook(page):
    """The notebook of a page, with what each cell printed and drew."""
    made = v4.new_notebook(cells=cells(page), metadata={'kernelspec': {'name': 'python3', 'display_name': 'Python 3', 'language': 'python'}})
    for number, cell in enumerate(made.cells):
        cell.id = f'cell-{number}'  # the same from one time to the next
    NotebookClient(made, timeout=600, kernel_name='python3').execute()
    for cell in made.cells:
        cell.metadata.pop('execution', None)  # the times of this run
    return made


def main():
    page, to = map(Path, sys.argv[1:])
    nbformat.write(notebook(page.read_text()), to)


if __name__ == '__main__':
    main()
