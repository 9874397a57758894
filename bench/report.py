"""What the benchmarks share: running and timing contenders, tables (Markdown and CSV), pictures."""
import csv
import datetime
import itertools
import pathlib
import platform
import re
import subprocess

import numpy as np

BENCH = pathlib.Path(__file__).resolve().parent
RESULTS = BENCH.parent / 'results' / 'bench'


def run(*command, **options):
    """What a program prints."""
    answer = subprocess.run([str(part) for part in command], capture_output=True, text=True, check=False, **options)
    if answer.returncode:
        raise SystemExit(f'{command[0]} failed: {answer.stderr.strip()}')
    return answer.stdout


def first_line(*command):
    answer = subprocess.run(command, capture_output=True, text=True, check=False)
    return (answer.stdout + answer.stderr).strip().splitlines()[0].strip()


def machine():
    """Date, processor, compiler."""
    cpu = re.search(r'model name\s*: (.*)', pathlib.Path('/proc/cpuinfo').read_text())
    return f'{datetime.date.today()}, {cpu[1] if cpu else platform.processor()}, {first_line("gfortran", "--version")}'


class Report:
    """Markdown on the screen and in results/bench/NAME.md; what the page says of it in short, and of which machine, in NAME.short.md."""

    def __init__(self, name, title):
        RESULTS.mkdir(parents=True, exist_ok=True)
        self.name, self.lines, self.short = name, [], []
        self.add(f'### {title}\n')

    def add(self, text):
        print(text, flush=True)
        self.lines.append(text)

    def tell(self, text):
        """A line of what the page says in short."""
        print(f'- {text}', flush=True)
        self.short.append(f'- {text}\n')

    def table(self, header, rows):
        """`header` and the rows' cells are texts or numbers; an empty last line ends the table."""
        lines = ['| ' + ' | '.join(header) + ' |', '|' + '---|' * len(header)]
        lines += ['| ' + ' | '.join(cell if isinstance(cell, str) else f'{cell:.3g}' for cell in row) + ' |' for row in rows]
        self.add('\n'.join(lines) + '\n')

    def csv(self, name, header, rows):
        with (RESULTS / f'{name}.csv').open('w', newline='') as file:
            file.write(f'# {machine()}\n')
            writer = csv.writer(file)
            writer.writerow(header)
            writer.writerows(rows)

    def save(self):
        (RESULTS / f'{self.name}.md').write_text('\n'.join(self.lines))
        (RESULTS / f'{self.name}.short.md').write_text(f'{machine()}, one thread unless said:\n\n{"".join(self.short)}')


def rows_of(name):
    """The rows of a table of results/bench, each by the names of its columns."""
    with (RESULTS / f'{name}.csv').open(newline='') as file:
        next(file)
        return list(csv.DictReader(file))


def time_at(aim, errors, seconds):
    """Time at an error, between the two settings around it; NaN where none comes as far.

    Settings that cost more and err more than another are left out."""
    best = []
    for error, time in sorted(zip(errors, seconds), key=lambda point: point[1]):
        if np.isfinite(error) and (not best or error < best[-1][0]):
            best.append((max(error, 1e-16), time))
    for (e1, t1), (e2, t2) in itertools.pairwise(best):
        if e2 <= aim < e1:
            return t1 * (t2 / t1)**(np.log(e1 / aim) / np.log(e1 / e2))
    return best[0][1] if best and best[0][0] <= aim else float('nan')
