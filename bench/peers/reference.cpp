// Reference dynamic factors: marched until periodic in extended precision, Runge-Kutta-Fehlberg
// 7(8) with local errors below 1e-16 static deflections.
//
//     reference PROBLEM        one line: the dynamic factors, relief by relief
#include "march.hpp"
#include <cstdio>
#include <fstream>

using Real = long double;
using Stepper = boost::numeric::odeint::runge_kutta_fehlberg78<State<Real>, Real>;

int main(int, char** argument) {
  std::ifstream file(argument[1]);
  const Problem<Real> problem(file);
  for (const Real relief : problem.relief) {
    March<Stepper, Real, true> march(problem, relief, 1e-16L, 1e-15L);
    for (const Real rpm : problem.rpm) std::printf("%.20Lg ", march.dynamic_factor(rpm));
  }
  std::printf("\n");
}
