// The way into a zero of a nested function, and out of it.
#include <algorithm>
#include <cmath>
#include <utility>

#include "saltus/event_integrator/field/held_functions.hpp"
#include "saltus/event_integrator/run/run_internal.hpp"

namespace saltus::event_integrator {

/// Over the rest of the way, with the rows in it: on parabolas that begin with the slopes here.
void Run::arrive_at_nested_roots(Located located) {
  const double h = located.t - run_.here.t;
  run_.rows.write_before(located.t, [&](double t, double* x) {
    const double s = (t - run_.here.t) / h;
    for (std::size_t k = 0; k < run_.here.x.size(); ++k) {
      const double mean = (located.x[k] - run_.here.x[k]) / h;
      x[k] = run_.here.x[k] + h * s * (run_.here.slope[k] + s * (mean - run_.here.slope[k]));
    }
  });
  // Selections are 0/0 at the end: those of the last step are theirs to what changes over this way.
  run_.evaluate_here();
  // The last steps may have been short because of rounding.
  constexpr double part = 1e-3;
  run_.here.time_scale =
      std::max({run_.here.time_scale, located.t - run_.here.t, part * (run_.here.t - nested_.since())});
  come_to(std::move(located));
}

/// Away from where a function is 0 with one that it has a root of, in a field that knows of no root: beside that point
/// a dense output may be on the side where the root is undefined. The first step is searched at its end only.
void Run::leave_nested_root() {
  const double limit = next_stop();
  const auto is_in_mode = [&](double t) {
    const auto& values = zeros_.functions(t, steps_.stepper().x_new());
    for (std::size_t i = 0; i < values.size(); ++i) {
      const auto& function = run_.search.functions()[i];
      if (function.kind == FunctionKind::surface && !(values[i] * function.sign > 0.0)) return false;
      if (values[i] * function.sign < 0.0) return false;
    }
    return true;
  };
  for (double h = root_step(); h > run_.here.smallest_step(); h *= 0.25) {
    const double t_new = std::min(run_.here.t + h, limit);
    if (steps_.take(t_new) == ode::Attempt::finite && steps_.error_norm() <= 1.0 && is_in_mode(t_new) &&
        steps_.remake_dense()) {
      steps_.set_length(t_new - run_.here.t);
      accept(t_new);
      return;
    }
    ++statistics_.rejected;
  }
}

}  // namespace saltus::event_integrator
