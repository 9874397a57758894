"""Draws doc/develop/architecture.svg from the `use` statements of src and app, and writes the table of rooms on
doc/develop/architecture.md: python3 doc/architecture.py
With an option nothing is written. --files prints every file with its first sentence; --stale lists what is stale; --rooms lists modules
that use a room above their own or another room past its front, that are not named after their path, or that are too long."""
import html
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / 'doc/develop/architecture.md'
PICTURE = ROOT / 'doc/develop/architecture.svg'
MOST_LINES = 800
BEGIN, END = '<!-- rooms: begin, by python3 doc/architecture.py -->', '<!-- rooms: end -->'

# From the ground up: a room may use those before it. What each is for.
ROOMS = {
    'base': 'kinds, errors, texts, tables, polynomials, solvers, memory, the operating system',
    'gear': 'one gear, a pair, its path of contact, tooth profile, tip relief, measures (ISO 21771, ISO 1328)',
    'elastic': 'finite elements of a gear section: compliance, stress, modes; contact of flanks and tip corners',
    'mesh': 'stiffness of a pair of teeth, load sharing, static transmission error, deviations of teeth',
    'face': 'load distribution over the face width: compliance over the face, leads and misalignment, K_H beta',
    'motion': 'the equation of motion, one step, one period, one operating point, sweeps, optimum',
    'rating': 'root stress, flank pressure, ISO 6336, life, losses',
    'study': 'from the text of a case to its tables: reader, case, run, results, tasks',
    'nonlinear': 'stability, branches, sensitivity, and the tasks of nonlinear motion',
    'as_built': 'gears with deviations of each tooth, and their task',
    'body_modes': 'natural modes of gear bodies in three dimensions, and their task',
    'api': 'the list of tasks, help, eleven calls for Fortran 77, C and Python',
    'facade': '`use gearsweep`: the public names',
    'app': 'the program: the only place that prints or stops',
}


def room_of(path):
    """The first folder below src; the room's front module is beside it."""
    folder, *rest = path.relative_to(ROOT / 'src').parts if path.is_relative_to(ROOT / 'src') else ('app',)
    return folder if rest or folder == 'app' else folder.removesuffix('.f90').replace('gearsweep', 'facade')


def sources():
    """The files of src and app by room, each with its text."""
    files = sorted((path for folder in ('src', 'app') for path in (ROOT / folder).rglob('*') if path.suffix in ('.f90', '.c')),
                   key=lambda path: (path.parent != ROOT / 'src', path.parts, path.suffix))
    rooms = {}
    for path in files:
        rooms.setdefault(room_of(path), {})[path] = path.read_text()
    unknown = set(rooms) - set(ROOMS)
    if unknown:
        raise SystemExit(f'{__file__}: say what these rooms are for: {", ".join(sorted(unknown))}')
    order = [*ROOMS]
    return {room: rooms[room] for room in sorted(rooms, key=order.index)}


def edges(rooms):
    """(file, its room, the module used, its room) for every use of another room."""
    home = {name.lower(): room for room, files in rooms.items() for text in files.values()
            for name in re.findall(r'^\s*module\s+(\w+)\s*$', text, re.MULTILINE | re.IGNORECASE) if name.lower() != 'procedure'}
    return [(path, room, name, home[name.lower()]) for room, files in rooms.items() for path, text in files.items()
            for name in re.findall(r'^\s*use\s*(?:,\s*\w+\s*)?(?:::)?\s*(\w+)', text, re.MULTILINE)
            if home.get(name.lower(), room) != room]


def upwards(rooms):
    """What uses a room above its own, or a module of another room that is not its front, a line each."""
    order = list(ROOMS)
    return [f'{path.relative_to(ROOT)} uses {name} of {other}, which stands above {room}' for path, room, name, other in edges(rooms)
            if room in ROOMS and other in ROOMS and order.index(other) > order.index(room)] + [
        f'{path.relative_to(ROOT)} uses {name}; the front of {other} is gearsweep_{other}' for path, _, name, other in edges(rooms)
            if other in ROOMS and other not in ('facade', 'app') and name.lower() != f'gearsweep_{other}']


