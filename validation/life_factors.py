"""The S-N curves of the materials of `&rating material`, as the program has them: the table of doc/strength.md.

    python -m validation.life_factors

writes it into the page.
"""

import pathlib

import gearsweep

from .page import markdown, parts

PAGE = pathlib.Path(__file__).parent.parent / 'doc' / 'strength.md'
MARKS = '<!-- life factors: begin, by python -m validation.life_factors -->', '<!-- life factors: end -->'
TEXT = """&case tasks = 'life' / &pair module_mm = 3 face_width_mm = 20 / &pinion teeth = 21 / &gear teeth = 34 / &load torque_nm = 20 /
&mesh model = 'weber' / &rating material = '{}' / &life rpm = 100 duration_h = 1 dynamic_load = .false. /"""


def materials():
    """Names of the materials, without common names, as the program declares them."""
    words = next(key['words'] for key in gearsweep.core.library.declared()['keys'] if (key['group'], key['name']) == ('rating', 'material'))
    return [word for word in words if word.islower()]


def factors(curve):
    """Static end, knee and last point: load cycles, and the stress over that at the knee."""
    return [f'{stress / curve.stress_mpa[1]:.4g} at {cycles:.3g}' for cycles, stress in zip(curve.failure_cycles, curve.stress_mpa)]


def table():
    rows = {}
    for material in materials():
        study = gearsweep.run(gearsweep.Case(TEXT.format(material)))
        rows.setdefault((*factors(study.life_curve), *factors(study.contact_curve)), []).append(f'`{material}`')
    names = ('material', 'Y_NT: static end', 'knee', 'last point', 'Z_NT: static end', 'knee', 'last point')
    return markdown(names, [(', '.join(found), *values) for values, found in rows.items()])


def current():
    """The table as the page has it."""
    return parts(PAGE, *MARKS)[1].strip()


if __name__ == '__main__':
    before, _, after = parts(PAGE, *MARKS)
    PAGE.write_text(f'{before}{table()}\n{after}', encoding='utf-8')
    print(table())
