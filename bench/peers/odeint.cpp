// Dynamic factors by marching with Boost.odeint: controlled Dormand-Prince steps.
//
//     odeint plain|located PROBLEM TOLERANCE...
//
// For each tolerance a line: seconds (the median of as many runs as fit into a twentieth of a
// second), then the dynamic factors, relief by relief. The marching ends at the same tolerance.
#include "march.hpp"
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>

using Stepper = boost::numeric::odeint::runge_kutta_dopri5<State<double>>;

template <bool located>
static void solve(const Problem<double>& problem, double tolerance, std::vector<double>& factors) {
  factors.clear();
  for (const double relief : problem.relief) {
    March<Stepper, double, located> march(problem, relief, tolerance, tolerance);
    for (const double rpm : problem.rpm) factors.push_back(march.dynamic_factor(rpm));
  }
}

int main(int count, char** argument) {
  const bool located = std::string(argument[1]) == "located";
  std::ifstream file(argument[2]);
  const Problem<double> problem(file);
  for (int i = 3; i < count; ++i) {
    std::vector<double> taken, factors;
    double all = 0;
    do {
      const auto from = std::chrono::steady_clock::now();
      (located ? solve<true> : solve<false>)(problem, std::atof(argument[i]), factors);
      taken.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - from).count());
      all += taken.back();
    } while (all < 0.05);
    std::nth_element(taken.begin(), taken.begin() + taken.size() / 2, taken.end());
    std::printf("%.6e", taken[taken.size() / 2]);
    for (const double factor : factors) std::printf(" %.17g", factor);
    std::printf("\n");
  }
}