def named_otherwise(rooms):
    """Files whose module is not named after their path."""
    return [f'{path.relative_to(ROOT)} must have the module {name}' for files in rooms.values() for path, text in files.items()
            if path.is_relative_to(ROOT / 'src') and re.search(r'^module ', text, re.MULTILINE)
            and not re.search(rf'^module {(name := module_of(path))}$', text, re.MULTILINE)]


def module_of(path):
    parts = path.relative_to(ROOT / 'src').with_suffix('').parts
    return parts[0] if parts == ('gearsweep',) else '_'.join(('gearsweep', *parts))


def too_long(rooms):
    """Files with more lines than one noun needs."""
    return [f'{path.relative_to(ROOT)} has {lines} lines, {MOST_LINES} at most' for files in rooms.values()
            for path, text in files.items() if (lines := text.count('\n')) > MOST_LINES]


def arrows(rooms):
    """The pairs of rooms to draw: without those that a longer way shows."""
    order = list(ROOMS)
    direct = {room: {below for _, one, _, below in edges(rooms) if one == room and below in order[:order.index(room)]}
              for room in rooms if room in ROOMS}

    def reach(room, seen=()):
        return {below for one in direct[room] if one not in seen for below in {one} | reach(one, (*seen, room))}
    return [(room, below) for room in direct for below in direct[room]
            if not any(below in reach(other, (room,)) for other in direct[room] - {below})]


