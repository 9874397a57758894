// All attracting motions of prescribed-mesh rows, by means of their own: Taylor series between located changes of contact,
// Newton's method with saltation on the map of 1 to 8 mesh periods, and marches from spread starts.
//
//     g++ -O2 -std=c++17 motions.cpp -o motions
//     motions STARTS LONGEST < rows > found
//     motions 0 0 < rows > found
//
// A row has the columns of ../model.py, from id to rpm. Each start is marched for at most LONGEST mesh periods. A line for
// each attracting motion: id, mesh periods until it repeats, DF, largest Floquet modulus, x [um] and v [m/s] at phase 0,
// loss (as in ../model.py), how many starts lead to it; Newton's method alone, from the first starts, finds some to which
// none does. And a line "id 0 ..." with how many starts lead to no motion, and how many there are.
//
// With 0 0, each row also has mesh periods, x and v of a motion that is said to be periodic: then its line tells what it is,
// and by how many static deflections Newton's method moved x and v.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

namespace {

constexpr int order = 16, longest_polynomial = 10;
constexpr double pi = 3.141592653589793;

struct Poly {
    double c[longest_polynomial] = {};
    int n = 1;                                   // how many coefficients
    double at(double t) const {
        double r = 0;
        for (int i = n - 1; i >= 0; --i) r = r * t + c[i];
        return r;
    }
    double slope(double t) const {
        double r = 0;
        for (int i = n - 1; i >= 1; --i) r = r * t + i * c[i];
        return r;
    }
};

Poly product(const Poly& a, const Poly& b) {
    Poly r;
    r.n = a.n + b.n - 1;
    for (int i = 0; i < a.n; ++i)
        for (int k = 0; k < b.n; ++k) r.c[i + k] += a.c[i] * b.c[k];
    return r;
}

void add(Poly& a, const Poly& b, double factor = 1) {
    a.n = std::max(a.n, b.n);
    for (int i = 0; i < b.n; ++i) a.c[i] += factor * b.c[i];
}

Poly line(double value, double slope) {
    Poly r;
    r.c[0] = value;
    r.c[1] = slope;
    r.n = slope == 0 ? 1 : 2;
    return r;
}

struct Row {
    int id, teeth[2], coefficients, shape;
    double angle, ratio, pitch, coef[5], mass[2], load, zeta, friction, backlash, relief[2], rpm;

    // What follows from it; lengths in um, time in mesh periods.
    int whole;
    double inner, period, unit, deflection, omega;
    std::vector<double> breaks;

    bool read(FILE* file) {
        double id_, z1, z2, n, form;
        if (std::fscanf(file, "%lf %lf %lf %lf %lf %lf %lf", &id_, &z1, &z2, &angle, &ratio, &pitch, &n) != 7) return false;
        for (double& a : coef)
            if (std::fscanf(file, "%lf", &a) != 1) return false;
        if (std::fscanf(file, "%lf %lf %lf %lf %lf %lf %lf %lf %lf %lf", &mass[0], &mass[1], &load, &zeta, &friction, &backlash,
                        &relief[0], &relief[1], &form, &rpm) != 10) return false;
        id = int(id_), teeth[0] = int(z1), teeth[1] = int(z2), coefficients = int(n), shape = int(form);
        complete();
        return true;
    }

    void complete() {
        whole = int(ratio);
        inner = ratio - whole;
        period = 60 / (teeth[0] * rpm);
        unit = 1e6 * period * period;
        breaks = {0, 1};
        if (inner > 0) breaks.push_back(inner);
        if (friction > 0) breaks.push_back(pitch - std::floor(pitch));
        std::sort(breaks.begin(), breaks.end());
        breaks.erase(std::unique(breaks.begin(), breaks.end()), breaks.end());
        double mean = 0;                         // stiffness over the path, by its polynomial in u
        for (int i = 0; i < coefficients; i += 2) mean += coef[i] / (i + 1);
        mean *= ratio;
        deflection = load / mean;
        omega = std::sqrt(unit * mean * (1 / mass[0] + 1 / mass[1]));
    }

    bool touches(int j, double middle) const { return middle + j < ratio; }

    Poly stiffness(double phase, int j) const {  // N/um
        if (coefficients == 1) return line(coef[0], 0);
        Poly u = line(2 * (phase + j) / ratio - 1, 2 / ratio), r = line(coef[coefficients - 1], 0);
        for (int i = coefficients - 2; i >= 0; --i) {
            r = product(r, u);
            r.c[0] += coef[i];
        }
        return r;
    }

