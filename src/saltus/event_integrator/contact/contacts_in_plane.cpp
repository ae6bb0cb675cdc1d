// Slips in a plane: between which speeds they are followed, how they begin and go on.
#include <algorithm>
#include <cmath>

#include "saltus/base/at.hpp"
#include "saltus/base/contains.hpp"
#include "saltus/event_integrator/contact/contacts.hpp"
#include "saltus/event_integrator/mode/small_internal.hpp"

namespace saltus::event_integrator {

using linalg::Vector;

double Contacts::fastest(const ContactMoment& moment, const ContactPoint& point, const std::vector<double>& x) const {
  double speed = moment.time_scale * point.acceleration.max_abs();
  for (const int velocity : layout_.velocities) speed = std::max(speed, std::abs(x[at(velocity)]));
  return speed;
}

/// Below this speed a slip in a plane has no direction: within the tolerances it may as well be at rest.
double Contacts::slowest(const ContactMoment& moment, const ContactPoint& point, const std::vector<double>& x) const {
  const double speed = fastest(moment, point, x);
  constexpr double part = 0.01, rounded = 1e-13, least = 1e-40;
  const double in_time = 256.0 * rounding_unit * std::abs(moment.t) * point.terms;
  return std::max({moment.tolerances.atol + part * moment.tolerances.rtol * speed, rounded * speed, in_time, least});
}

/// Whether what ends at a point is not a slip in a plane, but the range of speeds in which it is followed.
bool Contacts::reaches_a_speed(const ContactMoment& moment, int contact, const ContactPoint& point,
                               const std::vector<double>& x) const {
  if (mode_of(contact) != ContactMode::slip) return false;
  const double speed = point.along(point.velocity, contact).norm();
  const auto& [least, largest] = activity(contact).speeds;
  const bool at_bound = speed <= ends_below * std::sqrt(least) || ends_below * speed >= std::sqrt(largest);
  if (!at_bound || speed <= none_below * slowest(moment, point, x)) return false;
  const auto [modes, closed] = modes_here();
  ContactForces forces;
  constexpr double holds = 1e-9;
  return forces_in(point, closed, modes, forces) && forces.margin > holds;
}

/// Of slips in a plane. Where the velocity vanishes the force has no direction, and two functions would have to be 0 at
/// once: so steps end at ever smaller speeds, down to one that is none.
void Contacts::bound_speeds(const ContactMoment& moment, const std::vector<double>& x) {
  if (std::none_of(contacts_.begin(), contacts_.end(), [&](const auto& contact) { return contact.in_plane; })) return;
  const ContactPoint point = point_at(moment.t, moment.alpha, x);
  constexpr double apart = 10.0;
  for (int i = 0; i < point.contacts(); ++i) {
    if (!contacts_[at(i)].in_plane) continue;
    const double speed = point.along(point.velocity, i).norm();
    const double least = std::max(speed / apart, slowest(moment, point, x)), largest = apart * speed;
    change_activity(i, [&](auto& activity) {
      const bool slips = activity.state == model::Activity::State::slip;
      activity.speeds = {slips ? least * least : 1.0, slips ? largest * largest : 1.0};
    });
  }
}

/// The direction settles within |v| over the push of friction, which limits explicit steps. Where a growing force
/// breaks a contact away the speed grows like t^2: each time it doubles takes as many of them as 1/t. The last step may
/// be as short as that limit already.
bool Contacts::turns_fast(const ContactMoment& moment, const std::vector<double>& x) {
  const auto [modes, closed] = modes_here();
  if (!contains(modes, ContactMode::slip)) return false;
  const ContactPoint point = point_at(moment.t, moment.alpha, x);
  ContactForces forces;
  if (!forces_in(point, closed, modes, forces)) return false;
  constexpr double steps = 30.0, limit = 1.0;
  return std::any_of(closed.begin(), closed.end(), [&](int i) {
    if (modes[at(i)] != ContactMode::slip) return false;
    const Vector velocity = point.along(point.velocity, i);
    const int first = point.tangent_row(i, 0), second = point.tangent_row(i, 1);
    const double push =
        point.friction[at(i)] * forces.z(i) * std::max(point.influence(first, first), point.influence(second, second));
    const double growth = std::abs(point.along(forces.y, i).dot(velocity)) / velocity.norm();
    return push > steps * growth && push * moment.time_scale > limit * velocity.norm();
  });
}

/// The velocity of a slip may be the difference of larger ones, as on a belt, and errors of a step are relative to
/// these: a step whose errors are as large as the slip runs through its end unseen.
ode::Tolerances Contacts::bearable(const ContactMoment& moment, const std::vector<double>& x) {
  constexpr double part_of_slip = 0.1;
  ode::Tolerances parts{1.0, 1.0};
  const auto modes = modes_here().modes;
  if (!contains(modes, ContactMode::slip)) return parts;
  const ContactPoint point = point_at(moment.t, moment.alpha, x);
  for (int i = 0; i < point.contacts(); ++i) {
    if (modes[at(i)] != ContactMode::slip) continue;
    const double wanted = std::sqrt(activity(i).speeds[0]);
    for (int k = 0; k < 2; ++k) {
      const int row = point.tangent_row(i, k);
      const double terms = terms_of(values_.rows, row, layout_.velocities, x), slope = values_.rows.row(row).sum_abs();
      parts.rtol = std::min(parts.rtol, part_of_slip * wanted / (moment.tolerances.rtol * terms));
      parts.atol = std::min(parts.atol, part_of_slip * wanted / (moment.tolerances.atol * slope));
    }
  }
  return parts;
}

/// Gives it a slip of this velocity, its gap as it is.
void Contacts::set_slip(const ContactPoint& point, int contact, const Vector& velocity, std::vector<double>& x) {
  std::vector<int> rows{point.tangent_row(contact, 0), point.tangent_row(contact, 1)};
  Vector change = velocity;
  if (activity(contact).carries) {
    rows.push_back(contact);
    change.resize_and_keep(3);
    change(2) = 0.0;
  }
  change_velocities(rows, change - values_.velocity.selected_rows(rows), x);
}

/// At rest the force of a slip has no direction: it begins with a speed that is none, but one whose direction is known
/// to more than its rounding. The rounding is that of velocities over the speed: what is enough is between both.
void Contacts::start_slip(const ContactMoment& moment, int contact, const Vector& direction, std::vector<double>& x) {
  constexpr double clear = 4.0;
  constexpr int most_speeds = 20;
  ContactPoint point = point_at(moment.t, moment.alpha, x);
  double speed = clear * slowest(moment, point, x);
  for (int tried = 0; tried < most_speeds; ++tried) {
    set_slip(point, contact, speed * direction, x);
    change_activity(contact, [](auto& activity) { activity.state = model::Activity::State::slip; });
    point = point_at(moment.t, moment.alpha, x);
    const double needed = clear * slowest(moment, point, x);
    if (needed <= 2.0 * speed) break;
    speed = std::sqrt(speed * needed);
  }
}

bool Contacts::slip_goes_on(const Activities& before, Activities after) const {
  if (before == after) return false;
  for (std::size_t i = 0; i < after.size(); ++i) after[i].speeds = before[i].speeds;
  return before == after;
}

}  // namespace saltus::event_integrator
