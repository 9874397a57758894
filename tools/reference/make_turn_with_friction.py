"""Print the dynamic factor of gears as built with friction, waves and short touches, and the load ratio of their 28th pair.

The case is that of `with_friction` in test/unit/as_built/test_as_built.f90. Nothing of gearsweep is in it: DOP853 of scipy with located
changes of contact, from break to break, for four turns from rest.
"""
import numpy as np
from scipy.integrate import solve_ivp

UM = 1e-6
RATIO, PITCH, LOAD, ZETA, MU = 1.880688, 0.89915, 2471.162, 0.10853, 0.0406
STIFFNESS = 1e6 * np.array([422.865, 0, -149.424, 0, -2.592, 0, 47.765, 0, -33.716])
MASS, TEETH, TANGENT = (0.3011, 0.3012), (10, 35), np.tan(np.radians(21.33146835576881))
PERIOD = 60 / (TEETH[0] * 115654.02)
PLACE = [-3.05996209253904, 0.43505776151152636, -1.0255146410281473, -1.7366209661028416, 1.2763940215143295, -0.949237562293664,
         -6.387296971953901, 3.5248232270608577, 2.4565136448982146, 3.935957953618669]
FORM = [-1.23131372238288, 0.4711267154654208, -3.390556076915558, 1.2240628983085249, -4.638582064542988, 0.05261268688099199,
        -0.37500908413829753, 1.302230318817427, 1.0025590653053567, -2.1574738608560065]
#: Gear, order, amplitude in um, phase in degrees.
WAVES = [(0, 21, 0.6805, 27.886428846812297), (1, 11, 0.4482, 83.96352712965137), (1, 1, 2.4939, -80.29545132522384)]
FREE = 1 / MASS[0] + 1 / MASS[1]


def wave(tau):
    return sum(size * UM * np.sin(2 * np.pi * order * tau / TEETH[gear] + np.radians(phase)) for gear, order, size, phase in WAVES)


def error(pair, tau):
    """Profile error of a pair, from 0, in m: the pinion's tooth 4 enters at 0, and the next one is 3."""
    s, tooth = tau - pair, (3 - pair) % 10
    u = s / RATIO
    relief = 17.513 * (max(0.0, s - 1) / (RATIO - 1)) ** 2
    return UM * (relief - PLACE[tooth] - FORM[tooth] * (4 * u * (1 - u) - 2 / 3)) + wave(tau)


def stiffness(s):
    return np.polyval(STIFFNESS[::-1], 2 * s / RATIO - 1)


def push(s, past):
    """Acceleration per load of a pair, 1/kg: the arms of the friction grow and shrink along the path."""
    along = 2 * np.pi * (s - PITCH)
    arms = (TANGENT + along / TEETH[0]) / MASS[0] + (TANGENT - along / TEETH[1]) / MASS[1]
    return FREE + (MU if past else -MU) * arms


def follow(first, last, state, peaks):
    """The state at the end of a smooth interval, between whose ends no pair enters, leaves or passes the pitch point."""
    middle = (first + last) / 2
    pairs = [k for k in (int(middle) - 1, int(middle)) if 0 < middle - k < RATIO]
    past = {k: middle - k > PITCH for k in pairs}
    closed = {k for k in pairs if state[0] > error(k, first)}
    while first < last:
        def rate(tau, z, closed=frozenset(closed)):
            k = {j: stiffness(tau - j) * push(tau - j, past[j]) for j in closed}
            pull = sum(k[j] * (z[0] - error(j, tau)) for j in closed)
            return [z[1], PERIOD**2 * (LOAD * FREE - pull) - 2 * ZETA * PERIOD * np.sqrt(sum(k.values())) * z[1]]

        events = []
        for k in pairs:
            def gap(tau, z, k=k):
                return z[0] - error(k, tau)
            gap.terminal, gap.direction = True, -1 if k in closed else 1
            events.append(gap)
        found = solve_ivp(rate, (first, last), state, 'DOP853', events=events, rtol=1e-13, atol=1e-18, max_step=0.005)
        for k in closed:
            load = np.array([stiffness(t - k) * (x - error(k, t)) for t, x in zip(found.t, found.y[0])])
            at = int(np.argmax(load))
            peaks[k % 70] = max(peaks[k % 70], load[at])
            if 0 < at < len(load) - 1:
                # The peak of the curve through nine points around the largest.
                times = np.linspace(found.t[at - 1], found.t[at + 1], 9)
                here = np.polynomial.Polynomial.fit(times, [stiffness(t - k) * (z - error(k, t)) for t, z in zip(times, solve_ivp(
                    rate, (found.t[at - 1], times[-1]), found.y[:, at - 1], 'DOP853', t_eval=times, rtol=1e-13, atol=1e-18).y[0])], 6)
                tops = [top.real for top in here.deriv().roots() if abs(top.imag) < 1e-9 and times[0] < top.real < times[-1]]
                peaks[k % 70] = max([peaks[k % 70], *map(here, tops)])
        first, state = found.t[-1], found.y[:, -1]
        for k, times in zip(pairs, found.t_events):
            if len(times):
                closed ^= {k}
    return state


def main():
    state = np.array([5e-6, 0.0])
    for _ in range(4):
        peaks, before = np.zeros(70), state
        for k in range(70):
            for a, b in ((0, RATIO - 1), (RATIO - 1, PITCH), (PITCH, 1)):
                state = follow(k + a, k + b, state, peaks)
        print(f'moved by {max(abs(state - before)):.1e} m, {peaks.max() / LOAD:.12f} {peaks[27] / LOAD:.12f}', flush=True)


main()