    Poly error(double phase, int j, double middle) const {
        double s = phase + j;
        Poly part;
        double amount = 0;
        if (middle + j > whole && relief[0] > 0) part = line((s - whole) / inner, 1 / inner), amount = relief[0];
        else if (middle + j < inner && relief[1] > 0) part = line((inner - s) / inner, -1 / inner), amount = relief[1];
        if (amount == 0) return line(0, 0);
        Poly r = shape == 1 ? part : product(part, part), zero;
        add(zero, r, amount);
        return zero;
    }

    Poly mobility(double phase, int j, double middle) const {
        if (friction == 0) return line(1 / mass[0] + 1 / mass[1], 0);
        double sign = middle + j < pitch ? -friction : friction, d = phase + j - pitch, tangent = std::tan(angle * pi / 180);
        double f1 = 1 + sign * (tangent + 2 * pi * d / teeth[0]), f2 = 1 + sign * (tangent - 2 * pi * d / teeth[1]);
        return line(f1 / mass[0] + f2 / mass[1], sign * 2 * pi * (1 / (teeth[0] * mass[0]) - 1 / (teeth[1] * mass[1])));
    }
};

// Taylor series of x and its rate for x" + 2 zeta sqrt(w) x' + w x = r.
struct Series {
    double x[order + 1], v[order];

    void solve(const Poly& w, const double* damping, int dampings, const Poly* r, double x0, double v0) {
        x[0] = x0, x[1] = v0, v[0] = v0;
        for (int i = 0; i < order - 1; ++i) {
            double a = r && i < r->n ? r->c[i] : 0;
            for (int k = 0; k <= i && k < w.n; ++k) a -= w.c[k] * x[i - k];
            for (int k = 0; k <= i && k < dampings; ++k) a -= damping[k] * v[i - k];
            v[i + 1] = a / (i + 1);
            x[i + 2] = v[i + 1] / (i + 2);
        }
    }
    double place(double t) const {
        double r = 0;
        for (int i = order; i >= 0; --i) r = r * t + x[i];
        return r;
    }
    double rate(double t) const {
        double r = 0;
        for (int i = order - 1; i >= 0; --i) r = r * t + v[i];
        return r;
    }
};

template <class F>
double root(F f, double a, double b) {           // Illinois
    double fa = f(a), fb = f(b);
    for (int i = 0; i < 200 && fa != fb; ++i) {
        double t = (a * fb - b * fa) / (fb - fa), ft = f(t);
        if (ft == 0 || std::abs(t - b) < 1e-17) return t;
        if ((ft > 0) == (fb > 0)) fa /= 2;
        else a = b, fa = fb;
        b = t, fb = ft;
    }
    return b;
}

struct State {
    double x, v;
};

// One or several mesh periods.
struct Run {
    State state;
    double m[2][2] = {{1, 0}, {0, 1}};           // derivative of the state by that at the begin
    double peak = 0;
    int loss = 0;
    bool failed = false;
};

class Motion {
public:
    explicit Motion(const Row& row) : row(row) {}

    void run(Run& r, bool derivative, bool peaks) const {
        for (size_t i = 0; i + 1 < row.breaks.size() && !r.failed; ++i)
            interval(row.breaks[i], row.breaks[i + 1], r, derivative, peaks);
    }

    double size(State d) const { return std::max(std::abs(d.x), std::abs(d.v) / std::max(1.0, row.omega)) / row.deflection; }

