// One Runge-Kutta step of order 4 without an error estimate, for short looks ahead.
#pragma once

#include <vector>

#include "saltus/ode/stepper.hpp"

namespace saltus::ode {

/// Holds the classical method of order 4 [hairer1993, II.1, table 1.2]; owns its work space.
class ClassicalStep {
 public:
  /// @param n  states
  explicit ClassicalStep(std::size_t n);
  /// Takes x (n) from t to t + h along x' = f(t, x); not finite where f is not. Cost: four evaluations of f.
  void take(RightHandSide f, double t, double h, std::vector<double>& x);

 private:
  std::vector<double> trial_, k1_, k2_, k3_, k4_;
};

}  // namespace saltus::ode
