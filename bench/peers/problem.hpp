// A problem as `dynamics problem` prints it, and its mesh as polynomials over the phase.
#pragma once
#include <array>
#include <cmath>
#include <istream>
#include <stdexcept>
#include <vector>

constexpr int degree = 4;        // of the pair stiffness
constexpr int most_pairs = 3;

template <class Real>
struct Problem {
  Real teeth, contact_ratio, mass[2], load, zeta;
  std::vector<Real> stiffness, relief, rpm, start;  // start: x and dx/dt for each relief and speed, or none

  explicit Problem(std::istream& in) {
    in >> teeth >> contact_ratio >> mass[0] >> mass[1] >> load >> zeta;
    for (auto* list : {&stiffness, &relief, &rpm, &start}) {
      int n;
      in >> n;
      list->resize(n);
      for (auto& value : *list) in >> value;
    }
    if (!in || stiffness.size() > degree + 1 || contact_ratio > most_pairs) throw std::runtime_error("problem");
    stiffness.resize(degree + 1, Real(0));
  }
};

template <class Real, std::size_t n>
Real value(const std::array<Real, n>& a, Real t) {
  Real r = a[n - 1];
  for (std::size_t i = n - 1; i-- > 0;) r = r * t + a[i];
  return r;
}

template <class Real, std::size_t n>
std::array<Real, n - 1> derivative(const std::array<Real, n>& a) {
  std::array<Real, n - 1> d;
  for (std::size_t i = 1; i < n; ++i) d[i - 1] = i * a[i];
  return d;
}

// One pair over a stretch of the phase: stiffness, profile error and their slopes.
template <class Real>
struct Pair {
  std::array<Real, degree + 1> stiffness;
  std::array<Real, degree> stiffness_slope;
  std::array<Real, 2> error;
};

// A stretch without breaks, with the sums over the pairs for each set of pairs in contact (bits).
template <class Real>
struct Zone {
  Real first, last;
  int pairs;
  Pair<Real> pair[most_pairs];
  std::array<Real, degree + 1> square[1 << most_pairs];
  std::array<Real, degree + 2> push[1 << most_pairs];
  Real by_mass, drive;

  // The same sums at a deflection x, pair by pair.
  void sum(Real x, Real phase, Real& in_square, Real& in_push) const {
    in_square = 0;
    in_push = drive;
    for (int j = 0; j < pairs; ++j) {
      const Real error = value(pair[j].error, phase);
      if (!(x > error)) continue;
      const Real rate = value(pair[j].stiffness, phase) * by_mass;
      in_square += rate;
      in_push += rate * error;
    }
  }

  Zone(const Problem<Real>& problem, Real relief, Real from, Real until) : first(from), last(until) {
    const Real whole = std::floor(problem.contact_ratio), rest = problem.contact_ratio - whole;
    const Real middle = (from + until) / 2;
    pairs = int(std::ceil(problem.contact_ratio - middle));
    for (int j = 0; j < pairs; ++j) {
      pair[j].stiffness = shifted(problem.stiffness, 2 * Real(j) / problem.contact_ratio - 1, 2 / problem.contact_ratio);
      pair[j].stiffness_slope = derivative(pair[j].stiffness);
      pair[j].error = {0, 0};
      if (middle + j > whole) pair[j].error = {relief * (j - whole) / rest, relief / rest};
      if (middle + j < rest) pair[j].error = {relief * (rest - j) / rest, -relief / rest};
    }
    by_mass = 1 / problem.mass[0] + 1 / problem.mass[1];
    drive = problem.load * by_mass;
    for (int set = 0; set < 1 << most_pairs; ++set) {
      square[set] = {};
      push[set] = {drive};
      for (int j = 0; j < pairs; ++j) {
        if (!(set >> j & 1)) continue;
        for (int i = 0; i <= degree; ++i) {
          const Real rate = pair[j].stiffness[i] * by_mass;
          square[set][i] += rate;
          push[set][i] += rate * pair[j].error[0];
          push[set][i + 1] += rate * pair[j].error[1];
        }
      }
    }
  }

  // The polynomial in u = a + b t as one in t.
  static std::array<Real, degree + 1> shifted(const std::vector<Real>& in_u, Real a, Real b) {
    std::array<Real, degree + 1> in_t{};
    for (std::size_t k = in_u.size(); k-- > 0;) {
      for (int i = degree; i > 0; --i) in_t[i] = in_t[i] * a + in_t[i - 1] * b;
      in_t[0] = in_t[0] * a + in_u[k];
    }
    return in_t;
  }
};

template <class Real>
std::vector<Zone<Real>> make_zones(const Problem<Real>& problem, Real relief) {
  const Real change = problem.contact_ratio - std::floor(problem.contact_ratio);
  if (!(change > 0)) return {Zone<Real>(problem, relief, 0, 1)};
  return {Zone<Real>(problem, relief, 0, change), Zone<Real>(problem, relief, change, 1)};
}
