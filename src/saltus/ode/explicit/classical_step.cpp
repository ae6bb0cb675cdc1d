#include "saltus/ode/explicit/classical_step.hpp"

#include <cstddef>

namespace saltus::ode {

ClassicalStep::ClassicalStep(std::size_t n) : trial_(n), k1_(n), k2_(n), k3_(n), k4_(n) {}

void ClassicalStep::take(RightHandSide f, double t, double h, std::vector<double>& x) {
  const auto stage = [&](double part, const std::vector<double>& slope, std::vector<double>& result) {
    for (std::size_t i = 0; i < x.size(); ++i) trial_[i] = x[i] + part * h * slope[i];
    f(t + part * h, trial_.data(), result.data());
  };
  f(t, x.data(), k1_.data());
  stage(0.5, k1_, k2_);
  stage(0.5, k2_, k3_);
  stage(1.0, k3_, k4_);
  for (std::size_t i = 0; i < x.size(); ++i) x[i] += h / 6.0 * (k1_[i] + 2.0 * k2_[i] + 2.0 * k3_[i] + k4_[i]);
}

}  // namespace saltus::ode
