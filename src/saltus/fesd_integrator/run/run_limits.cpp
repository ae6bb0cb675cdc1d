// Switches that accumulate: the limit of their cycles, and how it goes on behind it.
#include <algorithm>
#include <cmath>
#include <utility>

#include "saltus/fesd_integrator/run/run_internal.hpp"

namespace saltus::fesd_integrator {

/// The rounding level of the condition's value, divided by its rate: the larger one of both sides of the switch.
double Run::resolution_of(const Condition& condition, const std::vector<double>& selections_before) {
  if (condition.kind != Condition::Kind::side) return 0.0;
  const auto j = static_cast<std::size_t>(condition.selection);
  discretization::StageValues& at = context_.at_point;
  double rate = 0.0;
  for (const std::vector<double>* selections : {&selections_before, &position_.selections()}) {
    context_.kernel.evaluate(position_.t(), position_.x().data(), selections->data(), context_.held.data(), at);
    double sum = at.indicator_t[j];
    visit_row(at.pattern->indicator_x, at.indicator_x, j,
              [&](std::size_t i, double gradient) { sum += gradient * at.f[i]; });
    rate = std::max(rate, std::abs(sum));
  }
  return rate > 0.0 ? context_.watch.noise(condition) / rate : 0.0;
}

void Run::note_switch(const Condition& condition, const Before& before) {
  const double resolution = cycles_.shrinks() ? resolution_of(condition, before.selections) : 0.0;
  cycles_.add({position_.t(), position_.set().modes(), position_.x(), resolution});
  const bool slides_more = position_.set().sliding().size() > before.set.sliding().size();
  if (context_.kernel.root_exponents().empty() || slides_more) {  // no root is lost, or no switch is next
    length_.stop_following();
  } else {
    length_.follow(cycles_, position_.t());
  }
}

/// What a cycle changes is at rest behind it: on all of its surfaces, in all of its regions.
Run::Rest Run::rest_of(const CycleSeries::Limit& limit) const {
  Rest rest{position_.set().modes(), {}};
  for (std::size_t j = 0; j < rest.modes.size(); ++j) {
    const bool changes = std::any_of(limit.modes.begin(), limit.modes.end(),
                                     [&](const std::vector<int>& other) { return other[j] != rest.modes[j]; });
    if (!changes && rest.modes[j] != 0) continue;
    if (changes) rest.at_zero.push_back(static_cast<int>(j));
    rest.modes[j] = 0;
  }
  for (const int j : position_.on_surfaces()) rest.at_zero.push_back(j);
  return rest;
}

bool Run::go_to_limit(CycleSeries::Wanted wanted) {
  if (tangents_.asked()) return false;  // derivatives are those of elements
  const auto limit = cycles_.limit(wanted);
  if (!limit || limit->t > context_.options.until) return false;
  const double* held = context_.held.data();
  if (context_.held.next_change(position_.t(), limit->t, position_.x().data()) < limit->t) return false;
  const double farthest = cycles_.last_change();
  cycles_.clear();
  length_.stop_following();
  const Rest rest = rest_of(*limit);
  auto x = limit->x;
  const RestProjection::Place place{limit->t, held, position_.size(), position_.selections()};
  if (!rest_.to_rest(ActiveSet(context_.facts.parts, rest.modes), place, farthest, x)) return false;
  auto found = transition_.continuations({limit->t, x, held, nullptr, rest.at_zero, position_.size(), length_.trial()});
  if (found.empty()) return false;
  const auto resting = std::find_if(found.begin(), found.end(),
                                    [&](const Continuation& candidate) { return candidate.set.modes() == rest.modes; });
  if (resting != found.end()) std::rotate(found.begin(), resting, resting + 1);
  const Before before = before_here();
  // What is asked for on the way is too near to the limit to be told apart.
  rows_.pass(limit->t);
  recorder_.accumulated(limit->t, position_.x(), x, {&before.set, &before.selections, held}, found, held);
  position_.jump_to(limit->t, std::move(x));
  continue_with(found);
  chain_.interrupt();
  events_.update_here();
  rows_.emit_here();
  return true;
}

}  // namespace saltus::fesd_integrator
