"""Lays the pages out for the documentation site, and the reference of the library beside them:
python3 doc/site/stage.py PAGES [REFERENCE]
Links between pages stay; a link to a file of the sources leads to a copy of it, and a link to a folder to its place on the map of
the sources. REFERENCE, FORD's pages, then need nothing from elsewhere."""
import re
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
SITE = ROOT / 'doc/site'
PAGES = {'README.md': 'index.md', 'CONTRIBUTING.md': 'contributing.md', 'CHANGELOG.md': 'changelog.md',
         'examples/README.md': 'tutorial.md'}


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
        return f'files.md#{relative.as_posix().replace("/", "")}' if relative.parts[0] == 'src' else 'architecture.md#other-folders'
    if path.suffix == '.f90' and relative.parts[0] == 'src':
        return f'reference/sourcefile/{path.name}.html'
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
        module = re.search(r'^\s*module\s+(\w+)\s*$', text, re.MULTILINE)
        public = [name.split('=')[0].strip() for said in re.findall(r'^\s*(?:.*,\s*)?public\s*::\s*([^!\n]*)', text, re.MULTILINE)
                  for name in re.split(r',(?![^(\[]*[)\]])', said)]
        if module and public:
            lines += [f'## {module[1]}', '', f'[Reference](reference/module/{module[1].lower()}.html): '
                      + ', '.join(f'`{name}`' for name in public if re.fullmatch(r'\w+', name)) + '.', '']
    return '\n'.join(lines)


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
    folder, *reference = map(Path, sys.argv[1:])
    said = subprocess.run([sys.executable, ROOT / 'doc/architecture.py', '--files'], capture_output=True, text=True, check=True).stdout
    shutil.rmtree(folder, ignore_errors=True)
    (folder / 'assets').mkdir(parents=True)
    known = pages()
    for page, name, text in [*((page, name, page.read_text()) for page, name in known.items()), (ROOT / 'files.md', 'files.md', f'# Every file\n{said}')]:
        text = re.sub(r'\]\(([^()\s]+)\)', lambda link, page=page: f']({target(link[1], page, folder, known)})', text)
        (folder / name).write_text(text)
    (folder / 'names.md').write_text(names())
    for name in ('iframe-worker.js', 'site.css'):
        shutil.copyfile(SITE / name, folder / 'assets' / name)
    for pages_of_ford in reference:
        unplug(pages_of_ford)
        shutil.copytree(pages_of_ford, folder / 'reference')


if __name__ == '__main__':
    main()
