"""A motion of two mesh periods in the main parametric tongue, by marching with scipy DOP853.

Prints the largest pair load over the static load and how far the motion repeats after one
and after two mesh periods.  Started from a disturbed rest, 1.5 static deflections, where
the motion with all pairs in contact repels.
"""
import numpy as np
from confirm import Direct
from model import Row

ROW = Row(coef=(400.0, 0.0, -110.0), zeta=0.03, rpm=29000.0)
PERIODS = 500

if __name__ == "__main__":
    d = Direct(ROW, rtol=1e-12)
    y = np.array([1.5 * ROW.Fs / (1.6e6 * (400 - 110 / 3)), 0.0])
    past = [y]
    for _ in range(PERIODS):
        past.append(d.period(past[-1]))
    peaks = []
    for start in past[-2:]:
        d.period(start, peaks=True)
        peaks.append(d.peak / ROW.Fs)
    print("dynamic factor", repr(max(peaks)))
    print("x moves by", abs(past[-1][0] - past[-2][0]), "m in one period,",
          abs(past[-1][0] - past[-3][0]), "m in two")
