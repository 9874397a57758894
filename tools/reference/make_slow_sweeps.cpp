// Writes slow_sweeps.dat: where a motion jumps while the speed rises slowly, by marching through all mesh periods.
//
//     g++ -O2 make_slow_sweeps.cpp -o slow_sweeps && ./slow_sweeps > slow_sweeps.dat
//
// Contact ratio 1.6, 400 N/um a pair, 25 teeth, 0.8 kg, 7000 N, no relief: two pairs over 0.6 of a mesh period, then one; all
// pairs part where x passes 0. Between such changes the motion is a closed form. The speed rises a little from one mesh period
// to the next, over a span that holds the fold. The jump is where the largest load of a mesh period first exceeds that at the
// fold by a quarter. The slower, the less it comes behind the fold: by the 2/3 power of the rate, which two rates remove.
#include <cmath>
#include <cstdio>
#include <initializer_list>

namespace {

const double mass = 0.8, force = 7000, pair_stiffness = 400e6, teeth = 25;

struct Motion { double x, v, zeta, peak; };

// An interval of time with n pairs, x > 0 at its begin or about to be.
struct Closed {
    double rest, decay, omega, a, b;
    Closed(const Motion &m, int n) {
        const double natural = std::sqrt(n * pair_stiffness * 2 / mass);
        rest = force / (n * pair_stiffness);
        decay = m.zeta * natural;
        omega = natural * std::sqrt(1 - m.zeta * m.zeta);
        a = m.x - rest;
        b = (m.v + decay * a) / omega;
    }
    double x(double t) const { return rest + std::exp(-decay * t) * (a * std::cos(omega * t) + b * std::sin(omega * t)); }
    double v(double t) const {
        return std::exp(-decay * t) * ((b * omega - decay * a) * std::cos(omega * t) - (a * omega + decay * b) * std::sin(omega * t));
    }
};

template <class F> double root(F f, double low, double high) {
    for (int i = 0; i < 200 && high - low > 1e-18; ++i) {
        const double middle = (low + high) / 2;
        (f(low) > 0) == (f(middle) > 0) ? low = middle : high = middle;
    }
    return high;
}

void advance(Motion &m, int n, double time) {
    while (time > 0) {
        if (m.x > 0 || (m.x == 0 && m.v > 0)) {
            const Closed c(m, n);
            const double step = 0.2 / c.omega;
            double t = 0, end = time;
            for (bool leaves = false; t < time && !leaves;) {
                const double next = std::fmin(t + step, time);
                double lowest = next;
                if (c.v(t) < 0 && c.v(next) > 0) lowest = root([&](double s) { return c.v(s); }, t, next);
                if (c.v(t) > 0 && c.v(next) < 0)
                    m.peak = std::fmax(m.peak, pair_stiffness * c.x(root([&](double s) { return c.v(s); }, t, next)));
                m.peak = std::fmax(m.peak, pair_stiffness * c.x(next));
                if (c.x(lowest) < 0) {
                    end = root([&](double s) { return c.x(s); }, t, lowest);
                    leaves = true;
                }
                t = next;
            }
            m = {end < time ? 0 : c.x(end), c.v(end), m.zeta, m.peak};
            time -= end;
            if (time > 0) m.x = -0.0;
        } else {
            const double a = force * 2 / mass, root_of = std::sqrt(m.v * m.v - 2 * a * m.x);
            const double t = (-m.v + root_of) / a;
            if (t >= time) {
                m.x += time * (m.v + a / 2 * time);
                m.v += a * time;
                return;
            }
            m.x = 0;
            m.v += a * t;
            time -= t;
        }
    }
}

void period(Motion &m, double rpm) {
    const double time = 60 / (teeth * rpm);
    m.peak = 0;
    advance(m, 2, 0.6 * time);
    advance(m, 1, 0.4 * time);
}

double jump(double zeta, double first, double last, long periods, double beyond) {
    // Where the pairs carry all the time, at 10 000 1/min, the motion is that of a linear system, which all states come to.
    const double linear = 10000;
    Motion m{force / (2 * pair_stiffness), 0, zeta, 0};
    for (int i = 0; i < 5000; ++i)
        for (int n : {2, 1}) {
            const Closed c(m, n);
            const double time = (n == 2 ? 0.6 : 0.4) * 60 / (teeth * linear);
            m = {c.x(time), c.v(time), zeta, 0};
        }
    const long run_up = 100000;
    for (long i = 0; i < run_up; ++i) period(m, linear + (first - linear) * i / run_up);
    for (long i = 0; i < periods; ++i) {
        const double rpm = first + (last - first) * i / periods;
        period(m, rpm);
        if (m.peak > beyond * force) return rpm;
    }
    return 0;
}

}  // namespace

int main() {
    std::puts("# Where a motion jumps while the speed rises slowly: make_slow_sweeps.cpp.");
    std::puts("# zeta [-], mesh periods over the span of 40 1/min, jump [1/min], the fold that two rates make of it [1/min]");
    const double zeta[] = {0.05, 0.02}, from[] = {11400, 11320};
    for (int i = 0; i < 2; ++i) {
        double before = 0;
        for (long periods : {12500L, 100000L, 800000L}) {
            const double at = jump(zeta[i], from[i], from[i] + 40, periods, 1.25 * 1.48);
            std::printf("%g %ld %.5f %.5f\n", zeta[i], periods, at, before > 0 ? at - (before - at) / (std::pow(8, 2.0 / 3) - 1) : 0.0);
            std::fflush(stdout);
            before = at;
        }
    }
}
