#include "saltus/event_integrator/recorder.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "saltus/event_integrator/small_internal.hpp"

namespace saltus::event_integrator {
namespace {

std::string why_executed(const model::Jump& jump) {
  switch (jump.trigger) {
    case model::JumpTrigger::times:
      return "a given time";
    case model::JumpTrigger::condition:
      return "its condition became true";
    case model::JumpTrigger::guard_down:
    case model::JumpTrigger::guard_up:
    case model::JumpTrigger::guard_both:
      return "its guard passed 0";
  }
  __builtin_unreachable();
}

}  // namespace

Recorder::Recorder(const evaluation::ModelKernel& kernel, const model::System& system)
    : kernel_(kernel), system_(system) {}

result::Mode Recorder::mode_columns(const std::vector<int>& mode, const std::vector<double>& alpha) const {
  result::Mode columns;
  columns.reserve(system_.columns.size());
  for (const auto& column : system_.columns) {
    const auto j = at(column.function);
    // Functions of discrete states are in no mode: their sign is that of their selection.
    const bool discrete = system_.switching[j].role == model::SwitchingRole::discrete;
    const int sign = discrete ? (alpha[j] > 0.5 ? 1 : alpha[j] < 0.5 ? -1 : 0) : mode[j];
    columns.push_back(column.orientation * sign);
  }
  return columns;
}

std::vector<double> Recorder::alpha_columns(const std::vector<double>& alpha) const {
  std::vector<double> columns;
  columns.reserve(system_.columns.size());
  for (const auto& column : system_.columns) {
    const double value = alpha[at(column.function)];
    columns.push_back(column.orientation > 0 ? value : 1.0 - value);
  }
  return columns;
}

void Recorder::row(double t, const std::vector<double>& x, const std::vector<int>& mode,
                   const std::vector<double>& alpha) {
  trajectory_.t.push_back(t);
  trajectory_.x.push_back(x);
  std::vector<double> u(at(kernel_.controls()));
  kernel_.inputs(t, alpha.data(), u.data());
  trajectory_.u.push_back(std::move(u));
  trajectory_.alpha.push_back(alpha_columns(alpha));
  trajectory_.mode.push_back(mode_columns(mode, alpha));
  std::vector<double> outputs(at(kernel_.outputs()));
  kernel_.outputs(t, x.data(), alpha.data(), outputs.data());
  trajectory_.outputs.push_back(std::move(outputs));
}

/// Two columns of the result with their orientations; nullopt if one of the surfaces is in none.
std::optional<result::Intersection> Recorder::intersection(const Meeting& meeting, const ModeState& after) const {
  result::Intersection shown;
  std::array<int, 2> orientation{};
  for (std::size_t k = 0; k < 2; ++k) {
    const auto column = std::find_if(system_.columns.begin(), system_.columns.end(),
                                     [&](const auto& c) { return c.function == meeting.surfaces[k]; });
    if (column == system_.columns.end()) return std::nullopt;
    shown.surfaces[k] = column->name;
    orientation[k] = column->orientation;
  }
  const auto oriented = [&](std::size_t k, double alpha) { return orientation[k] > 0 ? alpha : 1.0 - alpha; };
  // The corner of the columns where a surface is turned around is the one across.
  const std::size_t turned = (orientation[0] < 0 ? 1U : 0U) | (orientation[1] < 0 ? 2U : 0U);
  if (meeting.alpha) shown.alpha_before.emplace();
  for (std::size_t k = 0; k < 2; ++k) {
    for (std::size_t corner = 0; corner < 4; ++corner) {
      shown.velocities[k][corner] = orientation[k] * meeting.velocities[k][corner ^ turned];
    }
    if (meeting.alpha) (*shown.alpha_before)[k] = oriented(k, (*meeting.alpha)[k]);
    shown.alpha_after[k] = oriented(k, after.alpha[at(meeting.surfaces[k])]);
  }
  return shown;
}

void Recorder::add_transition(result::Event event, const Transition& transition) {
  event.mode_after = mode_columns(transition.state.mode, transition.state.alpha);
  event.alpha_after = alpha_columns(transition.state.alpha);
  event.unique = transition.unique;
  event.reason += (event.reason.empty() || transition.reason.empty() ? "" : "; ") + transition.reason;
  for (const auto& other : transition.alternatives) {
    event.alternatives.push_back({mode_columns(other.state.mode, other.state.alpha), alpha_columns(other.state.alpha)});
  }
  if (transition.meeting) event.intersection = intersection(*transition.meeting, transition.state);
  if (!event.alternatives.empty()) branch_points_.push_back({events_.size(), transition.decision});
  events_.push_back(std::move(event));
}

bool Recorder::switched(double t, const std::vector<double>& x, const ModeState& before, const Transition& transition) {
  result::Event event;
  result::Mode changed_before;
  result::Mode changed_after;
  for (const auto& column : system_.columns) {
    const auto j = at(column.function);
    if (system_.switching[j].role != model::SwitchingRole::listed) continue;
    if (before.mode[j] == transition.state.mode[j]) continue;
    changed_before.push_back(before.mode[j]);
    changed_after.push_back(transition.state.mode[j]);
    event.surfaces.push_back(column.name);
  }
  if (event.surfaces.empty()) return false;
  event.t = t;
  event.kind = result::kind_of_switch(changed_before, changed_after);
  event.x = x;
  event.x_after = x;
  event.mode_before = mode_columns(before.mode, before.alpha);
  event.alpha_before = alpha_columns(before.alpha);
  add_transition(std::move(event), transition);
  return true;
}

bool Recorder::started(double t, const std::vector<double>& x, const Transition& transition,
                       const std::vector<int>& surfaces) {
  result::Event event;
  for (const auto& column : system_.columns) {
    const bool at_zero = std::find(surfaces.begin(), surfaces.end(), column.function) != surfaces.end();
    if (at_zero && system_.switching[at(column.function)].role == model::SwitchingRole::listed) {
      event.surfaces.push_back(column.name);
    }
  }
  if (event.surfaces.empty()) return false;
  event.t = t;
  event.kind = result::EventKind::start;
  event.x = x;
  event.x_after = x;
  add_transition(std::move(event), transition);
  return true;
}

void Recorder::user(double t, const Passage& passage, int event) {
  result::Event entry;
  entry.t = t;
  entry.kind = result::EventKind::user;
  entry.name = system_.events[at(event)].name;
  entry.x = passage.x;
  entry.x_after = passage.x_after;
  entry.mode_before = mode_columns(passage.before.mode, passage.before.alpha);
  entry.mode_after = mode_columns(passage.after.mode, passage.after.alpha);
  entry.alpha_before = alpha_columns(passage.before.alpha);
  entry.alpha_after = alpha_columns(passage.after.alpha);
  entry.reason = "zero of an expression of [[events]]";
  if (system_.events[at(event)].guards.numel() > 0) entry.reason = "edge of a condition of [[events]]";
  if (passage.x != passage.x_after) entry.reason += ", by a jump";
  events_.push_back(std::move(entry));
}

void Recorder::jumped(double t, const std::vector<ExecutedJump>& jumps, const std::optional<ModeState>& before,
                      const Transition& transition) {
  for (std::size_t k = 0; k < jumps.size(); ++k) {
    const auto& name = system_.jumps[at(jumps[k].jump)].name;
    result::Event entry;
    entry.t = t;
    entry.kind = result::EventKind::jump;
    entry.name = name;
    entry.surfaces = {name};
    entry.x = jumps[k].x;
    entry.x_after = jumps[k].x_after;
    entry.reason = why_executed(system_.jumps[at(jumps[k].jump)]);
    if (k == 0 && before) {
      entry.mode_before = mode_columns(before->mode, before->alpha);
      entry.alpha_before = alpha_columns(before->alpha);
    }
    if (k + 1 == jumps.size()) {
      add_transition(std::move(entry), transition);
    } else {
      events_.push_back(std::move(entry));
    }
  }
}

void Recorder::accumulated(double t, const std::vector<int>& jumps, const Passage& passage, std::string reason) {
  result::Event entry;
  entry.t = t;
  entry.kind = result::EventKind::accumulation;
  for (const int jump : jumps) entry.surfaces.push_back(system_.jumps[at(jump)].name);
  entry.x = passage.x;
  entry.x_after = passage.x_after;
  entry.mode_before = mode_columns(passage.before.mode, passage.before.alpha);
  entry.mode_after = mode_columns(passage.after.mode, passage.after.alpha);
  entry.alpha_before = alpha_columns(passage.before.alpha);
  entry.alpha_after = alpha_columns(passage.after.alpha);
  entry.reason = std::move(reason);
  events_.push_back(std::move(entry));
}

void Recorder::spiralled(double t, const std::vector<int>& surfaces, const Passage& passage,
                         const Transition& transition) {
  result::Event entry;
  entry.t = t;
  entry.kind = result::EventKind::accumulation;
  for (const auto& column : system_.columns) {
    const auto j = at(column.function);
    const bool takes_part = std::find(surfaces.begin(), surfaces.end(), column.function) != surfaces.end();
    if (takes_part && passage.before.mode[j] != transition.state.mode[j]) entry.surfaces.push_back(column.name);
  }
  entry.x = passage.x;
  entry.x_after = passage.x_after;
  entry.mode_before = mode_columns(passage.before.mode, passage.before.alpha);
  entry.alpha_before = alpha_columns(passage.before.alpha);
  entry.reason = "the intervals of these switches shrink geometrically: the state is their limit";
  add_transition(std::move(entry), transition);
}

}  // namespace saltus::event_integrator
