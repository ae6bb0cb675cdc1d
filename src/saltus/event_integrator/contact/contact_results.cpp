#include "saltus/event_integrator/contact/contact_results.hpp"

#include <algorithm>
#include <string>
#include <tuple>
#include <utility>

#include "saltus/base/at.hpp"

namespace saltus::event_integrator {
namespace {

using result::EventKind;

class Shown {
 public:
  explicit Shown(const model::Layout& layout) : layout_(layout) {}

  [[nodiscard]] std::vector<result::ContactMode> modes(const std::vector<double>& x) const {
    std::vector<result::ContactMode> result;
    for (const auto& contact : layout_.contacts) {
      const bool closed = x[at(contact.closed)] != 0.0;
      const bool smooth = contact.friction_varies ? x[at(contact.smooth)] != 0.0 : !contact.has_friction;
      result.push_back(!closed                      ? result::ContactMode::open
                       : smooth                     ? result::ContactMode::closed
                       : x[at(contact.slip)] != 0.0 ? result::ContactMode::slip
                                                    : result::ContactMode::stick);
    }
    return result;
  }

  [[nodiscard]] std::vector<std::vector<double>> impulses(const std::vector<double>& before,
                                                          const std::vector<double>& x) const {
    std::vector<std::vector<double>> result;
    for (const auto& contact : layout_.contacts) {
      result.emplace_back();
      for (int k = contact.impulse; k <= contact.impulse + contact.tangents(); ++k) {
        result.back().push_back(x[at(k)] - before[at(k)]);
      }
    }
    return result;
  }

  void cut(std::vector<double>& x) const {
    if (x.size() > at(layout_.shown_states)) x.resize(at(layout_.shown_states));
  }

  [[nodiscard]] std::size_t states() const { return at(layout_.shown_states); }

  [[nodiscard]] bool owns(const std::string& name) const {
    return std::any_of(layout_.contacts.begin(), layout_.contacts.end(),
                       [&](const auto& contact) { return contact.name == name; });
  }

  /// Whether a slip goes on in the other direction.
  [[nodiscard]] static bool turns(const model::Contact& contact, const std::vector<double>& x,
                                  const std::vector<double>& after) {
    return contact.has_friction && !contact.in_plane && x[at(contact.slip)] != 0.0 && after[at(contact.slip)] != 0.0 &&
           x[at(contact.share)] * after[at(contact.share)] < 0.0;
  }

  /// An event of contacts, from the modes on both sides and the impulses; false if there is nothing to tell.
  bool tell(result::Event& event) const {
    const auto before = modes(event.x), after = modes(event.x_after);
    auto impulse = impulses(event.x, event.x_after);
    event.surfaces.clear();
    event.name.reset();
    bool hit = false, closes = false, opens = false, sticks = false;
    for (std::size_t i = 0; i < before.size(); ++i) {
      const bool pushed =
          std::any_of(impulse[i].begin(), impulse[i].end(), [](double component) { return component != 0.0; });
      if (before[i] == after[i] && !pushed && !turns(layout_.contacts[i], event.x, event.x_after)) continue;
      event.surfaces.push_back(layout_.contacts[i].name);
      hit = hit || pushed;
      closes = closes || before[i] == result::ContactMode::open;
      opens = opens || after[i] == result::ContactMode::open;
      sticks = sticks || after[i] == result::ContactMode::stick;
    }
    if (event.surfaces.empty()) return false;
    const std::string open = event.unique == false ? "; " + event.reason : "";
    event.kind = hit      ? EventKind::impact
                 : closes ? EventKind::contact
                 : opens  ? EventKind::lift_off
                 : sticks ? EventKind::stick
                          : EventKind::slip;
    event.reason = hit      ? "bodies collide: the impulses end their approach"
                   : closes ? "bodies touch without approaching"
                   : opens  ? "the normal force ends"
                   : sticks ? "friction holds what has come to rest"
                            : "the tangential force reaches the edge of the friction cone, or the slip turns around";
    event.reason += open;
    if (hit) event.impulse = std::move(impulse);
    return true;
  }

 private:
  const model::Layout& layout_;
};

}  // namespace

void show_contacts(const model::Layout& layout, result::Trajectory& trajectory) {
  const Shown shown(layout);
  for (const auto& x : trajectory.x) trajectory.contact_modes.push_back(shown.modes(x));
  trajectory.x.narrow(shown.states());
}

void show_contacts(const model::Layout& layout, result::Final& final, result::Events& events,
                   result::Trajectory& trajectory) {
  const Shown shown(layout);
  result::Events told;
  for (result::Event event : events) {
    const bool of_contact = event.kind == EventKind::jump && event.name && shown.owns(*event.name);
    const bool empty = of_contact && !shown.tell(event);
    if (empty && !told.empty() && told.t(told.size() - 1) == event.t && event.mode_after) {
      // Several contacts may end at once; the first of their jumps has changed all.
      result::Event first = told.back();
      told.pop_back();
      std::tie(first.mode_after, first.alpha_after) = std::tie(event.mode_after, event.alpha_after);
      if (event.unique == false) first.unique = false;
      told.push_back(std::move(first));
    }
    if (empty) continue;
    event.contact_modes_before = shown.modes(event.x);
    event.contact_modes_after = shown.modes(event.x_after);
    shown.cut(event.x);
    shown.cut(event.x_after);
    told.push_back(std::move(event));
  }
  events = std::move(told);
  show_contacts(layout, trajectory);
  final.contact_modes = shown.modes(final.x);
  shown.cut(final.x);
}

}  // namespace saltus::event_integrator
