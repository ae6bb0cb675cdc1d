// The first steps away from a surface on which the field of the mode has an infinite derivative.
#include <algorithm>
#include <cmath>
#include <utility>

#include "saltus/event_integrator/field/held_functions.hpp"
#include "saltus/event_integrator/field/rooted_exit.hpp"
#include "saltus/event_integrator/mode/at_surface.hpp"
#include "saltus/event_integrator/run/run_internal.hpp"
#include "saltus/switching/table/independent_rows.hpp"

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

/// Beside a surface with a root of psi, psi matters relative to itself: errors of a step are to be less than a part of
/// what psi is or becomes. h' = -sqrt(h) empties at 2 sqrt(h), which an error of atol in h moves by 1e-5.
void Run::tighten_beside_roots(double h) {
  // A thousandth of psi moves that time by 1e-3 sqrt(psi); of what is left at `least` of atol, 1e-18, by 1e-9 at most.
  constexpr double part = 1e-3, least = 1e-8;
  const double smallest = tolerances_.smallest_part();
  double atol = 1.0, rtol = 1.0;
  rooted_values_.resize(at(kernel_.event_functions()));
  kernel_.functions(here_.t, here_.x.data(), here_.state.alpha.data(), rooted_values_.data());
  for (const int j : continued_roots_) {
    if (here_.state.mode[at(j)] == 0) continue;
    const Rate rate = rates_.here(j);
    const double wanted = part * std::max(std::abs(rooted_values_[at(j)]), std::abs(h * rate.value));
    atol = std::min(atol, std::max(least, wanted / (rate.slope * tolerances_.mode().atol)));
    rtol = std::min(rtol, std::max(smallest, wanted / (rate.magnitude * tolerances_.mode().rtol)));
  }
  // In laps that shrink atol does so already. What rtol allows of terms that are larger than psi, as x and t of
  // x - sin(t) are, has to; psi becomes the rate with which it leaves its surface for a part of the lap. Their limit is
  // as far off as the part of psi that is wrong is of the lap: from 1e-3 of it laps of dopri5 shrank unevenly, so that
  // some had no limit. Steps change a state by far less than its own size there: no more is lost than its rounding.
  constexpr double lap_part = 0.1, part_of_lap = 1e-5;
  const double rounding = 8.0 * rounding_unit / tolerances_.mode().rtol;
  for (const int j : ending_roots_) {
    if (switch_laps_.empty() || here_.state.mode[at(j)] == 0) continue;
    const Rate rate = rates_.here(j);
    const double farthest =
        std::max(std::abs(rooted_values_[at(j)]), std::max(h, lap_part * closed_lap_) * std::abs(rate.value));
    rtol = std::min(rtol, std::max(rounding, part_of_lap * farthest / (rate.magnitude * tolerances_.mode().rtol)));
  }
  tighten_beside_nested_roots(atol, rtol);
  tolerances_.limit(StepTolerances::Reason::zeros, {.rtol = rtol, .atol = atol});
}

/// A surface before `until` that psi, of terms far larger than it is, has a few roundings left to: the root of what
/// rounding makes of these says nothing any more, and steps that stay on this side may change nothing.
std::optional<Located> Run::rooted_surface_ahead(double until) {
  constexpr double few = 4.0;
  auto& values = values_here_;
  find_functions(here_.t, here_.x.data(), values);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto& function = search_.functions()[i];
    const bool has_root = function.kind == FunctionKind::surface && contains(ending_roots_, function.index);
    if (!has_root || !(std::abs(values[i]) <= few * search_.noise(i))) continue;
    const Rate rate = rates_.here(function.index);
    // A step of this length may have ended beyond it by as little.
    const double left = std::max(0.0, -values[i] / rate.value);
    if (!(function.sign * rate.value < 0.0) || here_.t + left >= until) continue;
    Located located{here_.t + left, here_.x, {i}, {function.sign}};
    for (std::size_t k = 0; k < here_.x.size(); ++k) located.x[k] += left * here_.slope[k];
    move_onto(kernel_, here_.state, function.index, located.t, located.x);
    return located;
  }
  return std::nullopt;
}

