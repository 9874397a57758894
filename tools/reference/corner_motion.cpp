// Writes corner_motion.dat: steady motions of prescribed meshes whose pairs may be in contact before A and behind E, and
// may share compliances. Build and run: g++ -O2 -std=c++17 corner_motion.cpp && ./a.out > corner_motion.dat; ./a.out 15 solves
// the rows from the 15th on.
//
// Written from the mechanics alone, and with nothing of the library's methods: at every stage of classical Runge-Kutta
// steps the loads are found by trying all sets of pairs for the one that is consistent, with the deflections of all pairs
// under all loads as a linear system. Steps end at the breaks of the coefficients; where a step changes the set of pairs in
// contact, it is cut by bisection where the first change lies. The motion is marched until it repeats. Long double throughout.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>
typedef long double real;
const real pi = acosl(-1.0L);

struct Row {
  real c;                    // contact ratio
  std::vector<real> coef;    // own pair stiffness between A and E, N/um, powers of u = 2 s/c - 1
  real soften;               // and beyond, that at the end times 1 - soften*d, d base pitches off
  real gap2, gap3;           // profile error beyond: that at the end and gap2 d^2 + gap3 d^3, um
  real before, behind;       // how far contact reaches beyond A and E, base pitches
  real cp, cg;               // relief of pinion and gear at E and A, um, linear from D and B
  real shared;               // compliance that neighbouring pairs share, mean over the interval where two touch, um/N
  real slope, bow;           // and how it changes there: slope v + bow (3 v^2 - 1)/2, v from -1 to 1, um/N; constant beyond
  real decline;              // how much less pairs share that are no neighbours, um/N
  real m1, m2, F, zeta, mu, angle;
  int z1, z2;
  real sp;                   // pitch point
  real backlash;             // um; below 0: none
  real rpm;
};

struct Pair { real K, e, f1, f2, s; };  // stiffness N/um, profile error um, friction factors, path coordinate

