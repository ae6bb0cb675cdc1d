// One simulation step: elements of equal length up to every switch; run_locate.cpp finds where that is.
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "saltus/base/at.hpp"
#include "saltus/base/rounding_unit.hpp"
#include "saltus/fesd_integrator/run/run_internal.hpp"

namespace saltus::fesd_integrator {
namespace {

/// A simulation step is divided at most so often; then the elements are below any time scale of the model.
constexpr double shortest = 1e-12;
/// Elements that may jump over a switch are compared with parts of them, down to this power of 1/2.
constexpr int most_divisions_for_look = 8;
/// Parts of simulation steps that are divided for their errors are not shorter than this: what then is left of them has
/// no derivatives, or is the singularity of a solution.
constexpr double shortest_for_errors = 1e-3;
/// Modes that follow each other at one time; behind them elements are shortened.
constexpr int most_decisions_at_this_length = 4;

/// Between switches of laps that shrink, where the surface has roots: what is lost there is lost in every lap.
constexpr int elements_per_switch = 16;

}  // namespace

void Run::follow_laps() {
  const auto next = kernel_.root_exponents().empty() ? std::nullopt : laps_.next_switch();
  lap_part_ = next ? *next * options_.elements / elements_per_switch : 0.0;
  // Laps this short are those of roundings, and elements at the roundings of t would get nowhere.
  constexpr double shortest_followed = 1e-10, roundings = 64.0 * rounding_unit;
  if (lap_part_ <= std::max(shortest_followed * nominal_, options_.elements * roundings * std::abs(t_)))
    lap_part_ = 0.0;
}

double Run::part_end(double end) {
  const double remaining = end - t_;
  double longest = longest_part_;
  if (lap_part_ > 0.0) {
    // Where the next switch does not come, laps have ended.
    if (t_ - laps_.last_time() > lap_part_ * elements_per_switch) lap_part_ = 0.0;
    if (lap_part_ > 0.0) longest = std::min(longest, lap_part_);
  }
  if (!(longest < nominal_) || remaining <= longest) return end;
  return t_ + remaining / std::ceil(remaining / longest * (1.0 - 1e-12));
}

bool Run::too_coarse(const Element& element, const std::vector<double>& errors) {
  // Weights that nothing determines wander from stage to stage: no length makes these elements alike.
  if (!determined_) return false;
  share_ = std::max(share_, coarseness_.share(element, errors));
  // Twice: parts of the shortest length are so but for the roundings of t.
  return share_ > 1.0 && element.h * options_.elements > 2.0 * shortest_for_errors * nominal_;
}

void Run::set_longest_part(double h, Solved solved) {
  if (!options_.error_limit) return;
  // Shares grow with h^n_s; 0.8 and the bounds are those of step controls [hairer1993].
  const double ratio = 0.8 * std::pow(share_, -1.0 / solver_.tableau().stages());
  const double part = h * options_.elements;
  if (solved == Solved::coarse) {
    longest_part_ = std::max(part * std::clamp(ratio, 0.1, 0.5), shortest_for_errors * nominal_);
  } else {
    longest_part_ = std::max(longest_part_, part * std::min(ratio, 4.0));
  }
}

Run::Solved Run::solve_chain(int count, double h, Violation& violation) {
  chain_.count = 0;
  share_ = 0.0;
  chain_.left[0] = selections_;
  Point& left = begin_here();
  const int behind = previous_ ? 1 : warp_behind(h);
  for (int i = 0; i < count; ++i) {
    auto& element = chain_.elements[at(i)];
    element.warp = {i == 0 ? behind : 1, 1};
    auto guess = ElementSolver::Guess::left_end;
    const Element* last = i > 0 ? &chain_.elements[at(i - 1)] : previous_ ? &*previous_ : nullptr;
    if (last != nullptr && h <= 2.0 * last->h && last->warp.is_none()) {
      solver_.extrapolate(*last, h, element);
      guess = ElementSolver::Guess::stages;
    }
    auto outcome = solver_.solve(left, h, {&set_, 1}, held_.data(), guess, element);
    if (outcome != ElementSolver::Outcome::solved && guess == ElementSolver::Guess::stages) {
      outcome = solver_.solve(left, h, {&set_, 1}, held_.data(), ElementSolver::Guess::left_end, element);
    }
    if (outcome != ElementSolver::Outcome::solved) return Solved::failed;
    auto& right = chain_.left[static_cast<std::size_t>(i) + 1];
    right = left.selections;
    chain_.count = static_cast<std::size_t>(i) + 1;
    switch (watch_.look(element, set_, held_.data(), right, violation)) {
      case Watch::Answer::not_finite:
        return Solved::failed;
      case Watch::Answer::violated:
        return Solved::violated;
      case Watch::Answer::holds:
        break;
    }
    chain_.errors[at(i)] = watch_.errors();
    if (too_coarse(element, watch_.errors())) return Solved::coarse;
    if (watch_.may_miss() && divided_for_look_ < most_divisions_for_look &&
        jumps_over(left, h, most_divisions_for_look)) {
      return Solved::missed;
    }
    left.t = t_ + (i + 1) * h;
    left.x = element.end;
    left.selections = right;
    left.size = element.size;
  }
  return Solved::all;
}

bool Run::jumps_over(const Point& left, double h, int halvings) {
  if (halvings == 0) return false;
  Point from = left;
  Element half;
  const int behind = chain_.elements[chain_.count - 1].warp.left;
  for (int i = 0; i < 2; ++i) {
    half.warp = {from.t == chain_.elements[chain_.count - 1].t ? behind : 1, 1};
    Violation ignored;
    if (solver_.solve(from, 0.5 * h, {&set_, 1}, held_.data(), ElementSolver::Guess::left_end, half) !=
        ElementSolver::Outcome::solved) {
      return true;
    }
    auto right = from.selections;
    const auto answer = watch_.look(half, set_, held_.data(), right, ignored);
    if (answer != Watch::Answer::holds) return true;
    if (watch_.may_miss() && jumps_over(from, 0.5 * h, halvings - 1)) return true;
    from = {from.t + 0.5 * h, half.end, right, half.size};
  }
  return false;
}

void Run::advance(double end) {
  int elements = 0;
  double limit = t_;  // of the part that is tried
  const auto next_part = [&] {
    elements = options_.elements;
    limit = part_end(end);
  };
  next_part();
  while (!stopped() && t_ < end) {
    if (std::exchange(undecided_, false)) {
      fall_back(end, result::Termination::no_admissible_mode,
                fmt::format("no mode continues the solution at t = {:.10g}", t_));
      next_part();
      continue;
    }
    const double remaining = limit - t_;
    const double h = remaining / elements;
    if (elements == options_.elements) mean_ = h;
    Violation violation;
    auto solved = solve_chain(elements, h, violation);
    if (solved == Solved::all) {
      accept_chain(static_cast<std::size_t>(elements), limit, nullptr);
      row_here();
      divided_for_look_ = 0;
      set_longest_part(h, solved);
      next_part();
      continue;
    }
    if (solved == Solved::missed) ++divided_for_look_;
    std::optional<Located> located;
    if (solved == Solved::violated) {
      if (chain_.count == 1 && violation.theta == 0.0) {
        located = Located{0, 0.0, violation.condition};
      } else if (elements < 2) {
        // More switches than elements can separate: the rest is a simulation step of its own.
        reject();
        elements = options_.elements;
        continue;
      } else {
        located = find_switch(elements, remaining, violation, chain_.count - 1);
        if (located && located->coarse) solved = Solved::coarse;
      }
    }
    if (solved == Solved::coarse) {
      reject();
      set_longest_part(located ? located->h : h, solved);
      next_part();
      continue;
    }
    if (!located) {
      reject();
      if (stopped()) return;
      elements = options_.elements;
      limit = t_ + 0.5 * remaining;
      previous_.reset();
      if (0.5 * remaining <= shortest * nominal_ || !(limit > t_)) {
        if (!left_at_double_root()) {
          fall_back(end, result::Termination::not_converged,
                    fmt::format("the equations of an element have no solution that was found at t = {:.10g}", t_));
        }
        next_part();
      }
      continue;
    }
    if (located->count > 0) {
      double at = t_ + located->count * located->h;
      if (std::abs(limit - at) <= 1e-13 * nominal_) at = limit;
      accept_chain(static_cast<std::size_t>(located->count), at, &located->condition);
      set_longest_part(located->h, solved);
      elements = std::max(1, elements - located->count);
      if (located->divides) {
        reject();
        next_part();
      } else if (t_ >= limit) {
        next_part();
      }
    }
    if (stopped()) return;
    if (located->count == 0 && propagation_ != nullptr && std::exchange(ends_fixed_, false)) {
      propagation_->switched_here(t_, x_, selections_, held_.data(), set_, located->condition);
    }
    divided_for_look_ = 0;
    const ActiveSet before = set_;
    const auto selections = selections_;
    std::vector<int> at_zero = on_surfaces();
    if (located->condition.kind == Condition::Kind::side) at_zero.push_back(located->condition.selection);
    const Condition closing = located->condition;
    decide(std::move(at_zero), "located by the elements before it", before, selections, held_.data());
    row_here();
    if (!stopped() && !(set_ == before)) {
      const double resolution = laps_.shrinks() ? resolution_of(closing, selections) : 0.0;
      laps_.add({t_, set_.modes(), x_, resolution});
      follow_laps();
      if (set_.sliding().size() > before.sliding().size()) lap_part_ = 0.0;  // no switch is next
      if (go_to_limit(LapSeries::Wanted::resolved)) {
        next_part();
        continue;
      }
    }
    if (lap_part_ > 0.0) next_part();
    if (located->count == 0 && decisions_here_ > most_decisions_at_this_length) {
      // A decision looks at what is just behind; elements so long see something else.
      reject();
      limit = t_ + 0.5 * (limit - t_);
      elements = options_.elements;
    }
  }
}

}  // namespace saltus::fesd_integrator
