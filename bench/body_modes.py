"""Natural modes of the gear of Thamba et al. 2020 in three dimensions: one tooth sector beside CalculiX on the whole gear.

    python bench/body_modes.py PROGRAMS        (bench/run.sh body_modes sets up and does this)

The grid of the whole gear is the sector's, turned: CalculiX gets half of it twice, once for either symmetry about the middle
plane. Seconds are those of the processor, memory is the largest that a process held.
"""

import os
import pathlib
import subprocess
import sys
import tempfile

import numpy as np
from report import Report, first_line, machine

GRIDS = (2, 3)  # elements across a tooth
OF_EACH = 1  # modes of each nodal diameter and symmetry
OTHERS = 30  # modes of each symmetry by CalculiX
EDGE = 1e-3  # relative gap below the first mode that a nodal diameter may have beyond those wanted

body_modes = pathlib.Path(sys.argv[1]).resolve() / 'body_modes'


def measured(*command, folder):
    """Processor seconds, megabytes and output of a program."""
    with (folder / 'output').open('w+') as output:
        process = subprocess.Popen([str(part) for part in command], stdout=output, cwd=folder)
        _, status, used = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        if process.returncode:
            raise SystemExit(f'{command[0]} failed')
        output.seek(0)
        return used.ru_utime + used.ru_stime, used.ru_maxrss / 1e3, output.read()


def calculix(across, symmetry, count, folder):
    """Processor seconds, megabytes and frequencies."""
    subprocess.run([body_modes, 'deck', str(across), str(symmetry), str(count), folder / 'gear.inp'], check=True)
    seconds, memory, _ = measured('ccx', '-i', 'gear', folder=folder)
    rows = [line.split() for line in (folder / 'gear.dat').read_text().splitlines()]
    return seconds, memory, np.array([float(row[3]) for row in rows if len(row) == 5 and row[0].isdigit()][:count])


def compare(across, folder):
    """One row of the table."""
    seconds, memory, output = measured(body_modes, 'modes', across, OF_EACH, folder=folder)
    head, *rows = output.splitlines()
    modes = np.array([row.split() for row in rows], dtype=float)
    others, apart = np.zeros(2), 0.0
    for symmetry in (1, 2):
        ours = modes[modes[:, 0] == symmetry]
        frequencies = np.sort(np.repeat(ours[:, 3], ours[:, 2].astype(int)))
        taken = calculix(across, symmetry, OTHERS, folder)
        others = np.array((others[0] + taken[0], max(others[1], taken[1])))
        # The whole gear also has second modes of a nodal diameter among its lowest: each of ours must be one of its own.
        inside = frequencies[frequencies < taken[2][-1] * (1 - EDGE)]
        apart = max(apart, *(np.abs(taken[2] / frequency - 1).min() for frequency in inside))
    return [head.split()[1], f'{modes[:, 2].sum():.0f}', seconds, memory, others[0], others[1], others[0] / seconds, f'{apart:.1e}']


def main():
    report = Report('body_modes', 'Modes of a gear in three dimensions: one sector beside the whole gear')
    report.add(f'{machine()}, one thread; CalculiX {first_line("ccx", "-v").split()[-1]}. Gear of 60 teeth; unknowns of the half sector; '
               'processor seconds and megabytes of gearsweep, all nodal diameters, and of CalculiX, the lowest; last the '
               'largest relative difference of a frequency.\n')
    with tempfile.TemporaryDirectory() as name:
        rows = [compare(across, pathlib.Path(name)) for across in GRIDS]
    report.table(('unknowns', 'modes', 's', 'MB', f'CalculiX s, {2 * OTHERS} modes', 'MB', 'faster by', 'differs by'), rows)
    report.save()


main()
