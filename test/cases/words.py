"""The words that the table of CONTRIBUTING.md rules out: python3 test/cases/words.py
A word in bold in its last column is wrong wherever it stands. Each place is named with the word to say instead, and the exit code is 1.
The other words of that column are right for something else, which a search cannot tell.
With FILE..., in these files only."""
import io
import re
import subprocess
import sys
import tokenize
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PLACES = ('src', 'app', 'python/gearsweep', 'test', 'tools/callers', 'tools/reference', 'doc', 'README.md', 'CHANGELOG.md')
SUFFIXES = {'.f90', '.c', '.h', '.cpp', '.py', '.pyi', '.js', '.html', '.sh', '.md', '.txt', '.pyf'}

#: What is taken out of `path: line` before it is searched, and why.
EXCEPTED = (
    (r'[`\'"]member *[`\'"]|&section member = ', 'the former name of a key and a column'),
    (r'^(app/(wheel|release)\.sh|test/cases/(test_wheel|release)\.sh): .*|wheel\.sh|[wW]heel for other machines|manylinux|test_wheel|(a|the) wheel with|builds, wheel, limits|the wheel, scripts|leaves a wheel',
     'a package of Python'),
    (r'\'wheel\'|grinding wheel|edge break of its wheel', 'a wrong value, a tool and the word of a report'),
    (r'settling_periods', 'a key'),
    (r'an Octave transcription|GNU Octave|Octave, as in the paper', 'the program'),
    (r'yield(_| )(strength|point)|no_yield|\'yield\'', 'plastic flow, and the statement of Python'),
    (r'strobe\.svg|plot_strobe|[\'"`]strobe[\'"`]', 'the name of a picture'),
    (r'(waits|Waits) (for|until)|[Nn]obody waits|who waits|thread waits|With `waits`', 'a program that waits'),
    (r'[\'`]stretch *[\'`]|stretches by 1e-4|Stretches, shear', 'the name of a mode, and strain'),
    (r'^test/lint\.sh: printf .*', 'what the check of this check is made of'),
    (r'level_crossings', 'of a stress, by which cycles are counted'),
)
#: Words that may stand as names in code, and why.
IN_CODE = {
    'yield': 'a statement of Python',
    'waits': 'an argument, of a program that waits',
}


def ruled_out():
    """Each word in bold of the last column, with the words to say for it."""
    text = (ROOT / 'CONTRIBUTING.md').read_text()
    rows = re.findall(r'^\| ([^|]+) \| ([^|]+) \| ([^|]+) \|$', text, re.MULTILINE)
    found = {}
    for say, _, words in rows:
        for word in re.findall(r'\*\*([^*]+)\*\*', words):
            found[word] = f'{found[word]}, or {say}' if word in found else say
    return found


def pattern(word):
    """The word in all its forms, also as a part of a name."""
    stem = word.removesuffix('e')
    ends = '(e|es|ed|er|ing)' if stem != word else '(s|es|ed|ing)?'
    return re.compile(f'(?<![a-z]){stem.replace(" ", "[ _]")}{"" if word.endswith("s") else ends}(?![a-z])', re.IGNORECASE)


def code_of_fortran(line):
    """A line without its comment and its strings."""
    return re.sub(r"'[^']*'|\"[^\"]*\"|!.*", lambda found: ' '*len(found.group()), line)


def code_of_python(text):
    """The lines of a file without comments and strings."""
    lines = [[*line] for line in text.splitlines()]
    for kind, _, (row, first), (last_row, last), _ in tokenize.generate_tokens(io.StringIO(text).readline):
        if kind in (tokenize.COMMENT, tokenize.STRING):
            for at in range(row - 1, last_row):
                begin, end = (first if at == row - 1 else 0), (last if at == last_row - 1 else len(lines[at]))
                lines[at][begin:end] = ' '*(end - begin)
    return [''.join(line) for line in lines]


def code_of(path, text):
    """Per line, what is code and no sentence."""
    if path.suffix == '.f90':
        return [code_of_fortran(line) for line in text.splitlines()]
    if path.suffix in ('.py', '.pyi'):
        return code_of_python(text)
    return [line if path.suffix in ('.js', '.c', '.cpp') and not re.match(r'\s*(//|/?\*)', line) else '' for line in text.splitlines()]


def files(named):
    if named:
        return [Path(name).resolve() for name in named]
    listed = subprocess.run(['git', 'ls-files', '--', *PLACES], cwd=ROOT, capture_output=True, text=True, check=True).stdout
    return [ROOT / name for name in listed.splitlines() if Path(name).suffix in SUFFIXES and ROOT / name != Path(__file__).resolve()]


def shown(path):
    return path.relative_to(ROOT).as_posix() if path.is_relative_to(ROOT) else path.name


def newest(path, text):
    """Of the changelog its newest section."""
    return '\n## '.join(text.split('\n## ')[:2]) if path.name == 'CHANGELOG.md' else text


def found_in(path, words):
    """Line and word of each place."""
    text = newest(path, path.read_text())
    name = f'{shown(path)}: '
    for number, (line, code) in enumerate(zip(text.splitlines(), code_of(path, text), strict=True), 1):
        line, code = name + line, ' '*len(name) + code
        for excepted, _ in EXCEPTED:
            line = re.sub(excepted, lambda found: ' '*len(found.group()), line)
        for word, form in words.items():
            for place in form.finditer(line):
                if not (word in IN_CODE and code[place.start():place.end()].strip()):
                    yield number, word, place.group()


def main():
    say = ruled_out()
    if not say:
        sys.exit('CONTRIBUTING.md: its table of words has none in bold')
    words = {word: pattern(word) for word in say}
    wrong = [f'{shown(path)}:{number}: {form}: say {say[word]}' for path in files(sys.argv[1:]) for number, word, form in found_in(path, words)]
    print(*wrong, sep='\n')
    sys.exit(1 if wrong else 0)


if __name__ == '__main__':
    main()
