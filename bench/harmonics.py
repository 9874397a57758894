"""Harmonics of the static transmission error: by segment (the library) against FFT of samples.

    python bench/harmonics.py PROGRAMS      (bench/run.sh harmonics sets up and does this)
"""
import functools
import itertools
import pathlib
import sys
import time
from statistics import median

import mpmath
import numpy as np
from peers.scipy_march import Problem
from pictures import draw
from report import BENCH, Report, machine, run

HARMONICS = 10
SAMPLES = [2**k for k in range(5, 21)] + [200]
REPEATS = 21
mpmath.mp.dps = 30

programs = pathlib.Path(sys.argv[1])


class Static:
    """Static transmission error of a problem's mesh with one relief, in um; `number` is the kind of its numbers."""

    def __init__(self, problem, relief, number):
        self.contact_ratio = number(problem.contact_ratio)
        self.load = number(problem.load)
        self.stiffness = [number(k) / 10**6 for k in problem.stiffness]
        self.relief = number(relief) * 10**6
        self.enters = self.contact_ratio - 1       # phase at which the second pair has left

    def pair(self, s):
        u = 2 * s / self.contact_ratio - 1
        stiffness = 0 * s
        for k in reversed(self.stiffness):
            stiffness = stiffness * u + k
        return stiffness

    def exact(self, phase):
        """One phase, any kind of number."""
        first = self.pair(phase)
        error = max(self.relief * (1 - phase / self.enters), 0)
        x = error + self.load / first
        if phase < self.enters:
            second, other = self.pair(phase + 1), self.relief * phase / self.enters
            both = (self.load + first * error + second * other) / (first + second)
            x = both if both > max(error, other) else min(x, other + self.load / second)
        return x

    def sampled(self, phase):
        """Many phases at once."""
        first, error = self.pair(phase), self.relief * np.maximum(1 - phase / self.enters, 0)
        x = error + self.load / first
        two = phase < self.enters
        k1, e1, t = first[two], error[two], phase[two]
        k2, e2 = self.pair(t + 1), self.relief * t / self.enters
        both = (self.load + k1 * e1 + k2 * e2) / (k1 + k2)
        x[two] = np.where(both > np.maximum(e1, e2), both, np.minimum(x[two], e2 + self.load / k2))
        return x

    def amplitudes(self, samples):
        """By FFT, um."""
        return 2 * np.abs(np.fft.rfft(self.sampled(np.arange(samples) / samples))[1:HARMONICS + 1]) / samples

    def kinks(self):
        """Phases between which the error is smooth: where the pairs that carry change too."""
        def separates(phase):
            k1, k2 = self.pair(phase), self.pair(phase + 1)
            e1, e2 = self.relief * (1 - phase / self.enters), self.relief * phase / self.enters
            return self.load - (k1 * (e2 - e1) if e2 > e1 else k2 * (e1 - e2))  # below 0: one pair carries alone
        ends = [mpmath.mpf(0), self.enters / 2, self.enters, mpmath.mpf(1)]
        for a, b in itertools.pairwise(ends):
            places = [a + (b - a) * (i + mpmath.mpf(1) / 1000) / 50 for i in range(50)]
            for p, q in itertools.pairwise(places):
                if separates(p) * separates(q) < 0:
                    ends.append(mpmath.findroot(separates, (p, q), solver='anderson'))
        return sorted(ends)

    def integrated(self):
        """By quadrature between the kinks, many digits."""
        ends = self.kinks()
        def amplitude(k):
            return 2 * abs(mpmath.quad(lambda t: self.exact(t) * mpmath.expj(-2 * mpmath.pi * k * t), ends))

        return [amplitude(k) for k in range(1, HARMONICS + 1)]


def timed(action):
    taken = []
    for _ in range(REPEATS):
        start = time.perf_counter()
        answer = action()
        taken.append(time.perf_counter() - start)
    return answer, median(taken)


def errors(amplitudes, exact):
    """Largest error over the largest harmonic, and largest relative error of a harmonic."""
    off = np.abs(amplitudes - exact)
    return off.max() / exact.max(), (off / exact).max()


def main():
    report = Report('harmonics', 'Harmonics of the static transmission error: by segment against FFT')
    case = BENCH / 'problems' / 'case1.nml'
    lines = run(programs / 'harmonics', case, HARMONICS).splitlines()
    reliefs = case.read_text().split('amount_um =')[1].split('/')[0].split(',')
    problem = Problem('\n'.join(lines[len(reliefs):]))
    rows, table = [], []
    for line, relief in zip(lines, problem.relief):
        seconds, *amplitudes = map(float, line.split())
        exact = np.array([float(value) for value in Static(problem, relief, mpmath.mpf).integrated()])
        label = f'{1e6 * relief:.0f} um'
        own = errors(1e6 * np.array(amplitudes), exact)
        rows.append((label, 'by segment', '', *own, seconds))
        sampled = Static(problem, relief, float)
        curve = []
        for samples in SAMPLES:
            found, taken = timed(functools.partial(sampled.amplitudes, samples))
            curve.append((samples, *errors(found, exact), taken))
            rows.append((label, 'FFT', *curve[-1]))
        *curve, coarse = curve
        table.append((label, f'{1e6 * seconds:.3g}', f'{own[0]:.1e}', f'{own[1]:.1e}', f'{coarse[1]:.1e}', f'{100 * coarse[2]:.2g} %',
                      f'{1e6 * coarse[3]:.3g}', f'{curve[-1][1]:.1e}', f'{1e3 * curve[-1][3]:.3g}'))
    report.add(f'{machine()}, NumPy {np.__version__}, one thread. Case 1 of the dynamics, first {HARMONICS} harmonics. Reference: quadrature\n'
               'between the kinks with 30 digits. Error: over the largest harmonic; worst: largest relative error of a harmonic.\n')
    report.table(('relief', 'by segment, us', 'error', 'worst', 'FFT of 200: error', 'worst', 'us', f'FFT of {max(SAMPLES)}: error', 'ms'),
                 table)
    report.csv('harmonics', ('relief', 'method', 'samples', 'error', 'worst_harmonic', 'seconds'), rows)
    draw('harmonics')
    report.save()


main()
