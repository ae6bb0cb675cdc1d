#include "saltus/event_integrator/mode/at_surface.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "saltus/event_integrator/mode/resolution.hpp"
#include "saltus/event_integrator/mode/small_internal.hpp"
#include "saltus/ode/explicit/classical_step.hpp"

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

std::vector<int> sliding_inside(const evaluation::ModelKernel& kernel, const ModeState& state, int function) {
  std::vector<int> result;
  for (const int i : kernel.inner(function)) {
    if (state.mode[at(i)] != 0 || !std::binary_search(state.sliding.begin(), state.sliding.end(), i)) continue;
    const auto& groups = kernel.region_groups();
    const bool is_region = std::any_of(groups.begin(), groups.end(), [i](const auto& group) { return group.holds(i); });
    if (is_region && state.sliding.size() > 1) return {};
    result.push_back(i);
  }
  return result;
}

std::vector<std::vector<double>> corners_at(const ModeState& state, const std::vector<int>& surfaces) {
  constexpr std::size_t most = 10;
  const std::size_t count = std::min(surfaces.size(), most);
  std::vector<std::vector<double>> corners(std::size_t{1} << count, state.alpha);
  for (std::size_t corner = 0; corner < corners.size(); ++corner) {
    for (std::size_t i = 0; i < count; ++i) {
      corners[corner][at(surfaces[i])] = (corner >> i & 1U) != 0 ? 1.0 : 0.0;
    }
  }
  return corners;
}

bool is_around_root(const evaluation::ModelKernel& kernel, int function) {
  const auto& inner = kernel.inner(function);
  return std::any_of(inner.begin(), inner.end(), [&](int i) { return kernel.has_root_inside(function, i); });
}

std::vector<std::vector<double>> corners_inside(const evaluation::ModelKernel& kernel, const ModeState& state,
                                                int function) {
  if (state.sliding.size() == 1) return {state.corner_alpha[0], state.corner_alpha[1]};
  return corners_at(state, sliding_inside(kernel, state, function));
}

bool moves_along(const evaluation::ModelKernel& kernel, const std::vector<double>& alpha, int surface, double t,
                 const double* x, double scale) {
  const std::size_t n = at(kernel.states());
  std::vector<double> f(n), row(n), values(at(kernel.event_functions())), point(x, x + n);
  const auto velocity = [&](int function, double time) {
    kernel.field(time, point.data(), alpha.data(), f.data());
    double sum = 0.0;
    kernel.gradient(function, time, point.data(), alpha.data(), row.data(), &sum);
    for (std::size_t i = 0; i < n; ++i) sum += row[i] == 0.0 ? 0.0 : row[i] * f[i];
    return sum;
  };
  // Ten digits, as for other signs of velocities, less what the step costs.
  constexpr double tangent = 1e-9;
  if (!(std::abs(velocity(surface, t)) <= tangent * scale)) return false;
  kernel.functions(t, x, alpha.data(), values.data());
  double time = std::numeric_limits<double>::infinity();
  for (const int i : kernel.inner(surface)) {
    const double left = std::abs(values[at(i)] / velocity(i, t));
    if (left > 0.0) time = std::min(time, left);
  }
  if (!std::isfinite(time)) return false;
  const double h = look_ahead(time);
  const auto along = [&](double at_time, const double* here, double* slope) {
    kernel.field(at_time, here, alpha.data(), slope);
  };
  ode::ClassicalStep(n).take(along, t, h, point);
  return std::abs(velocity(surface, t + h)) <= tangent * scale;
}

bool continuous_across(const evaluation::ModelKernel& kernel, const std::vector<std::vector<double>>& corners,
                       int nested, double t, const std::vector<double>& x, double time_scale) {
  std::vector<double> values(at(kernel.event_functions()));
  double lowest = std::numeric_limits<double>::infinity();
  double highest = -lowest;
  for (const auto& alpha : corners) {
    kernel.functions(t, x.data(), alpha.data(), values.data());
    lowest = std::min(lowest, values[at(nested)]);
    highest = std::max(highest, values[at(nested)]);
  }
  // Four digits above rounding: the point is on the surface to rounding, a jump is not of that size.
  return highest - lowest <= smallest_jump(size_of(kernel, nested, t, x.data(), corners.back().data(), time_scale));
}

}  // namespace saltus::event_integrator
