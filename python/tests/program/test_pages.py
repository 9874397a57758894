"""The examples of doc/: each case runs as printed, and what the page shows is what the program says."""

import re

import pytest
from conftest import ROOT, alike, compare

EXAMPLE = re.compile(
    r'<!-- a case: (\S+) -->\n```text\n(.*?)```\n.*?`gearsweep \1` prints.*?<!-- from what it prints -->\n```text\n(.*?)```', re.DOTALL
)
EXAMPLES = {
    f'{page.name}: {name}': (name, case, shown)
    for page in sorted((ROOT / 'doc').glob('*.md'))
    for name, case, shown in EXAMPLE.findall(page.read_text())
}
#: Of a residual nothing but its size is known.
LEAST = {'body_modes.md: body_modes.nml': 1e-8}
#: Pages on a task that have no lines of Python to run.
TASKS = ('as_built', 'body_modes', 'deflection_relief', 'face_load', 'flank', 'harmonic', 'life', 'rating', 'transient')


@pytest.mark.parametrize('example', EXAMPLES)
def test_an_example_prints_what_the_page_shows(program, tmp_path, example):
    name, case, shown = EXAMPLES[example]
    (tmp_path / name).write_text(case)
    done = program(name, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    said = done.stdout.splitlines(keepends=True)
    lines = shown.count('\n')
    least = LEAST.get(example, compare.LEAST)
    assert any(alike(shown, ''.join(said[at : at + lines]), least) for at in range(len(said))), f'{example}\n{shown}\n{done.stdout}'


@pytest.mark.parametrize('task', TASKS)
def test_a_task_without_lines_of_python_has_an_example(task):
    assert any(example.endswith(f': {task}.nml') for example in EXAMPLES)


def test_every_block_of_a_case_is_run():
    for page in (ROOT / 'doc').glob('*.md'):
        text = page.read_text()
        assert text.count('<!-- a case: ') == text.count('<!-- from what it prints -->') == len(EXAMPLE.findall(text)), page.name


def test_the_notice_names_each_library_that_is_linked():
    import tomllib

    notice = (ROOT / 'NOTICE').read_text()
    for name in tomllib.loads((ROOT / 'fpm.toml').read_text())['build']['link']:
        library = re.sub(r'^:?(lib)?|\.a$', '', name)
        assert re.search(rf'\blib{library}\b', notice), name


#: Lists of keys and of columns, which nobody reads from end to end.
LISTS = ('case.md', 'tables.md')


@pytest.mark.parametrize('page', [page for page in sorted((ROOT / 'doc').rglob('*.md')) if page.name not in LISTS], ids=lambda page: page.name)
def test_a_page_is_read_in_a_quarter_of_an_hour(page):
    """At most 2500 words of prose: without examples and tables."""
    text = re.sub(r'```.*?```|<!--.*?-->', '', page.read_text(), flags=re.DOTALL)
    assert len(' '.join(line for line in text.splitlines() if not line.startswith('|')).split()) <= 2500