def draw(rooms):
    """One box a room, the program on top; arrows from who uses to what is used."""
    height, gap, width = 40, 18, 610
    shown = [room for room in reversed(ROOMS) if room in rooms]
    top = {room: 10 + i * (height + gap) for i, room in enumerate(shown)}
    drawn = sorted(arrows(rooms), key=lambda pair: (top[pair[1]] - top[pair[0]], pair))
    left = 40 + 5 * sum(top[below] - top[room] > height + gap for room, below in drawn)  # room for those past the boxes, half on each side
    parts = []
    far = 0
    for room, below in drawn:
        start, end = top[room] + height, top[below]
        if end - start == gap:
            parts.append(f'<path d="M{left + 60} {start}V{end - 2}"/>')
        else:
            # Past the boxes between, on the left or on the right.
            far += 1
            right = far % 2
            x = left + width if right else left
            out = x + (24 + 10 * (far // 2)) * (1 if right else -1)
            parts.append(f'<path d="M{x} {start - 14}H{out}V{end + 14}H{x + (3 if right else -3)}"/>')
    boxes = []
    for room in shown:
        count = sum(path.suffix == '.f90' for path in rooms[room])
        files = '' if room in ('facade', 'app') else f' ({count} files)'
        boxes.append(f'<rect x="{left}" y="{top[room]}" width="{width}" height="{height}" rx="4"/>'
                     f'<text x="{left + 10}" y="{top[room] + 16}" class="name">{room}<tspan class="what">{files}</tspan></text>'
                     f'<text x="{left + 10}" y="{top[room] + 32}" class="what">{html.escape(ROOMS[room].replace("`", ""))}</text>')
    size = f'width="{width + 2 * left}" height="{len(shown) * (height + gap)}"'
    return '\n'.join([
        f'<svg xmlns="http://www.w3.org/2000/svg" {size} viewBox="0 0 {width + 2 * left} {len(shown) * (height + gap)}" role="img">',
        '<title>The rooms of the sources, and which uses which</title>',
        ('<style>rect{fill:#f4f6f8;stroke:#8a97a5}path{fill:none;stroke:#44525f;stroke-width:1.3;marker-end:url(#tip)}'
        'text{font-family:sans-serif}.name{font-size:13px;font-weight:bold;fill:#1c2833}.what{font-size:12px;font-weight:normal;'
        'fill:#44525f}.ground{fill:#fff;stroke:none}</style>'),
        ('<defs><marker id="tip" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="7" markerHeight="7" orient="auto">'
        '<polygon points="0,0 8,4 0,8" fill="#44525f"/></marker></defs>'),
        '<rect class="ground" width="100%" height="100%"/>', *parts, *boxes, '</svg>', ''])


def first_sentence(path, text):
    """What the file says of itself first."""
    if path.suffix == '.c':
        words = re.match(r'\s*/\*(.*?)\*/', text, re.DOTALL)
        said = words[1] if words else ''
    else:
        lines = []
        for line in text.splitlines():
            match = re.match(r'\s*!>?(?:\s(.*))?$', line)
            if not match or (lines and not match[1]):
                break
            lines.append(match[1] or '')
        said = ' '.join(lines)
    said = re.sub(r'\s+', ' ', said).strip()
    match = re.match(r'.*?[.;](?=\s|$)', said)
    said = (match[0] if match else said).rstrip('.:;')
    if not said:
        raise SystemExit(f'{path.relative_to(ROOT)} does not say what it is for: its first line must be a comment')
    return said.replace('|', '\\|')


def folder_of(room):
    return {'facade': 'src/gearsweep.f90', 'app': 'app'}.get(room, f'src/{room}')


def table_of(rooms):
    """A row for each room: its folder, how many files, what it is for."""
    lines = ['| room | files | what it is for |', '|---|---|---|']
    for room, files in rooms.items():
        lines.append(f'| [{folder_of(room)}](../../{folder_of(room)}) | {len(files)} | {ROOMS[room]} |')
    return '\n'.join(lines)


def listing(rooms):
    """A part for each room: its files, and what they say they are for."""
    lines = []
    for room, files in rooms.items():
        lines += ['', f'### {folder_of(room)}', '', f'{ROOMS[room][0].upper()}{ROOMS[room][1:]}.', '', '| file | what it is for |', '|---|---|']
        lines += [f'| [{(name := path.relative_to(ROOT).as_posix())}]({name}) | {first_sentence(path, text)} |' for path, text in files.items()]
    return '\n'.join([*lines, ''])


def page_with(rooms):
    text = PAGE.read_text()
    before, rest = text.split(BEGIN)
    return before + BEGIN + '\n' + table_of(rooms) + '\n' + END + rest.split(END)[1]


def missing(rooms):
    """Files that this page and CONTRIBUTING.md name and that are not there, and lines of code that they show and that are no more."""
    faults = []
    code = {line.strip() for files in rooms.values() for text in files.values() for line in text.splitlines()}
    for page in (PAGE, ROOT / 'CONTRIBUTING.md'):
        text = page.read_text()
        name = page.relative_to(ROOT)
        faults += [f'{name} names {link}, which is not there' for link in re.findall(r'\]\((?!http)([^)#]+)', text)
                   if not (page.parent / link).exists()]
        faults += [f'{name} shows a line that is not in the sources: {line.strip()}'
                   for block in re.findall(r'```fortran\n(.*?)```', text, re.DOTALL) for line in block.splitlines()
                   if line.strip() not in code | {'', '...'}]
    return faults


def stale(rooms):
    """What is no longer as it would be written now; each file must say what it is for."""
    listing(rooms)
    return [f'{path.relative_to(ROOT)} is stale: python3 doc/architecture.py'
            for path, now in ((PAGE, page_with(rooms)), (PICTURE, draw(rooms))) if not path.exists() or path.read_text() != now]


def main():
    rooms = sources()
    if sys.argv[1:] == ['--files']:
        print(listing(rooms))
        return
    if sys.argv[1:]:
        faults = {'--rooms': lambda rooms: upwards(rooms) + named_otherwise(rooms) + too_long(rooms), '--stale': lambda rooms: stale(rooms) or missing(rooms)}[sys.argv[1]](rooms)
        print('\n'.join(faults), end='\n' if faults else '')
        raise SystemExit(bool(faults))
    PICTURE.write_text(draw(rooms))
    PAGE.write_text(page_with(rooms))


if __name__ == '__main__':
    main()