struct Motion {
  const Row& r;
  real T;
  std::vector<real> breaks;
  explicit Motion(const Row& row) : r(row), T(60 / (row.z1 * row.rpm)) {
    auto add = [&](real s) { breaks.push_back(s - floorl(s)); };
    add(0); add(r.c); add(-r.before); add(r.c + r.behind);
    if (r.mu > 0) add(r.sp);
    breaks.push_back(1);
    std::sort(breaks.begin(), breaks.end());
  }
  // All pairs at a phase; `mid` is a phase within the same smooth interval.
  std::vector<Pair> pairs(real tau, real mid) const {
    std::vector<Pair> list;
    for (int n = -2; n < 6; n++) {
      real s = tau + n, m = mid + n;
      if (m < -r.before || m > r.c + r.behind) continue;
      Pair p;
      p.s = s;
      real at = m < 0 ? 0 : m > r.c ? r.c : s, u = 2 * at / r.c - 1, d = m < 0 ? -s : m > r.c ? s - r.c : 0, B = r.c - floorl(r.c);
      p.K = 0;
      for (int i = (int)r.coef.size() - 1; i >= 0; i--) p.K = p.K * u + r.coef[i];
      p.K *= 1 - r.soften * d;
      p.e = r.gap2 * d * d + r.gap3 * d * d * d;
      if (m > floorl(r.c)) p.e += r.cp * (at - floorl(r.c)) / B;
      if (m < B) p.e += r.cg * (B - at) / B;
      real sign = m < r.sp ? -1 : 1, t = tanl(r.angle * pi / 180);
      p.f1 = 1 + sign * r.mu * (t + (s - r.sp) * 2 * pi / r.z1);
      p.f2 = 1 + sign * r.mu * (t - (s - r.sp) * 2 * pi / r.z2);
      list.push_back(p);
    }
    return list;
  }
  // What a load on pair i moves pair k by.
  static real moves(const Row& r, const std::vector<Pair>& p, int i, int k) {
    if (i == k) return r.shared + 1 / p[i].K;
    if (abs(i - k) > 1) return r.shared - r.decline;
    real v = std::min(1.0L, std::max(-1.0L, 2 * p[std::min(i, k)].s / (r.c - 1) - 1));
    return r.shared + r.slope * v + r.bow * (3 * v * v - 1) / 2;
  }
  // Loads F_j of a set of pairs at x: x = e_j + sum C_ji F_i, by elimination.
  static std::vector<real> loads(const Row& r, const std::vector<Pair>& p, unsigned set, real x) {
    std::vector<int> in;
    for (size_t j = 0; j < p.size(); j++) if (set >> j & 1) in.push_back(j);
    size_t n = in.size();
    std::vector<std::vector<real>> a(n, std::vector<real>(n + 1));
    for (size_t i = 0; i < n; i++) {
      for (size_t k = 0; k < n; k++) a[i][k] = moves(r, p, in[i], in[k]);
      a[i][n] = x - p[in[i]].e;
    }
    for (size_t i = 0; i < n; i++)
      for (size_t k = 0; k < n; k++) if (k != i) {
        real q = a[k][i] / a[i][i];
        for (size_t l = i; l <= n; l++) a[k][l] -= q * a[i][l];
      }
    std::vector<real> f(p.size(), 0);
    for (size_t i = 0; i < n; i++) f[in[i]] = a[i][n] / a[i][i];
    return f;
  }
  // The consistent set: those in contact push, the others are apart.
  unsigned contact(const std::vector<Pair>& p, real x) const {
    for (unsigned set = 0; set < 1u << p.size(); set++) {
      std::vector<real> f = loads(r, p, set, x);
      bool ok = true;
      for (size_t j = 0; j < p.size(); j++) {
        real left = x;
        for (size_t i = 0; i < p.size(); i++) if (set >> i & 1) left -= moves(r, p, i, j) * f[i];
        ok = ok && (set >> j & 1 ? f[j] > 0 : left <= p[j].e);
      }
      if (ok) return set;
    }
    return 0;
  }
  void slope(real tau, real mid, unsigned set, bool back, const real y[2], real d[2]) const {
    std::vector<Pair> p = pairs(tau, mid);
    std::vector<real> f = loads(r, p, set, y[0]), g = loads(r, p, set, y[0] + 1);
    real accel = r.F * (1 / r.m1 + 1 / r.m2), w2 = 0;          // N/kg; restoring per um
    for (size_t j = 0; j < p.size(); j++) {
      real m = p[j].f1 / r.m1 + p[j].f2 / r.m2;
      accel -= f[j] * m;
      w2 += (g[j] - f[j]) * m;
    }
    if (back) {
      real k = 0;
      std::vector<Pair> q = pairs(tau, mid);
      unsigned between = 0;
      for (int n = -1; n < 5; n++) {
        real s = mid + n;
        if (s < 0 || s > r.c) continue;
        int first = -2;
        while (mid + first < -r.before) first++;
        between |= 1u << (n - first);
        q[n - first].e = 0;
      }
      for (real v : loads(r, q, between, 1)) k += v;
      accel -= k * (y[0] + r.backlash) * (1 / r.m1 + 1 / r.m2);
      w2 += k * (1 / r.m1 + 1 / r.m2);
    }
    d[0] = y[1];
    d[1] = T * T * 1e6L * accel - 2 * r.zeta * sqrtl(1e6L * w2) * T * y[1];
  }
  void step(real tau, real mid, unsigned set, bool back, real h, const real y[2], real out[2]) const {
    real k[4][2], z[2];
    slope(tau, mid, set, back, y, k[0]);
    for (int i = 0; i < 2; i++) z[i] = y[i] + h / 2 * k[0][i];
    slope(tau + h / 2, mid, set, back, z, k[1]);
    for (int i = 0; i < 2; i++) z[i] = y[i] + h / 2 * k[1][i];
    slope(tau + h / 2, mid, set, back, z, k[2]);
    for (int i = 0; i < 2; i++) z[i] = y[i] + h * k[2][i];
    slope(tau + h, mid, set, back, z, k[3]);
    for (int i = 0; i < 2; i++) out[i] = y[i] + h / 6 * (k[0][i] + 2 * k[1][i] + 2 * k[2][i] + k[3][i]);
  }
  real peak = 0;
  int events = 0, beyond = 0, apart = 0;
  void watch(real tau, real mid, const real y[2], real w[3], std::vector<real> last[2]) {
    std::vector<Pair> p = pairs(tau, mid);
    std::vector<real> f = loads(r, p, contact(p, y[0]), y[0]);
    // A parabola through three equal steps finds the maximum between.
    if (last[0].size() == f.size() && last[1].size() == f.size() && fabsl(w[0] - w[1]) < 1e-12L)
      for (size_t j = 0; j < f.size(); j++) {
        real a = (f[j] + last[1][j]) / 2 - last[0][j], b = (f[j] - last[1][j]) / 2;
        if (last[0][j] >= f[j] && last[0][j] >= last[1][j] && a < 0) peak = std::max(peak, last[0][j] - b * b / (4 * a));
      }
    for (real v : f) peak = std::max(peak, v);
    last[1] = last[0];
    last[0] = f;
  }
  // One period from y; n steps of it.
  void run(real y[2], int n, bool peaks) {
    events = beyond = apart = 0;
    for (size_t i = 0; i + 1 < breaks.size(); i++) {
      real a = breaks[i], b = breaks[i + 1];
      if (b - a < 1e-13L) continue;
      real mid = (a + b) / 2, tau = a, h0 = (b - a) / ceill(n * (b - a)), w[3] = {0, 0, 0};
      std::vector<real> last[2];
      if (peaks) watch(tau, mid, y, w, last);
      while (tau < b - 1e-15L) {
        real h = std::min(h0, b - tau);
        if (b - tau - h < 1e-12L) h = b - tau;
        std::vector<Pair> p = pairs(tau + 1e-16L, mid);
        unsigned set = contact(pairs(tau, mid), y[0]);
        bool back = r.backlash >= 0 && y[0] < -r.backlash;
        // Right behind a change, the set is that of the step's begin.
        real probe[2];
        step(tau, mid, set, back, h * 1e-6L, y, probe);
        set = contact(pairs(tau + h * 1e-6L, mid), probe[0]);
        back = r.backlash >= 0 && probe[0] < -r.backlash;
        real z[2];
        auto same = [&](real part) {
          step(tau, mid, set, back, part, y, z);
          return contact(pairs(tau + part, mid), z[0]) == set && (r.backlash >= 0 && z[0] < -r.backlash) == back;
        };
        if (!same(h)) {
          real low = h * 1e-6L, high = h;
          for (int k = 0; k < 70; k++) {
            real m = (low + high) / 2;
            (same(m) ? low : high) = m;
          }
          h = high;
          same(h);
          events++;
        }
        if (peaks) {
          int first = -2;
          while (mid + first < -r.before) first++;
          for (size_t j = 0; j < p.size(); j++) {
            real s = mid + first + (int)j;
            if ((s < 0 || s > r.c) && set >> j & 1) beyond = 1;
            if (s > 0 && s < r.c && !(set >> j & 1)) apart = 1;
          }
        }
        y[0] = z[0]; y[1] = z[1];
        tau = h == b - tau ? b : tau + h;
        w[1] = w[0]; w[0] = h;
        if (peaks) watch(tau, mid, y, w, last);
      }
    }
  }
};

