"""Write coast_flanks.dat: motions of gears with backlash whose teeth are out of place and which are eccentric.

Nothing of gearsweep is in it: DOP853 of scipy from break to break, until the motion repeats. Each flank is followed by itself: the
pinion's tooth i drives the gear's tooth i (teeth count as they engage; that many further on where the gears are put together so),
and its back is before the front of the gear's tooth i + 1. A tooth that is late by p comes p later with both flanks; an eccentric
gear moves its centre, whose way along the normals of drive and coast flanks closes or opens their gaps.
"""
import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import minimize_scalar

UM = 1e-6


def springs(closed, k, c):
    """Effective stiffness of each closed spring of `closed`, all behind one compliance c."""
    own = [k[j] / (1 - c * k[j]) for j in closed]
    return own, 1 + c * sum(own)


def side(x, k, gap, c):
    """Loads of springs k that touch above gap, behind one compliance c, at the deflection x: tries which are closed."""
    closed = [j for j in range(len(k)) if x > gap[j]]
    for _ in range(20):
        own, soft = springs(closed, k, c)
        common = c * sum(o * (x - gap[j]) for o, j in zip(own, closed)) / soft
        now = [j for j in range(len(k)) if x - common > gap[j]]
        if now == closed:
            break
        closed = now
    load = np.zeros(len(k))
    for o, j in zip(own, closed):
        load[j] = o * (x - common - gap[j])
    return load, closed, [o / soft for o in own]


class Motion:
    """One case; all in SI, places of teeth and eccentricities in um."""

    def __init__(self, name, z, offset, rpm, ratio, load, zeta, mass, k, backlash, friction, shared, angle, late, centre, coast=None):
        self.name, self.z, self.offset, self.rpm, self.ratio, self.load, self.zeta = name, z, offset, rpm, ratio, load, zeta
        self.mass, self.k, self.backlash, self.friction, self.shared = mass, np.array(k) * 1e6, backlash * UM, friction, shared
        self.angle, self.late, self.centre = np.radians(angle), [np.array(a) * UM for a in late], centre
        self.coast_late = [np.array(a) * UM for a in coast] if coast else self.late
        self.turn = int(np.lcm(*z))
        self.duration = 60 / (z[0] * rpm)
        self.breaks = sorted({0.0, ratio - int(ratio), 1.0} | ({ratio / 2 - int(ratio / 2)} if friction else set()))

    def eccentric(self, tau):
        """How far the gears' centres open the gaps of the drive and of the coast flanks at a time."""
        drive, coast = np.array([np.cos(self.angle), np.sin(self.angle)]), np.array([-np.cos(self.angle), np.sin(self.angle)])
        opened = np.zeros(2)
        for gear in range(2):
            amount, first = self.centre[gear]
            # Coordinates: along the motion of the pitch point, and from pinion to gear. The pinion turns from the second to the
            # first, the gear from the first to the second.
            turned = 2 * np.pi * (tau + (self.offset if gear else 0)) / self.z[gear]
            direction = np.radians(first) + (turned if gear else -turned)
            way = amount * UM * np.array([np.cos(direction), np.sin(direction)])
            away = way if gear else -way
            opened += [away @ drive, away @ coast]
        return opened

    def forces(self, tau, x, number):
        """Loads of the drive and the coast flanks of the pairs between A and E, newest first, and what they do."""
        pairs = [number - j for j in range(int(np.ceil(self.ratio))) if 0 <= tau - (number - j) < self.ratio]
        s = np.array([tau - p for p in pairs])
        k = np.polyval(self.k[::-1], s)
        drive, coast = self.eccentric(tau)
        pinion = [self.late[0][p % self.z[0]] for p in pairs]
        ahead = [self.late[1][(p + self.offset) % self.z[1]] for p in pairs]
        back_of = [self.coast_late[0][p % self.z[0]] for p in pairs]
        behind = [self.coast_late[1][(p + 1 + self.offset) % self.z[1]] for p in pairs]
        gap = [drive + a - b for a, b in zip(pinion, ahead)]
        back = [self.backlash + coast - a + b for a, b in zip(back_of, behind)]
        loads, closed, stiff = side(x, k, gap, self.shared)
        backs, _, stiff_backs = side(-x, k, back, self.shared)
        plain = sum(1 / m for m in self.mass)
        mobility = np.full(len(s), plain)
        if self.friction:
            way = (s - self.ratio / 2) * 2 * np.pi
            arm = (np.tan(self.angle) + way / self.z[0]) / self.mass[0] + (np.tan(self.angle) - way / self.z[1]) / self.mass[1]
            mobility = plain + self.friction * np.where(s > self.ratio / 2, 1, -1) * arm
        square = sum(g * mobility[j] for g, j in zip(stiff, closed)) + plain * sum(stiff_backs)
        push = plain * (self.load + backs.sum()) - loads @ mobility
        return pairs, loads, backs, square, push

    def rate(self, tau, state, number):
        *_, square, push = self.forces(tau, state[0], number)
        return [state[1], self.duration**2 * push - 2 * self.zeta * self.duration * np.sqrt(square) * state[1]]

    def period(self, number, state, note=None):
        for first, last in zip(self.breaks, self.breaks[1:]):
            ends = number + np.array([first, last]) + [1e-13, -1e-13]
            # The scale of the state is some um.
            run = solve_ivp(self.rate, ends, state, 'DOP853', args=(number,), rtol=1e-12, atol=1e-18, dense_output=True,
                            max_step=0.02)
            state = run.y[:, -1]
            if note:
                note(number, ends, run.sol)
        return state

    def find(self):
        state, number = np.array([self.load / self.k[0], 0.0]), 0
        while True:
            before = state
            for _ in range(self.turn):
                state = self.period(number % self.turn + self.turn, state)
                number += 1
            if np.abs((state - before) * [1.0, 0.01]).max() < 2e-9 * UM:
                break
            if number > 400 * self.turn:
                raise ValueError(f'{self.name} does not become periodic')
        self.state, self.peaks, self.coast, self.least = state, np.zeros(self.turn), 0.0, np.inf

        def note(number, ends, motion):
            times = np.linspace(*ends, 400)
            found = [self.forces(t, motion(t)[0], number) for t in times]
            for j, pair in enumerate(found[0][0]):
                self.peaks[pair % self.turn] = max(self.peaks[pair % self.turn], top(
                    times, [f[1][j] for f in found], lambda t, j=j: self.forces(t, motion(t)[0], number)[1][j]))
            if any(f[2].any() for f in found):
                self.coast = max(self.coast, top(times, [f[2].sum() for f in found],
                                                 lambda t: self.forces(t, motion(t)[0], number)[2].sum()))
            self.least = min(self.least, -top(times, [-motion(t)[0] for t in times], lambda t: -motion(t)[0]))

        for number in range(self.turn, 2 * self.turn):
            state = self.period(number, state, note)

    def write(self, file):
        def row(*values):
            file.write(' '.join(repr(float(v)) if isinstance(v, float | np.floating) else str(v) for v in values) + '\n')

        file.write(self.name + '\n')
        row(*self.z, self.offset, self.rpm, self.ratio, self.load, self.zeta, *self.mass)
        row(len(self.k), *self.k)
        row(self.backlash, self.friction, self.shared, float(self.angle))
        for gear in range(2):
            row(*self.late[gear])
            row(*self.coast_late[gear])
            row(self.centre[gear][0] * UM, float(np.radians(self.centre[gear][1])))
        row(self.peaks.max() / self.load, self.coast / self.load, self.least, self.state[0], self.state[1])
        row(*(self.peaks / self.load))


