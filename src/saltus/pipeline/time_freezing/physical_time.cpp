#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/base/contains.hpp"
#include "saltus/base/rounding_unit.hpp"
#include "saltus/model/layout.hpp"
#include "saltus/model/time_freezing/time_freezing.hpp"
#include "saltus/pipeline/time_freezing/physical_time_internal.hpp"

namespace saltus::pipeline {
namespace {

using model::FrozenContact;
using model::FrozenSelection;
using result::ContactMode;
using result::Event;
using result::EventKind;
using result::Mode;

/// Relative to the fastest one of the run: velocities that differ less are the same at an impact without known
/// impulses.
constexpr double same_velocity = 1e-7;

class PhysicalTime {
 public:
  PhysicalTime(const model::Layout& layout, const model::TimeFreezing& freezing, double standing, result::Result& run)
      : layout_(layout), freezing_(freezing), run_(run), clock_(at(freezing_.clock)), standing_(standing) {
    std::set<int> added;
    std::set<std::string> frozen;
    for (const auto& hysteresis : freezing_.hysteresis) frozen.insert(hysteresis.name);
    for (const auto& contact : freezing_.contacts) {
      for (const auto& one : {contact.gap, contact.normal, contact.tangent}) added.insert(one.function);
      frozen.insert(contact.name);
    }
    for (const auto& group : layout.groups) {
      shows_regions_ = shows_regions_ && group.name.find('.') == std::string::npos;
    }
    for (std::size_t c = 0; c < layout.columns.size(); ++c) {
      const auto& column = layout.columns[c];
      const auto& function = layout.surfaces[at(column.function)];
      // Names of what freezing adds begin with the name of what is frozen and a point: "ground.gap"; "18.5-x" does not.
      const auto point = function.name.find('.');
      const bool is_hidden =
          point != std::string::npos && frozen.contains(function.name.substr(0, point)) && !function.named;
      if (!(is_hidden || (added.contains(column.function) && !function.named))) kept_.push_back(c);
    }
  }

  std::vector<std::string> run() {
    auto raw = std::exchange(run_.trajectory, {});
    auto events = std::exchange(run_.events, {});
    for (const auto& x : raw.x) {
      for (const int v : freezing_.velocities) fastest_ = std::max(fastest_, std::abs(x[at(v)]));
    }
    last_clock_ = raw.x.back()[clock_];
    const auto stops = instants(events, raw);
    auto stop = stops.begin();
    // Rows whose clock is that of the next instant, or has passed it.
    const auto is_at_stop = [&](double clock) {
      return stop != stops.end() && (clock >= stop->t || same_time(clock, stop->t));
    };
    for (std::size_t r = 0; r < raw.t.size();) {
      const bool stands = is_at_stop(clock_at(raw.x[r]));
      double t = stands ? stop->t : clock_at(raw.x[r]);
      const auto goes_on = [&](double clock) {
        return stands ? clock <= t || same_time(t, clock) : same_time(t, clock) && !is_at_stop(clock);
      };
      std::size_t last = r;
      while (last + 1 < raw.t.size() && goes_on(clock_at(raw.x[last + 1]))) ++last;
      // Where an impact begins the run its error may take the clock back.
      if (!run_.trajectory.t.empty()) t = std::max(t, run_.trajectory.t.back());
      const std::size_t before = run_.events.size();
      if (stands) take_events((stop++)->events, t);
      const bool is_event = run_.events.size() > before;
      if (last > r && (is_event || std::vector<double>(raw.u[r]) != std::vector<double>(raw.u[last])))
        add_row(raw, r, t);
      const auto impulse = is_event ? run_.events[before].impulse : std::nullopt;
      add_row(raw, last, t, impulse.value_or(std::vector<std::vector<double>>()));
      r = last + 1;
    }
    take_final();
    std::vector<std::string> names;
    for (const std::size_t c : kept_) names.push_back(layout_.columns[c].name);
    return names;
  }

 private:
  [[nodiscard]] bool same_time(double a, double b) const {
    return std::abs(a - b) <= std::max(standing_, 8.0 * rounding_unit * std::max(1.0, std::abs(a)));
  }

  /// Of the last row.
  void take_final() {
    auto& rows = run_.trajectory;
    auto& final = run_.final;
    final = {rows.t.back(), rows.x.back(), rows.mode.back(), rows.alpha.back(), rows.outputs.back()};
    if (!rows.contact_modes.empty()) final.contact_modes = rows.contact_modes.back();
    if (!rows.regions.empty()) {
      final.regions = rows.regions.back();
      final.theta = rows.theta.back();
    }
  }