    const Row& row;

private:
    void interval(double a, double b, Run& r, bool derivative, bool peaks) const {
        double middle = (a + b) / 2, phase = a;
        int pairs = 0;
        bool closed[8], back = row.backlash >= 0 && r.state.x < -row.backlash;
        while (row.touches(pairs, middle)) ++pairs;
        for (int j = 0; j < pairs; ++j) closed[j] = r.state.x > row.error(a, j, middle).at(0);
        for (int pieces = 0; phase < b; ++pieces) {
            if (pieces > 10000000) {
                r.failed = true;
                return;
            }
            Poly k[4], e[4], w, force = line((1 / row.mass[0] + 1 / row.mass[1]) * row.load * row.unit, 0);
            int shut = 0;
            for (int j = 0; j < pairs; ++j) {
                k[j] = row.stiffness(phase, j), e[j] = row.error(phase, j, middle);
                shut += closed[j];
                if (back) {
                    double gain = row.unit * (1 / row.mass[0] + 1 / row.mass[1]);
                    add(w, k[j], gain), add(force, k[j], -gain * row.backlash);
                } else if (closed[j]) {
                    Poly rate = product(k[j], row.mobility(phase, j, middle));
                    add(w, rate, row.unit), add(force, product(rate, e[j]), row.unit);
                }
            }
            double damping[order] = {}, h = b - phase;
            int dampings = 0;
            if (w.c[0] > 0) {
                h = std::min(h, 0.8 / std::sqrt(w.c[0]) / (row.zeta > 1 ? 2 * row.zeta : 1));
                dampings = w.n == 1 ? 1 : order;
                damping[0] = std::sqrt(w.c[0]);
                for (int i = 1; i < dampings; ++i) {
                    double s = i < w.n ? w.c[i] : 0;
                    for (int l = 1; l < i; ++l) s -= damping[l] * damping[i - l];
                    damping[i] = s / (2 * damping[0]);
                }
                for (int i = 0; i < dampings; ++i) damping[i] *= 2 * row.zeta;
                while (dampings > 1 && std::abs(damping[dampings - 1]) * std::pow(h, dampings - 1) < 1e-18 * damping[0]) --dampings;
            }
            h = std::min(h, 0.125);
            bool last = h >= (b - phase) * (1 - 1e-12);
            if (last) h = b - phase;
            Series series;
            series.solve(w, damping, dampings, &force, r.state.x, r.state.v);
            int who = -1;
            double t = h;
            for (int j = 0; j < pairs; ++j) find_event(series, e[j], closed[j], j, t, who);
            if (row.backlash >= 0) find_event(series, line(-row.backlash, 0), !back, 7, t, who);
            r.loss = std::max(r.loss, back ? 3 : shut == 0 ? 2 : shut < pairs ? 1 : 0);
            if (peaks)
                for (int j = 0; j < pairs; ++j)
                    if (closed[j]) peak(series, k[j], e[j], t, r);
            State before{series.place(t), series.rate(t)};
            if (derivative) {
                Series one, two;
                one.solve(w, damping, dampings, nullptr, 1, 0), two.solve(w, damping, dampings, nullptr, 0, 1);
                compose(one.place(t), two.place(t), one.rate(t), two.rate(t), r);
            }
            r.state = before;
            double crossed = 0, old_damping = damping_at(w, t);
            if (who == 7) back = !back, crossed = before.v;
            else if (who >= 0) {
                crossed = before.v - e[who].slope(t);
                double at = e[who].at(t);
                bool was = closed[who];
                for (int j = 0; j < pairs; ++j)  // pairs of equal error change together
                    if (closed[j] == was && std::abs(e[j].at(t) - at) < 1e-14 * row.deflection &&
                        std::abs(e[j].slope(t) - e[who].slope(t)) < 1e-12 * row.deflection) closed[j] = !was;
            }
            if (who >= 0 && derivative && crossed != 0) {
                double now = 0;
                for (int j = 0; j < pairs; ++j) {
                    if (back) now += k[j].at(t) * (1 / row.mass[0] + 1 / row.mass[1]) * row.unit;
                    else if (closed[j]) now += k[j].at(t) * row.mobility(phase, j, middle).at(t) * row.unit;
                }
                double jump = -(2 * row.zeta * std::sqrt(now) - old_damping) * before.v;
                compose(1, 0, jump / crossed, 1, r);
            }
            phase = last && who < 0 ? b : phase + t;
        }
    }

    double damping_at(const Poly& w, double t) const { return 2 * row.zeta * std::sqrt(std::max(0.0, w.at(t))); }

    static void compose(double a, double b, double c, double d, Run& r) {
        for (int k = 0; k < 2; ++k) {
            double x = r.m[0][k], v = r.m[1][k];
            r.m[0][k] = a * x + b * v, r.m[1][k] = c * x + d * v;
        }
    }

