// Marches the motion with a controlled stepper of Boost.odeint until it is periodic: restarted at
// every break, the peak of the pair loads refined. With `located`, changes of contact are located
// too, and the sums over the pairs in contact are polynomials made beforehand; else the right side
// goes through the pairs and leaves changes of contact to the step control.
//
// The state is x in static deflections and dx/dt in static deflections times natural frequency;
// the time is the mesh phase.
#pragma once
#include "problem.hpp"
#include <boost/numeric/odeint.hpp>
#include <algorithm>

template <class Real>
using State = std::array<Real, 2>;

template <class Real, bool located>
struct Motion {          // the right side for one zone and one set of pairs in contact
  const Zone<Real>* zone;
  int set;
  Real scale, turn, zeta, omega;  // turn: natural frequency times period

  void operator()(const State<Real>& z, State<Real>& slope, Real phase) const {
    Real square, push;
    if constexpr (located) {
      square = value(zone->square[set], phase);
      push = value(zone->push[set], phase);
    } else {
      zone->sum(z[0] * scale, phase, square, push);
    }
    slope[0] = turn * z[1];
    slope[1] = turn / (omega * omega) * (push / scale - square * z[0] - 2 * zeta * std::sqrt(square) * omega * z[1]);
  }
};

template <class Stepper, class Real, bool located>
class March {
  using Motion = ::Motion<Real, located>;

 public:
  // Local errors stay below `tolerance`, the transient's rest below `wanted` static deflections.
  March(const Problem<Real>& problem, Real relief, Real tolerance, Real wanted)
      : problem_(problem), zones_(make_zones(problem, relief)), tolerance_(tolerance), wanted_(wanted) {
    Real stiffness = 0;  // mean of the sum over the pairs
    for (std::size_t i = 0; i < problem.stiffness.size(); i += 2)
      stiffness += problem.stiffness[i] / (i + 1) * problem.contact_ratio;
    scale_ = problem.load / stiffness;
    omega_ = std::sqrt(stiffness * (1 / problem.mass[0] + 1 / problem.mass[1]));
  }

  // Dynamic factor at a speed (1/min); unless another state is given, from rest under the mean load.
  Real dynamic_factor(Real rpm, State<Real> z = {1, 0}) {
    turn_ = omega_ * 60 / (problem_.teeth * rpm);
    const Real zeta = problem_.zeta;
    const Real decay = std::exp(-turn_ * (zeta - std::sqrt(std::max(Real(0), zeta * zeta - 1))));
    step_.assign(zones_.size(), Real(0.05) / std::max(Real(1), turn_));
    const int most_periods = 30 + int(2 * std::log(wanted_) / std::log(decay));  // errors may keep it from settling
    for (int period = 1; period < most_periods; ++period) {
      const State<Real> before = z;
      run(z, false);
      const Real moved = std::max(std::abs(z[0] - before[0]), std::abs(z[1] - before[1]));
      if (moved * decay / (1 - decay) < wanted_) break;
    }
    peak_ = 0;
    run(z, true);
    return peak_ / problem_.load;
  }

 private:
  void run(State<Real>& z, bool wants_peak) {
    for (std::size_t i = 0; i < zones_.size(); ++i) {
      const auto& zone = zones_[i];
      int set = 0;
      for (int j = 0; j < zone.pairs; ++j) set |= (!located || gap(zone, j, z, zone.first) > 0) << j;
      for (Real phase = zone.first; phase < zone.last;) leg(zone, set, phase, z, step_[i], wants_peak);
    }
  }

  // To the zone's end or the first change of contact, which changes the set.
  void leg(const Zone<Real>& zone, int& set, Real& phase, State<Real>& z, Real& h, bool wants_peak) {
    using namespace boost::numeric::odeint;
    const Motion motion{&zone, set, scale_, turn_, problem_.zeta, omega_};
    auto stepper = make_controlled(tolerance_, tolerance_, Stepper());
    State<Real> slope, next, next_slope;
    motion(z, slope, phase);
    while (phase < zone.last) {
      const bool last = phase + h * Real(1.000001) >= zone.last;
      Real t = phase, dt = last ? zone.last - phase : h;
      if (attempt(stepper, motion, z, slope, t, next, next_slope, dt) == fail) {
        h = dt;
        continue;
      }
      if (!last) h = dt;
      else t = zone.last, h = std::max(h, dt);
      int member = -1;
      const Real until = located ? first_change(motion, z, slope, phase, next, next_slope, t, member) : t;
      if (until < t) {
        t = until;
        next = z;
        single(motion, next, slope, phase, t - phase);
        motion(next, next_slope, t);
      }
      if (wants_peak) note_peaks(motion, z, slope, phase, next, next_slope, t);
      phase = t;
      z = next;
      slope = next_slope;
      if (member >= 0) {
        set ^= 1 << member;
        return;
      }
    }
  }

  template <class Controlled>
  static auto attempt(Controlled& stepper, const Motion& motion, const State<Real>& z, const State<Real>& slope, Real& t,
                      State<Real>& next, State<Real>& next_slope, Real& dt) {
    using category = typename Stepper::stepper_category;
    if constexpr (std::is_same_v<category, boost::numeric::odeint::explicit_error_stepper_fsal_tag>) {
      return stepper.try_step(motion, z, slope, t, next, next_slope, dt);
    } else {
      const auto result = stepper.try_step(motion, z, slope, t, next, dt);
      if (result == boost::numeric::odeint::success) motion(next, next_slope, t);
      return result;
    }
  }

