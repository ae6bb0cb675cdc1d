#include "saltus/event_integrator/at_surface.hpp"

#include <cmath>
#include <limits>

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

bool continuous_across(const evaluation::ModelKernel& kernel, const ModeState& state, int nested, double t,
                       const std::vector<double>& x) {
  const auto size = at(kernel.event_functions());
  std::vector<double> below(size), above(size), magnitude(size), slope(size);
  kernel.functions(t, x.data(), state.corner_alpha[0].data(), below.data());
  kernel.functions(t, x.data(), state.corner_alpha[1].data(), above.data());
  kernel.scales(t, x.data(), state.corner_alpha[1].data(), magnitude.data(), slope.data());
  // Four digits above rounding: the point is on the surface to rounding, a jump is not of that size.
  return std::abs(below[at(nested)] - above[at(nested)]) <=
         1e5 * std::numeric_limits<double>::epsilon() * magnitude[at(nested)];
}

}  // namespace saltus::event_integrator
