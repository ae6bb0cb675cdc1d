// Which modes of contacts end, and what cannot follow them.
#include <algorithm>
#include <cmath>

#include "saltus/base/at.hpp"
#include "saltus/event_integrator/contact/contacts.hpp"
#include "saltus/event_integrator/mode/small_internal.hpp"

namespace saltus::event_integrator {

/// By contact. Where others keep a gap closed, too, its force may end and the contact go on without it. Where forces
/// are not unique a mode ends only if none of them hold it: else what has come to an edge is how they are shared.
std::vector<std::vector<ContactMode>> Contacts::modes_that_end(const ContactMoment& moment, const ContactPoint& point,
                                                               const std::vector<int>& ended,
                                                               const std::vector<double>& x) const {
  std::vector<std::vector<ContactMode>> result(contacts_.size());
  const auto [modes, closed] = modes_here();
  const auto is_at_rest = [&](int i) { return contains(closed, i) && !slips(modes[at(i)]); };
  if (std::all_of(ended.begin(), ended.end(), is_at_rest)) {
    constexpr double clear = 1e-6;
    ContactForces others;
    if (forces_in(point, closed, modes, others) && others.is_open && others.margin > clear) return result;
  }
  const auto is_shared = [&](int contact) {
    linalg::RowBasis others = no_rows();
    for (int i = 0; i < point.contacts(); ++i) {
      if (i != contact && mode_of(i) != ContactMode::open) others.takes(values_.rows.row(i));
    }
    return others.spans(values_.rows.row(contact));
  };
  for (int i = 0; i < point.contacts(); ++i) {
    const auto mode = mode_of(i);
    const bool slowly = mode == ContactMode::slip && point.along(point.velocity, i).is_zero(),
               ends = contains(ended, i);
    if (ends && !slowly && !is_shared(i) && !reaches_a_speed(moment, i, point, x)) result[at(i)].push_back(mode);
    if (const auto back = way_back(moment, i, ends, x)) result[at(i)].push_back(*back);
  }
  return result;
}

/// The slip along the friction of a contact that sticks at the edge of its cone, or has just reached it.
std::optional<ContactMode> Contacts::way_back(const ContactMoment& moment, int contact, bool ends,
                                              const std::vector<double>& x) const {
  const auto& entry = contacts_[at(contact)];
  if (mode_of(contact) != ContactMode::stick || entry.in_plane) return std::nullopt;
  const double share = activity(contact).share[0];
  double friction = std::abs(share) == 1.0 ? -share : 0.0;
  if (ends && activity(contact).holds[0]) {
    std::vector<double> values(contact_of_guard_.size());
    kernel_.functions(moment.t, x.data(), moment.alpha.data(), values.data());
    // They are negative inside of the cone.
    const int first = entry.has_gap ? 1 : 0;
    const double below = -values[at(kernel_.jump_guard(entry.jump, first))],
                 above = -values[at(kernel_.jump_guard(entry.jump, first + 1))];
    constexpr double at_edge = 1e-6;
    if (std::min(below, above) <= at_edge * std::max(below, above)) friction = above - below;
  }
  if (friction == 0.0) return std::nullopt;
  return friction > 0.0 ? ContactMode::slip_up : ContactMode::slip_down;
}

}  // namespace saltus::event_integrator