def top(times, values, of):
    """The largest value, also between the places."""
    i = int(np.argmax(values))
    if 0 < i < len(times) - 1 and values[i] > 0:
        best = minimize_scalar(lambda t: -of(t), bounds=(times[i - 1], times[i + 1]), method='bounded', options={'xatol': 1e-11})
        return max(values[i], -best.fun)
    return values[i]


def wobble(teeth, a, b):
    return [a * ((b * i) % teeth / teeth - 0.5) for i in range(teeth)]


def one(teeth, which, amount):
    return [amount if i == which else 0.0 for i in range(teeth)]


STILL = (0.0, 0.0)
CASES = [
    Motion('one pinion tooth', (9, 7), 3, 3200.0, 1.6, 900.0, 0.12, (0.6, 0.9), (300.0,), 4.0, 0.0, 0.0, 20.0,
           (one(9, 4, 5.0), wobble(7, 0.0, 1)), (STILL, STILL)),
    Motion('one gear tooth', (9, 7), 3, 3200.0, 1.6, 900.0, 0.12, (0.6, 0.9), (300.0,), 4.0, 0.0, 0.0, 20.0,
           (wobble(9, 0.0, 1), one(7, 2, -5.0)), (STILL, STILL)),
    Motion('pitch and run-out', (10, 15), 4, 9000.0, 1.7, 1200.0, 0.1, (0.6, 0.9), (260.0, 120.0, -70.0), 6.0, 0.0, 0.0, 22.0,
           (wobble(10, 6.0, 3), wobble(15, 7.0, 4)), ((4.0, 35.0), (3.0, 200.0))),
    Motion('friction', (12, 8), 1, 7000.0, 1.55, 1000.0, 0.11, (0.7, 0.5), (280.0, 60.0, -40.0), 5.0, 0.07, 0.0, 20.0,
           (wobble(12, 6.0, 5), wobble(8, 5.0, 3)), ((3.0, -60.0), (2.5, 110.0))),
    Motion('shared compliance', (8, 12), 5, 8200.0, 1.65, 1100.0, 0.12, (0.6, 0.8), (290.0, 90.0, -55.0), 5.0, 0.0, 8e-10, 25.0,
           (wobble(8, 6.0, 3), wobble(12, 5.0, 5)), ((2.0, 15.0), (4.0, -75.0))),
    Motion('coast flanks by themselves', (8, 12), 2, 8600.0, 1.6, 1000.0, 0.12, (0.6, 0.8), (290.0,), 4.0, 0.0, 0.0, 20.0,
           (wobble(8, 6.0, 3), wobble(12, 5.0, 5)), (STILL, STILL), (wobble(8, 6.0, 5), wobble(12, 5.0, 7))),
]

if __name__ == '__main__':
    with open('coast_flanks.dat', 'w', encoding='ascii') as file:
        file.write('# Motions of gears with backlash, teeth out of place and eccentricities, by make_coast_flanks.py. Of each: name;\n'
                   '# teeth, by how many the gear is put together further on, speed (1/min), contact ratio, load (N), damping ratio,\n'
                   '# masses (kg); K over s: how many coefficients, ascending (N/m); backlash (m), friction, shared compliance (m/N),\n'
                   '# pressure angle (rad); of pinion and gear: how late each drive and each coast flank is (m), eccentricity (m) and its\n'
                   '# direction (rad);\n'
                   '# largest load of a pair and of the coast flanks over the load, least transmission error (m), state (m); of each\n'
                   '# pair its largest load.\n')
        for case in CASES:
            case.find()
            print(case.name, case.peaks.max() / case.load, case.coast / case.load, case.least, case.state)
            case.write(file)
