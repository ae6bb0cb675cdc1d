// Which gaps and rates of contacts are none.
#include <algorithm>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "saltus/base/at.hpp"
#include "saltus/base/rounding_unit.hpp"
#include "saltus/event_integrator/contact/contacts.hpp"

namespace saltus::event_integrator {

/// Those of what touches whose gaps have no gradient, and so no normal, here, against where the motion goes on to.
std::vector<int> Contacts::without_normal(const ContactMoment& moment, const std::vector<int>& touching,
                                          const std::vector<double>& x) const {
  constexpr double none = 1e-3;
  auto ahead = x;
  for (std::size_t k = 0; k < layout_.positions.size(); ++k) {
    ahead[at(layout_.positions[k])] += ahead_by * moment.time_scale * x[at(layout_.velocities[k])];
  }
  evaluation::ContactValues later;
  kernel_.contacts(moment.t, ahead.data(), moment.alpha.data(), later);
  std::vector<int> found;
  std::copy_if(touching.begin(), touching.end(), std::back_inserter(found), [&](int i) {
    return contacts_[at(i)].has_gap && values_.rows.row(i).norm() <= none * later.rows.row(i).norm();
  });
  return found;
}

/// The sizes of the terms of a row times positions, or velocities: what the rounding of a gap, or rate, is relative to.
double Contacts::terms_of(const evaluation::ContactValues::Rows& rows, int row, const std::vector<int>& states,
                          const std::vector<double>& x) {
  double terms = 0.0;
  for (std::size_t k = 0; k < states.size(); ++k) terms += std::abs(rows(row, index(k)) * x[at(states[k])]);
  return terms;
}

double Contacts::gap_terms(int contact, const std::vector<double>& x) const {
  return terms_of(values_.rows, contact, layout_.positions, x);
}

/// How large a gap may be that is 0 to the rounding of its terms.
double Contacts::no_gap(int contact, const std::vector<double>& x) const {
  return std::max(64.0 * rounding_unit * gap_terms(contact, x), none_at_start);
}

/// What closes a gap again: an acceleration of its own, or one by the forces of those that rest beside it.
double Contacts::pull_on(int contact, const ContactPoint& point, const std::vector<double>& x) const {
  switching::HeldRows rows(point.velocity.size());
  for (int i = 0; i < point.contacts(); ++i) {
    if (i != contact && point.has_gap[at(i)] && point.velocity(i) == 0.0 && touches(i, x, {})) rows.hold(i);
  }
  double acceleration = point.acceleration(contact);
  linalg::Vector forces;
  if (!rows.held().empty() &&
      rows.solve(point.influence, point.acceleration, forces) != switching::HeldRows::Solution::none)
    acceleration = std::min(acceleration, acceleration + point.influence.row(contact).dot(forces));
  return std::max(0.0, -acceleration);
}

/// Whether a gap that moves with this speed against a pull gets no further, or takes no longer, than its rounding.
/// Without an end to them such bounces would go on for ever: no speed is small enough to end at once.
bool Contacts::is_nothing(const ContactMoment& moment, int contact, double speed, double pull,
                          const std::vector<double>& x) const {
  constexpr double roundings = 64.0 * rounding_unit;
  return speed * speed <= 2.0 * pull * roundings * gap_terms(contact, x) ||
         speed <= pull * roundings * std::abs(moment.t);
}

/// Whether a contact opens and falls back before that.
bool Contacts::rises_by_nothing(const ContactMoment& moment, int contact, const ContactPoint& point,
                                const std::vector<double>& x) const {
  return contacts_[at(contact)].has_gap &&
         is_nothing(moment, contact, std::abs(point.normal_velocity(contact)), pull_on(contact, point, x), x);
}

/// Whether all that closes has fallen by nothing in the motion up to here.
bool Contacts::fall_by_nothing(const ContactMoment& moment, const std::vector<int>& touching, const ContactPoint& point,
                               const std::vector<double>& x) {
  std::vector<double> rate(x.size()), free(x.size());
  kernel_.field(moment.t, x.data(), moment.alpha.data(), rate.data());
  free_field(moment.t, x, moment.alpha, free.data());
  return std::all_of(touching.begin(), touching.end(), [&](int i) {
    double pull = -point.acceleration(i);
    for (std::size_t k = 0; k < layout_.velocities.size(); ++k) {
      const std::size_t state = at(layout_.velocities[k]);
      pull -= values_.rows(i, index(k)) * (rate[state] - free[state]);
    }
    return point.normal_velocity(i) >= 0.0 || is_nothing(moment, i, -point.normal_velocity(i), pull, x);
  });
}

/// Whether a gap closes no faster than velocities are known: than the rounding of the terms of its rate, and of what
/// they change by in the time; or as its rate and acceleration vanish together. The rounding of a gap of (t_0 - t)^3
/// leaves the time open, and with it the speed v there, as large as a^2 = 2 v da/dt.
bool Contacts::closes_flatly(const ContactMoment& moment, int contact, const ContactPoint& point,
                             const std::vector<double>& x) const {
  const double speed = std::abs(point.normal_velocity(contact)), acceleration = point.acceleration(contact);
  const double terms = std::abs(acceleration) * std::max(std::abs(moment.t), moment.time_scale) +
                       terms_of(values_.rows, contact, layout_.velocities, x);
  if (speed <= 64.0 * rounding_unit * terms) return true;
  if (speed > rests_below * slowest(moment, point, x)) return false;
  auto ahead = x;
  const double h = ahead_by * moment.time_scale;
  move_ahead(moment, h, ahead);
  evaluation::ContactValues later;
  kernel_.contacts(moment.t + h, ahead.data(), moment.alpha.data(), later);
  const double rate = std::abs(later.acceleration(contact) - acceleration) / h;
  return acceleration * acceleration <= 4.0 * speed * rate;
}

/// Contacts that an impact has closed as slowly as nothing would be left to rise by.
void Contacts::note_last_bounces(const ContactMoment& moment, const std::vector<int>& touching, ContactPoint before,
                                 const std::vector<double>& x) {
  const double none = 64.0 * rounding_unit * before.velocity.max_abs();
  for (const int i : touching) {
    double& speed = before.velocity(i);
    if (!(speed < 0.0) || before.restitution[at(i)] == 0.0 || mode_of(i) == ContactMode::open) continue;
    speed *= -before.restitution[at(i)];
    if (speed <= none || rises_by_nothing(moment, i, before, x)) last_bounces_.push_back(contacts_[at(i)].jump);
  }
}

/// Whether a gap and its rate are 0 within the tolerances: that of another contact in the same impacts.
bool Contacts::comes_to_rest(const ContactMoment& moment, int contact, const ContactPoint& point,
                             const std::vector<double>& x) const {
  const auto& [rtol, atol] = moment.tolerances;
  return std::abs(values_.gap(contact)) <= atol + rtol * gap_terms(contact, x) &&
         (std::abs(point.normal_velocity(contact)) <= rests_below * slowest(moment, point, x) ||
          rises_by_nothing(moment, contact, point, x));
}

bool Contacts::are_moved(const std::vector<double>& x, const std::vector<double>& x_after) const {
  const auto differ = [&](int state) { return x[at(state)] != x_after[at(state)]; };
  return !none() && (std::any_of(layout_.positions.begin(), layout_.positions.end(), differ) ||
                     std::any_of(layout_.velocities.begin(), layout_.velocities.end(), differ));
}

bool Contacts::have_jumped(const ContactMoment& moment, const std::vector<double>& x) {
  if (none()) return false;
  const ContactPoint point = point_at(moment.t, moment.alpha, x);
  const double still = none_below * slowest(moment, point, x);
  for (int i = 0; i < point.contacts(); ++i) {
    const auto& contact = contacts_[at(i)];
    const double gap = values_.gap(i), none = no_gap(i, x);
    if (contact.has_gap && (gap < -none || (activity(i).is_closed() && gap > none))) return true;
    const double speed = contact.has_friction ? point.along(point.velocity, i).norm() : 0.0;
    const auto mode = mode_of(i);
    if (mode == ContactMode::stick && speed > still) return true;
    if (mode != ContactMode::slip) continue;
    const auto& [least, largest] = activity(i).speeds;
    if (speed * speed < least || speed * speed > largest) return true;
  }
  return false;
}

std::optional<std::string> Contacts::begin_anew(const ContactMoment& moment, std::vector<double>& x) {
  kernel_.set_activities(Activities(contacts_.size()));
  kernel_.contacts(moment.t, x.data(), moment.alpha.data(), values_);
  for (int i = 0; i < static_cast<int>(contacts_.size()); ++i) {
    if (!contacts_[at(i)].has_gap || values_.gap(i) >= -no_gap(i, x)) continue;
    return fmt::format("a jump at t = {:.17g} makes the gap of {} {:.6g}: bodies must not overlap", moment.t,
                       names({i}), values_.gap(i));
  }
  return std::nullopt;
}

/// The contact that is open, and whose gap this event function is.
std::optional<int> Contacts::open_with_gap(int function, const Activities& activities) const {
  if (!guards(function)) return std::nullopt;
  const int i = contact_of_guard_[at(function)];
  const auto& contact = contacts_[at(i)];
  const bool is_open = contact.has_gap && !activities[at(i)].is_closed();
  return is_open && kernel_.jump_guard(contact.jump, 0) == function ? std::optional(i) : std::nullopt;
}

double Contacts::tolerated(int function, const Activities& activities) const {
  return open_with_gap(function, activities) ? none_at_start : 0.0;
}

auto Contacts::gap_motion(int function, const ContactMoment& moment, const Activities& activities,
                          const std::vector<double>& x, const std::vector<double>& slope, Along& along) const
    -> std::optional<GapMotion> {
  const auto contact = open_with_gap(function, activities);
  if (!contact) return std::nullopt;
  auto& [known, at_x, along_slope, ahead, here, later] = along;
  const double h = ahead_by * moment.time_scale;
  if (!known || at_x != x || along_slope != slope) {
    at_x = ahead = x;
    along_slope = slope;
    for (std::size_t i = 0; i < x.size(); ++i) ahead[i] += h * slope[i];
    kernel_.contacts(moment.t, x.data(), moment.alpha.data(), here);
    kernel_.contacts(moment.t + h, ahead.data(), moment.alpha.data(), later);
    known = true;
  }
  // A guard is positive where its gap is negative.
  GapMotion motion{terms_of(here.rows, *contact, layout_.positions, x), -here.velocity(*contact),
                   terms_of(here.rows, *contact, layout_.velocities, x),
                   (here.velocity(*contact) - later.velocity(*contact)) / h};
  double along_time = here.velocity(*contact);
  for (std::size_t k = 0; k < layout_.positions.size(); ++k) {
    along_time -= here.rows(*contact, index(k)) * x[at(layout_.velocities[k])];
  }
  motion.terms += std::abs(along_time);
  motion.size += std::abs(along_time * moment.t);
  return motion;
}

}  // namespace saltus::event_integrator
