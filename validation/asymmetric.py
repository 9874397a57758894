"""What Karpat et al. 2012 made their tool for: symmetric and asymmetric teeth beside each other, loaded on either side.

    python -m validation.asymmetric

writes the table and the picture of doc/asymmetric.md. The paper prints no values, and no gear: data/karpat_asymmetric.nml says what
stands in.
"""

import pathlib

from .cases import ANGLES, case, run, study
from .page import markdown, parts

NAME = 'karpat_asymmetric'
PAGE = pathlib.Path(__file__).parent.parent / 'doc' / 'asymmetric.md'
PICTURE = PAGE.with_suffix('.svg')
BEGIN, END = '<!-- table: begin, by python -m validation.asymmetric -->', '<!-- table: end -->'
#: The paper's method: coefficients constant over each of 200 equal steps in a mesh period.
METHOD = {'numerics': {'method': 'constant', 'steps_per_period': 200}}
TASKS = ('geometry', 'mesh', 'static', 'sweep')
HEADER = ('drive / coast, deg', 'contact ratio', 'mean mesh stiffness, N/µm', 'STE, peak to peak, µm', 'its harmonics 1, 2, 3, µm',
          'largest DF', 'at 1/min', "by the paper's method", 'root tension, MPa', "coast flanks' stiffness over the motion's")  # fmt: skip


def of(drive, coast):
    """All tasks of the pair with these pressure angles on the loaded and on the other flanks."""
    return study(TASKS, f'{NAME}+angles-{drive}-{coast}')


def by_the_papers_method(drive, coast):
    """Largest dynamic factor over the same speeds."""
    return run(case(f'{NAME}+angles-{drive}-{coast}').changed(**METHOD), 'sweep').sweep_worst.worst_dynamic_factor[0]


def row(drive, coast):
    """The numbers of a row."""
    found = of(drive, coast)
    worst, error = found.sweep_worst, found.transmission_error
    return (found.geometry.contact_ratio, found.motion.mean_mesh_stiffness_n_um, error.peak_to_peak_um[0],
            *found.harmonics.amplitude_um[0, 1:4], worst.worst_dynamic_factor[0], worst.rpm[0],
            by_the_papers_method(drive, coast), found.root_stress.tension_mpa[0], coast_stiffness(drive, coast))  # fmt: skip


def coast_stiffness(drive, coast):
    """Mean stiffness of the coast flanks, which is that of the same gears loaded on their other side, on the line of action of the
    loaded flanks, where path and force go with the base radii; over the stiffness that the motion takes for them."""
    own, taken = of(coast, drive), of(drive, coast)
    lever = float(taken.gears.coast_base_diameter_mm[0] / taken.gears.base_diameter_mm[0])
    return own.motion.mean_mesh_stiffness_n_um * lever**2 / taken.motion.mean_mesh_stiffness_n_um


def table():
    """All rows, as Markdown."""
    lines = []
    for drive, coast in ANGLES:
        ratio, stiffness, peak, *harmonics, factor, rpm, by_theirs, stress, coasting = row(drive, coast)
        lines.append((f'{drive} / {coast}', f'{ratio:.4f}', f'{stiffness:.1f}', f'{peak:.2f}', ', '.join(f'{one:.2f}' for one in harmonics),
                      f'{factor:.3f}', f'{rpm:.0f}', f'{by_theirs:.3f}', f'{stress:.1f}', f'{coasting:.2f}'))  # fmt: skip
    return markdown(HEADER, lines)


def picture():
    """Static transmission error, its harmonics, mesh stiffness and dynamic factor of all pairs."""
    from matplotlib.figure import Figure

    from gearsweep.plots import compare, style

    studies = {f'{drive} / {coast}°': of(drive, coast) for drive, coast in ANGLES}
    with style():
        figure = Figure((6.89, 5.4), layout='constrained')
        shown = (('mesh', 'ste_um'), ('mesh', 'mesh_stiffness_n_um'), ('harmonics', 'amplitude_um'), ('sweep', 'dynamic_factor'))
        for ax, (name, column) in zip(figure.subplots(2, 2).flat, shown):
            compare(studies, name, column, ax)
            if name != 'mesh':
                ax.get_legend().remove()
    return figure


def current():
    """The table as the page has it."""
    return parts(PAGE, BEGIN, END)[1].strip()


if __name__ == '__main__':
    from gearsweep.plots import save

    before, _, after = parts(PAGE, BEGIN, END)
    PAGE.write_text(f'{before}{table()}\n{after}', encoding='utf-8')
    save(picture(), PICTURE, 'svg')
    print(table())
