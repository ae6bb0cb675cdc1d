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
  return std::all_of(executed.begin(), executed.end(),
                     [&](const auto& one) { return c.run.contacts.slip_goes_on(one.x, one.x_after); });
}

void limit_beside_rest(RunState& run) {
  if (run.contacts.none()) return;
  ode::Tolerances parts = run.contacts.bearable(run.contact_moment(), run.here.x);
  parts.rtol = std::max(parts.rtol, std::min(1.0, run.tolerances.smallest_part()));
  run.tolerances.limit(StepTolerances::Reason::slips, parts);
}

bool begin_contacts(const InstantContext& c) {
  if (c.run.contacts.none()) return true;
  const auto before = c.run.here.x;
  if (auto problem = c.run.contacts.resolve(c.run.contact_moment(), {}, c.run.here.x)) {
    c.run.end(Termination::outside_class, std::move(*problem));
    return false;
  }
  limit_beside_rest(c.run);
  if (const auto jump = c.run.contacts.jump_to_tell(c.run.here.x)) {
    ExecutedJump& executed = c.cascade.executed().append();
    executed.x = before;
    executed.jump = *jump;
    executed.x_after = c.run.here.x;
    executed.why_open = c.run.contacts.why_open();
  }
  return true;
}

bool begin_contacts_anew(const InstantContext& c) {
  if (auto problem = c.run.contacts.begin_anew(c.run.contact_moment(), c.run.here.x)) {
    c.run.end(Termination::outside_class, std::move(*problem));
    return false;
  }
  const auto jumps = c.cascade.executed().size();
  if (!begin_contacts(c)) return false;
  if (jumps > 0 && c.cascade.executed().size() == jumps) c.cascade.executed().back().x_after = c.run.here.x;
  return true;
}

bool contacts_jump(const InstantContext& c) {
  if (!c.run.contacts.have_jumped(c.run.contact_moment(), c.run.here.x)) return false;
  const auto x_before = c.run.here.x;
  if (!begin_contacts_anew(c)) return true;
  if (c.cascade.executed().empty()) {
    ExecutedJump& executed = c.cascade.executed().append();
    executed.x = x_before;
    executed.jump = c.run.switching.layout.contacts.front().jump;
    executed.x_after = c.run.here.x;
    executed.why_open = c.run.contacts.why_open();
  }
  c.cascade.read_user_signs(JumpCascade::Gaps::begun);
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
  const auto ended = c.run.contacts.with_jumps([&](int jump) { return c.run.jumps.holds(jump); });
  auto problem = c.run.contacts.resolve(c.run.contact_moment(), ended, c.run.here.x);
  if (problem) c.run.end(Termination::outside_class, std::move(*problem));
  for (const int jump : c.run.contacts.last_bounces()) c.out.last_bounces.push_back(jump);
  if (problem) return false;
  limit_beside_rest(c.run);
  return true;
}

bool contact_modes_hold(const InstantContext& c) {
  const auto ended = c.run.contacts.with_jumps([&](int jump) { return c.run.jumps.holds(jump); });
  if (ended.empty()) return true;
  const auto n = at(c.run.kernel.event_functions());
  std::vector<double> values(n), magnitude(n), slope(n);
  c.run.kernel.functions(c.run.here.t, c.run.here.x.data(), c.run.here.state.alpha.data(), values.data());
  c.run.kernel.scales(c.run.here.t, c.run.here.x.data(), c.run.here.state.alpha.data(), magnitude.data(), slope.data());
  constexpr double clear = 1e-9;
  const bool hold = std::none_of(values.begin(), values.end(), [&](const double& value) {
    const auto function = static_cast<int>(&value - values.data());
    return c.run.contacts.guards(function) &&
           value > std::max(clear * magnitude[at(function)], c.run.contacts.tolerated(function, c.run.here.x));
  });
  if (hold) return true;
  c.run.end(Termination::outside_class, fmt::format("the mode of {} that follows at t = {:.17g} ends where it begins",
                                                    c.run.contacts.names(ended), c.run.here.t));
  return false;
}

}  // namespace saltus::event_integrator