int main(int argc, char** argv) {
  std::vector<Row> rows;
  std::vector<real> flat = {400}, even = {400, 0, -112}, skew = {400, 30, -100, -12, 8};
  auto add = [&](Row r) { rows.push_back(r); };
  //   c    coef  soften gap2  gap3   before behind cp cg shared slope bow decline  m1   m2   F    zeta  mu    angle z1 z2 sp  backlash rpm
  add({1.6L, flat, 0,    3000, 0,     .15L, .15L, 0, 0, 0, 0, 0, 0,       .8L, .8L, 7000, .10L, 0,    20, 25, 25, .8L, -1, 4000});
  add({1.6L, even, .5L,  3000, 1000,  .15L, .15L, 0, 0, 0, 0, 0, 0,       .8L, .8L, 7000, .17L, 0,    20, 25, 25, .8L, -1, 1600});
  add({1.6L, even, .5L,  3000, 1000,  .15L, .15L, 0, 0, 0, 0, 0, 0,       .8L, .8L, 7000, .17L, 0,    20, 25, 25, .8L, -1, 6800});
  add({1.6L, skew, 1,    2500, 3000,  .2L,  .12L, 4, 6, 0, 0, 0, 0,       .8L, .8L, 7000, .10L, 0,    20, 25, 25, .8L, -1, 11000});
  add({1.6L, skew, 1,    2500, 3000,  .2L,  .12L, 0, 0, 0, 0, 0, 0,       .8L, .8L, 7000, .10L, .08L, 20, 25, 25, .75L, -1, 8500});
  add({1.9L, even, .3L,  2800, 500,   .2L,  .2L,  0, 0, 0, 0, 0, 0,       .8L, .8L, 7000, .12L, 0,    20, 25, 25, .9L, -1, 5200});
  add({2.3L, even, .3L,  2800, 500,   .2L,  .2L,  3, 3, 0, 0, 0, 0,       .8L, .8L, 9000, .10L, .06L, 20, 25, 25, 1.1L, -1, 9000});
  add({1.6L, even, 0,    0,    0,     0,    0,    0, 0, 4e-4L, 0, 0, 0,   .8L, .8L, 7000, .12L, 0,    20, 25, 25, .8L, -1, 5000});
  add({1.6L, skew, 0,    0,    0,     0,    0,    5, 5, 6e-4L, 0, 0, 0,   .6L, 2.1L, 9000, .10L, .08L, 20, 20, 47, .7L, -1, 9500});
  add({2.3L, skew, 0,    0,    0,     0,    0,    9, 9, 5e-4L, 0, 0, 0,   .8L, .8L, 9000, .10L, .05L, 20, 25, 25, 1.1L, -1, 15000});
  add({1.6L, even, .5L,  3000, 1000,  .15L, .15L, 0, 0, 5e-4L, 0, 0, 0,   .8L, .8L, 7000, .17L, 0,    20, 25, 25, .8L, -1, 6800});
  add({1.6L, skew, 1,    2500, 3000,  .2L,  .12L, 4, 2, 5e-4L, 0, 0, 0,   .6L, 2.1L, 9000, .08L, .08L, 20, 20, 47, .7L, -1, 12000});
  add({1.6L, even, .5L,  3000, 1000,  .15L, .15L, 22, 22, 3e-4L, 0, 0, 0, .8L, .8L, 6000, .06L, 0,    20, 25, 25, .8L, -1, 13000});
  add({1.6L, skew, .5L,  3000, 1000,  .15L, .15L, 0, 0, 3e-4L, 0, 0, 0,   .8L, .8L, 7000, .05L, .08L, 20, 25, 25, .8L, 2, 12500});
  // What neighbours share changes along the path; above a contact ratio of 2 pairs that are no neighbours share less.
  add({1.6L, skew, 0,    0,    0,     0,    0,    4, 3, 6e-4L, 12e-5L, -5e-5L, 0, .6L, 2.1L, 8000, .08L, .06L, 20, 20, 47, .7L, -1, 7500});
  add({2.3L, skew, 0,    0,    0,     0,    0,    9, 9, 8e-4L, 8e-5L, -6e-5L, 4e-4L, .8L, .8L, 9000, .10L, .05L, 20, 25, 25, 1.1L, -1, 15000});
  add({1.9L, even, .3L,  2800, 500,   .2L,  .2L,  0, 0, 6e-4L, 6e-5L, -4e-5L, 3e-4L, .8L, .8L, 7000, .12L, 0, 20, 25, 25, .9L, -1, 5200});
  add({2.3L, even, .3L,  2800, 500,   .2L,  .2L,  3, 3, 7e-4L, 0, -8e-5L, 7e-4L, .8L, .8L, 9000, .10L, .06L, 20, 25, 25, 1.1L, -1, 9000});
  add({2.3L, skew, .3L,  2800, 500,   .1L,  .1L, 25, 25, 6e-4L, 5e-5L, -6e-5L, 3e-4L, .8L, .8L, 7000, .05L, 0, 20, 25, 25, 1.1L, -1, 17000});
  add({2.3L, skew, .3L,  2800, 500,   .1L,  .1L, 18, 18, 6e-4L, 5e-5L, -6e-5L, 3e-4L, .8L, .8L, 7000, .04L, .05L, 20, 25, 25, 1.1L, 1, 19000});
  add({2.3L, skew, .3L,  2800, 500,   .1L,  .1L, 45, 45, 6e-4L, 5e-5L, -6e-5L, 3e-4L, .8L, .8L, 3000, .04L, .05L, 20, 25, 25, 1.1L, 1, 13000});
  if (argc > 1) rows.erase(rows.begin(), rows.begin() + atoi(argv[1]) - 1);
  int before = argc > 1 ? atoi(argv[1]) - 1 : 0;
  puts("# Steady motions of prescribed meshes with contact beyond A and E and with shared compliance.");
  puts("# Made by corner_motion.cpp, which says how. Columns: id, contact_ratio, n_coef, coef 0 to 4 (N/um), soften, gap2, gap3");
  puts("# (um), before, behind, relief of pinion and gear (um), shared, its slope and bow, decline (um/N), m1, m2 (kg), load (N), zeta, mu, angle (deg), z1, z2,");
  puts("# pitch point, backlash (um; -1: none), rpm, largest load on a pair over the load, x (um) and its derivative over the mesh");
  puts("# phase (um) at phase 0, what the last halving of the steps changed of the largest load, events in a period,");
  puts("# 1: a pair carries beyond A or E, 1: a pair between A and E was apart");
  for (size_t i = 0; i < rows.size(); i++) {
    const Row& r = rows[i];
    real found[2] = {0, 0}, state[2], y[2];
    int events = 0, beyond = 0, apart = 0;
    y[0] = r.F / (r.coef[0]); y[1] = 0;
    for (int half = 0; half < 2; half++) {
      Motion m(r);
      int n = (int)ceill(2 * pi * 0 + sqrtl(3e6L * r.coef[0] * (1 / r.m1 + 1 / r.m2)) * m.T * (half ? 240 : 120));
      for (int k = 0; k < 4000; k++) {
        real before[2] = {y[0], y[1]};
        m.run(y, n, false);
        if (fabsl(y[0] - before[0]) < 1e-14L * fabsl(y[0]) + 1e-15L && fabsl(y[1] - before[1]) < 1e-13L * fabsl(y[0])) break;
        if (k == 3999) fprintf(stderr, "row %zu does not converge: %Lg\n", i + 1 + before, y[0] - before[0]);
      }
      state[0] = y[0]; state[1] = y[1];
      m.run(y, n, true);
      found[half] = m.peak / r.F;
      events = m.events; beyond = m.beyond; apart = m.apart;
    }
    real c[5] = {0, 0, 0, 0, 0};
    for (size_t k = 0; k < r.coef.size(); k++) c[k] = r.coef[k];
    printf("%zu %.3Lf %zu %.1Lf %.1Lf %.1Lf %.1Lf %.1Lf %.2Lf %.1Lf %.1Lf %.3Lf %.3Lf %.1Lf %.1Lf %.1Le %.1Le %.1Le %.1Le %.2Lf %.2Lf %.1Lf %.3Lf %.3Lf "
           "%.1Lf %d %d %.3Lf %.1Lf %.1Lf %.14Lf %.14Lf %.14Lf %.0Le %d %d %d\n", i + 1 + before, r.c, r.coef.size(), c[0], c[1], c[2], c[3], c[4],
           r.soften, r.gap2, r.gap3, r.before, r.behind, r.cp, r.cg, r.shared, r.slope, r.bow, r.decline, r.m1, r.m2, r.F, r.zeta, r.mu, r.angle, r.z1, r.z2,
           r.sp, r.backlash, r.rpm, found[1], state[0], state[1], fabsl(found[1] - found[0]), events, beyond, apart);
    fflush(stdout);
  }
}
