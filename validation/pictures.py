"""Pictures of the report and of the README: our curves, the printed points on them."""

import importlib.util
import io
import pathlib
from dataclasses import dataclass

from . import ledger
from .cases import TASKS, study

README = pathlib.Path(__file__).parent.parent / 'doc' / 'dynamic_factor.svg'


@dataclass(frozen=True)
class Picture:
    """The table and case that are drawn, and printed points, of which each number is one or a row's id."""

    paper: str
    table: str
    case: str
    title: str
    caption: str
    points: tuple = ()  # of a sweep (speed, DF, relief), of an optimum (relief, DF)


CIRCLES = 'printed values as circles.'
PICTURES = (
    Picture('dogan2021', 'sweep', 'case1', 'Fig. 7a',
            f'Dynamic factor over speed, case 1; {CIRCLES} 1.16 at 15 um cannot be reproduced.',
            (('rpm_1', 'df_1', 'relief_1_0'), ('n1_1', 'df1_1', 'relief_1_0'), ('n2_1', 'df2_1', 'relief_1_0'),
             ('rpm_1', 'df_15', 'relief_1_15'), ('n1_1', 'df1_15', 'relief_1_15'), ('n2_1', 'df2_15', 'relief_1_15'))),
    Picture('dogan2021', 'optimum_curve', 'case1', 'Fig. 8a', f'Largest dynamic factor over relief, case 1; {CIRCLES}',
            (('relief_1_0', 'df2_1'), ('best_1', 'df2_15'))),
    Picture('dogan2021', 'sweep', 'case2', 'Fig. 7b', f'Dynamic factor over speed, case 2; {CIRCLES}',
            (('rpm_2', 'df_2', 'relief_2_0'), ('n1_2', 'df1_2', 'relief_2_0'), ('n1_2', 'df1_28', 'relief_2_28'))),
    Picture('dogan2021', 'optimum_curve', 'case2', 'Fig. 8b', f'Largest dynamic factor over relief, case 2; {CIRCLES}',
            (('relief_2_0', 'df1_2'), ('best_2', 'df1_28'))),
    Picture('dogan2021', 'load', 'case1', 'Fig. 5', 'Load of one pair along its path at 1600 rpm, case 1, and dynamic transmission error.'),
    Picture('dogan2021', 'load', 'case2', 'Fig. 6', 'Load of one pair along its path at 1000 rpm, case 2, and dynamic transmission error.'),
    Picture('karpat2012', 'mesh', 'case1', 'Fig. 6a', 'Static transmission error over the path of contact, with the stiffness '
            'and the load sharing it comes from; the paper gives no gears, the first case of Dogan et al. 2021 stands in.'),
    Picture('karpat2012', 'harmonics', 'case1', 'Fig. 6b', 'Harmonics of that static transmission error.'),
    Picture('hassan2009', 'modal', 'hassan', 'Modes of Table 1', 'Mode shapes of the three-tooth section.'),
    Picture('hassan2009', 'static', 'hassan', 'Table 2', 'Stress at the fillet tangent while the load moves through the nine steps.'),
    Picture('thamba2020', 'mesh', 'thamba+six-um', 'Fig. 1', 'Stiffness, load sharing and static transmission error without relief '
            'and with 6 um on both gears from the highest point of single contact on: what a relief of a sound size does.'),
    Picture('thamba2020', 'modal', 'thamba+whole', 'Table 5', 'First mode of the whole gear, held at the bore that fits it: it twists.'),
)


def all_for(papers):
    """(title, caption, PNG bytes) of each picture of these papers; none without matplotlib."""
    if not importlib.util.find_spec('matplotlib'):
        return []
    return [(f'{ledger.PAPERS[p.paper]}, {p.title}', p.caption, _drawn(p, 'png')) for p in PICTURES if p.paper in papers]


def update():
    """Draws the picture of the README."""
    README.write_bytes(_drawn(PICTURES[0], 'svg'))


def _drawn(picture, ending):
    """The picture as the bytes of a file."""
    from matplotlib import pyplot

    from gearsweep import plots

    file = io.BytesIO()
    figure = _figure(picture, plots)
    plots.save(figure, file, ending)
    pyplot.close(figure)
    return file.getvalue()


def _figure(picture, plots):
    answer = study(TASKS.get(picture.table, picture.table), picture.case)
    if picture.points:
        points = [[_value(picture.paper, end) for end in point] for point in picture.points]
        plot = {'sweep': plots.plot_sweep, 'optimum_curve': plots.plot_optimum}[picture.table]
        return plot(answer, points=points).figure
    return next(plots.figures(answer, picture.table))[1]


def _value(paper, end):
    """A coordinate: a number, or the printed value of a row."""
    return ledger.find(paper, end).value if isinstance(end, str) else end
