"""README's blocks, run as printed: what they print is what stands below them."""

import contextlib
import importlib.metadata
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
import tomllib
from conftest import ROOT, alike

README = (ROOT / 'README.md').read_text()


def run(lines, folder, without=()):
    """Runs Python lines by themselves, where the modules `without` cannot be imported."""
    script = ''.join(f'import sys; sys.modules[{name!r}] = None\n' for name in without) + lines
    return subprocess.run(
        [sys.executable, '-W', 'error', '-c', script],
        cwd=folder,
        env=os.environ | {'MPLBACKEND': 'agg'},
        capture_output=True,
        text=True,
        timeout=300, check=False,
    )


def block(kind, beside):
    """The block of this kind behind the remark `beside`, or the first one behind the block before."""
    found = re.search(rf'<!-- {beside} -->\n```{kind}\n(.*?)```', README, re.DOTALL)
    assert found, f'README has no {kind} behind: {beside}'
    return found[1]


def printed_lines():
    return block('python', 'prints the relief and the worst dynamic factor below')


def test_it_is_short():
    assert 80 <= README.count('\n') <= 100


def test_the_case_is_the_one_that_is_run():
    assert block('text', 'the case: examples/first.nml') == (ROOT / 'examples/first.nml').read_text()


def test_the_program_prints_what_the_page_shows(program, tmp_path):
    done = program(ROOT / 'examples/first.nml', cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    # The time is this machine's.
    shown, said = (re.sub(r'(?m)^Time .*$', 'Time', text)
                   for text in (block('text', 'what the program prints of examples/first.nml'), done.stdout))  # fmt: skip
    assert alike(shown, said), f'README shows\n{shown}\nthe program prints\n{said}'


@pytest.mark.parametrize('words', [['--new', '--short', 'sweep'], ['--help', 'tip', 'relief']])
def test_the_other_commands_answer(program, tmp_path, words):
    assert f'sh app/run.sh {" ".join(words)}' in README
    done = program(*words, cwd=tmp_path)
    assert done.returncode == 0 and 'relief' in done.stdout


def test_the_report_is_written(tmp_path):
    assert 'gearsweep examples/first.nml --report first.html' in README
    (tmp_path / 'examples').symlink_to(ROOT / 'examples')
    words = ['-m', 'gearsweep', 'examples/first.nml', '--report', 'first.html', '--no-pictures']
    done = subprocess.run([sys.executable, *words], cwd=tmp_path, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stderr
    assert '<html' in (tmp_path / 'first.html').read_text()[:200]


def name_of(requirement):
    return re.match(r'[A-Za-z0-9._-]+', requirement)[0].lower().replace('_', '-')


def brought():
    """The distributions that README's own `pip install` leaves: what it names, and what that needs in turn."""
    project = tomllib.loads((ROOT / 'pyproject.toml').read_text())['project']
    commands = re.findall(r"^    pip install '?\.(?:\[([a-z,]+)\])?'?$", README, re.MULTILINE)
    assert len(commands) == 1, 'README has one pip install'
    extras = commands[0].split(',') if commands[0] else []
    open_ones = project['dependencies'] + [one for extra in extras for one in project['optional-dependencies'][extra]]
    found = set()
    while open_ones:
        requirement = open_ones.pop()
        name = name_of(requirement)
        if name in found or 'extra ==' in requirement:
            continue
        found.add(name)
        # What is not found is for another system or version of Python.
        with contextlib.suppress(importlib.metadata.PackageNotFoundError):
            open_ones += importlib.metadata.requires(name) or []
    return found


def test_the_lines_work_with_what_is_installed(tmp_path):
    (tmp_path / 'examples').symlink_to(ROOT / 'examples')
    homes = importlib.metadata.packages_distributions()
    mine = brought() | {'gearsweep'}
    lacking = sorted(top for top, owners in homes.items() if mine.isdisjoint(name_of(owner) for owner in owners))
    assert 'pandas' in lacking
    done = run(printed_lines(), tmp_path, lacking)
    assert done.returncode == 0, done.stderr
    assert alike(block('text', 'what these lines print'), done.stdout)
    assert (tmp_path / 'sweep.png').read_bytes()[:4] == b'\x89PNG'


def test_without_matplotlib_they_say_what_to_install(tmp_path):
    (tmp_path / 'examples').symlink_to(ROOT / 'examples')
    done = run(printed_lines(), tmp_path, ['matplotlib'])
    assert done.returncode == 1
    assert done.stderr.splitlines()[-1].endswith('need matplotlib, which is not installed: pip install matplotlib')
    assert done.stdout, 'the numbers do not need it'


def test_the_system_packages_are_named_where_pip_is():
    """All that app/setup.sh installs for the same build, on a line before pip's."""
    needed = re.findall(r'missing="(?:\$missing )?([^"]+)"', (ROOT / 'app/setup.sh').read_text())
    needed = {name for names in needed for name in names.split()} - {'libc6-dev', 'python3'}  # come with the others
    for page in (README, (ROOT / 'doc/python.md').read_text()):
        line = re.search(r'^    sudo apt-get install (.*)$', page, re.MULTILINE)
        assert line and page.index(line[0]) < page.index("pip install '.")
        assert {'gfortran', 'libopenblas-dev', 'pkg-config'} <= needed & set(line[1].split())
        assert {'python3-dev', 'python3-venv'} <= set(line[1].split())


def test_paths_that_readme_names_exist():
    for target in re.findall(r'\]\(([^)#]+)(?:#[^)]*)?\)', README):
        assert (Path(ROOT) / target).exists(), target
