// The way into a zero of a nested function, and out of it.
#include <algorithm>
#include <cmath>

#include "saltus/event_integrator/field/held_functions.hpp"
#include "saltus/event_integrator/run/run_internal.hpp"

namespace saltus::event_integrator {

/// Over the rest of the way, with the rows in it: on parabolas that begin with the slopes here.
Run::Step Run::arrive_at_nested_roots(const Located& located) {
  const double h = located.t - here_.t;
  rows_.write_before(located.t, [&](double t, double* x) {
    const double s = (t - here_.t) / h;
    for (std::size_t k = 0; k < here_.x.size(); ++k) {
      const double mean = (located.x[k] - here_.x[k]) / h;
      x[k] = here_.x[k] + h * s * (here_.slope[k] + s * (mean - here_.slope[k]));
    }
  });
  // Selections are 0/0 at the end: those of the last step are theirs to what changes over this way.
  std::vector<double> slope(here_.x.size());
  field_(here_.t, here_.x.data(), slope.data());
  if (is_finite(field_.alpha())) here_.state.alpha = field_.alpha();
  // The last steps may have been short because of rounding.
  here_.time_scale = std::max({here_.time_scale, located.t - here_.t, 1e-3 * (here_.t - nested_.since())});
  return handle(located);
}

/// Away from where a function is 0 with one that it has a root of, in a field that knows of no root: beside that point
/// a dense output may be on the side where the root is undefined. The first step is searched at its end only.
void Run::leave_nested_root() {
  const double limit = next_stop();
  const auto is_in_mode = [&](double t) {
    const auto& values = zeros_.functions(t, steps_.stepper().x_new());
    for (std::size_t i = 0; i < values.size(); ++i) {
      const auto& function = search_.functions()[i];
      if (function.kind == FunctionKind::surface && !(values[i] * function.sign > 0.0)) return false;
      if (values[i] * function.sign < 0.0) return false;
    }
    return true;
  };
  for (double h = root_step(); h > here_.smallest_step(); h *= 0.25) {
    const double t_new = std::min(here_.t + h, limit);
    if (steps_.take(t_new) == ode::Attempt::finite && steps_.error_norm() <= 1.0 && is_in_mode(t_new) &&
        steps_.remake_dense()) {
      steps_.set_length(t_new - here_.t);
      static_cast<void>(accept(t_new));
      return;
    }
    ++outcome_.result.statistics.rejected;
  }
}

}  // namespace saltus::event_integrator
