"""Draws doc/architecture.svg from the `use` statements of src and app, and writes the list of files on doc/architecture.md
from the first sentence of each file: python3 doc/architecture.py
With --stale and --rooms nothing is written: the former tells what is stale, the latter which module uses one of a room above
its own."""
import html
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / 'doc/architecture.md'
PICTURE = ROOT / 'doc/architecture.svg'
BEGIN, END = '<!-- files: begin, by python3 doc/architecture.py -->', '<!-- files: end -->'

# From the ground up: a room may use those before it. What each is for.
ROOMS = {
    'foundation': 'kinds, units, errors, text, polynomials, interfaces to C and to libraries',
    'geometry': 'one gear, a pair, its path of contact, tooth profile and relief',
    'elastic': 'finite elements of a gear body: compliance, stress, modes',
    'mesh': 'stiffness of a pair of teeth, load sharing, static transmission error',
    'rating': 'root stress under the real load, ISO 6336-3, Lewis',
    'dynamics/model': 'the equation of motion once, and its coefficients over the phase',
    'dynamics/step': 'one step and one period: collocation, contact events, load peaks',
    'dynamics/solve': 'one operating point: steady motion, its stability, its error',
    'dynamics/analyses': 'many points: sweep, optimum, response, stability, Poincare section',
    'dynamics/quick': 'whole turns of many pairs of gears to 1e-3, in few long steps',
    'bifurcation': 'branches of periodic motions, and where the motion changes its kind along them',
    'sensitivity': 'how a motion changes with each number of its oscillator',
    'reader': 'the form of a case: groups, keys and values of a text, each key declared once',
    'case': 'what is wanted: the keys that several tasks share, their checks, and what a case knows of a task',
    'tasks': 'what a case may ask for: a file or a folder for each, with its keys, its run and its tables',
    'catalogue': 'all tasks and keys together: reading of cases, help, cases to begin with',
    'study': 'from a case to its results, stage by stage, task by task',
    'results': 'tables of results, and what is written from them',
    'api': 'eleven calls for Fortran 77, C and Python',
    'facade': '`use gearsweep`: the public names',
    'app': 'the program: the only place that prints or stops',
}


# Rooms of which others use this module and none beside it.
ENTRIES = {'bifurcation': 'gearsweep_bifurcation', 'sensitivity': 'gearsweep_sensitivity'}


def room_of(path):
    """Some rooms have folders, which are no rooms."""
    folder = path.relative_to(ROOT).parent.as_posix().removeprefix('src/')
    return 'facade' if folder == 'src' else next((room for room in ROOMS if folder.startswith(f'{room}/')), folder)


def sources():
    """The files of src and app by room, each with its text."""
    files = sorted((path for folder in ('src', 'app') for path in (ROOT / folder).rglob('*') if path.suffix in ('.f90', '.c')),
                   key=lambda path: (path.stem, path.suffix))
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
    """What uses a room above its own, or a room past its entry, a line each."""
    order = list(ROOMS)
    return [f'{path.relative_to(ROOT)} uses {name} of {other}, which stands above {room}' for path, room, name, other in edges(rooms)
            if room in ROOMS and other in ROOMS and order.index(other) > order.index(room)] + [
        f'{path.relative_to(ROOT)} uses {name} of {other}, whose entry is {ENTRIES[other]}' for path, _, name, other in edges(rooms)
            if other in ENTRIES and name.lower() != ENTRIES[other]]


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


def listing(rooms):
    """A table for each room: its files, and what they say they are for."""
    lines = []
    for room, files in rooms.items():
        what = ROOMS[room].replace('`use gearsweep`: the', 'The')
        folder = {'facade': 'src', 'app': 'app'}.get(room, f'src/{room}')
        lines += ['', f'### {folder}', '', f'{what[0].upper()}{what[1:]}.', '', '| file | what it is for |', '|---|---|']
        lines += [f'| [{path.name}](../{path.relative_to(ROOT).as_posix()}) | {first_sentence(path, text)} |' for path, text in files.items()]
    return '\n'.join([*lines, ''])


def page_with(rooms):
    text = PAGE.read_text()
    before, rest = text.split(BEGIN)
    return before + BEGIN + '\n' + listing(rooms) + '\n' + END + rest.split(END)[1]


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
    """What is no longer as it would be written now."""
    return [f'{path.relative_to(ROOT)} is stale: python3 doc/architecture.py'
            for path, now in ((PAGE, page_with(rooms)), (PICTURE, draw(rooms))) if not path.exists() or path.read_text() != now]


def main():
    rooms = sources()
    if sys.argv[1:]:
        faults = {'--rooms': upwards, '--stale': lambda rooms: stale(rooms) or missing(rooms)}[sys.argv[1]](rooms)
        print('\n'.join(faults), end='\n' if faults else '')
        raise SystemExit(bool(faults))
    PICTURE.write_text(draw(rooms))
    PAGE.write_text(page_with(rooms))


if __name__ == '__main__':
    main()
