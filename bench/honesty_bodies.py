"""How honest the error estimates of the finite elements are: random gear bodies against grids three to four times as fine."""
import numpy as np
from report import run

BODIES, MODES = 48, 8
SECTIONS = 200      # whose stress is looked at
ASKED = ('number', 'teeth', 'bore', 'across', 'tension', 'compression', 'estimate')
FINE = 8            # elements across a tooth from which a grid suits stress


def computed(programs, kind, last=BODIES):
    """A row for each body."""
    text = run(programs / 'honesty_bodies', kind, 1, last)
    return np.array([line.split() for line in text.splitlines()], float)


def measure(programs):
    """What is told of each body (dict of columns), true errors over estimates of its frequencies (bodies, modes), and the true
    errors of its root stress and of these."""
    asked, true = (computed(programs, kind) for kind in ('asked', 'true'))
    bodies = dict(zip(ASKED, asked.T))
    apart = np.abs(asked / true - 1)
    stress, modes = apart[:, 4:6].max(1), apart[:, 7:7 + MODES]
    return bodies, modes / asked[:, 7 + MODES:], stress, modes


def measure_stress(programs):
    """Elements across, true errors over estimates of the root stress, and true errors, of the sections alone."""
    asked, true = (computed(programs, f'{kind}_stress', 2 * SECTIONS) for kind in ('asked', 'true'))
    error = np.abs(asked[:, 4:6] / true[:, 4:6] - 1).max(1)
    return asked[:, 3], error / asked[:, 6], error


def classes(bodies):
    whole, bore = bodies['teeth'] == 0, bodies['bore']
    yield 'all', bore > 0
    for name, mask in (('whole gears', whole), ('sections', ~whole)):
        for low, high in ((0, 0.1), (0.1, 0.3), (0.3, 1)):
            yield f'{name}, bore {low:g} to {high:g}', mask & (bore >= low) & (bore < high)


def row(name, ratio, error):
    return (name, str(ratio.size), *(f'{100 * np.mean(ratio > factor):.1f} %' for factor in (1, 2)),
            f'{np.median(ratio):.2g}', f'{ratio.max():.2g}', f'{100 * np.median(error):.2g} %')


def compare(report, programs):
    bodies, mode_ratio, stress, modes = measure(programs)
    header = ('values', 'true error above the estimate', 'above twice', 'median ratio', 'largest', 'median error')
    report.add(f'**Finite elements.** {BODIES} random gear bodies, every second one a whole gear held at its bore; bores from 3 % of the root\n'
               'radius to thin rims, 3 to 10 elements across a tooth; the true values come from a grid three to four times as fine.\n'
               f'The first {MODES} natural frequencies of each:\n')
    report.table(('', *header), [row(name, mode_ratio[mask], modes[mask]) for name, mask in classes(bodies) if mask.any()])
    across, stress_ratio, error = measure_stress(programs)
    report.add(f'Largest tension and compression at the root under one load, of {SECTIONS} random sections:\n')
    fine = across >= FINE
    report.table(('', *header), [row(name, stress_ratio[mask], error[mask]) for name, mask in (
        ('all', across > 0), (f'{FINE} and more elements across', fine), ('fewer', ~fine)) if mask.any()])
    report.tell(f'Error estimates of {mode_ratio.size} natural frequencies of random gear bodies: the true error is above twice the '
                f'estimate at {100 * np.mean(mode_ratio > 2):.1f} %.')
    report.csv('honesty_bodies', (*ASKED, 'stress_error', *(f'frequency_error_{k}' for k in range(1, MODES + 1)),
                                  *(f'frequency_ratio_{k}' for k in range(1, MODES + 1))),
               np.column_stack([*bodies.values(), stress, modes, mode_ratio]))
