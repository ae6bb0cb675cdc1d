#include "saltus/event_integrator/steps/thin_layers.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "saltus/event_integrator/mode/small_internal.hpp"

namespace saltus::event_integrator {
namespace {

/// Lowers tolerances to what one layer after the other allows.
class ToleranceLimits {
 public:
  ToleranceLimits(const evaluation::ModelKernel& kernel, const ThinLayers& layers, const ode::Tolerances& wanted,
                  const ModeState& state, double t, const double* x)
      : kernel_(kernel),
        layers_(layers),
        state_(state),
        t_(t),
        x_(x, x + kernel.states()),
        row_(x_.size()),
        values_(at(kernel.event_functions())),
        result_(wanted) {
    kernel_.functions(t, x, state.alpha.data(), values_.data());
  }

  ode::Tolerances run() {
    for (const auto& layer : layers_.corners) {
      const double psi = 0.5 * (values_[at(layer.lower)] + values_[at(layer.upper)]);
      if (!(std::abs(psi) <= 2.0 * layers_.half_width)) continue;
      limit_by_errors_of(layer.lower);
      limit_by_rates_of(layer);
    }
    for (const int weight : layers_.weights) {
      // Positive, but not that of a region that is alone: 1 to a part that does not matter either.
      const double psi = values_[at(weight)];
      const double alone = layers_.half_width * std::exp(-layers_.weight_range / layers_.half_width);
      if (psi >= -layers_.half_width && psi < layers_.weight_range - alone) limit_by_errors_of(weight);
    }
    return result_;
  }

 private:
  /// Errors of the states in psi itself.
  void limit_by_errors_of(int function) {
    // The relay of the catalogue, at epsilon from 1e-5 to 1e-9 and rtol from 1e-5 to 1e-10: a tenth of this is as
    // good, five times this misses sliding segments at the thin end.
    constexpr double share = 1e-4;
    double rate = 0.0;
    kernel_.gradient(function, t_, x_.data(), state_.alpha.data(), row_.data(), &rate);
    double slope = 0.0, size = 0.0;
    for (std::size_t i = 0; i < row_.size(); ++i) {
      slope += std::abs(row_[i]);
      size += std::abs(row_[i] * x_[i]);
    }
    limit(share * layers_.half_width, slope, size);
  }

  /// Errors of all states in psi' beside the layer: a solution that leaves it tangentially needs the time
  /// sqrt(2 epsilon / psi'') for that, at a speed of up to sqrt(2 epsilon psi'').
  void limit_by_rates_of(const ThinLayers::Corners& layer) {
    constexpr double share = 1e-2;
    double speed = 0.0, slope = 0.0, size = 0.0;
    for (const double side : {0.0, 1.0}) {
      std::vector<double> alpha = state_.alpha;
      alpha[at(layer.lower)] = alpha[at(layer.upper)] = side;
      const auto rate = [&] { return kernel_.lie_derivative(layer.lower, 1, t_, x_.data(), alpha.data()); };
      const double here = rate();
      const double bend = std::abs(kernel_.lie_derivative(layer.lower, 2, t_, x_.data(), alpha.data()));
      const double own = std::sqrt(2.0 * layers_.half_width * bend);
      // Across the layer at a speed of its own: nothing to mistake.
      constexpr double fast = 10.0;
      if (!(std::abs(here) <= fast * own)) continue;
      speed = std::max(speed, own);
      for (double& x : x_) {
        constexpr double part = 1e-6;  // of a difference: three digits are plenty
        const double kept = x;
        const double step = part * std::max(std::abs(x), part);
        x += step;
        const double change = std::abs(rate() - here) / step;
        x = kept;
        slope += change;
        size += change * std::abs(x);
      }
    }
    if (speed > 0.0) limit(share * speed, slope, size);
  }

  void limit(double error, double slope, double size) {
    if (slope > 0.0 && std::isfinite(slope)) result_.atol = std::min(result_.atol, error / slope);
    if (size > 0.0 && std::isfinite(size)) result_.rtol = std::min(result_.rtol, error / size);
  }

  const evaluation::ModelKernel& kernel_;
  const ThinLayers& layers_;
  const ModeState& state_;
  double t_;
  std::vector<double> x_, row_, values_;
  ode::Tolerances result_;
};

}  // namespace

ode::Tolerances within_layers(const evaluation::ModelKernel& kernel, const ThinLayers& layers,
                              const ode::Tolerances& wanted, const ModeState& state, double t, const double* x) {
  ode::Tolerances result = ToleranceLimits(kernel, layers, wanted, state, t, x).run();
  result.rtol = std::max(result.rtol, std::min(wanted.rtol, 4.0 * rounding_unit));
  return result;
}

}  // namespace saltus::event_integrator