  /// An error at the end may take the clock back, too.
  template <class State>
  [[nodiscard]] double clock_at(const State& x) const {
    return std::min<double>(x[clock_], last_clock_);
  }

  /// Holds the events at one reading of the clock.
  struct Instant {
    double t = 0.0;
    std::vector<Event> events;
  };

  /// By the clocks of the events alone: rows must make no difference to them.
  [[nodiscard]] std::vector<Instant> instants(const result::Events& events, const result::Trajectory& raw) const {
    std::vector<Instant> list;
    const auto is_here = [&](double clock) { return clock <= list.back().t || same_time(clock, list.back().t); };
    for (const Event& event : events) {
      const double clock = clock_at(event.x);
      if (list.empty() || !is_here(clock)) list.push_back({std::max(clock, clock_at(raw.x.front())), {}});
      list.back().events.push_back(event);
    }
    // Where a run ends in a collision no event is behind it.
    if (!list.empty() && is_here(last_clock_)) list.back().events.back().x_after = raw.x.back();
    return list;
  }

  /// Of a simulation, not of an optimum.
  [[nodiscard]] bool has_impulses() const {
    return !freezing_.contacts.empty() && freezing_.contacts.front().impulse >= 0;
  }

  /// Whether velocities differ.
  [[nodiscard]] bool jumps(const std::vector<double>& x, const std::vector<double>& x_after) const {
    double change = 0.0;
    for (const int v : freezing_.velocities) change = std::max(change, std::abs(x_after[at(v)] - x[at(v)]));
    return change > same_velocity * fastest_;
  }

  template <class Values>
  [[nodiscard]] Values kept(const Values& all) const {
    Values result;
    for (const std::size_t c : kept_) result.push_back(all[c]);
    return result;
  }

  /// The row behind an impact has its impulses.
  void add_row(const result::Trajectory& raw, std::size_t r, double t,
               const std::vector<std::vector<double>>& impulse = {}) {
    auto& rows = run_.trajectory;
    rows.t.push_back(t);
    rows.x.push_back(shown_states(freezing_, raw.x[r]));
    rows.u.push_back(raw.u[r]);
    rows.alpha.push_back(kept(std::vector<double>(raw.alpha[r])));
    rows.mode.push_back(kept(Mode(raw.mode[r])));
    auto values = outputs(raw.outputs[r]);
    for (std::size_t i = 0; i < impulse.size(); ++i) {
      const auto& contact = freezing_.contacts[i];
      values[at(contact.gap_output) + 2 + at(contact.tangents)] = impulse[i].front();
    }
    rows.outputs.push_back(std::move(values));
    if (!freezing_.contacts.empty()) rows.contact_modes.push_back(contact_modes(raw.mode[r]));
    if (!shows_regions_) return;
    if (!raw.regions.empty()) rows.regions.push_back(raw.regions[r]);
    if (!raw.theta.empty()) rows.theta.push_back(raw.theta[r]);
  }

  /// Forces of numerical time become forces; where time stands still, to the rounding of its rate in free motion (1),
  /// there are impulses instead.
  [[nodiscard]] std::vector<double> outputs(std::vector<double> values) const {
    const double rate = values[at(freezing_.clock_rate)];
    for (const auto& contact : freezing_.contacts) {
      const std::size_t force = at(contact.gap_output) + 1;
      for (std::size_t k = force; k <= force + at(contact.tangents); ++k) {
        values[k] = rate > 8.0 * rounding_unit ? values[k] / rate : 0.0;
      }
    }
    values.pop_back();
    return values;
  }

  /// `otherwise` is that of a selection without a column.
  [[nodiscard]] int mode_of(const FrozenSelection& selection, const Mode& mode, int otherwise) const {
    for (std::size_t c = 0; c < layout_.columns.size(); ++c) {
      const auto& column = layout_.columns[c];
      if (column.function == selection.function) {
        return selection.orientation * column.orientation * mode[c];
      }
    }
    return otherwise;
  }

