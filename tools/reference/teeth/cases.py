"""The cases of the load-distribution analysis: what they are made of, and as cases of gearsweep."""
from dataclasses import dataclass
from itertools import product


@dataclass(frozen=True)
class Case:
    name: str
    teeth: tuple
    module: float
    load: float                          # on the line of action, N/mm
    reliefs: tuple = (0.0, 10.0)         # of both gears, from B and D on, um
    angle: tuple = (20.0, 20.0)          # pressure angle of the rack on drive and coast flanks, deg
    shift: tuple = (0.0, 0.0)
    addendum: float = 1.0
    dedendum: float = 1.25
    tip_radius: float = 0.25
    section: int = 3                     # teeth; 0 for whole gears
    bore: tuple = (0.0, 0.0)             # diameters, mm
    switches: tuple = ((0, 0, 0), (0, 1, 0), (1, 1, 0), (1, 1, 1))


DOGAN = (25, 25), 3.18, 276.0
CASES = [
    Case('three', *DOGAN, (0.0, 5.0, 10.0, 15.0), switches=tuple(product((0, 1), repeat=3))),
    Case('five', *DOGAN, section=5),
    Case('seven', *DOGAN, section=7),
    Case('bore-40', *DOGAN, section=0, bore=(40.0, 40.0)),
    Case('bore-10', *DOGAN, section=0, bore=(10.0, 10.0)),
    Case('turbine', (25, 116), 7.0, 560.0, (0.0, 28.0)),
    Case('shifted', (20, 40), 2.0, 200.0, shift=(0.3, -0.1), section=5),
    Case('stub', (22, 30), 3.0, 150.0, addendum=0.7, dedendum=1.0, section=5),
    Case('high', (40, 60), 2.5, 250.0, angle=(17.0, 17.0), addendum=1.4, dedendum=1.65, tip_radius=0.2, section=7),
    Case('high-bore', (40, 60), 2.5, 250.0, angle=(17.0, 17.0), addendum=1.4, dedendum=1.65, tip_radius=0.2, section=0,
         bore=(30.0, 40.0)),
    Case('asymmetric', (25, 40), 3.0, 300.0, angle=(30.0, 20.0), tip_radius=0.2, section=5),
    Case('asymmetric-bore', (25, 40), 3.0, 200.0, angle=(18.0, 28.0), tip_radius=0.2, section=0, bore=(30.0, 30.0)),
]


def text(case, keys=''):
    """The case as gearsweep reads it, with further keys of the group mesh."""
    gears = '\n'.join(
        f'&{name} teeth = {case.teeth[k]} profile_shift = {case.shift[k]} addendum = {case.addendum} dedendum = {case.dedendum} '
        f'rack_tip_radius = {case.tip_radius}{f" bore_mm = {case.bore[k]}" if case.bore[k] else ""} /'
        for k, name in enumerate(('pinion', 'gear')))
    coast = f' coast_angle_deg = {case.angle[1]}' if case.angle[1] != case.angle[0] else ''
    fixed = "'sides', 'rim'" if case.section else "'rim'"
    return f"""&case tasks = 'mesh' /
&pair module_mm = {case.module} pressure_angle_deg = {case.angle[0]}{coast} face_width_mm = 10 /
{gears}
&load line_load_n_mm = {case.load} /
&relief amount_um = {', '.join(str(v) for v in case.reliefs)} start = 'hpstc' /
&mesh model = 'fe' ste_harmonics = 3 {keys} /
&section teeth = {case.section} fixed = {fixed} /
"""
