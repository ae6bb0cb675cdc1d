// One simulation step: elements of equal length up to every switch.
#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "saltus/fesd_integrator/run/run_internal.hpp"

namespace saltus::fesd_integrator {
namespace {

/// A simulation step is divided at most so often; then the elements are below any time scale of the model.
constexpr double shortest = 1e-12;

}  // namespace

Run::StepPart Run::next_part(double end) {
  return {end, length_.end_of_part(position_.t(), end, cycles_.last_time()), context_.options.elements};
}

void Run::advance(double end) {
  StepPart part = next_part(end);
  while (!stopped() && position_.t() < end) {
    if (decisions_.take_open()) {
      fall_back(end, result::Termination::no_admissible_mode,
                fmt::format("no mode continues the solution at t = {:.10g}", position_.t()));
      part = next_part(end);
      continue;
    }
    const Attempt tried = attempt(part);
    switch (tried.outcome) {
      case Attempt::Outcome::all:
        accept_part(part, tried);
        break;
      case Attempt::Outcome::coarse:
        refine_part(part, tried.h);
        break;
      case Attempt::Outcome::crowded:
        reject();
        part.elements = context_.options.elements;
        break;
      case Attempt::Outcome::unsolved:
        halve_part(part);
        break;
      case Attempt::Outcome::at_switch:
        go_to_switch(part, tried.located);
        break;
    }
  }
}

Run::Attempt Run::attempt(const StepPart& part) {
  const double h = (part.limit - position_.t()) / part.elements;
  if (part.elements == context_.options.elements) length_.set_mean(h);
  Violation violation;
  switch (chain_.solve(part.elements, h, violation)) {
    case Chain::Solved::all:
      return {Attempt::Outcome::all, h};
    case Chain::Solved::coarse:
      return {Attempt::Outcome::coarse, h};
    case Chain::Solved::missed:
    case Chain::Solved::failed:
      return {Attempt::Outcome::unsolved};
    case Chain::Solved::violated:
      return attempt_before(part, violation);
  }
  __builtin_unreachable();
}

/// The chain that ends at the switch that a violation shows.
Run::Attempt Run::attempt_before(const StepPart& part, const Violation& violation) {
  if (chain_.count() == 1 && violation.theta == 0.0) {
    return {Attempt::Outcome::at_switch, 0.0, {0, 0.0, violation.condition}};
  }
  if (part.elements < 2) return {Attempt::Outcome::crowded};
  const auto located = locator_.find(part.elements, part.limit - position_.t(), violation);
  if (!located) return {Attempt::Outcome::unsolved};
  if (located->coarse) return {Attempt::Outcome::coarse, located->h};
  return {Attempt::Outcome::at_switch, located->h, *located};
}

void Run::accept_part(StepPart& part, const Attempt& attempt) {
  accept_chain(static_cast<std::size_t>(part.elements), part.limit, nullptr);
  rows_.emit_here();
  chain_.forget_jumps();
  length_.lengthen_behind(attempt.h);
  part = next_part(part.end);
}

void Run::refine_part(StepPart& part, double h) {
  reject();
  length_.shorten_behind(h);
  part = next_part(part.end);
}

void Run::halve_part(StepPart& part) {
  reject();
  if (stopped()) return;
  const double half = 0.5 * (part.limit - position_.t());
  part.elements = context_.options.elements;
  part.limit = position_.t() + half;
  chain_.interrupt();
  if (half > shortest * length_.nominal() && part.limit > position_.t()) return;
  if (!left_at_double_root()) {
    fall_back(part.end, result::Termination::not_converged,
              fmt::format("the equations of an element have no solution that was found at t = {:.10g}", position_.t()));
  }
  part = next_part(part.end);
}

void Run::go_to_switch(StepPart& part, const Located& located) {
  if (located.count > 0) accept_up_to(part, located);
  if (stopped()) return;
  if (located.count == 0) tangents_.switched_here(located.condition);
  chain_.forget_jumps();
  decide_at(part, located);
}

void Run::accept_up_to(StepPart& part, const Located& located) {
  double end = position_.t() + located.count * located.h;
  if (std::abs(part.limit - end) <= 1e-13 * length_.nominal()) end = part.limit;
  accept_chain(static_cast<std::size_t>(located.count), end, &located.condition);
  length_.lengthen_behind(located.h);
  part.elements = std::max(1, part.elements - located.count);
  if (located.divides) reject();
  if (located.divides || position_.t() >= part.limit) part = next_part(part.end);
}

void Run::decide_at(StepPart& part, const Located& located) {
  const Before before = before_here();
  std::vector<int> at_zero = position_.on_surfaces();
  if (located.condition.kind == Condition::Kind::side) at_zero.push_back(located.condition.selection);
  decide({std::move(at_zero), located.condition.selection}, "located by the elements before it", before,
         context_.held.data());
  rows_.emit_here();
  if (!stopped() && !(position_.set() == before.set)) {
    note_switch(located.condition, before);
    if (go_to_limit(CycleSeries::Wanted::resolved)) {
      part = next_part(part.end);
      return;
    }
  }
  if (length_.is_following()) part = next_part(part.end);
  if (located.count == 0 && decisions_.asks_for_shorter_elements()) {
    reject();
    part.limit = position_.t() + 0.5 * (part.limit - position_.t());
    part.elements = context_.options.elements;
  }
}

/// Near the double root alpha is the square root of time: it is known to the root of what time is known to, and no
/// element ends where it is zero.
bool Run::left_at_double_root() {
  if (tangents_.asked()) return false;  // its derivative by time is infinite there
  constexpr double near = 1e-5;
  const ActiveSet& set = position_.set();
  const double* const no_indicator = nullptr;  // selections have none
  const bool at_bound = std::any_of(set.conditions().begin(), set.conditions().end(), [&](const Condition& condition) {
    return condition.kind != Condition::Kind::side &&
           set.value(condition, no_indicator, position_.selections().data()) <= near;
  });
  if (!at_bound) return false;
  const Before before = before_here();
  decide({position_.on_surfaces()}, "a selection has a double root at its bound", before, context_.held.data());
  rows_.emit_here();
  return stopped() || decisions_.is_open() || !(position_.set() == before.set);
}

}  // namespace saltus::fesd_integrator
