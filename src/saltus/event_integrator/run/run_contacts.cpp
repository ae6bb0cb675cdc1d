// Contacts in a run: where their modes change.
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "saltus/base/at.hpp"
#include "saltus/event_integrator/run/run_internal.hpp"

namespace saltus::event_integrator {

using result::Termination;

namespace {

/// Surfaces that were slid on before the last bounce and left by it. A bounce leaves them by less each time: the limit
/// is on them, whatever the extrapolation leaves of their psi.
std::vector<int> slid_on_between_bounces(const evaluation::ModelKernel& kernel, const std::vector<int>& slid,
                                         const Position& limit, const std::vector<double>& x_last) {
  constexpr double converged = 1e-2;
  std::vector<double> there(at(kernel.event_functions())), last(there);
  kernel.functions(limit.t, limit.x.data(), limit.state.alpha.data(), there.data());
  kernel.functions(limit.t, x_last.data(), limit.state.alpha.data(), last.data());
  std::vector<int> found;
  for (const int j : slid) {
    if (limit.state.mode[at(j)] != 0 && std::abs(there[at(j)]) <= converged * std::abs(last[at(j)])) found.push_back(j);
  }
  return found;
}

}  // namespace

ContactMoment Run::contact_moment() const { return {here_.t, here_.state.alpha, here_.time_scale, tolerances_.mode()}; }

/// Whether the jumps of this time were none: a slip in a plane goes on as it was.
bool Run::only_slips_on() const {
  const auto executed = cascade_.executed().items();
  return std::all_of(executed.begin(), executed.end(),
                     [&](const auto& one) { return contacts_.slip_goes_on(one.x, one.x_after); });
}

/// Modes at the start; bodies that touch and approach collide at once.
bool Run::begin_contacts() {
  if (contacts_.none()) return true;
  const auto before = here_.x;
  if (auto problem = contacts_.resolve(contact_moment(), {}, here_.x)) {
    fail(Termination::outside_class, std::move(*problem));
    return false;
  }
  limit_beside_rest();
  if (const auto jump = contacts_.jump_to_tell(here_.x)) {
    ExecutedJump& executed = cascade_.executed().append();
    executed.x = before;
    executed.jump = *jump;
    executed.x_after = here_.x;
    executed.why_open = contacts_.why_open();
  }
  return true;
}

/// Behind a jump of positions or velocities: modes afresh, as at a start.
bool Run::begin_contacts_anew() {
  if (auto problem = contacts_.begin_anew(contact_moment(), here_.x)) {
    fail(Termination::outside_class, std::move(*problem));
    return false;
  }
  const auto jumps = cascade_.executed().size();
  if (!begin_contacts()) return false;
  if (jumps > 0 && cascade_.executed().size() == jumps) cascade_.executed().back().x_after = here_.x;
  return true;
}

/// Whether what jumps here, a gap or the velocity of a belt, makes contacts begin anew. Their event is told here.
bool Run::contacts_jump() {
  if (!contacts_.have_jumped(contact_moment(), here_.x)) return false;
  const auto x_before = here_.x;
  if (!begin_contacts_anew()) return true;
  if (cascade_.executed().empty()) {
    ExecutedJump& executed = cascade_.executed().append();
    executed.x = x_before;
    executed.jump = switching_context_.layout.contacts.front().jump;
    executed.x_after = here_.x;
    executed.why_open = contacts_.why_open();
  }
  cascade_.read_user_signs(JumpCascade::Gaps::begun);
  return true;
}

/// What puts the state on closed gaps moves it off those that have been located beside them: no body is in another one.
void Run::put_on_gaps(const Located& located) {
  const auto touching = contacts_.with_jumps([&](int jump) {
    return std::any_of(located.functions.begin(), located.functions.end(), [&](std::size_t place) {
      const auto& function = search_.functions()[place];
      return function.kind == FunctionKind::user && function.index == kernel_.jump_guard(jump, 0);
    });
  });
  if (!touching.empty()) static_cast<void>(contacts_.project(here_.t, here_.state.alpha, here_.x, touching));
}

/// All contacts whose modes end here, at once.
bool Run::move_contacts() {
  const auto ended = contacts_.with_jumps([&](int jump) { return jumps_.holds(jump); });
  auto problem = contacts_.resolve(contact_moment(), ended, here_.x);
  if (problem) fail(Termination::outside_class, std::move(*problem));
  for (const int jump : contacts_.last_bounces()) event_.last_bounces.push_back(jump);
  if (problem) return false;
  limit_beside_rest();
  choose_method();
  return true;
}

/// Slips in a plane that are slow among fast velocities.
void Run::limit_beside_rest() {
  if (contacts_.none()) return;
  ode::Tolerances parts = contacts_.bearable(contact_moment(), here_.x);
  parts.rtol = std::max(parts.rtol, std::min(1.0, tolerances_.smallest_part()));
  tolerances_.limit(StepTolerances::Reason::slips, parts);
}

/// Steps through the beginning of a slip in a plane are implicit.
void Run::choose_method() {
  if (contacts_.none() || ode::is_implicit(options_.method)) return;
  steps_.use(contacts_.turns_fast(contact_moment(), here_.x) ? ode::Method::radau5 : options_.method);
}

/// A mode whose own conditions clearly do not hold would never end.
bool Run::contact_modes_hold() {
  const auto ended = contacts_.with_jumps([&](int jump) { return jumps_.holds(jump); });
  if (ended.empty()) return true;
  const auto n = at(kernel_.event_functions());
  std::vector<double> values(n), magnitude(n), slope(n);
  kernel_.functions(here_.t, here_.x.data(), here_.state.alpha.data(), values.data());
  kernel_.scales(here_.t, here_.x.data(), here_.state.alpha.data(), magnitude.data(), slope.data());
  constexpr double clear = 1e-9;
  const bool hold = std::none_of(values.begin(), values.end(), [&](const double& value) {
    const auto function = static_cast<int>(&value - values.data());
    return contacts_.guards(function) &&
           value > std::max(clear * magnitude[at(function)], contacts_.tolerated(function, here_.x));
  });
  if (hold) return true;
  fail(Termination::outside_class,
       fmt::format("the mode of {} that follows at t = {:.17g} ends where it begins", contacts_.names(ended), here_.t));
  return false;
}

/// Rows up to the limit of a sequence of bounces, on lines: gaps may move, and x_last is not on them any more.
void Run::rows_to_limit(double t_last, const std::vector<double>& x_last, const std::vector<double>& x_limit,
                        const ModeState& before) {
  rows_.each_before(t_last, here_.t, [&](double t) {
    auto x = x_limit;
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += (here_.t - t) / (here_.t - t_last) * (x_last[i] - x[i]);
    contacts_.forget_impulses(x);
    recorder_.row(t, x, before, before.alpha);
  });
  rows_.skip_here();
  if (here_.t > t_last) recorder_.row(here_.t, x_limit, before, before.alpha);
}

/// Behind the limit of a sequence of bounces the gaps are closed.
void Run::settle_contacts(const SeriesLimit& limit, const std::vector<double>& x_last, const ModeState& before) {
  jump_accumulation_.clear();
  const double t_last = here_.t;
  const Contacts::Bounces bounces{limit.events, limit.t - t_last, contacts_.without_slip(contact_moment(), x_last)};
  here_.move_to(limit.t, limit.x.data());
  contacts_.copy_modes(x_last, here_.x);
  contacts_.forget_impulses(here_.x);
  cascade_.begin();
  const auto slid_on = slid_on_between_bounces(kernel_, event_.before.sliding, here_, x_last);
  for (const int j : slid_on) here_.state.alpha[at(j)] = event_.before.alpha[at(j)];  // what holds it opens a contact
  auto problem = contacts_.settle(contact_moment(), bounces, here_.x);
  if (problem) fail(Termination::outside_class, std::move(*problem));
  limit_beside_rest();
  auto x_before = here_.x;
  contacts_.copy_modes(x_last, x_before);
  contacts_.forget_impulses(x_before);
  rows_to_limit(t_last, x_last, x_before, before);
  const auto accumulated = [&] {
    recorder_.accumulated(here_.t, limit.events, {x_before, here_.x, before, here_.state},
                          "the intervals of these impacts shrink geometrically: the gaps close in their limit");
    row(here_.t, here_.x);
    event_.last_time = here_.t;
  };
  if (!outcome_.running) return accumulated();
  cascade_.drop_zeros();
  for (const int j : slid_on) cascade_.add_zero(j);
  cascade_.read_user_signs();
  if (!decide_behind_jumps()) return accumulated();
  cascade_.give_directions();
  accumulated();
  go_on_from_limit();
}

}  // namespace saltus::event_integrator
