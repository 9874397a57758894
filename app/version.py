"""Compares all places that have the version, or sets them: python3 app/version.py [VERSION [DATE]]
The version is that of fpm.toml. The changelog begins with `VERSION - DATE`, with the date of CITATION.cff, or with `VERSION - unreleased`.
To set a version renames the first heading if that is unreleased, and adds one above it otherwise. Without a date the version is unreleased."""
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
WHOLE, MINOR = r'\d+\.\d+\.\d+', r'\d+\.\d+'
#: Files, the text before the version, the form of the version, and the text after it.
PLACES = (
    ('fpm.toml', r'^version = "', WHOLE, '"'),
    ('src/base/version.f90', "version = '", WHOLE, "'"),
    ('CITATION.cff', '^version: ', WHOLE, '$'),
    ('CHANGELOG.md', '^## ', WHOLE, ' - '),
    ('README.md', '^gearsweep ', WHOLE, '$'),
    ('doc/linking.md', r'find_package\(gearsweep ', MINOR, ' REQUIRED'),
    ('doc/linking.md', r'`libgearsweep\.so\.', MINOR, '`'),
    ('validation/claims.csv', '^CITATION.cff,version: ', WHOLE, ',tested'),
    ('validation/claims.csv', r'src/base/version\.f90 :: ', WHOLE, ','),
)
DAY = re.compile(r'^(date-released: )(\S+)$', re.MULTILINE)
HEADING = re.compile(rf'^(## {WHOLE} - )(\S+)$', re.MULTILINE)


def read(name):
    return (ROOT / name).read_text()


def write(name, text):
    (ROOT / name).write_text(text)


def found(name, before, number, behind):
    """The first match: of the changelog, the newest version."""
    match = re.search(f'({before})({number})(?={behind})', read(name), re.MULTILINE)
    if match is None:
        raise SystemExit(f'{name} has no version after {before}')
    return match


def faults():
    version = found(*PLACES[0])[2]
    for place in PLACES:
        wanted = version if place[2] is WHOLE else version.rpartition('.')[0]
        if (said := found(*place)[2]) != wanted:
            yield f'{place[0]} has {said}, fpm.toml {version}'
    heading, day = HEADING.search(read('CHANGELOG.md')), DAY.search(read('CITATION.cff'))
    if heading is None or day is None:
        yield 'CHANGELOG.md or CITATION.cff has no date'
    elif heading[2] not in ('unreleased', day[2]):
        yield f'CHANGELOG.md has the date {heading[2]}, CITATION.cff {day[2]}'


def set_version(version, date):
    if not re.fullmatch(WHOLE, version) or not re.fullmatch(r'20\d\d-\d\d-\d\d|unreleased', date):
        raise SystemExit('usage: python3 app/version.py [VERSION [YYYY-MM-DD]], as 1.2.0 2030-12-31')
    changes = read('CHANGELOG.md')
    newest = HEADING.search(changes)
    if newest[2] != 'unreleased' and version not in newest[1]:
        write('CHANGELOG.md', changes[: newest.start()] + f'## {version} - {date}\n\n' + changes[newest.start() :])
    for place in PLACES:
        match, text = found(*place), read(place[0])
        write(place[0], text[: match.start(2)] + (version if place[2] is WHOLE else version.rpartition('.')[0]) + text[match.end(2) :])
    write('CHANGELOG.md', HEADING.sub(rf'\g<1>{date}', read('CHANGELOG.md'), count=1))
    if date != 'unreleased':
        write('CITATION.cff', DAY.sub(rf'\g<1>{date}', read('CITATION.cff')))


def main():
    if len(sys.argv) > 1:
        set_version(sys.argv[1], sys.argv[2] if len(sys.argv) == 3 else 'unreleased')
    for fault in (wrong := list(faults())):
        print(fault)
    return bool(wrong)


if __name__ == '__main__':
    sys.exit(main())
