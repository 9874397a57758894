"""Light loads on gears relieved for full load: the time of motions with lost contact, many of which do not repeat.

    python bench/part_load.py               (bench/run.sh part_load sets up and does this)
"""
import os
import pathlib
import subprocess
import tempfile

from as_built import PROGRAM
from report import Report, machine

REPEATS = 3
CASE = """&case tasks = '{task}' /
&pair module_mm = {module} face_width_mm = {width} /
&pinion teeth = {teeth[0]} profile_shift = {shift[0]} bore_mm = {bore[0]} /
&gear teeth = {teeth[1]} profile_shift = {shift[1]} bore_mm = {bore[1]} /
&load torque_nm = {torque} /
&relief amount_um = {reliefs} /
&dynamics damping_ratio = {damping} /
"""
SWEEP = '&sweep rpm_first = 500 rpm_last = {last} rpm_step = {step} /\n'
RATING = "&rating rpm = {rpm} material = '18CrNiMo7-6' accuracy_grade = 6 /\n"
PAIRS = (
    dict(teeth=(17, 25), module=1, width=9.3, shift=(0.17, 0.21), bore=(5.9, 6.2), torque=0.07, reliefs='0, 2, 5', damping=0.07,
         last=12000, step=200, rpm=6000),
    dict(teeth=(40, 43), module=8, width=108.8, shift=(0.14, -0.24), bore=(112, 86), torque=309.57, reliefs='0, 16, 40', damping=0.1,
         last=6000, step=100, rpm=3000),
    dict(teeth=(31, 97), module=1, width=11.6, shift=(0.19, -0.2), bore=(10.8, 24.2), torque=0.3, reliefs='0, 2, 5', damping=0.1,
         last=12000, step=200, rpm=6000),
    dict(teeth=(29, 61), module=4, width=52.3, shift=(0.37, 0.25), bore=(40.6, 61), torque=34.82, reliefs='0, 8, 20', damping=0.03,
         last=12000, step=200, rpm=6000))


def seconds(task, pair):
    """Least processor time of a task, s."""
    text = CASE + {'sweep': SWEEP, 'optimum': SWEEP, 'rating': RATING, 'mesh': ''}[task]
    times = []
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / 'case.nml'
        path.write_text(text.format(task=task, **pair))
        for _ in range(REPEATS):
            before = os.times()
            code = subprocess.run([PROGRAM, path, '--quiet', '--threads', '1', '--out', folder], check=False).returncode
            after = os.times()
            assert code in (0, 4), code           # 4: a motion that does not repeat has no dynamic factor
            times.append(after.children_user + after.children_system - before.children_user - before.children_system)
    return min(times)


def main():
    report = Report('part_load', 'Light loads on gears relieved for full load')
    report.add(f'{machine()}, one thread. Processor time of a run, the least of {REPEATS}: the mesh by finite elements alone, a sweep of three '
               'reliefs over 56 or 58 speeds, the best relief, a rating at one speed.\n')
    tasks = ('mesh', 'sweep', 'optimum', 'rating')
    rows = [('/'.join(map(str, pair['teeth'])), *(seconds(task, pair) for task in tasks)) for pair in PAIRS]
    report.table(('teeth', *tasks), [(name, *(f'{one:.2f} s' for one in times)) for name, *times in rows])
    most = [max(row[1 + k] for row in rows) for k in range(len(tasks))]
    report.tell(f'at part load a sweep takes at most {most[1]:.2f} s, the best relief {most[2]:.2f} s, a rating {most[3]:.2f} s.')
    report.save()


main()
