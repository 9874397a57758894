"""Pictures of the report: our curves by gearsweep's plot functions, the printed points on them."""

import importlib.util
import io
from dataclasses import dataclass

import gearsweep

from . import ledger
from .cases import result


@dataclass(frozen=True)
class Picture:
    """The task and case whose result is drawn, and printed points (x, y), each a number or a row's id."""

    paper: str
    task: str
    case: str
    title: str
    caption: str
    points: tuple = ()


CIRCLES = 'printed values as circles.'
PICTURES = (
    Picture('dogan2021', 'sweep', 'case1', 'Fig. 7a', f'Dynamic factor over speed, case 1; {CIRCLES}',
            (('rpm_1', 'df_1'), ('n1_1', 'df1_1'), ('n2_1', 'df2_1'),
             ('rpm_1', 'df_15'), ('n1_1', 'df1_15'), ('n2_1', 'df2_15'))),
    Picture('dogan2021', 'sweep', 'case2', 'Fig. 7b', f'Dynamic factor over speed, case 2; {CIRCLES}',
            (('rpm_2', 'df_2'), ('n1_2', 'df1_2'), ('n1_2', 'df1_28'))),
    Picture('dogan2021', 'optimum', 'case1', 'Fig. 8a', f'Worst dynamic factor over relief, case 1; {CIRCLES}',
            ((0, 'df2_1'), ('best_1', 'df2_15'))),
    Picture('dogan2021', 'optimum', 'case2', 'Fig. 8b', f'Worst dynamic factor over relief, case 2; {CIRCLES}',
            ((0, 'df1_2'), ('best_2', 'df1_28'))),
    Picture('dogan2021', 'load', 'case1', 'Fig. 5', 'Load of one pair along its path at 1600 rpm, case 1.'),
    Picture('dogan2021', 'load', 'case2', 'Fig. 6', 'Load of one pair along its path at 1000 rpm, case 2.'),
    Picture('hassan2009', 'modal', 'hassan', 'Modes of Table 1', 'Mode shapes of the three-tooth section.'),
)


def all_for(papers):
    """(title, caption, PNG bytes) of each picture of these papers that gearsweep can draw; none without matplotlib."""
    if not importlib.util.find_spec('matplotlib'):
        return []
    return [(f'{ledger.PAPERS[p.paper]}, {p.title}', p.caption, _draw(p)) for p in PICTURES
            if p.paper in papers and hasattr(gearsweep, f'plot_{p.task}')]


def _draw(picture):
    """The picture as PNG."""
    from matplotlib import pyplot

    figure = pyplot.figure(figsize=(7, 4.5))
    axes = getattr(gearsweep, f'plot_{picture.task}')(result(picture.task, picture.case))
    points = [[_value(picture.paper, end) for end in point] for point in picture.points]
    if points:
        axes.plot(*zip(*points), 'o', mfc='none', mec='black', ms=8, zorder=5)
    file = io.BytesIO()
    figure.savefig(file, format='png', dpi=110, bbox_inches='tight')
    pyplot.close(figure)
    return file.getvalue()


def _value(paper, end):
    """A coordinate: a number, or the printed value of a row."""
    return ledger.find(paper, end).value if isinstance(end, str) else end
