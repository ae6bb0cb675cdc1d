#include "saltus/event_integrator/instant/limit_stage.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "saltus/base/at.hpp"
#include "saltus/event_integrator/instant/contact_stage.hpp"
#include "saltus/event_integrator/instant/instant_rows.hpp"
#include "saltus/event_integrator/instant/jump_stage.hpp"
#include "saltus/event_integrator/instant/rest_stage.hpp"
#include "saltus/event_integrator/mode/field_rates.hpp"

namespace saltus::event_integrator {
namespace {

using result::Termination;

/// Whether the guards of a jump whose values change nothing come true by the motion that the jumps do not set: they
/// are added to the zeros then.
bool comes_true(const InstantContext& c, int jump, FieldRates& rates, const std::vector<double>& slope) {
  auto& [run, cascade, out] = c;
  const ode::Tolerances& tolerances = run.tolerances.step();
  const auto& guards = run.switching.layout.jumps[at(jump)].guards;
  bool any = false;
  for (int g = 0; g < static_cast<int>(guards.size()); ++g) {
    const int function = run.kernel.jump_guard(jump, g);
    const Rate rate = rates.along(function, slope);
    const double resolved = tolerances.atol * rate.slope + tolerances.rtol * rate.magnitude;
    if (run.jumps.is_discrete_guard(function) || !(std::abs(cascade.zero_value(function)) <= resolved)) continue;
    any = run.jumps.trigger_sign(jump, g, c.jump_point(), 0) * rate.value > 0.0;
    if (!any) return false;
    run.ledger.add(function);
  }
  return any;
}

/// Whether jumps change nothing at their limit, and their conditions come true there by what they do not set: the
/// conditions then hold behind it, and nothing fires again.
bool change_nothing(const InstantContext& c, const std::vector<int>& jumps) {
  auto& [run, cascade, out] = c;
  const Position& here = run.here;
  const ode::Tolerances& tolerances = run.tolerances.step();
  FieldRates rates(run.kernel, here);
  std::vector<double> slope(here.x.size());
  run.kernel.field(here.t, here.x.data(), here.state.alpha.data(), slope.data());
  for (const int jump : jumps) {
    const auto& targets = run.switching.layout.jumps[at(jump)].targets;
    std::vector<double> values(targets.size());
    run.kernel.jump_values(jump, here.t, here.x.data(), here.state.alpha.data(), values.data());
    for (std::size_t i = 0; i < targets.size(); ++i) {
      const double x = here.x[at(targets[i])];
      if (!(std::abs(values[i] - x) <= tolerances.atol + tolerances.rtol * std::abs(x))) return false;
      slope[at(targets[i])] = 0.0;
    }
    if (!comes_true(c, jump, rates, slope)) return false;
  }
  return true;
}

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

/// Rows up to the limit of a sequence of bounces, on lines: gaps may move, and x_last is not on them any more.
void rows_to_limit(RunState& run, double t_last, const std::vector<double>& x_last, const std::vector<double>& x_limit,
                   const ModeState& before) {
  const double t_limit = run.here.t;
  run.rows.each_before(t_last, t_limit, [&](double t) {
    auto x = x_limit;
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += (t_limit - t) / (t_limit - t_last) * (x_last[i] - x[i]);
    run.recorder.row(t, x, before, before.alpha);
  });
  run.rows.skip_here();
  if (t_limit > t_last) run.recorder.row(t_limit, x_limit, before, before.alpha);
}

}  // namespace

bool rest_at_limit(const InstantContext& c, const Instant& instant) {
  auto& [run, cascade, out] = c;
  const Position& here = run.here;
  const auto names = [&](const std::vector<int>& jumps) { return jump_names(run.switching.layout, jumps); };
  std::vector<int> jumps;
  for (const auto& guard : instant.guards) jumps.push_back(guard.hold.jump);
  if (jumps.empty()) {
    if (change_nothing(c, instant.limit.events)) return free_passing(c);
    run.end(Termination::outside_class,
            fmt::format("the jumps {} accumulate at t = {:.17g}, but no guard of theirs is left at 0: what follows is "
                        "not determined",
                        names(instant.limit.events), here.t));
    return false;
  }
  std::vector<HeldGuard> guards = run.holding.held().all();
  guards.insert(guards.end(), instant.guards.begin(), instant.guards.end());
  constexpr double at_rest = 1e-3;
  if (hold_guards(c, std::move(guards), {}) &&
      !(run.holding.largest_rate(here.t, here.state.alpha, here.x) <= at_rest * instant.rate)) {
    run.end(Termination::outside_class,
            fmt::format("the jumps {} accumulate at t = {:.17g}, but their guards cannot be at rest at 0 together",
                        names(jumps), here.t));
  }
  return run.running && free_passing(c);
}

bool settle_contacts(const InstantContext& c, const SeriesLimit& limit, const ModeState& before_last) {
  auto& [run, cascade, out] = c;
  Position& here = run.here;
  const double t_last = here.t;
  const std::vector<double> x_last = here.x;
  const Contacts::Bounces bounces{limit.events, limit.t - t_last,
                                  run.contacts.without_slip(run.contact_moment(), x_last)};
  here.move_to(limit.t, limit.x.data());
  cascade.begin();
  const auto slid_on = slid_on_between_bounces(run.kernel, before_last.sliding, here, x_last);
  // What holds it opens a contact.
  for (const int j : slid_on) here.state.alpha[at(j)] = before_last.alpha[at(j)];
  auto problem = run.contacts.settle(run.contact_moment(), bounces, here.x);
  if (problem) run.end(Termination::outside_class, std::move(*problem));
  limit_beside_rest(run);
  out.x_before = here.x;
  in_mode_before(c, [&] { rows_to_limit(run, t_last, x_last, out.x_before, out.before); });
  if (!run.running) return false;
  cascade.drop_zeros();
  for (const int j : slid_on) run.ledger.add(j);
  cascade.read_user_signs();
  return true;
}

void record_limit_of_jumps(const InstantContext& c, const std::vector<int>& jumps, std::string_view why) {
  auto& [run, cascade, out] = c;
  const Position& here = run.here;
  run.recorder.accumulated(here.t, jumps, {out.x_before, here.x, out.before, here.state}, why);
  run.row(here.t, here.x);
  run.last_event = here.t;
}

void record_limit_of_switches(const InstantContext& c, const Instant& instant) {
  auto& [run, cascade, out] = c;
  const Position& here = run.here;
  const auto why = instant.limit.kind == SeriesKind::unresolved
                       ? "these are zero together, as far as they can be told apart"
                       : "the intervals of these switches shrink geometrically: the state is their limit";
  run.recorder.spiralled(here.t, instant.surfaces, {out.x_before, here.x, out.before, here.state}, instant.transition,
                         why);
  run.row(here.t, here.x);
  run.last_event = here.t;
}

}  // namespace saltus::event_integrator
