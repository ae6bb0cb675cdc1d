#include "saltus/event_integrator/record/recorder.hpp"

#include <algorithm>
#include <limits>
#include <span>
#include <string_view>
#include <utility>

#include "saltus/base/contains.hpp"
#include "saltus/event_integrator/field/higher_order.hpp"
#include "saltus/event_integrator/mode/small_internal.hpp"

namespace saltus::event_integrator {
namespace {

std::string_view why_executed(const model::Layout::Jump& jump) {
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

/// So many numbers are appended one by one, which is quicker than what the standard library does for any number.
constexpr std::size_t few = 8;

void append(std::vector<double>& list, const std::vector<double>& values) {
  if (values.size() > few) {
    list.insert(list.end(), values.begin(), values.end());
  } else {
    for (const double value : values) list.push_back(value);
  }
}

/// As Recording::contact_states.
void append(std::vector<int>& list, const Activities& activities) {
  for (const auto& activity : activities) {
    const auto state = static_cast<int>(activity.state);
    list.push_back(activity.state == model::Activity::State::slip && activity.share[0] < 0.0 ? -state : state);
  }
}

/// Room for so many more; returns where it begins.
double* extend(std::vector<double>& list, std::size_t count) {
  if (count > few) {
    list.resize(list.size() + count);
  } else {
    for (std::size_t k = 0; k < count; ++k) list.push_back(0.0);
  }
  return list.data() + list.size() - count;
}

/// What result::kind_of_switch says of it.
result::EventKind kind_of(const ModeChange& change) {
  if (change.after == 0) return result::EventKind::enter_sliding;
  return change.before == 0 ? result::EventKind::leave_sliding : result::EventKind::crossing;
}

}  // namespace

Recorder::Recorder(const evaluation::ModelKernel& kernel)
    : kernel_(kernel), layout_(kernel.layout()), listed_columns_(layout_.surfaces.size()) {
  recording_.n_x = at(kernel.states());
  recording_.n_u = at(kernel.controls());
  recording_.n_y = at(kernel.outputs());
  recording_.n_c = layout_.contacts.size();
  // Lists that start empty are moved at every second of the first events.
  constexpr std::size_t first_events = 64;
  recording_.event_list.reserve(first_events);
  recording_.surfaces.reserve(first_events);
  recording_.states.reserve(first_events * recording_.n_x);
  recording_.text.reserve(1024);
  recording_.row_times.reserve(2 * first_events);
  recording_.row_modes.reserve(2 * first_events);
  recording_.row_states.reserve(2 * first_events * recording_.n_x);
  recording_.modes.reserve(2 * first_events);
  for (std::size_t c = 0; c < layout_.columns.size(); ++c) {
    const auto j = at(layout_.columns[c].function);
    if (layout_.surfaces[j].role == model::SwitchingRole::listed) listed_columns_[j].push_back(c);
  }
}

void Recorder::row(double t, const std::vector<double>& x, const ModeState& state, const std::vector<double>& alpha) {
  append_row(t, x, alpha, number(state, alpha, state.higher.get()));
}

void Recorder::row_before(double t, const std::vector<double>& x, const ModeState& before, long first_event) {
  const bool known = before_switch_.event == first_event;
  append_row(t, x, before.alpha, known ? before_switch_.mode : number(before, before.alpha, nullptr));
}

void Recorder::row_behind(const std::vector<double>& x, const ModeState& state, const std::vector<double>& alpha,
                          const ModeChange& change) {
  const auto& event = recording_.event_list.back();
  if (!change.is_single()) return row(event.t, x, state, alpha);
  const auto slid = at(change.slid != nullptr ? change.slid->surface : change.surface);
  append_row(event.t, x, alpha, recording_.modes.append_change(slid, state.mode[slid], alpha[slid]));
}

void Recorder::append_row(double t, const std::vector<double>& x, const std::vector<double>& alpha, std::size_t mode) {
  recording_.row_times.push_back(t);
  append(recording_.row_states, x);
  if (recording_.n_u > 0) kernel_.inputs(t, alpha.data(), extend(recording_.row_inputs, recording_.n_u));
  if (recording_.n_y > 0) {
    kernel_.outputs(t, x.data(), alpha.data(), extend(recording_.row_outputs, recording_.n_y));
  }
  recording_.row_modes.push_back(mode);
  append(recording_.row_contacts, kernel_.activities());
  if (ranges_ != nullptr) widen_ranges(x, alpha);
}

/// By the row just appended.
void Recorder::widen_ranges(const std::vector<double>& x, const std::vector<double>& alpha) {
  ranges_->widen(0, x);
  std::size_t column = x.size();
  ranges_->widen(column, std::span(recording_.row_inputs).last(recording_.n_u));
  column += recording_.n_u;
  const double* outputs = recording_.row_outputs.data() + recording_.row_outputs.size() - recording_.n_y;
  for (std::size_t k = 0; k < recording_.n_y; ++k) {
    const bool selection = k + cut_outputs_ >= recording_.n_y;
    ranges_->widen(column++, selection ? std::clamp(outputs[k], 0.0, 1.0) : outputs[k]);
  }
  ranges_->widen(column, alpha);
}

std::size_t Recorder::number(const ModeState& state, const std::vector<double>& alpha, const HigherOrderSet* higher) {
  const bool all_determined = higher == nullptr || higher->undetermined.empty();
  if (all_determined && state.resting.empty()) return recording_.modes.append(state.mode, alpha);
  determined_ = alpha;
  const auto leave_open = [&](const std::vector<int>& surfaces) {
    for (const int j : surfaces) determined_[at(j)] = std::numeric_limits<double>::quiet_NaN();
  };
  if (!all_determined) leave_open(higher->undetermined);
  leave_open(state.resting);
  return recording_.modes.append(state.mode, determined_);
}

Recording::Event& Recorder::begin(double t, result::EventKind kind, const Activities& before, const Activities& after) {
  auto& event = recording_.event_list.emplace_back();
  event.t = t;
  event.kind = kind;
  event.contacts = recording_.contact_states.size();
  append(recording_.contact_states, before);
  append(recording_.contact_states, after);
  const auto empty_at = [](std::size_t place) { return Recording::Range{place, place}; };
  event.surfaces = empty_at(recording_.surfaces.size());
  event.impulses = empty_at(recording_.impulses.size());
  event.alternatives = empty_at(recording_.alternatives.size());
  event.reason = empty_at(recording_.text.size());
  return event;
}

std::size_t Recorder::keep(const std::vector<double>& x) {
  append(recording_.states, x);
  return recording_.states.size() - x.size();
}

void Recorder::set_states(Recording::Event& event, const std::vector<double>& x, const std::vector<double>& x_after) {
  event.x = keep(x);
  event.x_after = &x == &x_after ? event.x : keep(x_after);
}

void Recorder::add_surface(Recording::Event& event, std::size_t surface) {
  recording_.surfaces.push_back(surface);
  event.surfaces.end = recording_.surfaces.size();
}

void Recorder::add_reason(Recording::Event& event, std::string_view reason) {
  const bool first = event.reason.begin == recording_.text.size();
  if (!first && !reason.empty()) recording_.text += "; ";
  recording_.text += reason;
  event.reason.end = recording_.text.size();
}

void Recorder::set_passage(Recording::Event& event, const Passage& passage) {
  set_states(event, passage.x, passage.x_after);
  event.mode = number(passage.before);
  event.mode_after = number(passage.after);
}

void Recorder::add_transition(Recording::Event& event, const Transition& transition) {
  add_transition(event, transition, number(transition.state));
}

void Recorder::add_transition(Recording::Event& event, const Transition& transition, std::size_t mode_after) {
  event.mode_after = mode_after;
  event.unique = transition.unique;
  add_reason(event, transition.reason);
  if (transition.meeting) {
    event.meeting = recording_.meetings.size();
    recording_.meetings.push_back(*transition.meeting);
  }
  if (transition.alternatives.empty() && !transition.beyond_spiral) return;
  for (const auto& other : transition.alternatives) {
    recording_.alternatives.push_back({other.state.mode, other.state.alpha});
  }
  if (!transition.alternatives.empty()) event.alternatives.end = recording_.alternatives.size();
  recording_.branch_points.push_back({recording_.event_list.size() - 1, transition.decision});
}

/// Regions that came or went, as changes of modes: 0 while active.
void Recorder::note_changed_regions(const ModeState& before, const ModeState& after) {
  const auto note = [&](int from, int to) {
    listed_before_.push_back(from);
    listed_after_.push_back(to);
  };
  for (const auto& range : kernel_.region_groups()) {
    int came = 0, went = 0, active = 0;
    for (int j = range.first; j < range.first + range.count; ++j) {
      const bool is_active = after.mode[at(j)] == 0;
      active += is_active ? 1 : 0;
      if ((before.mode[at(j)] == 0) == is_active) continue;
      (is_active ? came : went) += 1;
      columns_.push_back(surface_of_region(j));
    }
    if (came == 1 && went == 1 && active == 1) {
      note(-1, 1);  // replaced by another one
      continue;
    }
    if (came > 0) note(-1, 0);
    if (went > 0) note(0, -1);
  }
}

/// Surfaces that are slid on before and after, while a kink inside them begins or ends to be held with them.
void Recorder::note_held_kinks(const ModeState& before, const ModeState& after) {
  for (const std::size_t i : changed_) {
    if (!layout_.surfaces[i].is_kink || (before.mode[i] == 0) == (after.mode[i] == 0)) continue;
    for (std::size_t j = 0; j < before.mode.size(); ++j) {
      if (before.mode[j] != 0 || after.mode[j] != 0 ||
          !contains(kernel_.inner(static_cast<int>(j)), static_cast<int>(i)))
        continue;
      for (const std::size_t column : listed_columns_[j]) {
        if (!contains(columns_, column)) columns_.push_back(column);
      }
    }
  }
}

bool Recorder::switched(double t, const std::vector<double>& x, const ModeChange& change) {
  if (change.is_single()) {
    switched_single(t, x, change);
    return true;
  }
  const ModeState& before = *change.mode_before;
  const Transition& transition = *change.transition;
  const std::size_t number_before = number(before);
  const std::size_t number_after = number(transition.state);
  changed_.clear();
  if (number_after != number_before) recording_.modes.append_changed(changed_);
  listed_before_.clear();
  listed_after_.clear();
  columns_.clear();
  for (const std::size_t j : changed_) {
    for (const std::size_t column : listed_columns_[j]) {
      columns_.push_back(column);
      listed_before_.push_back(before.mode[j]);
      listed_after_.push_back(transition.state.mode[j]);
    }
  }
  note_changed_regions(before, transition.state);
  const bool switches = !columns_.empty();
  note_held_kinks(before, transition.state);
  if (columns_.empty()) return false;
  auto& event =
      begin(t, switches ? result::kind_of_switch(listed_before_, listed_after_) : result::EventKind::change_sliding);
  std::sort(columns_.begin(), columns_.end());
  for (const std::size_t column : columns_) add_surface(event, column);
  set_states(event, x, x);
  event.mode = number_before;
  if (!before.higher) before_switch_ = {events() - 1, number_before};  // rows have the selections that it leaves open
  add_transition(event, transition, number_after);
  return true;
}

void Recorder::switched_single(double t, const std::vector<double>& x, const ModeChange& change) {
  const auto j = at(change.surface);
  const auto& columns = listed_columns_[j];
  auto& event = begin(t, kind_of(change));
  for (const std::size_t column : columns) add_surface(event, column);
  set_states(event, x, x);
  if (const auto* slid = change.slid) {
    const auto k = at(slid->surface);
    event.mode = recording_.modes.append_change(k, 0, slid->alpha_before);
    event.mode_after =
        recording_.modes.append_changes({{{j, change.after, change.alpha_after}, {k, 0, slid->alpha_after}}});
    event.meeting = recording_.meetings.size();
    recording_.meetings.push_back(slid->meeting);
  } else {
    event.mode = recording_.modes.append_change(j, change.before, change.alpha_before);
    event.mode_after = recording_.modes.append_change(j, change.after, change.alpha_after);
  }
  before_switch_ = {events() - 1, event.mode};
  event.reason = reason_of(change);
}

/// Solutions come back to their switches: their words are written once.
Recording::Range Recorder::reason_of(const ModeChange& change) {
  auto& known = known_reasons_[(3 * at(change.surface) + at(change.after + 1)) % known_reasons_.size()];
  const bool same_reason = known.reason.data() == change.reason.data() && known.reason.size() == change.reason.size();
  const int slid = change.slid != nullptr ? change.slid->surface : -1;
  if (known.surface == change.surface && known.slid == slid && same_reason) return known.place;
  auto& text = recording_.text;
  known = {change.surface, slid, change.reason, {text.size(), text.size()}};
  if (change.slid != nullptr) {
    append_meeting(layout_, change.slid->meeting.surfaces, change.slid->leaf, change.reason, text);
  } else {
    text += layout_.surfaces[at(change.surface)].name;
    text += ": ";
    text += change.reason;
  }
  known.place.end = text.size();
  return known.place;
}

bool Recorder::started(double t, const std::vector<double>& x, const Transition& transition,
                       const std::vector<int>& surfaces) {
  columns_.clear();
  for (std::size_t c = 0; c < layout_.columns.size(); ++c) {
    const int function = layout_.columns[c].function;
    const bool at_zero = contains(surfaces, function);
    if (at_zero && layout_.surfaces[at(function)].role == model::SwitchingRole::listed) columns_.push_back(c);
  }
  for (const int j : surfaces) {
    if (layout_.surfaces[at(j)].role == model::SwitchingRole::region) columns_.push_back(surface_of_region(j));
  }
  std::sort(columns_.begin(), columns_.end());
  if (columns_.empty()) return false;
  auto& event = begin(t, result::EventKind::start);
  for (const std::size_t column : columns_) add_surface(event, column);
  set_states(event, x, x);
  add_transition(event, transition);
  return true;
}

void Recorder::user(double t, const Passage& passage, int event) {
  auto& entry = begin(t, result::EventKind::user, passage.before.activities, kernel_.activities());
  entry.entry = at(event);
  set_passage(entry, passage);
  const bool condition = layout_.events[at(event)].is_condition();
  add_reason(entry, condition ? "edge of a condition of [[events]]" : "zero of an expression of [[events]]");
  if (passage.x == passage.x_after) return;
  recording_.text += ", by a jump";
  entry.reason.end = recording_.text.size();
}

void Recorder::jumped(double t, std::span<const ExecutedJump> jumps, const ModeState* before,
                      const Transition& transition) {
  for (std::size_t k = 0; k < jumps.size(); ++k) {
    auto& entry = begin(t, result::EventKind::jump, jumps[k].activities, jumps[k].activities_after);
    recording_.impulses.insert(recording_.impulses.end(), jumps[k].impulses.begin(), jumps[k].impulses.end());
    entry.impulses.end = recording_.impulses.size();
    entry.entry = at(jumps[k].jump);
    entry.of_jumps = true;
    add_surface(entry, entry.entry);
    set_states(entry, jumps[k].x, jumps[k].x_after);
    const std::string& open = jumps[k].why_open.text;
    add_reason(entry, open.empty() ? why_executed(layout_.jumps[entry.entry]) : std::string_view(open));
    if (k == 0 && before != nullptr) entry.mode = number(*before);
    if (k + 1 == jumps.size()) add_transition(entry, transition);
    if (jumps[k].why_open.is_undecided) entry.unique = std::nullopt;
    if (!open.empty()) entry.unique = false;
  }
}

void Recorder::accumulated(double t, const std::vector<int>& jumps, const Passage& passage, std::string_view reason) {
  auto& entry = begin(t, result::EventKind::accumulation, passage.before.activities, kernel_.activities());
  entry.of_jumps = true;
  for (const int jump : jumps) add_surface(entry, at(jump));
  set_passage(entry, passage);
  add_reason(entry, reason);
}

Recording Recorder::hand_over() {
  auto& list = recording_.event_list;
  constexpr std::size_t remembered = 16;
  for (std::size_t k = 0; k < list.size(); ++k) {
    past_.event_times.push_back(list[k].t);
    if (list.size() - k > remembered) continue;
    const auto named = list[k].surfaces;
    auto& surfaces = past_.surfaces.emplace_back();
    for (std::size_t i = named.begin; i < named.end && !list[k].of_jumps; ++i)
      surfaces.push_back(recording_.surfaces[i]);
  }
  if (past_.surfaces.size() > remembered) {
    past_.surfaces.erase(past_.surfaces.begin(), past_.surfaces.end() - remembered);
  }
  if (!list.empty()) past_.unique = list.back().unique;
  past_.rows += recording_.row_times.size();
  if (!recording_.row_times.empty()) past_.last_row = recording_.row_times.back();
  before_switch_ = {};
  known_reasons_.fill({});
  Recording rest;
  rest.n_x = recording_.n_x;
  rest.n_u = recording_.n_u;
  rest.n_y = recording_.n_y;
  rest.n_c = recording_.n_c;
  rest.modes = recording_.modes;
  rest.modes.restart();
  return std::exchange(recording_, std::move(rest));
}

bool Recorder::switched_lately(int function, long events) const {
  const auto& list = recording_.event_list;
  const auto& columns = listed_columns_[at(function)];
  for (auto event = list.rbegin(); event != list.rend() && events > 0; ++event, --events) {
    if (event->of_jumps) continue;
    for (std::size_t k = event->surfaces.begin; k < event->surfaces.end; ++k) {
      if (contains(columns, recording_.surfaces[k])) return true;
    }
  }
  for (auto past = past_.surfaces.rbegin(); past != past_.surfaces.rend() && events > 0; ++past, --events) {
    if (std::find_first_of(past->begin(), past->end(), columns.begin(), columns.end()) != past->end()) return true;
  }
  return false;
}

void Recorder::spiralled(double t, const std::vector<int>& surfaces, const Passage& passage,
                         const Transition& transition, std::string_view why) {
  auto& entry = begin(t, result::EventKind::accumulation, passage.before.activities, kernel_.activities());
  for (std::size_t c = 0; c < layout_.columns.size(); ++c) {
    const int function = layout_.columns[c].function;
    const bool takes_part = contains(surfaces, function);
    if (takes_part && passage.before.mode[at(function)] != transition.state.mode[at(function)]) add_surface(entry, c);
  }
  columns_.clear();
  listed_before_.clear();
  listed_after_.clear();
  note_changed_regions(passage.before, transition.state);
  for (const std::size_t region : columns_) add_surface(entry, region);
  set_states(entry, passage.x, passage.x_after);
  entry.mode = number(passage.before);
  add_reason(entry, why);
  add_transition(entry, transition);
}

}  // namespace saltus::event_integrator
