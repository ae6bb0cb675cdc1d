#include "saltus/event_integrator/contact/contact_results.hpp"

#include <algorithm>
#include <cstdlib>
#include <string>
#include <tuple>
#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/base/contains.hpp"

namespace saltus::event_integrator {
namespace {

using result::EventKind;

/// Normal, then along tangents.
std::vector<std::vector<double>> by_contact(const model::Layout& layout, std::span<const double> impulses) {
  const std::size_t m = layout.contacts.size();
  std::vector<std::vector<double>> found;
  for (std::size_t i = 0; i < m; ++i) {
    auto& own = found.emplace_back();
    for (std::size_t k = 0; k <= at(layout.contacts[i].tangents()); ++k) {
      own.push_back(k * m + i < impulses.size() ? impulses[k * m + i] : 0.0);
    }
  }
  return found;
}

/// From the modes of the contacts that it is about.
void name_event(const model::Layout& layout, result::Event& event) {
  bool closes = false, opens = false, sticks = false;
  for (std::size_t i = 0; i < layout.contacts.size(); ++i) {
    if (!contains(event.surfaces, layout.contacts[i].name)) continue;
    closes = closes || event.contact_modes_before[i] == result::ContactMode::open;
    opens = opens || event.contact_modes_after[i] == result::ContactMode::open;
    sticks = sticks || event.contact_modes_after[i] == result::ContactMode::stick;
  }
  const std::string open = event.unique == false ? "; " + event.reason : "";
  const auto name = [&](EventKind kind, const char* reason) {
    event.kind = kind;
    event.reason = reason + open;
  };
  if (event.impulse) return name(EventKind::impact, "bodies collide: the impulses end their approach");
  if (closes) return name(EventKind::contact, "bodies touch without approaching");
  if (opens) return name(EventKind::lift_off, "the normal force ends");
  if (sticks) return name(EventKind::stick, "friction holds what has come to rest");
  name(EventKind::slip, "the tangential force reaches the edge of the friction cone, or the slip turns around");
}

}  // namespace

std::vector<result::ContactMode> contact_modes(std::span<const int> states) {
  using State = model::Activity::State;
  constexpr auto is_same = [](State a, result::ContactMode b) { return static_cast<int>(a) == static_cast<int>(b); };
  static_assert(is_same(State::open, result::ContactMode::open) && is_same(State::closed, result::ContactMode::closed));
  static_assert(is_same(State::stick, result::ContactMode::stick) && is_same(State::slip, result::ContactMode::slip));
  std::vector<result::ContactMode> modes;
  for (const int state : states) modes.push_back(static_cast<result::ContactMode>(std::abs(state)));
  return modes;
}

bool tell_contacts(const model::Layout& layout, std::span<const int> before, std::span<const int> after,
                   std::span<const double> impulses, result::Event& event) {
  event.contact_modes_before = contact_modes(before);
  event.contact_modes_after = contact_modes(after);
  const auto is_own = [&](const auto& contact) { return contact.name == event.name; };
  const auto& contacts = layout.contacts;
  if (event.kind != EventKind::jump || std::none_of(contacts.begin(), contacts.end(), is_own)) return true;
  const auto impulse = by_contact(layout, impulses);
  event.surfaces.clear();
  event.name.reset();
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const bool pushed = std::any_of(impulse[i].begin(), impulse[i].end(), [](double part) { return part != 0.0; });
    if (pushed) event.impulse = impulse;
    if (pushed || before[i] != after[i]) event.surfaces.push_back(contacts[i].name);
  }
  if (!event.surfaces.empty()) name_event(layout, event);
  return !event.surfaces.empty();
}

void take_into_previous(result::Events& events) {
  const result::Event empty = events.back();
  events.pop_back();
  if (events.empty() || events.t(events.size() - 1) != empty.t || !empty.mode_after) return;
  result::Event first = events.back();
  events.pop_back();
  std::tie(first.mode_after, first.alpha_after) = std::tie(empty.mode_after, empty.alpha_after);
  if (empty.unique == false) first.unique = false;
  events.push_back(std::move(first));
}

void write_impulses(const model::Layout& layout, const result::Events& events, result::Trajectory& trajectory) {
  for (std::size_t k = 0; k < events.size(); ++k) {
    if (events.kind(k) != EventKind::impact) continue;
    const auto behind = std::upper_bound(trajectory.t.begin(), trajectory.t.end(), events.t(k)) - trajectory.t.begin();
    if (behind == 0 || trajectory.t[at(behind - 1)] != events.t(k)) continue;
    const auto row = trajectory.outputs.change(at(behind - 1));
    const auto impulse = *events[k].impulse;
    for (std::size_t i = 0; i < layout.contacts.size(); ++i) {
      const auto& names = layout.output_names;
      const auto place = std::find(names.begin(), names.end(), "impulse(" + layout.contacts[i].name + ")");
      if (place != names.end()) row[at(place - names.begin())] += impulse[i][0];
    }
  }
}

}  // namespace saltus::event_integrator
