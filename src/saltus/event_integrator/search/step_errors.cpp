#include "saltus/event_integrator/search/step_errors.hpp"

#include <algorithm>
#include <cmath>

namespace saltus::event_integrator {

double StepErrors::of(int function, double t, const double* x, const double* alpha, const StepBounds& bounds) {
  double rate = 0.0;
  kernel_.gradient(function, t, x, alpha, gradient_.data(), &rate);
  double error = 0.0;
  for (std::size_t i = 0; i < gradient_.size(); ++i) {
    if (gradient_[i] == 0.0) continue;
    const double size = std::max(std::abs(bounds.low[i]), std::abs(bounds.high[i]));
    error += std::abs(gradient_[i]) * (now_.atol + now_.rtol * size);
  }
  return std::isfinite(error) ? error : 0.0;
}

}  // namespace saltus::event_integrator
