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

/// Onto all surfaces that meet, where f has a root of one of them: what is left of psi when another one is put to zero,
/// 1e-15, has a root of 3e-8, or none.
void Run::project_onto_roots(const Located& located) {
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
/// cycles that shrink, and say it.
void Run::note_time_scale(double h) {
  const bool is_cut = steps_.was_undefined() && zeros_.any_continued();
  here_.time_scale = is_cut ? std::max(h, std::min(here_.time_scale, here_.t - event_.last_time)) : h;
}

/// A state at rest on a kink is on either side of it; the root says into which one it goes. False where the run ends.
bool Run::take_side_of_root() {
  const auto j = at(event_.rooted);
  if (switching_context_.layout.surfaces[j].role != model::SwitchingRole::kink) return true;
  const auto leads_away = [&](const ModeState& state) {
    return RootedExit(kernel_, switching_context_.affine_in_alpha, state, event_.rooted)
        .leads_away(here_.t, here_.x, root_step());
  };
  Transition other;
  other.state = here_.state;
  set_surface(other.state, event_.rooted, -here_.state.mode[j], here_.state.mode[j] > 0 ? 0.0 : 1.0);
  set_corner_alpha(other.state);
  other.zero_order.assign(here_.state.mode.size(), 0);
  other.zero_order[j] = 2;
  other.rooted = event_.rooted;
  if (leads_away(here_.state) || !leads_away(other.state)) return true;
  return enter(other);
}

void Run::leave_root() {
  const int surface = std::exchange(event_.rooted, -1);
  if (!kernel_.has_root(surface)) return leave_nested_root();
  RootedExit exit(kernel_, switching_context_.affine_in_alpha, here_.state, surface);
  const double begin = here_.t;
  const double limit = next_stop();
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
    if (!x_new || !zeros_.keep_their_signs(surface, t_new, x_new->data())) {
      ++outcome_.result.statistics.rejected;
      h *= 0.25;
      continue;
    }
    rows_.each_before(here_.t, t_new, [&](double t) {
      row(t, exit.step(here_.t, here_.x, t - here_.t, tolerances_.step()).value_or(*x_new));
    });
    ++taken;
    ++outcome_.result.statistics.steps;
    here_.move_to(t_new, x_new->data());
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