  [[nodiscard]] std::vector<ContactMode> contact_modes(const Mode& mode) const {
    std::vector<ContactMode> modes;
    for (const auto& contact : freezing_.contacts) {
      // A gap that stays 0 keeps its rate at 0, whatever side the rate's own selection takes.
      const bool opens = mode_of(contact.normal, mode, -1) > 0;
      const bool closed = !opens && mode_of(contact.gap, mode, 1) <= 0;
      const bool sticks = mode_of(contact.tangent, mode, 1) == 0;
      modes.push_back(!closed                        ? ContactMode::open
                      : contact.tangent.function < 0 ? ContactMode::closed
                      : sticks                       ? ContactMode::stick
                                                     : ContactMode::slip);
    }
    return modes;
  }

  /// States, modes and selections of the user's alone.
  void keep_columns(Event& event) const {
    for (auto* mode : {&event.mode_before, &event.mode_after}) {
      if (*mode) *mode = kept(**mode);
    }
    for (auto* alpha : {&event.alpha_before, &event.alpha_after}) {
      if (*alpha) *alpha = kept(**alpha);
    }
    event.x = shown_states(freezing_, event.x);
    event.x_after = shown_states(freezing_, event.x_after);
  }

  /// All events of numerical time at one physical time.
  void take_events(const std::vector<Event>& here, double t) {
    Event event = here.front();
    event.t = t;
    event.mode_after = here.back().mode_after;
    event.alpha_after = here.back().alpha_after;
    event.regions_after = here.back().regions_after;
    event.x_after = here.back().x_after;
    event.surfaces.clear();
    event.name.reset();
    if (!shows_regions_) {
      event.regions_before.reset();
      event.regions_after.reset();
    }
    const bool has_modes = event.mode_before && event.mode_after && !freezing_.contacts.empty();
    if (has_modes) {
      event.contact_modes_before = contact_modes(*event.mode_before);
      event.contact_modes_after = contact_modes(*event.mode_after);
    }
    const bool decided = take_hysteresis(event) || take_impact(event) || (has_modes && take_contacts(event));
    if (!decided) take_surfaces(here, event);
    keep_columns(event);
    if (decided) {
      event.unique = true;
      event.alternatives.clear();
      event.reason = "time stood still";
    }
    if (decided || !event.surfaces.empty()) run_.events.push_back(event);
    for (const auto& one : here) {
      if (one.kind != EventKind::user) continue;
      Event user = one;
      user.t = t;
      keep_columns(user);
      run_.events.push_back(std::move(user));
    }
  }

  [[nodiscard]] bool take_hysteresis(Event& event) const {
    for (const auto& entry : freezing_.hysteresis) {
      if (std::round(event.x[at(entry.state)]) != std::round(event.x_after[at(entry.state)])) {
        event.surfaces.push_back(entry.name);
      }
    }
    if (event.surfaces.empty()) return false;
    event.kind = EventKind::jump;
    event.name = event.surfaces.front();
    return true;
  }

  [[nodiscard]] bool take_impact(Event& event) const {
    std::vector<std::vector<double>> impulse;
    if (!has_impulses()) return take_jump_of_velocities(event);
    for (const auto& contact : freezing_.contacts) {
      const std::size_t state = at(contact.impulse);
      impulse.emplace_back();
      for (std::size_t k = state; k <= state + std::max(1U, static_cast<unsigned>(contact.tangents)); ++k) {
        impulse.back().push_back(event.x_after[k] - event.x[k]);
      }
      if (impulse.back()[0] > 0.0) event.surfaces.push_back(contact.name);
    }
    if (event.surfaces.empty()) return false;
    event.kind = EventKind::impact;
    event.impulse = std::move(impulse);
    return true;
  }

  [[nodiscard]] bool take_jump_of_velocities(Event& event) const {
    if (!jumps(event.x, event.x_after)) return false;
    for (std::size_t i = 0; i < freezing_.contacts.size(); ++i) {
      const bool closed = freezing_.contacts.size() == 1 || event.contact_modes_after.empty() ||
                          event.contact_modes_after[i] != ContactMode::open || freezing_.contacts[i].is_elastic;
      if (closed) event.surfaces.push_back(freezing_.contacts[i].name);
    }
    event.kind = EventKind::impact;
    return true;
  }

  /// Whether a slip goes on in the other direction.
  [[nodiscard]] bool turns(const FrozenContact& contact, ContactMode mode, const Event& event) const {
    return mode == ContactMode::slip && contact.tangents == 1 &&
           mode_of(contact.tangent, *event.mode_before, 1) * mode_of(contact.tangent, *event.mode_after, 1) < 0;
  }

