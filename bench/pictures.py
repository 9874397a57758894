"""The benchmarks' pictures, from the tables in results/bench, in the style of all others:

    python bench/pictures.py
"""
from runpy import run_path
from types import SimpleNamespace

import matplotlib.pyplot as plt
import numpy as np
from report import BENCH, RESULTS, rows_of

# By its path: the package, which is not built here, needs the library.
look = SimpleNamespace(**run_path(str(BENCH.parent / 'python' / 'gearsweep' / 'plots' / 'look.py')))

# Colour, mark and line of each method.
METHODS = {
    'gearsweep': (look.VERMILION, 'o', '-'), 'gearsweep, native build': (look.VERMILION, 'D', '--'),
    'gearsweep, marching': (look.ORANGE, 's', '-'),
    'aligned RK4, shooting': (look.GREEN, '^', '-'), 'aligned RK4, marching': (look.GREEN, 'v', '--'),
    'RK4, equal steps': (look.PALE, 'x', '-'), 'constant steps (Karpat)': (look.PALE, '+', '--'),
    'constant steps, aligned': (look.PURPLE, '+', '-'),
    'Boost.odeint': (look.BLUE, 'P', '-'), 'Boost.odeint, plain': (look.BLUE, 'X', ':'),
    'SciPy DOP853': (look.SKY, 'h', '-'), 'SciPy LSODA': (look.INK, '1', '-'), 'SciPy Radau': (look.YELLOW, 'p', '-'),
    'Octave, as in the paper': (look.INK, '*', ':'),
}
ELEMENTS = {
    'gearsweep, graded': (look.VERMILION, 'o', '-'), 'gearsweep, uniform': (look.ORANGE, 's', '--'),
    'scikit-fem, SciPy': (look.SKY, 'h', '-'), 'CalculiX': (look.INK, '^', ':'),
}
CONTACT = {'full': look.BLUE, 'partial': look.ORANGE, 'lost': look.VERMILION}


def as_style(colour, mark, line):
    return {'color': colour, 'marker': mark, 'linestyle': line, 'markerfacecolor': 'white' if line == ':' else None, 'markersize': 3}


def column(rows, name):
    return np.array([float(row[name]) for row in rows])


def panels(rows, columns, height):
    """As wide as a page."""
    return plt.subplots(rows, columns, figsize=(look.PAGE, height * look.MM), layout='constrained')


def dynamics():
    table = rows_of('dynamics')
    figure, axes = panels(2, 4, 125)
    axes = axes.ravel()
    for axis, problem in zip(axes, dict.fromkeys(row['problem'] for row in table)):
        for method, style in METHODS.items():
            mine = [row for row in table if row['problem'] == problem and row['method'] == method and np.isfinite(float(row['error']))]
            if mine:
                axis.loglog(column(mine, 'seconds_per_point'), np.maximum(column(mine, 'error'), 1e-14), label=method, **as_style(*style))
        title = (BENCH / 'problems' / f'{problem}.nml').read_text().split("title = '")[1].split("'")[0]
        axis.set(title=title.replace(': ', ':\n').replace(' um', ' µm'), ylim=(1e-13, 1))
    axes[-1].axis('off')
    axes[-1].legend(*axes[0].get_legend_handles_labels(), loc='center')
    figure.supxlabel('Time for a point (s)', fontsize=8)
    figure.supylabel('Error of the dynamic factor (–)', fontsize=8)
    return figure


def cost():
    speeds, damping = rows_of('cost_speeds'), rows_of('cost_damping')
    reliefs = (BENCH / 'problems' / 'case1.nml').read_text().split('amount_um =')[1].split('/')[0].count(',') + 1
    figure, (left, right) = panels(1, 2, 70)
    every, full, changing, marched = (
        as_style(*style) for style in ((look.INK, '^', '-'), (look.VERMILION, 'o', '-'), (look.PURPLE, 's', '-'), (look.BLUE, 'v', '--')))
    count = column(speeds, 'speeds')
    left.loglog(count, 1e6 * column(speeds, 'seconds') / count / reliefs, label='all points', **every)
    left.loglog(count, 1e6 * column(speeds, 'seconds_full_contact') / count / column(speeds, 'reliefs_full_contact'),
                label='in full contact', **full)
    left.set(xlabel='Speeds (–)', ylabel='Time for a point (µs)', ylim=(0.5, 100))
    ratio, in_full = column(damping, 'damping_ratio'), column(damping, 'points_full')
    everywhere = in_full + column(damping, 'points_changing') + column(damping, 'points_other')
    for label, seconds, points, style in (
        ('all points', 'seconds', everywhere, every), ('contact changes', 'seconds_changing', column(damping, 'points_changing'), changing),
        ('in full contact', 'seconds_full', in_full, full),
        ('in full contact, marched', 'seconds_marched', column(damping, 'points_marched'), marched),
    ):
        right.loglog(ratio, 1e6 * column(damping, seconds) / points, label=label, **style)
    right.set(xlabel='Damping ratio (–)')
    for axis in (left, right):
        axis.legend()
    return figure


