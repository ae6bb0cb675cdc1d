#include "saltus/event_integrator/instant/contact_stage.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "saltus/base/at.hpp"

namespace saltus::event_integrator {

using result::Termination;

bool only_slips_on(const InstantContext& c) {
  const auto executed = c.cascade.executed().items();
  return std::all_of(executed.begin(), executed.end(), [&](const auto& one) {
    return one.x == one.x_after && c.run.contacts.slip_goes_on(one.activities, one.activities_after);
  });
}

void limit_beside_rest(RunState& run) {
  if (run.contacts.none()) return;
  ode::Tolerances parts = run.contacts.bearable(run.contact_moment(), run.here.x);
  parts.rtol = std::max(parts.rtol, std::min(1.0, run.tolerances.smallest_part()));
  run.tolerances.limit(StepTolerances::Reason::slips, parts);
}

bool begin_contacts(const InstantContext& c) {
  auto& [run, cascade, out] = c;
  Position& here = run.here;
  if (run.contacts.none()) return true;
  const auto before = here.x;
  const Activities activities = run.contacts.activities();
  if (auto problem = run.contacts.resolve(run.contact_moment(), {}, here.x)) {
    run.end(Termination::outside_class, std::move(*problem));
    return false;
  }
  limit_beside_rest(c.run);
  if (const auto jump = run.contacts.jump_to_tell()) {
    cascade.begin_execution(*jump, before, activities);
    cascade.end_execution_of_contacts();
  }
  return true;
}

bool begin_contacts_anew(const InstantContext& c) {
  auto& [run, cascade, out] = c;
  if (auto problem = run.contacts.begin_anew(run.contact_moment(), run.here.x)) {
    run.end(Termination::outside_class, std::move(*problem));
    return false;
  }
  const auto jumps = cascade.executed().size();
  if (!begin_contacts(c)) return false;
  if (cascade.executed().size() == jumps) cascade.end_execution();
  return true;
}

bool contacts_jump(const InstantContext& c) {
  auto& [run, cascade, out] = c;
  Position& here = run.here;
  if (!run.contacts.have_jumped(run.contact_moment(), here.x)) return false;
  const auto x_before = here.x;
  const Activities activities = run.contacts.activities();
  if (!begin_contacts_anew(c)) return true;
  if (cascade.executed().empty()) {
    cascade.begin_execution(run.switching.layout.contacts.front().jump, x_before, activities);
    cascade.end_execution_of_contacts();
  }
  cascade.read_user_signs(JumpCascade::Gaps::begun);
  return true;
}

void put_on_gaps(RunState& run, const Located& located) {
  const auto touching = run.contacts.with_jumps([&](int jump) {
    return std::any_of(located.functions.begin(), located.functions.end(), [&](std::size_t place) {
      const auto& function = run.search.functions()[place];
      return function.kind == FunctionKind::user && function.index == run.kernel.jump_guard(jump, 0);
    });
  });
  if (!touching.empty())
    static_cast<void>(run.contacts.project(run.here.t, run.here.state.alpha, run.here.x, touching));
}

bool move_contacts(const InstantContext& c) {
  auto& [run, cascade, out] = c;
  const auto ended = run.contacts.with_jumps([&](int jump) { return run.jumps.holds(jump); });
  auto problem = run.contacts.resolve(run.contact_moment(), ended, run.here.x);
  if (problem) run.end(Termination::outside_class, std::move(*problem));
  for (const int jump : run.contacts.last_bounces()) out.last_bounces.push_back(jump);
  if (problem) return false;
  limit_beside_rest(c.run);
  return true;
}

bool contact_modes_hold(const InstantContext& c) {
  auto& [run, cascade, out] = c;
  Position& here = run.here;
  const auto ended = run.contacts.with_jumps([&](int jump) { return run.jumps.holds(jump); });
  if (ended.empty()) return true;
  const auto n = at(run.kernel.event_functions());
  std::vector<double> values(n), magnitude(n), slope(n);
  run.kernel.functions(here.t, here.x.data(), here.state.alpha.data(), values.data());
  run.kernel.scales(here.t, here.x.data(), here.state.alpha.data(), magnitude.data(), slope.data());
  constexpr double clear = 1e-9;
  const bool hold = std::none_of(values.begin(), values.end(), [&](const double& value) {
    const auto function = static_cast<int>(&value - values.data());
    return run.contacts.guards(function) &&
           value > std::max(clear * magnitude[at(function)], run.contacts.tolerated(function));
  });
  if (hold) return true;
  run.end(Termination::outside_class, fmt::format("the mode of {} that follows at t = {:.17g} ends where it begins",
                                                  run.contacts.names(ended), here.t));
  return false;
}

}  // namespace saltus::event_integrator