    // The first time before t at which x leaves its side of a level.
    void find_event(const Series& s, const Poly& level, bool above, int j, double& t, int& who) const {
        constexpr int parts = 3;
        double side = above ? 1 : -1, left = 0, end = t, tiny = 1e-13 * row.deflection;
        double swing = 0;                        // it cannot go farther
        for (int i = order; i >= 1; --i) swing = (swing + std::abs(s.x[i]) + (i < level.n ? std::abs(level.c[i % longest_polynomial]) : 0)) * end;
        if (side * (s.x[0] - level.c[0]) > swing) return;
        auto gap = [&](double u) { return side * (s.place(u) - level.at(u)); };
        auto rate = [&](double u) { return side * (s.rate(u) - level.slope(u)); };
        double rate_left = rate(0), gap_left = gap(0);
        for (int i = 1; i <= parts; ++i) {
            double right = end * i / parts, rate_right = rate(right), gap_right = gap(right), low = right;
            if (rate_left < 0 && rate_right > 0) low = root(rate, left, right);
            if ((low < right ? gap(low) : gap_right) < -tiny) {
                // After an arch, from its top on, as it may begin on the level.
                double top = rate_left > 0 ? root(rate, left, low) : left;
                double found = top > left || gap_left > 0 ? root(gap, top, low) : left;
                if (found < t) t = found, who = j;
                return;
            }
            left = right, rate_left = rate_right, gap_left = gap_right;
        }
    }

    void peak(const Series& s, const Poly& k, const Poly& e, double h, Run& r) const {
        auto force = [&](double u) { return k.at(u) * (s.place(u) - e.at(u)); };
        auto rate = [&](double u) { return k.slope(u) * (s.place(u) - e.at(u)) + k.at(u) * (s.rate(u) - e.slope(u)); };
        constexpr int parts = 3;
        for (int i = 0; i < parts; ++i) {
            double a = h * i / parts, b = h * (i + 1) / parts;
            r.peak = std::max({r.peak, force(a), force(b)});
            if (rate(a) > 0 && rate(b) < 0) r.peak = std::max(r.peak, force(root(rate, a, b)));
        }
    }
};

double modulus(const double m[2][2]) {
    double half = (m[0][0] + m[1][1]) / 2, det = m[0][0] * m[1][1] - m[0][1] * m[1][0], square = half * half - det;
    return square < 0 ? std::sqrt(std::max(0.0, det)) : std::abs(half) + std::sqrt(square);
}

struct Orbit {
    std::vector<State> states;                   // once a mesh period
    double m[2][2];                              // of all its periods, from the first state
    double multiplier, factor;
    int loss, starts = 0;
};

class Search {
public:
    Search(const Row& row, int longest) : motion(row), row(row), longest(longest) {}

    // The periodic motion that Newton's method finds over p periods from a state.
    bool newton(State s, int p, Orbit& orbit) const {
        Run r = over(s, p);
        for (int i = 0; i < 40; ++i) {
            if (r.failed) return false;
            State d{r.state.x - s.x, r.state.v - s.v};
            double residual = motion.size(d);
            double a = 1 - r.m[0][0], b = -r.m[0][1], c = -r.m[1][0], e = 1 - r.m[1][1], det = a * e - b * c;
            if (!(std::abs(det) > 1e-14) || !(residual < 1e6)) return false;
            State step{(e * d.x - b * d.v) / det, (a * d.v - c * d.x) / det};
            if (motion.size(step) < 1e-10) return keep(s, p, orbit);
            double part = 1;
            State next;
            for (;; part /= 2) {
                if (part < 0.05) return motion.size(step) < 1e-8 && keep(s, p, orbit);
                next = {s.x + part * step.x, s.v + part * step.v};
                r = over(next, p);
                if (!r.failed && motion.size({r.state.x - next.x, r.state.v - next.v}) < residual) break;
            }
            s = next;
        }
        return false;
    }

    // Where a start leads to: 0, 1 ... of `found`, or -1.
    int follow(State s) {
        std::vector<State> past{s};
        int next = 4;
        for (int n = 1; n <= longest; ++n) {
            Run r{s};
            motion.run(r, false, false);
            if (r.failed || !(motion.size(r.state) < 1e6)) return -1;
            s = r.state;
            past.insert(past.begin(), s);
            if (past.size() > 9) past.pop_back();
            if (n < next) continue;
            next = n + 4 + n / 8;
            for (int p = 1; p < int(past.size()); ++p) {
                if (motion.size({s.x - past[p].x, s.v - past[p].v}) > 0.25) continue;
                Orbit orbit;
                if (!newton(s, p, orbit) || !(orbit.multiplier < 1)) continue;
                if (leads_to(s, orbit)) return number_of(orbit);
            }
        }
        return -1;
    }

    // Newton's method alone.
    void seed(State s) {
        for (int p = 1; p <= 3; ++p) {
            Orbit orbit;
            if (newton(s, p, orbit) && orbit.multiplier < 1) number_of(orbit);
        }
    }

