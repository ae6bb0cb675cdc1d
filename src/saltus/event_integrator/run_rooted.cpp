// The first steps away from a surface on which the field of the mode has an infinite derivative.
#include <algorithm>
#include <cmath>
#include <utility>

#include "saltus/event_integrator/rooted_exit.hpp"
#include "saltus/event_integrator/run_internal.hpp"

namespace saltus::event_integrator {

/// Whether no function but that of `surface` has changed its sign since it had these values.
bool Run::keep_their_signs(const std::vector<double>& before, int surface, double t, const double* x) {
  const auto values = all_functions(t, x);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto& function = search_.functions()[i];
    if (function.kind == FunctionKind::surface && function.index == surface) continue;
    if (!(values[i] * before[i] >= 0.0)) return false;
  }
  return true;
}

void Run::leave_root() {
  const int surface = std::exchange(rooted_, -1);
  RootedExit exit(kernel_, surroundings_.affine_in_alpha, state_, surface);
  const double begin = t_;
  const double limit = std::min({options_.until, jumps_.next_time(), next_departure()});
  double h = 1e-2 * h_scale_;
  // Of -1.5 sqrt(x) + t^2 the derivative falls like 1/t^2 only: explicit steps, three over the stiffness each, are
  // worth while when a hundred of them double the time since the exit.
  constexpr double steps_left = 300.0;
  constexpr int most_steps = 200;
  for (int taken = 0; taken < most_steps && t_ < limit && h > smallest_step();) {
    if (t_ > begin && exit.stiffness(t_, x_) * (t_ - begin) <= steps_left) break;
    const double t_new = t_ + h >= limit ? limit : t_ + h;
    const auto x_new = exit.step(t_, x_, t_new - t_, tolerances_);
    // What else happens is located by ordinary steps.
    if (!x_new || !keep_their_signs(all_functions(t_, x_.data()), surface, t_new, x_new->data())) {
      ++result_.statistics.rejected;
      h *= 0.25;
      continue;
    }
    const auto& times = options_.output.times;
    for (; next_output_ < times.size() && times[next_output_] < t_new; ++next_output_) {
      if (times[next_output_] <= t_) continue;
      row(times[next_output_], exit.step(t_, x_, times[next_output_] - t_, tolerances_).value_or(*x_new));
    }
    ++taken;
    ++result_.statistics.steps;
    t_ = t_new;
    x_ = *x_new;
    const bool requested = next_output_ < times.size() && times[next_output_] == t_;
    if (requested) ++next_output_;
    if (options_.output.rows == OutputTimes::Rows::at_steps || requested || t_ >= options_.until) row(t_, x_);
    h *= 2.0;
  }
  if (t_ == begin) return;
  Transition same;
  same.state = state_;
  same.zero_order.assign(state_.mode.size(), 0);
  if (enter(same)) start_step();
}

}  // namespace saltus::event_integrator
