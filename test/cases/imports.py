"""Checks the imports of the Python package: python3 test/cases/imports.py [FOLDER]
No modules import each other in a circle, and each room imports only rooms before it in `ROOMS`. Imports inside functions count; those
under `if TYPE_CHECKING` do not, as they do not run. Every fault is printed on a line, and the exit code is 1.
"""
import ast
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
#: From the ground up; '' is the package's front: __init__ and __main__.
ROOMS = ('core', 'plots', 'report', 'many', 'panel', '')
#: The calls of the library, which import nothing.
COMPILED = '_flat'


def modules(package):
    """Returns the file of each module, by its name within the package; '' is the package itself."""
    return {'.'.join(path.relative_to(package).with_suffix('').parts).removesuffix('__init__').removesuffix('.'): path
            for path in sorted(package.rglob('*.py'))}


def imports(tree):
    """Lists all import statements that can run."""
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, (ast.Import, ast.ImportFrom)):
            yield node
        elif isinstance(node, ast.If) and ast.unparse(node.test).endswith('TYPE_CHECKING'):
            yield from imports(ast.Module(node.orelse, []))
        else:
            yield from imports(node)


def imported(name, path, files, package):
    """Returns the modules of the package that a module imports."""
    folder = name.split('.') if path.name == '__init__.py' and name else name.split('.')[:-1]
    found = set()
    for node in imports(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            names = [one.name.partition('.')[2] for one in node.names if one.name.split('.')[0] == package]
            found.update(names)
            continue
        if node.level == 0 and (node.module or '').split('.')[0] != package:
            continue
        above = folder[:len(folder) - node.level + 1] if node.level else []
        source = '.'.join([*above, *(node.module or '').split('.')[node.level == 0:]]).strip('.')
        for one in node.names:
            module = f'{source}.{one.name}'.strip('.')
            if module != COMPILED:
                found.add(module if module in files else source)
    return found


def circle(graph):
    """Returns one circle of modules, or an empty list."""
    done = set()

    def search(name, way):
        if name in way:
            return way[way.index(name):]
        if name in done:
            return []
        for below in sorted(graph[name]):
            if found := search(below, [*way, name]):
                return found
        done.add(name)
        return []

    return next((found for name in graph if (found := search(name, []))), [])


def room(name):
    return name.split('.')[0] if name.split('.')[0] in ROOMS else ''


def faults(package):
    """Returns a line for each import of a higher room, and one for a circle."""
    files = modules(package)
    graph = {name: imported(name, path, files, package.name) for name, path in files.items()}
    lines = [f'{files[name]} imports {package.name}.{below}, which does not exist' for name in graph for below in sorted(graph[name] - set(files))]
    graph = {name: below & set(files) for name, below in graph.items()}
    lines += [f'{files[name]} imports {package.name}.{below}: {room(below) or "the front"} is above {room(name)}'
             for name in graph for below in sorted(graph[name]) if ROOMS.index(room(below)) > ROOMS.index(room(name))]
    if found := circle(graph):
        lines.append(f'{package}: modules import each other in a circle: {" -> ".join(one or "the front" for one in [*found, found[0]])}')
    return lines


def main():
    found = faults(Path(sys.argv[1]) if sys.argv[1:] else ROOT / 'python/gearsweep')
    print(*found, sep='\n', end='\n' if found else '')
    sys.exit(bool(found))


if __name__ == '__main__':
    main()
