"""What the three inputs that no drawing states decide, for the pair of examples/first.nml: the tables of doc/choices.md.

    python -m validation.choices

writes them into the page.
"""

import pathlib

import gearsweep

from .page import markdown, parts

ROOT = pathlib.Path(__file__).parent.parent
PAGE = ROOT / 'doc' / 'choices.md'
NAMES = ('racks', 'damping', 'bodies')
#: Addendum, dedendum and tip radius of the basic racks of ISO 53, in modules.
RACKS = {'A': (1, 1.25, 0.38), 'B': (1, 1.25, 0.30), 'C': (1, 1.25, 0.25), 'D': (1, 1.4, 0.39)}
RATIOS = (0.17, 0.1, 0.07, 0.03)
#: Through all resonances of the pair.
SPEEDS = {'rpm_first': 1000, 'rpm_last': 26000, 'rpm_step': 100}
BODIES = {
    'whole gears on assumed bores of 21 and 34 mm (the default)': {},
    'whole gears on bores of 20 and 40 mm': {'pinion': {'bore_mm': 20}, 'gear': {'bore_mm': 40}},
    'three teeth, sides and rim held': {'section': {'teeth': 3, 'fixed': ('sides', 'rim')}},
    'rims of 6 mm, sides held': {'section': {'teeth': 5, 'fixed': 'sides', 'rim_mm': 6}},
}


def marks(name):
    return f'<!-- {name}: begin, by python -m validation.choices -->', f'<!-- {name}: end -->'


def case():
    return gearsweep.Case.read(ROOT / 'examples' / 'first.nml')


def rack(profile):
    """Root tension of the pinion, MPa; the lowest frequency of its section, Hz; mean mesh stiffness, N/um."""
    addendum, dedendum, radius = RACKS[profile]
    gear = {'addendum': addendum, 'dedendum': dedendum, 'rack_tip_radius': radius}
    found = gearsweep.run(case().changed(pinion=gear, gear=gear, relief={'amount_um': 0}), ('mesh', 'static', 'modal'))
    return found.root_stress.tension_mpa[0], found.modal.frequency_hz[0], found.motion.mean_mesh_stiffness_n_um


def racks():
    values = {profile: rack(profile) for profile in RACKS}
    rows = [(profile, f'{tension:.0f}', f'{frequency / 1000:.1f}', f'{stiffness:.0f}')
            for profile, (tension, frequency, stiffness) in values.items()]  # fmt: skip
    return markdown(('profile', 'root tension of the pinion, MPa', 'lowest frequency of its section, kHz', 'mean mesh stiffness, N/µm'), rows)


def damped(ratio):
    """Worst DF without relief and with 10 um: the larger motion of each speed; speeds at which contact is lost without relief."""
    changed = case().changed(relief={'amount_um': (0, 10)}, dynamics={'damping_ratio': ratio}, sweep=SPEEDS)
    found = gearsweep.run(changed, 'sweep')
    lost = int((found.sweep.at(relief_um=0).contact == 'lost').sum() + (found.sweep.at(relief_um=0).contact == 'coast').sum())
    return (*found.sweep_worst.worst_dynamic_factor, lost, len(found.sweep.at(relief_um=0).rpm))


def damping():
    rows = []
    for ratio in RATIOS:
        without, relieved, lost, of = damped(ratio)
        rows.append((f'{ratio}', f'{without:.2f}', f'{relieved:.3f}', f'{lost} of {of}'))
    return markdown(('damping ratio', 'worst DF without relief', 'worst DF with 10 µm', 'speeds at which contact is lost without relief'), rows)


def body(name):
    """Mean mesh stiffness, N/um, the speed of its resonance, 1/min, and the worst DF without relief."""
    found = gearsweep.run(case().changed(relief={'amount_um': 0}, sweep=SPEEDS, **BODIES[name]), ('mesh', 'sweep'))
    return found.motion.mean_mesh_stiffness_n_um, found.motion.resonance_rpm, found.sweep_worst.worst_dynamic_factor[0]


def bodies():
    rows = [(name, f'{stiffness:.0f}', f'{rpm:.0f}', f'{factor:.2f}') for name in BODIES for stiffness, rpm, factor in [body(name)]]
    return markdown(('body', 'mean mesh stiffness, N/µm', 'resonance, 1/min', 'worst DF without relief'), rows)


def current(name):
    """A table as the page has it."""
    return parts(PAGE, *marks(name))[1].strip()


if __name__ == '__main__':
    for name in NAMES:
        table = globals()[name]()
        before, _, after = parts(PAGE, *marks(name))
        PAGE.write_text(f'{before}{table}\n{after}', encoding='utf-8')
        print(f'{table}\n')