def harmonics():
    table = rows_of('harmonics')
    reliefs = list(dict.fromkeys(row['relief'] for row in table))
    figure, axis = plt.subplots(figsize=(look.COLUMN, 80 * look.MM), layout='constrained')
    for relief, style in zip(reliefs, look.line_styles(len(reliefs))):
        by = {method: [row for row in table if row['relief'] == relief and row['method'] == method] for method in ('FFT', 'by segment')}
        sampled = by['FFT'][:-1]
        axis.loglog(column(sampled, 'seconds'), column(sampled, 'error'), marker='.', label=relief.replace('um', 'µm'), **style)
        axis.loglog(column(by['by segment'], 'seconds'), column(by['by segment'], 'error'), 'D', color=style['color'])
    axis.set(xlabel='Time (s)', ylabel='Error over the largest harmonic (–)', ylim=(1e-17, 1))
    look.legends_above(axis, ('Tip relief; lines: FFT, diamonds: by segment', axis.get_legend_handles_labels()[0]))
    return figure


def elastic():
    table = rows_of('elastic')
    quantities = [name.removesuffix(' error') for name in table[0] if name.endswith(' error')]
    figure, axes = panels(1, len(quantities), 75)
    for axis, quantity in zip(axes, quantities):
        for method, style in ELEMENTS.items():
            mine = [row for row in table if row['method'] == method]
            axis.loglog(column(mine, f'{quantity} seconds'), column(mine, f'{quantity} error'), label=method, **as_style(*style))
        axis.set(title=quantity.capitalize(), xlabel='Time (s)')
    axes[0].set(ylabel='Relative error (–)')
    figure.legend(*axes[0].get_legend_handles_labels(), loc='outside lower center', ncols=4)
    return figure


def honesty():
    table = [row for row in rows_of('honesty') if float(row['compared'])]
    error, estimate = np.maximum(column(table, 'true_error'), 1e-17), column(table, 'estimate')
    figure, (left, right) = panels(1, 2, 75)
    bins = np.arange(-5, 4.01, 0.25)
    groups = [column(table, 'contact') == i for i in range(len(CONTACT))]
    labels = [f'contact {name}' for name in CONTACT]
    left.hist([np.log10(error[mask] / estimate[mask]).clip(bins[0], bins[-1]) for mask in groups], bins, stacked=True,
              color=list(CONTACT.values()), label=labels)
    left.axvline(np.log10(2), **look.ASIDE)
    left.set(xlabel='log10 of true error over estimate; dashed: 2 (–)', ylabel='Points (–)')
    left.legend()
    for mask, colour in zip(groups, CONTACT.values()):
        right.loglog(estimate[mask], np.maximum(error[mask], 1e-16), '.', color=colour, markersize=2, rasterized=True)
    ends = np.array([1e-16, 1])
    right.loglog(ends, ends, color=look.INK, linewidth=0.6)
    right.loglog(ends, 2 * ends, **look.ASIDE)
    right.set(xlabel='Estimate (–)', ylabel='True error (–)', xlim=(1e-16, 1), ylim=(1e-16, 10))
    return figure


def draw(name):
    """The picture of that name, as SVG and PNG."""
    with look.style():
        figure = globals()[name]()
        for ending in ('svg', 'png'):
            figure.savefig(RESULTS / f'{name}.{ending}', metadata={'Date': None} if ending == 'svg' else None)
        plt.close(figure)


if __name__ == '__main__':
    for name in ('dynamics', 'cost', 'harmonics', 'elastic', 'honesty'):
        draw(name)