  static void single(const Motion& motion, State<Real>& z, const State<Real>& slope, Real phase, Real h) {
    Stepper stepper;
    State<Real> next, next_slope = slope;
    if constexpr (std::is_same_v<typename Stepper::stepper_category, boost::numeric::odeint::explicit_error_stepper_fsal_tag>)
      stepper.do_step(motion, z, slope, phase, next, next_slope, h);
    else
      stepper.do_step(motion, z, slope, phase, next, h);
    z = next;
  }

  Real gap(const Zone<Real>& zone, int j, const State<Real>& z, Real phase) const {
    return scale_ * z[0] - value(zone.pair[j].error, phase);
  }

  Real gap_slope(const Zone<Real>& zone, int j, const State<Real>& slope) const {
    return scale_ * slope[0] - zone.pair[j].error[1];
  }

  // Phase of the first change of contact in a step, and the pair; `until` and -1 where there is none.
  Real first_change(const Motion& motion, const State<Real>& z, const State<Real>& slope, Real from,
                    const State<Real>& next, const State<Real>& next_slope, Real until, int& member) const {
    member = -1;
    for (int j = 0; j < motion.zone->pairs; ++j) {
      const Real sign = motion.set >> j & 1 ? 1 : -1, h = until - from;
      const Real a = sign * gap(*motion.zone, j, z, from), b = sign * gap(*motion.zone, j, next, until);
      const Real da = sign * gap_slope(*motion.zone, j, slope) * h, db = sign * gap_slope(*motion.zone, j, next_slope) * h;
      Real end = 1;
      if (b > 0) {                                // it may have dipped in between
        if (!(da < 0 && db > 0)) continue;
        end = turning(a, b, da, db);
        if (!(gap_at(motion, z, slope, from, h * end, j) * sign < 0)) continue;
      }
      const Real at = from + h * crossing(motion, z, slope, from, h, j, sign, end);
      if (at < until || member < 0) {
        until = std::min(at, until);
        member = j;
      }
    }
    return until;
  }

  Real gap_at(const Motion& motion, State<Real> z, const State<Real>& slope, Real from, Real h, int j) const {
    single(motion, z, slope, from, h);
    return gap(*motion.zone, j, z, from + h);
  }

  // Where, as a part of the step, the gap changes sign: regula falsi (Illinois), on the far side.
  Real crossing(const Motion& motion, const State<Real>& z, const State<Real>& slope, Real from, Real h, int j,
                Real sign, Real high) const {
    Real low = 0, at_low = sign * gap(*motion.zone, j, z, from), at_high = sign * gap_at(motion, z, slope, from, h * high, j);
    for (int i = 0; i < 60 && (high - low) * h > 8 * std::numeric_limits<Real>::epsilon() && at_high < -tolerance_ * Real(0.01) * scale_; ++i) {
      Real t = (low * at_high - high * at_low) / (at_high - at_low);
      if (!(t > low && t < high)) t = (low + high) / 2;
      const Real here = sign * gap_at(motion, z, slope, from, h * t, j);
      if (here > 0) low = t, at_low = here, at_high /= 2;
      else high = t, at_high = here, at_low /= 2;
    }
    return high;
  }

  // Place of the extremum of the cubic through two values and slopes, as a part of the step.
  static Real turning(Real a, Real b, Real da, Real db) {
    const Real p = 3 * (da + db - 2 * (b - a)), q = 2 * (3 * (b - a) - 2 * da - db);
    const Real root = std::sqrt(std::max(Real(0), q * q - 4 * p * da));
    const Real t = 2 * da / (-q + (da > 0 ? root : -root));
    return t > 0 && t < 1 ? t : Real(0.5);
  }

  // The load of pair j and its slope over the phase.
  State<Real> load(const Motion& motion, int j, const State<Real>& z, const State<Real>& slope, Real phase) const {
    const auto& pair = motion.zone->pair[j];
    const Real stiffness = value(pair.stiffness, phase), overlap = gap(*motion.zone, j, z, phase);
    return {stiffness * overlap,
            value(pair.stiffness_slope, phase) * overlap + stiffness * gap_slope(*motion.zone, j, slope)};
  }

  void note_peaks(const Motion& motion, const State<Real>& z, const State<Real>& slope, Real from, const State<Real>& next,
                  const State<Real>& next_slope, Real until) {
    const Real h = until - from;
    for (int j = 0; j < motion.zone->pairs; ++j) {
      if (!(motion.set >> j & 1)) continue;
      const auto a = load(motion, j, z, slope, from), b = load(motion, j, next, next_slope, until);
      peak_ = std::max({peak_, a[0], b[0]});
      if (!(a[1] > 0 && b[1] < 0) || std::max(a[0], b[0]) + h * (a[1] - b[1]) / 4 < peak_) continue;
      // The cubic gives the place, a step to it the state, one step of Newton's the rest.
      Real part = turning(a[0], b[0], h * a[1], h * b[1]);
      for (int i = 0; i < 2; ++i) {
        State<Real> top = z, top_slope;
        single(motion, top, slope, from, h * part);
        motion(top, top_slope, from + h * part);
        const auto c = load(motion, j, top, top_slope, from + h * part);
        const Real bend = c[1] > 0 ? (b[1] - c[1]) / (1 - part) : (c[1] - a[1]) / part;  // slope over the part
        const Real move = bend < 0 ? -c[1] / bend : 0;
        peak_ = std::max(peak_, c[0] + h * c[1] * move / 2);
        if (!(part + move > 0 && part + move < 1)) break;
        part += move;
      }
    }
  }

  const Problem<Real>& problem_;
  std::vector<Zone<Real>> zones_;
  std::vector<Real> step_;       // last step of each zone
  Real tolerance_, wanted_, scale_, omega_, turn_ = 0, peak_ = 0;
};
