// Reference dynamic factors: marched until periodic in extended precision, Runge-Kutta-Fehlberg
// 7(8) with local errors below TOLERANCE static deflections, the transient below ten times that.
//
//     reference PROBLEMS TOLERANCE   for each problem a line: the dynamic factors, relief by relief
#include "march.hpp"
#include <cstdio>
#include <cstdlib>
#include <fstream>

using Real = long double;
using Stepper = boost::numeric::odeint::runge_kutta_fehlberg78<State<Real>, Real>;

int main(int, char** argument) {
  const Real tolerance = std::strtold(argument[2], nullptr);
  std::ifstream file(argument[1]);
  while (file >> std::ws && !file.eof()) {
    const Problem<Real> problem(file);
    auto start = problem.start.begin();
    for (const Real relief : problem.relief) {
      March<Stepper, Real, true> march(problem, relief, tolerance, 10 * tolerance);
      for (const Real rpm : problem.rpm) {
        State<Real> from{1, 0};
        if (!problem.start.empty()) {
          from = {start[0], start[1]};
          start += 2;
        }
        std::printf("%.20Lg ", march.dynamic_factor(rpm, from));
      }
    }
    std::printf("\n");
  }
}
