#include "saltus/event_integrator/jumps/jumps.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "saltus/base/at.hpp"
#include "saltus/base/contains.hpp"
#include "saltus/event_integrator/mode/selections_at.hpp"
#include "saltus/event_integrator/mode/small_internal.hpp"

namespace saltus::event_integrator {
namespace {

using model::JumpTrigger;

constexpr double never = std::numeric_limits<double>::infinity();

/// @param value  of the guard, or its sign
double step_of(const model::Layout::Guard& guard, double value) {
  return value > 0.0 || (value == 0.0 && guard.true_at_equality) ? 1.0 : 0.0;
}

}  // namespace

std::optional<std::string> compared_at_jumps_only(const model::Layout& layout, int state) {
  for (const auto& surface : layout.surfaces) {
    if (surface.role == model::SwitchingRole::discrete && contains(surface.states, state)) return surface.name;
  }
  for (const auto& jump : layout.jumps) {
    for (const auto& guard : jump.guards) {
      if (guard.discrete && contains(guard.states, state)) return jump.name;
    }
  }
  return std::nullopt;
}

Jumps::Jumps(const evaluation::ModelKernel& kernel, const JumpSpan& span)
    : kernel_(kernel),
      layout_(kernel.layout()),
      span_(span),
      origin_(span.begun.value_or(span.from)),
      truth_(layout_.jumps.size(), 0U),
      steps_(layout_.jumps.size()),
      times_passed_(layout_.jumps.size(), 0),
      values_(at(kernel.event_functions())),
      next_time_(never) {
  for (std::size_t k = 0; k < layout_.jumps.size(); ++k) {
    times_passed_[k] = passed_before_start(static_cast<int>(k));
  }
}

/// How many given times the run does not come to: at its start only those that happen there.
long Jumps::passed_before_start(int jump) const {
  const double from = span_.from;
  const bool goes_on = span_.begun.has_value();
  const auto is_over = [&](double time) {
    return goes_on ? has_come(time, from) : time < from && !is_same(time, from);
  };
  const auto& entry = layout_.jumps[at(jump)];
  if (!(entry.every > 0.0))
    return std::partition_point(entry.times.begin(), entry.times.end(), is_over) - entry.times.begin();
  if (!goes_on) return 0;
  long passed = std::max(0L, static_cast<long>((from - origin_) / entry.every) - 1);
  while (is_over(origin_ + static_cast<double>(passed + 1) * entry.every)) ++passed;
  return passed;
}

bool Jumps::is_discrete_guard(int function) const { return kernel_.is_discrete_guard(function); }

bool Jumps::is_compared(int function) const {
  for (std::size_t k = 0; k < layout_.jumps.size(); ++k) {
    if (layout_.jumps[k].trigger != JumpTrigger::condition) continue;
    for (int g = 0; g < static_cast<int>(layout_.jumps[k].guards.size()); ++g) {
      if (kernel_.jump_guard(static_cast<int>(k), g) == function) return true;
    }
  }
  return false;
}

/// The next time of a jump with given times.
double Jumps::time_of(int jump) const {
  const auto& entry = layout_.jumps[at(jump)];
  if (entry.trigger != JumpTrigger::times) return never;
  const long passed = times_passed_[at(jump)];
  // A multiple of the period, not a sum of periods: nothing accumulates.
  if (entry.every > 0.0) return origin_ + static_cast<double>(passed + 1) * entry.every;
  return passed < static_cast<long>(entry.times.size()) ? entry.times[at(passed)] : never;
}

void Jumps::find_next_time() {
  double first = never;
  for (std::size_t k = 0; k < layout_.jumps.size(); ++k) first = std::min(first, time_of(static_cast<int>(k)));
  for (const auto& execution : queue_) first = std::min(first, execution.t);
  next_time_ = first;
  // A time that is written comes before one that is computed.
  for (std::size_t k = 0; k < layout_.jumps.size(); ++k) {
    const double time = time_of(static_cast<int>(k));
    if (!layout_.jumps[k].times.empty() && is_same(time, first)) next_time_ = time;
  }
  if (is_same(span_.until, first)) next_time_ = span_.until;
}

/// Pointwise as written: signs of continuous guards are known just behind this time, discrete ones are exact.
int Jumps::guard_sign(int function, const JumpPoint& point) const {
  if (!is_discrete_guard(function)) return point.signs[at(function - kernel_.switching_functions())];
  const double value = values_[at(function)];
  return value > 0.0 ? 1 : value < 0.0 ? -1 : 0;
}

/// step of each guard; values_ are those of the point. Returns whether one is another than last time.
bool Jumps::read_steps(int jump, const JumpPoint& point) const {
  const auto& guards = layout_.jumps[at(jump)].guards;
  auto& steps = steps_[at(jump)];
  bool changed = steps.size() != guards.size();
  steps.resize(guards.size());
  for (std::size_t g = 0; g < guards.size(); ++g) {
    const double step = step_of(guards[g], guard_sign(guards[g].function, point));
    changed = changed || step != steps[g];
    steps[g] = step;
  }
  return changed;
}

unsigned Jumps::truth(int jump, const JumpPoint& point) const {
  const auto trigger = layout_.jumps[at(jump)].trigger;
  if (trigger == JumpTrigger::times) return 0U;
  if (trigger == JumpTrigger::condition) {
    // A condition is a function of its comparisons.
    if (!read_steps(jump, point)) return truth_[at(jump)] & 1U;
    const double* steps = steps_[at(jump)].data();
    return kernel_.jump_condition(jump, point.t, point.x.data(), point.alpha.data(), steps) ? 1U : 0U;
  }
  const int sign = guard_sign(layout_.jumps[at(jump)].guards.front().function, point);
  const unsigned below = trigger != JumpTrigger::guard_up && sign < 0 ? 1U : 0U;
  const unsigned above = trigger == JumpTrigger::guard_up ? 1U : 2U;
  return below | (trigger != JumpTrigger::guard_down && sign > 0 ? above : 0U);
}

bool Jumps::ends_itself(int jump, const JumpPoint& point) const {
  const auto& entry = layout_.jumps[at(jump)];
  const auto alpha = at_instant(point);
  const bool at_once = kernel_.jump_delay(jump, point.t, point.x.data(), alpha.data()) == 0.0;
  if (entry.trigger != JumpTrigger::condition || !at_once) return false;
  std::vector<double> set(entry.targets.size()), x = point.x, steps;
  kernel_.jump_values(jump, point.t, point.x.data(), alpha.data(), set.data());
  for (std::size_t i = 0; i < set.size(); ++i) x[at(entry.targets[i])] = set[i];
  kernel_.functions(point.t, x.data(), alpha.data(), values_.data());
  for (const auto& guard : entry.guards) steps.push_back(step_of(guard, values_[at(guard.function)]));
  return !kernel_.jump_condition(jump, point.t, x.data(), alpha.data(), steps.data());
}

/// In a run that goes on a condition may hold since it has jumped; not where the jump would have ended it.
void Jumps::begin(const JumpPoint& point) {
  for (std::size_t k = 0; k < truth_.size(); ++k) {
    const bool anew = layout_.jumps[k].at_start && (!span_.begun || ends_itself(static_cast<int>(k), point));
    truth_[k] = anew ? 0U : ~0U;
  }
  update(point);
}

void Jumps::update(const JumpPoint& point) {
  if (none()) return;
  kernel_.functions(point.t, point.x.data(), point.alpha.data(), values_.data());
  for (std::size_t k = 0; k < truth_.size(); ++k) {
    const int jump = static_cast<int>(k);
    const unsigned now = truth(jump, point);
    const bool became_true = (now & ~truth_[k]) != 0U;
    truth_[k] = now;
    if (became_true) trigger(jump, point);
    while (has_come(time_of(jump), point.t)) {
      ++times_passed_[k];
      trigger(jump, point);
    }
    if (!layout_.jumps[k].persistent && now == 0U && layout_.jumps[k].trigger != JumpTrigger::times) {
      std::erase_if(queue_, [jump](const Execution& execution) { return execution.jump == jump; });
    }
  }
  find_next_time();
}

void Jumps::accept(const std::vector<int>& jumps, const JumpPoint& point) {
  kernel_.functions(point.t, point.x.data(), point.alpha.data(), values_.data());
  for (const int jump : jumps) truth_[at(jump)] = truth(jump, point);
}

std::vector<double> Jumps::at_instant(const JumpPoint& point) const {
  auto alpha = point.alpha;
  if (alpha.empty()) return alpha;
  for (std::size_t j = 0; j < alpha.size(); ++j) {
    const bool moves = layout_.surfaces[j].role != model::SwitchingRole::region;
    if (moves && (alpha[j] == 0.0 || alpha[j] == 1.0)) alpha[j] = 0.5;
  }
  return selections_at(kernel_, point.t, point.x.data(), std::move(alpha), point.zeros);
}

void Jumps::trigger(int jump, const JumpPoint& point) {
  const auto alpha = at_instant(point);
  const double delay = kernel_.jump_delay(jump, point.t, point.x.data(), alpha.data());
  if (!(delay >= 0.0 && std::isfinite(delay))) {
    problem_ = fmt::format("the delay of the jump '{}' is {} at t = {:.17g}; it must be a finite number >= 0",
                           layout_.jumps[at(jump)].name, delay, point.t);
    return;
  }
  Execution execution{jump, point.t + delay, {}};
  if (layout_.jumps[at(jump)].evaluated == model::JumpValues::at_trigger) {
    execution.values.resize(layout_.jumps[at(jump)].targets.size());
    kernel_.jump_values(jump, point.t, point.x.data(), alpha.data(), execution.values.data());
  }
  queue_.push_back(std::move(execution));
}

bool Jumps::due(double t) const {
  return std::any_of(queue_.begin(), queue_.end(),
                     [&](const Execution& execution) { return has_come(execution.t, t); });
}

int Jumps::execute(const JumpPoint& point, std::vector<double>& x) {
  const auto alpha = at_instant(point);
  auto chosen = queue_.end();
  double largest = 0.0;
  for (auto entry = queue_.begin(); entry != queue_.end(); ++entry) {
    if (!has_come(entry->t, point.t)) continue;
    const double priority = kernel_.jump_priority(entry->jump, point.t, point.x.data(), alpha.data());
    if (std::isnan(priority)) {
      problem_ = fmt::format("the priority of the jump '{}' is not a number at t = {:.17g}",
                             layout_.jumps[at(entry->jump)].name, point.t);
    }
    const bool first = chosen == queue_.end();
    if (first || priority > largest || (priority == largest && entry->jump < chosen->jump)) {
      chosen = entry;
      largest = priority;
    }
  }
  const int jump = chosen->jump;
  const auto& entry = layout_.jumps[at(jump)];
  std::vector<double> values = std::move(chosen->values);
  queue_.erase(chosen);
  if (entry.evaluated == model::JumpValues::at_execution) {
    values.resize(entry.targets.size());
    kernel_.jump_values(jump, point.t, point.x.data(), alpha.data(), values.data());
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i])) {
      problem_ = fmt::format("the jump '{}' sets {} to {} at t = {:.17g}; guard its expression with if(…)", entry.name,
                             layout_.state_names[at(entry.targets[i])], values[i], point.t);
      return jump;
    }
  }
  if (!entry.forbidden.empty()) {
    came_to_forbidden_ = true;
    problem_ = fmt::format("{} at {:.6g}, t = {:.17g}", entry.forbidden, values.front(), point.t);
    return jump;
  }
  for (std::size_t i = 0; i < values.size(); ++i) x[at(entry.targets[i])] = values[i];
  find_next_time();
  return jump;
}

int Jumps::trigger_sign(int jump, int guard, const JumpPoint& point, int inward) const {
  switch (layout_.jumps[at(jump)].trigger) {
    case JumpTrigger::times:
      return 0;
    case JumpTrigger::guard_down:
      return -1;
    case JumpTrigger::guard_up:
      return 1;
    case JumpTrigger::guard_both:
      return inward;
    case JumpTrigger::condition:
      break;
  }
  kernel_.functions(point.t, point.x.data(), point.alpha.data(), values_.data());
  static_cast<void>(read_steps(jump, point));
  auto alpha = std::exchange(steps_[at(jump)], {});  // to be read anew
  const auto holds = [&](double step) {
    alpha[at(guard)] = step;
    return kernel_.jump_condition(jump, point.t, point.x.data(), point.alpha.data(), alpha.data());
  };
  const bool above = holds(1.0);
  const bool below = holds(0.0);
  return above == below ? 0 : above ? 1 : -1;
}

}  // namespace saltus::event_integrator
