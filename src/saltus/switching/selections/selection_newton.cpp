#include "saltus/switching/selections/selection_newton.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "saltus/switching/table/newton_steps_internal.hpp"

namespace saltus::switching {

SelectionNewton::SelectionNewton(int surfaces, Interpolation interpolation)
    : surfaces_(surfaces),
      interpolation_(interpolation),
      lu_(surfaces),
      g_(static_cast<std::size_t>(surfaces)),
      step_(g_.size()),
      jacobian_(g_.size() * g_.size()),
      shifted_(g_.size()) {}

bool SelectionNewton::solve(ProjectedField g, double* alpha) {
  constexpr int iterations = 30;
  constexpr double astray = 1e3;
  NewtonSteps steps;
  for (int k = 0; k < iterations; ++k) {
    g(alpha, g_.data());
    selection_jacobian(g, interpolation_, surfaces_, alpha, g_.data(), jacobian_.data(), shifted_.data());
    evaluations_ += surfaces_ + 1;
    if (!lu_.factor(jacobian_)) return false;
    std::copy(g_.begin(), g_.end(), step_.begin());
    lu_.solve(step_.data());
    double size = 0.0;
    double reach = 0.0;
    for (std::size_t j = 0; j < step_.size(); ++j) {
      alpha[j] -= step_[j];
      size = std::max(size, std::abs(step_[j]));
      reach = std::max(reach, std::abs(alpha[j]));
    }
    if (!(reach < astray)) return false;
    if (steps.end_with({size, reach})) return true;
  }
  return false;
}

}  // namespace saltus::switching
