#include "saltus/event_integrator/at_surface.hpp"

#include <algorithm>
#include <cmath>

#include "saltus/event_integrator/small_internal.hpp"

namespace saltus::event_integrator {

void move_onto(const evaluation::ModelKernel& kernel, const ModeState& state, int surface, double t,
               std::vector<double>& x) {
  std::vector<double> row(x.size());
  std::vector<double> values(at(kernel.event_functions()));
  double rate = 0.0;
  kernel.gradient(surface, t, x.data(), state.alpha.data(), row.data(), &rate);
  kernel.functions(t, x.data(), state.alpha.data(), values.data());
  double square = 0.0;
  for (const double d : row) square += d * d;
  if (!(square > 0.0) || !std::isfinite(square)) return;
  for (std::size_t i = 0; i < x.size(); ++i) x[i] -= values[at(surface)] * row[i] / square;
}

double size_of(const evaluation::ModelKernel& kernel, int function, double t, const double* x, const double* alpha,
               double time_scale) {
  std::vector<double> magnitude(at(kernel.event_functions()));
  std::vector<double> slope(magnitude.size());
  kernel.scales(t, x, alpha, magnitude.data(), slope.data());
  std::vector<double> f(at(kernel.states()));
  std::vector<double> row(f.size());
  double rate = 0.0;
  kernel.field(t, x, alpha, f.data());
  kernel.gradient(function, t, x, alpha, row.data(), &rate);
  double change = std::abs(rate);
  for (std::size_t i = 0; i < f.size(); ++i) change += row[i] == 0.0 ? 0.0 : std::abs(row[i] * f[i]);
  change *= time_scale;
  // The field may be undefined on the far side of a surface.
  return std::isfinite(change) ? std::max(magnitude[at(function)], change) : magnitude[at(function)];
}

bool continuous_across(const evaluation::ModelKernel& kernel, const ModeState& state, int nested, double t,
                       const std::vector<double>& x, double time_scale) {
  const auto size = at(kernel.event_functions());
  std::vector<double> below(size), above(size);
  kernel.functions(t, x.data(), state.corner_alpha[0].data(), below.data());
  kernel.functions(t, x.data(), state.corner_alpha[1].data(), above.data());
  // Four digits above rounding: the point is on the surface to rounding, a jump is not of that size.
  return std::abs(below[at(nested)] - above[at(nested)]) <=
         1e5 * rounding_unit * size_of(kernel, nested, t, x.data(), state.corner_alpha[1].data(), time_scale);
}

}  // namespace saltus::event_integrator