  /// Without an impulse: what opens, touches, sticks or slips.
  [[nodiscard]] bool take_contacts(Event& event) const {
    const auto &before = event.contact_modes_before, &after = event.contact_modes_after;
    for (std::size_t i = 0; i < before.size(); ++i) {
      if (before[i] == after[i] && !turns(freezing_.contacts[i], before[i], event)) continue;
      if (event.surfaces.empty()) {
        event.kind = after[i] == ContactMode::open    ? EventKind::lift_off
                     : before[i] == ContactMode::open ? EventKind::contact
                     : after[i] == ContactMode::stick ? EventKind::stick
                                                      : EventKind::slip;
      }
      event.surfaces.push_back(freezing_.contacts[i].name);
    }
    return !event.surfaces.empty();
  }

  /// Switching functions of the user alone.
  void take_surfaces(const std::vector<Event>& here, Event& event) const {
    const auto& last = here.back();
    std::vector<std::string> names;
    for (const std::size_t c : kept_) names.push_back(layout_.columns[c].name);
    for (const auto& one : here) {
      if (one.kind == EventKind::user) continue;
      for (const auto& surface : one.surfaces) {
        const bool is_kept = contains(names, surface);
        const bool is_new = !contains(event.surfaces, surface);
        if (!is_kept || !is_new) continue;
        event.surfaces.push_back(surface);
        event.kind = one.kind;
      }
    }
    take_kind(event);
    take_alternatives(here, event);
    event.reason = last.reason;
  }

  /// What hidden selections begin or end to slide on says nothing of the user's.
  void take_kind(Event& event) const {
    Mode before, after;
    for (const std::size_t c : kept_) {
      if (!event.mode_before || !event.mode_after || !contains(event.surfaces, layout_.columns[c].name)) continue;
      before.push_back((*event.mode_before)[c]);
      after.push_back((*event.mode_after)[c]);
    }
    if (before != after) event.kind = result::kind_of_switch(before, after);
  }

  /// What could follow instead, as far as it can be seen: selections of a contact that persists are not unique, the
  /// motion is.
  void take_alternatives(const std::vector<Event>& here, Event& event) const {
    event.alternatives.clear();
    event.unique = true;
    for (const auto& one : here) {
      if (one.kind == EventKind::user) continue;
      bool is_seen = one.alternatives.empty();
      for (const auto& other : one.alternatives) {
        if (is_taken(other, one)) continue;
        is_seen = true;
        result::Alternative shown{kept(other.mode), kept(other.alpha), {}};
        if (shows_regions_) shown.regions = other.regions;
        const auto is_known = [&](const auto& known) {
          return known.mode == shown.mode && known.regions == shown.regions;
        };
        if (std::none_of(event.alternatives.begin(), event.alternatives.end(), is_known))
          event.alternatives.push_back(std::move(shown));
      }
      if (is_seen && one.unique != true && event.unique != false) event.unique = one.unique;
    }
  }

  /// Whether an alternative is what goes on, but for selections that are hidden.
  [[nodiscard]] bool is_taken(const result::Alternative& other, const Event& event) const {
    const bool same_regions = !shows_regions_ || !event.regions_after || other.regions == *event.regions_after;
    return same_regions && event.mode_after && kept(other.mode) == kept(*event.mode_after) &&
           contact_modes(other.mode) == contact_modes(*event.mode_after);
  }

  const model::Layout& layout_;
  const model::TimeFreezing& freezing_;
  result::Result& run_;
  std::size_t clock_ = 0;
  double standing_ = 0.0, fastest_ = 0.0, last_clock_ = 0.0;
  bool shows_regions_ = true;      ///< they are the user's
  std::vector<std::size_t> kept_;  ///< columns
};

}  // namespace

std::vector<double> shown_states(const model::TimeFreezing& freezing, const std::vector<double>& x) {
  std::vector<double> shown(x.begin(), x.begin() + freezing.first_hidden);
  for (const auto& entry : freezing.hysteresis)
    shown[at(entry.state)] = std::round(shown[at(entry.state)]) + 0.0;  // no -0
  return shown;
}

std::vector<std::string> to_physical_time(const model::Layout& layout, const model::TimeFreezing& freezing,
                                          double standing, result::Result& run) {
  return PhysicalTime(layout, freezing, standing, run).run();
}

}  // namespace saltus::pipeline
