"""Gears as built whose teeth all meet each other: the time of a hunting pair, to the tolerance and with quick.

    python bench/hunting.py                 (bench/run.sh hunting sets up and does this)
"""
import resource

from as_built import run
from report import Report, machine

DRAWS, SPEEDS = 100, 50
CASE = """&case tasks = 'as_built' /
&pair module_mm = 2.5 face_width_mm = 28 /
&pinion teeth = 23 profile_shift = 0.3 /
&gear teeth = 57 profile_shift = -0.1 /
&material young_gpa = 206 poisson = 0.3 density_kgm3 = 7850 /
&load torque_nm = 180 /
&mesh model = 'fe' /
&relief amount_um = {reliefs} /
&dynamics damping_ratio = 0.1 /
&deviations pinion_class = 6 gear_class = 6 draws = {draws} /
&sweep rpm_first = 1500 rpm_last = 11986 rpm_step = 214 /
&as_built quick = .{quick}. /
"""


def price(reliefs):
    """Processor time of an operating point to the tolerance (ms): what two more draws take."""
    one, three = (run(CASE.format(draws=draws, reliefs=reliefs, quick='false'))[0] for draws in (1, 3))
    return 1e3 * (three - one) / (2 * SPEEDS * len(reliefs.split(',')))


def main():
    report = Report('hunting', 'Turns of a hunting pair as built')
    report.add(f'{machine()}, one thread. 23/57 teeth of class 6 with contact beyond A and E, whose turn has 1311 mesh periods, at {SPEEDS} speeds '
               'from 1500 to 11986 rpm: processor time of an operating point at the tolerance 1e-6, what two draws more take.\n')
    reliefs = ('0', '5', '10', '15')
    prices = [price(relief) for relief in reliefs]
    report.table(('relief um', 'an operating point'), [(relief, f'{one:.0f} ms') for relief, one in zip(reliefs, prices, strict=True)])
    many = run(CASE.format(draws=DRAWS, reliefs=', '.join(reliefs), quick='true'))[0]
    memory = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024
    report.add(f'\n{DRAWS} pairs of gears, these speeds and reliefs, with `quick`: {many:.0f} s of processor time and {memory:.0f} MB.\n')
    report.tell(f'an operating point of 23/57 teeth takes {min(prices):.0f} to {max(prices):.0f} ms, and {DRAWS} pairs of gears with quick {many:.0f} s.')
    report.save()


main()
