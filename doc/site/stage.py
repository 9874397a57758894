"""Lays the pages out for the documentation site, and the reference of the library beside them:
python3 doc/site/stage.py PAGES [NOTEBOOK.ipynb] [REFERENCE]
A page gets the pictures of the NOTEBOOK with its name (doc/notebook.py), and a link to it. Links between pages stay the same; a link
to a file of the sources leads to a copy of it, and a link to a folder to its place on the map of the sources. REFERENCE, FORD's pages,
then needs nothing from elsewhere."""
import base64
import json
import re
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
SITE = ROOT / 'doc/site'
PAGES = {'README.md': 'index.md', 'CONTRIBUTING.md': 'contributing.md', 'CHANGELOG.md': 'changelog.md',
         'examples/README.md': 'tutorial.md'}
#: Weight of a page in the search, so that pages that explain come before lists of names.
BOOST = {'questions.md': 4, 'case.md': 0.5, 'tables.md': 0.5, 'changelog.md': 0.2, 'files.md': 0.1, 'names.md': 0.1}
MODULE = re.compile(r'^\s*module\s+(\w+)\s*$', re.MULTILINE)


def pages():
    """The pages by where they lie, each with its name in the site."""
    return {ROOT / name: to for name, to in PAGES.items()} | {
        path: path.name for folder in ('doc', 'doc/develop') for path in sorted((ROOT / folder).glob('*.md'))}


def target(link, page, folder, known):
    """Where a link of a page leads in the site; copies the file where it is one of the sources."""
    where, anchor = (*link.split('#', 1), '')[:2]
    anchor = f'#{anchor}' if anchor else ''
    if not where or re.match(r'\w+:', where):
        return link
    path = (page.parent / where).resolve()
    if path in known:
        return known[path] + anchor
    if not path.exists():
        raise SystemExit(f'{page.relative_to(ROOT)} leads to {link}, which is not there')
    relative = path.relative_to(ROOT)
    if path.is_dir():
        return f'files.md#{"".join(relative.parts[:2])}' if relative.parts[0] == 'src' else 'architecture.md#other-folders'
    if path.suffix == '.f90' and relative.parts[0] == 'src':
        # By the module, as several rooms have files of one name.
        module = MODULE.search(path.read_text())
        return f'reference/module/{module[1].lower()}.html' if module else f'reference/sourcefile/{path.name}.html'
    # Browsers show text, and save what they do not know.
    name = f'pictures/{path.name}' if path.suffix == '.svg' else f'files/{relative.as_posix()}.txt'
    (folder / name).parent.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(path, folder / name)
    return name


def names():
    """A page with the public names of every module, for the search."""
    lines = ['# Public names', '', 'Every public name of the library, by module; [its reference](reference/index.html) has the rest.', '']
    for path in sorted((ROOT / 'src').rglob('*.f90')):
        text = re.sub(r'&\s*\n\s*&?', ' ', path.read_text())
        module = MODULE.search(text)
        public = [name.split('=')[0].strip() for said in re.findall(r'^\s*(?:.*,\s*)?public\s*::\s*([^!\n]*)', text, re.MULTILINE)
                  for name in re.split(r',(?![^(\[]*[)\]])', said)]
        if module and public:
            lines += [f'## {module[1]}', '', f'[Reference](reference/module/{module[1].lower()}.html): '
                      + ', '.join(f'`{name}`' for name in public if re.fullmatch(r'\w+', name)) + '.', '']
    return '\n'.join(lines)


def illustrate(text, notebook, folder):
    """The page of a notebook with the pictures that its lines drew, and a link to it."""
    drawn = [output['data']['image/png'] for cell in json.loads(notebook.read_text())['cells']
             for output in cell.get('outputs', ()) if 'image/png' in output.get('data', {})]
    lines = re.findall(r'<!-- its picture: (.+?) -->', text)
    if len(lines) != len(drawn):
        raise SystemExit(f'{notebook.name} has {len(drawn)} pictures, its page {len(lines)} lines that draw one')
    for number, (line, picture) in enumerate(zip(lines, drawn), 1):
        name = f'pictures/{notebook.stem}-{number}.png'
        (folder / name).write_bytes(base64.b64decode(picture))
        text = text.replace(f'<!-- its picture: {line} -->', f'![Drawn by {line}]({name})\n\n*Drawn by* `gearsweep.{line}`')
    shutil.copyfile(notebook, folder / notebook.name)
    return text.replace('\n\n', f'\n\n[The notebook]({notebook.name}) has the same steps with all that they print.\n\n', 1)


def weighted(name, text):
    return f'---\nsearch:\n  boost: {BOOST[name]}\n---\n{text}' if name in BOOST else text


def unplug(reference):
    """Takes what FORD's pages fetch from elsewhere out of them."""
    shutil.copyfile(SITE / 'reference.css', reference / 'css/reference.css')
    for page in reference.rglob('*.html'):
        text = page.read_text()
        up = '../' * (len(page.relative_to(reference).parts) - 1)
        text = re.sub(r'<link href="https://cdn[^>]*>', f'<link href="{up or "./"}css/reference.css" rel="stylesheet">', text, flags=re.DOTALL)
        text = re.sub(r'<script[^>]*(?:src="https:|x-mathjax)[^>]*>.*?</script>', '', text, flags=re.DOTALL)
        text = re.sub(r'<script>(?:(?!</script>).)*bootstrap\..*?</script>', '', text, flags=re.DOTALL)
        text = re.sub(r'<link href="[^"]*/css/local.css" rel="stylesheet">', '', text)
        text = re.sub(r'(<a class="navbar-brand")', rf'<a href="{up}../index.html">Documentation</a>\1', text, count=1)
        page.write_text(text)


def main():
    folder, *made = map(Path, sys.argv[1:])
    notebooks = {path.stem: path for path in made if path.suffix == '.ipynb'}
    said = subprocess.run([sys.executable, ROOT / 'doc/architecture.py', '--files'], capture_output=True, text=True, check=True).stdout
    shutil.rmtree(folder, ignore_errors=True)
    for name in ('assets', 'pictures'):
        (folder / name).mkdir(parents=True)
    known = pages()
    for page, name, text in [*((page, name, page.read_text()) for page, name in known.items()), (ROOT / 'files.md', 'files.md', f'# Every file\n{said}')]:
        text = re.sub(r'\]\(([^()\s]+)\)', lambda link, page=page: f']({target(link[1], page, folder, known)})', text)
        if page.stem in notebooks:
            text = illustrate(text, notebooks[page.stem], folder)
        (folder / name).write_text(weighted(name, text))
    (folder / 'names.md').write_text(weighted('names.md', names()))
    for name in ('iframe-worker.js', 'site.css'):
        shutil.copyfile(SITE / name, folder / 'assets' / name)
    for pages_of_ford in made:
        if pages_of_ford.suffix == '.ipynb':
            continue
        unplug(pages_of_ford)
        shutil.copytree(pages_of_ford, folder / 'reference')


if __name__ == '__main__':
    main()