    // What a motion that is said to be periodic is.
    void check(State s, int p) const {
        Orbit orbit;
        if (!newton(s, p, orbit)) return void(std::printf("%d 0\n", row.id));
        print(orbit, motion.size({s.x - orbit.states[0].x, s.v - orbit.states[0].v}));
    }

    void print(const Orbit& o, double last) const {
        std::printf("%d %d %.12f %.9f %.12g %.12g %d %.9g\n", row.id, int(o.states.size()), o.factor, o.multiplier, o.states[0].x,
                    o.states[0].v / row.period * 1e-6, o.loss, last);
    }

    std::vector<Orbit> found;

private:
    Run over(State s, int p) const {
        Run r{s};
        for (int i = 0; i < p && !r.failed; ++i) motion.run(r, true, false);
        return r;
    }

    bool keep(State s, int p, Orbit& orbit) const {
        Run r{s};
        orbit.states.clear();
        for (int i = 0; i < p; ++i) {
            orbit.states.push_back(r.state);
            motion.run(r, true, true);
            if (r.failed) return false;
            if (motion.size({r.state.x - s.x, r.state.v - s.v}) < 1e-7) break;
        }
        std::copy(&r.m[0][0], &r.m[0][0] + 4, &orbit.m[0][0]);
        orbit.multiplier = modulus(r.m);
        orbit.factor = r.peak / row.load;
        orbit.loss = r.loss;
        return true;
    }

    // Does the motion from s come nearer to the orbit, as the orbit's linear map says?
    bool leads_to(State s, const Orbit& orbit) const {
        int p = int(orbit.states.size()), returns = std::max(1, std::min(60, int(0.3 / (1 - orbit.multiplier)) + 1));
        State d{s.x - orbit.states[0].x, s.v - orbit.states[0].v};
        if (motion.size(d) < 1e-6) return true;
        if (motion.size(d) > 0.3) return false;
        Run r{s};
        for (int i = 0; i < returns; ++i) {
            for (int k = 0; k < p && !r.failed; ++k) motion.run(r, false, false);
            d = {orbit.m[0][0] * d.x + orbit.m[0][1] * d.v, orbit.m[1][0] * d.x + orbit.m[1][1] * d.v};
        }
        State real{r.state.x - orbit.states[0].x, r.state.v - orbit.states[0].v};
        return !r.failed && motion.size({real.x - d.x, real.v - d.v}) < 0.3 * motion.size(d) + 1e-6;
    }

    int number_of(const Orbit& orbit) {
        for (size_t i = 0; i < found.size(); ++i) {
            if (found[i].states.size() != orbit.states.size()) continue;
            for (const State& s : found[i].states)
                if (motion.size({s.x - orbit.states[0].x, s.v - orbit.states[0].v}) < 1e-5) return int(i);
        }
        found.push_back(orbit);
        return int(found.size()) - 1;
    }

    Motion motion;
    const Row& row;
    int longest;
};

}  // namespace

int main(int count, char** words) {
    if (count != 3) return std::fprintf(stderr, "motions STARTS LONGEST < rows > found\n"), 2;
    const int starts = std::atoi(words[1]), longest = std::atoi(words[2]);
    constexpr double span = 4;                   // static deflections
    constexpr int seeds = 20;
    Row row;
    while (row.read(stdin)) {
        Search search(row, longest);
        if (starts == 0) {
            double p, x, v;
            if (std::scanf("%lf %lf %lf", &p, &x, &v) != 3) return 1;
            search.check({x, v * row.period * 1e6}, int(p));
            continue;
        }
        int nowhere = 0;
        for (int i = 0; i < starts; ++i) {
            // Points of a plane that fill it evenly (Roberts): multiples of 1/g and 1/g^2, g^3 = g + 1.
            double a = std::fmod(0.5 + i * 0.7548776662466927, 1.0), b = std::fmod(0.5 + i * 0.5698402909980532, 1.0);
            State start{row.deflection * (1 + span * (2 * a - 1)), row.deflection * row.omega * span * (2 * b - 1)};
            if (i < seeds) search.seed(start);
            int to = search.follow(start);
            if (to < 0) ++nowhere;
            else ++search.found[to].starts;
        }
        for (const Orbit& o : search.found) search.print(o, o.starts);
        std::printf("%d 0 %d %d\n", row.id, nowhere, starts);
        std::fflush(stdout);
    }
}