/// Onto all surfaces that meet, where f has a root of one of them: what is left of psi when another one is put to zero,
/// 1e-15, has a root of 3e-8, or none.
void Run::settle_on_roots(const Located& located) {
  if (!kernel_.region_groups().empty()) return;
  std::vector<int> surfaces = here_.state.sliding;
  for (const std::size_t i : located.functions) {
    const auto& function = search_.functions()[i];
    if (function.kind == FunctionKind::surface) surfaces.push_back(function.index);
  }
  const auto rooted = [&](int j) { return kernel_.has_root(j); };
  if (surfaces.size() < 2 || std::none_of(surfaces.begin(), surfaces.end(), rooted)) return;
  HeldFunctions held(kernel_);
  std::vector<HeldFunction> functions;
  std::vector<double> alpha = here_.state.alpha;
  for (const int j : surfaces) functions.push_back({j, 0});
  if (here_.state.higher) {
    for (const int j : here_.state.sliding) alpha[at(j)] = 0.5;
    for (const HeldFunction& function : here_.state.higher->functions) {
      if (function.order > 0) functions.push_back(function);
    }
  }
  const std::size_t count = functions.size();
  held.set(std::move(functions), std::move(alpha));
  held.differentiate(here_.t, here_.x.data());
  for (std::size_t i = 0; i < count; ++i) {
    if (!(held.independent_part(i) > switching::dependent_part)) return;
  }
  static_cast<void>(held.project(here_.t, here_.x.data()));
}

/// The time scale of what is decided behind a step. Steps that end where a field is undefined say nothing of it: they
/// go down to the resolution of t. Without surfaces that are slid on beside roots (super-twisting) they are those of
/// laps that shrink, and say it.
void Run::note_time_scale(double h) {
  const bool is_cut = undefined_ahead_ && !continued_roots_.empty();
  here_.time_scale = is_cut ? std::max(h, std::min(here_.time_scale, here_.t - last_event_time_)) : h;
}

/// A surface that is at zero here, beside which the field has an infinite derivative; -1 if there is none.
int Run::root_here() {
  const auto values = all_functions(here_.t, here_.x.data());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto& function = search_.functions()[i];
    const bool beside = function.kind == FunctionKind::surface && here_.state.mode[at(function.index)] != 0;
    if (!beside || !(std::abs(values[i]) <= search_.noise(i))) continue;
    RootedExit exit(kernel_, surroundings_.affine_in_alpha, here_.state, function.index);
    if (exit.has_root(here_.t, here_.x)) return function.index;
  }
  return -1;
}

/// A state at rest on a kink is on either side of it; the root says into which one it goes. False where the run ends.
bool Run::take_side_of_root() {
  const auto j = at(rooted_);
  if (surroundings_.system.switching[j].role != model::SwitchingRole::kink) return true;
  const auto leads_away = [&](const ModeState& state) {
    return RootedExit(kernel_, surroundings_.affine_in_alpha, state, rooted_).leads_away(here_.t, here_.x, root_step());
  };
  Transition other;
  other.state = here_.state;
  set_surface(other.state, rooted_, -here_.state.mode[j], here_.state.mode[j] > 0 ? 0.0 : 1.0);
  set_corner_alpha(other.state);
  other.zero_order.assign(here_.state.mode.size(), 0);
  other.zero_order[j] = 2;
  other.rooted = rooted_;
  if (leads_away(here_.state) || !leads_away(other.state)) return true;
  return enter(other);
}

void Run::leave_root() {
  const int surface = std::exchange(rooted_, -1);
  if (!kernel_.has_root(surface)) return leave_nested_root();
  RootedExit exit(kernel_, surroundings_.affine_in_alpha, here_.state, surface);
  const double begin = here_.t;
  const double limit = std::min({options_.until, jumps_.next_time(), next_departure()});
  double h = root_step();
  // Of -1.5 sqrt(x) + t^2 the derivative falls like 1/t^2 only: explicit steps, three over the stiffness each, are
  // worth while when a hundred of them double the time since the exit.
  constexpr double steps_left = 300.0;
  constexpr int most_steps = 200;
  for (int taken = 0; taken < most_steps && here_.t < limit && h > here_.smallest_step();) {
    if (here_.t > begin && exit.stiffness(here_.t, here_.x) * (here_.t - begin) <= steps_left) break;
    const double t_new = here_.t + h >= limit ? limit : here_.t + h;
    const auto x_new = exit.step(here_.t, here_.x, t_new - here_.t, tolerances_.step());
    // What else happens is located by ordinary steps.
    if (!x_new || !keep_their_signs(all_functions(here_.t, here_.x.data()), surface, t_new, x_new->data())) {
      ++result_.statistics.rejected;
      h *= 0.25;
      continue;
    }
    rows_.each_before(here_.t, t_new, [&](double t) {
      row(t, exit.step(here_.t, here_.x, t - here_.t, tolerances_.step()).value_or(*x_new));
    });
    ++taken;
    ++result_.statistics.steps;
    here_.t = t_new;
    here_.x = *x_new;
    rows_.write_end_of_step();
    h *= 2.0;
  }
  if (here_.t == begin) return;
  Transition same;
  same.state = here_.state;
  same.zero_order.assign(here_.state.mode.size(), 0);
  if (enter(same)) start_step();
}

}  // namespace saltus::event_integrator
