#include "saltus/event_integrator/contact/contacts.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "saltus/base/at.hpp"
#include "saltus/event_integrator/contact/shared_friction.hpp"
#include "saltus/event_integrator/mode/small_internal.hpp"

namespace saltus::event_integrator {
namespace {

using linalg::Vector;

constexpr double small_velocity =
    1e-9;  ///< relative size of velocities that count as none at an event: location and projection

}  // namespace

Contacts::Contacts(evaluation::ModelKernel& kernel)
    : kernel_(kernel), layout_(kernel.layout()), contacts_(layout_.contacts) {
  if (contacts_.empty()) return;
  kernel_.set_activities(Activities(contacts_.size()));
  contact_of_guard_.assign(at(kernel.event_functions()), -1);
  is_of_contact_.assign(layout_.jumps.size(), false);
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    const int jump = contacts_[i].jump;
    is_of_contact_[at(jump)] = true;
    for (const auto& guard : layout_.jumps[at(jump)].guards)
      contact_of_guard_[at(guard.function)] = static_cast<int>(i);
  }
}

/// Of the accelerations that the forces of closed contacts cancel, by the sizes of these forces in t and x.
double Contacts::force_terms(const ContactPoint& point, double t, const std::vector<double>& alpha,
                             const std::vector<double>& x) {
  const auto carries = [](const auto& activity) { return activity.carries; };
  if (std::none_of(activities().begin(), activities().end(), carries)) return 0.0;
  auto& [rate, magnitude, slope] = terms_;
  magnitude.resize(contact_of_guard_.size());
  slope.resize(contact_of_guard_.size());
  kernel_.scales(t, x.data(), alpha.data(), magnitude.data(), slope.data());
  double largest = 0.0;
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    const auto& activity = activities()[i];
    if (!contacts_[i].has_gap || !activity.carries) continue;
    const double force = magnitude[at(kernel_.jump_guard(contacts_[i].jump, 0))] * activity.force_unit;
    const auto row = static_cast<linalg::Index>(i);
    if (std::isfinite(force)) largest = std::max(largest, force * point.influence(row, row));
  }
  return largest;
}

void Contacts::free_field(double t, const std::vector<double>& x, const std::vector<double>& alpha, double* f) {
  const Activities own = activities();
  kernel_.set_activities(Activities(own.size()));
  kernel_.field(t, x.data(), alpha.data(), f);
  kernel_.set_activities(own);
}

/// Along the motion without contact forces.
double Contacts::acceleration_terms(double t, const std::vector<double>& alpha, const std::vector<double>& x) {
  auto& rate = terms_.rate;
  rate.resize(x.size());
  free_field(t, x, alpha, rate.data());
  double largest = 0.0;
  for (linalg::Index row = 0; row < values_.acceleration.size(); ++row) {
    double terms = 0.0, along = 0.0;
    for (std::size_t k = 0; k < layout_.velocities.size(); ++k) {
      const double term = values_.rows(row, index(k)) * rate[at(layout_.velocities[k])];
      terms += std::abs(term);
      along += term;
    }
    terms += std::abs(values_.acceleration(row) - along);
    if (!std::isfinite(terms)) return 0.0;
    largest = std::max(largest, terms);
  }
  return largest;
}

ContactPoint Contacts::point_at(double t, const std::vector<double>& alpha, const std::vector<double>& x) {
  ContactPoint point;
  read_point(t, alpha, x, point);
  return point;
}

void Contacts::read_point(double t, const std::vector<double>& alpha, const std::vector<double>& x,
                          ContactPoint& point) {
  read_motion(t, alpha, x, point);
  point.free_terms = acceleration_terms(t, alpha, x);
  point.terms = std::max(point.free_terms, force_terms(point, t, alpha, x));
}

/// All but the sizes of terms.
void Contacts::read_motion(double t, const std::vector<double>& alpha, const std::vector<double>& x,
                           ContactPoint& point) {
  kernel_.contacts(t, x.data(), alpha.data(), values_);
  read_contacts(contacts_, values_, point);
  point.acceleration = values_.acceleration;
}

ContactMode Contacts::mode_of(int contact) const {
  constexpr std::array modes{ContactMode::open, ContactMode::closed, ContactMode::stick, ContactMode::slip};
  const auto state = activity(contact).state;
  const bool along = state == model::Activity::State::slip && !contacts_[at(contact)].in_plane;
  if (!along) return modes[static_cast<std::size_t>(state)];
  return activity(contact).share[0] > 0.0 ? ContactMode::slip_up : ContactMode::slip_down;
}

/// Whether the gap is 0: by the mode, by the event, or to the rounding of its terms.
bool Contacts::touches(int contact, const std::vector<double>& x, const std::vector<int>& ended) const {
  if (!contacts_[at(contact)].has_gap || activity(contact).is_closed() || contains(ended, contact)) return true;
  return std::abs(values_.gap(contact)) <= no_gap(contact, x);
}

/// Velocities that are 0 by their modes, or to their rounding, are 0; so is that of a slip that ends.
void Contacts::clean(const ContactMoment& moment, ContactPoint& point, const std::vector<double>& x,
                     const std::vector<int>& ended) const {
  const int m = point.contacts();
  const double small = small_velocity * fastest(moment, point, x), end = none_below * slowest(moment, point, x);
  const auto is_over = [&](int i) {
    return slips(mode_of(i)) && point.along(point.velocity, i).norm() <= (point.in_plane(i) ? end : small);
  };
  // Below the slowest speed none has a direction: slips that come to rest together do so at one time.
  const bool in_plane = std::any_of(ended.begin(), ended.end(), [&](int i) { return point.in_plane(i) && is_over(i); });
  std::vector<bool> slip_has_ended(at(m), false);
  for (int i = 0; i < m; ++i) {
    slip_has_ended[at(i)] = (contains(ended, i) || (in_plane && point.in_plane(i))) && is_over(i);
  }
  for (int row = 0; row < static_cast<int>(point.velocity.size()); ++row) {
    const int contact = row % m;
    const auto mode = mode_of(contact);
    const bool slip_ends = slip_has_ended[at(contact)];
    const bool held = row < m ? mode != ContactMode::open : mode == ContactMode::stick || slip_ends;
    const auto rounding = [&] { return 16.0 * rounding_unit * terms_of(values_.rows, row, layout_.velocities, x); };
    if (held || std::abs(point.velocity(row)) <= rounding()) point.velocity(row) = 0.0;
  }
}

std::optional<std::string> Contacts::resolve(const ContactMoment& moment, const std::vector<int>& ended,
                                             std::vector<double>& x) {
  why_open_.clear();
  impulses_.resize(0);
  ContactPoint point = point_at(moment.t, moment.alpha, x);
  last_bounces_.clear();
  if (!ended.empty() &&
      std::all_of(ended.begin(), ended.end(), [&](int i) { return reaches_a_speed(moment, i, point, x); })) {
    bound_speeds(moment, x);
    return std::nullopt;
  }
  clean(moment, point, x, ended);
  std::vector<int> touching;
  for (int i = 0; i < point.contacts(); ++i) {
    if (touches(i, x, ended)) touching.push_back(i);
  }
  if (const auto flat = without_normal(moment, touching, x); !flat.empty()) {
    return fmt::format(
        "the gap of {} has no normal at t = {:.17g}, where its gradient is 0: write it as a distance (x for x^3)",
        names(flat), moment.t);
  }
  if (auto problem = out_of_range(moment, touching, point)) return problem;
  auto excluded = modes_that_end(moment, point, ended, x);
  const bool closing =
      std::any_of(touching.begin(), touching.end(), [&](int i) { return point.normal_velocity(i) < 0.0; });
  const bool touch_only = closing && std::all_of(touching.begin(), touching.end(), [&](int i) {
                            return point.normal_velocity(i) >= 0.0 || closes_flatly(moment, i, point, x);
                          });
  if (touch_only) point.restitution.assign(contacts_.size(), 0.0);
  const ContactPoint before = closing ? point : ContactPoint{};
  if (closing) {
    const bool rests = fall_by_nothing(moment, touching, point, x) && come_to_rest(moment, touching, point, x);
    if (!rests && !collide(moment, touching, std::nullopt, point, x)) {
      return fmt::format("the impact of {} at t = {:.17g} has no end: bodies jam, or normals depend on each other",
                         names(touching), moment.t);
    }
    if (touch_only) {
      impulses_.resize(0);
      why_open_.clear();
    }
    excluded.assign(contacts_.size(), {});
  }
  auto problem = find_modes(moment, touching, std::move(excluded), point, x);
  if (closing) note_last_bounces(moment, touching, before, x);
  return problem;
}

std::vector<int> Contacts::without_slip(const ContactMoment& moment, const std::vector<double>& x) {
  ContactPoint point = point_at(moment.t, moment.alpha, x);
  clean(moment, point, x, {});
  std::vector<int> found;
  for (int i = 0; i < point.contacts(); ++i) {
    if (point.along(point.velocity, i).is_zero()) found.push_back(i);
  }
  return found;
}

std::optional<std::string> Contacts::settle(const ContactMoment& moment, const Bounces& bounces,
                                            std::vector<double>& x) {
  why_open_.clear();
  impulses_.resize(0);
  std::vector<int> touching;
  const ContactPoint limit = point_at(moment.t, moment.alpha, x);
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    const bool closed = activities()[i].is_closed(), rests = closed || contains(bounces.jumps, contacts_[i].jump);
    if (!rests && !comes_to_rest(moment, static_cast<int>(i), limit, x)) continue;
    touching.push_back(static_cast<int>(i));
    if (!closed) change_activity(static_cast<int>(i), [](auto& activity) { activity.carries = true; });
  }
  // What is left of velocities into the gaps is more than rounding: to keep a slip would be work on it.
  static_cast<void>(project(moment.t, moment.alpha, x, {}, Slips::free));
  ContactPoint point = point_at(moment.t, moment.alpha, x);
  clean(moment, point, x, {});
  // The limit is extrapolated, to the tolerances. Along the ground it goes on: impulses that vanish have no friction.
  const double none = rests_below * slowest(moment, point, x);
  linalg::RowBasis at_rest = no_rows();
  std::vector<int> still;
  const auto stop = [&](int row) {
    point.velocity(row) = 0.0;
    if (at_rest.takes(values_.rows.row(row))) still.push_back(row);
  };
  const auto stop_slips = [&](auto condition) {
    for (const int i : touching) {
      for (int k = 0; condition(i) && k < point.tangents[at(i)]; ++k) stop(point.tangent_row(i, k));
    }
  };
  for (const int i : touching) stop(i);
  // Where impacts end in sticking it is what the extrapolation leaves of the slips between them.
  const double between = std::max(none, bounces.left * point.terms);
  stop_slips(
      [&](int i) { return point.along(point.velocity, i).norm() <= (contains(bounces.sticking, i) ? between : none); });
  // What follows from velocities that are 0 is 0, too: a slip there would have the direction of a rounding. Along gaps
  // that move with time it is not.
  const double small = small_velocity * fastest(moment, point, x);
  change_velocities(still, -values_.velocity.selected_rows(still), x);
  kernel_.contacts(moment.t, x.data(), moment.alpha.data(), values_);
  stop_slips([&](int i) {
    bool follows = point.along(values_.velocity, i).norm() <= small;
    for (int k = 0; k < point.tangents[at(i)]; ++k)
      follows = follows && at_rest.spans(values_.rows.row(point.tangent_row(i, k)));
    return follows;
  });
  if (auto problem = find_modes(moment, touching, std::vector<std::vector<ContactMode>>(contacts_.size()), point, x))
    return problem;
  // Gaps that close in one limit may have rates that are not 0 together.
  const ContactPoint behind = point_at(moment.t, moment.alpha, x);
  const double slow = std::max(none, 1e-6 * fastest(moment, behind, x));
  const auto moves = [&](int i) {
    return mode_of(i) != ContactMode::open && std::abs(behind.normal_velocity(i)) > slow;
  };
  if (std::none_of(touching.begin(), touching.end(), moves)) return std::nullopt;
  return fmt::format("the gaps of {} close at t = {:.17g} and cannot stay closed together: bodies jam", names(touching),
                     moment.t);
}

/// The activities of these modes. Of rows that depend on each other some hold; the others follow, and a tangential
/// force that does keeps its share of the friction cone.
void Contacts::enter(const ContactMoment& moment, const ContactPoint& point, const std::vector<int>& resting,
                     const ContactForces& found, std::vector<double>& x) {
  using State = model::Activity::State;
  const int m = point.contacts();
  linalg::RowBasis basis = no_rows();
  Activities next(at(m));
  for (int i = 0; i < m; ++i) {
    const bool closed = found.faces[at(i)] != ContactMode::open;
    next[at(i)].state = !closed ? State::open : point.tangents[at(i)] == 0 ? State::closed : State::stick;
    next[at(i)].carries = closed && !contains(found.idle, i) && basis.takes(values_.rows.row(i));
    set_units(moment, point, i, x, next[at(i)]);
  }
  const auto following = rows_that_follow(point, resting, found);
  for (int i = 0; i < m; ++i) {
    const double limit = point.friction[at(i)] * found.z(i);
    const bool holds = found.faces[at(i)] == ContactMode::stick && !contains(found.idle, i);
    for (int k = 0; holds && k < contacts_[at(i)].tangents(); ++k) {
      const int row = point.tangent_row(i, k);
      if (!contains(following, row) && basis.takes(values_.rows.row(row))) {
        next[at(i)].holds[at(k)] = true;
      } else if (limit > 0.0) {
        next[at(i)].share[at(k)] = std::clamp(-found.z(row) / limit, -1.0, 1.0);
      }
    }
  }
  kernel_.set_activities(next);
  for (int i = 0; i < m; ++i) {
    if (!slips(found.faces[at(i)])) continue;
    bool is_free = false;
    for (int k = 0; k < contacts_[at(i)].tangents(); ++k)
      is_free = is_free || !basis.spans(values_.rows.row(point.tangent_row(i, k)));
    enter_slip(moment, point, found, i, is_free, x);
  }
}

/// Of forces the one that the contact alone would need for the largest acceleration, of speeds the fastest one.
void Contacts::set_units(const ContactMoment& moment, const ContactPoint& point, int i, const std::vector<double>& x,
                         model::Activity& activity) const {
  double response = point.influence(i, i);
  for (int k = 0; k < point.tangents[at(i)]; ++k) {
    const int row = point.tangent_row(i, k);
    response = std::max(response, point.influence(row, row));
  }
  const double force = response > 0.0 ? point.free_terms / response : 0.0, speed = fastest(moment, point, x);
  activity.force_unit = force > 0.0 && std::isfinite(force) ? force : 1.0;
  activity.speed_unit = speed > 0.0 && std::isfinite(speed) ? speed : 1.0;
}

/// What others hold at rest is at the edge of its cone, and does not slip.
/// @param is_free  what is held does not hold its tangents, too
void Contacts::enter_slip(const ContactMoment& moment, const ContactPoint& point, const ContactForces& found, int i,
                          bool is_free, std::vector<double>& x) {
  const auto& contact = contacts_[at(i)];
  const bool is_still = point.along(point.velocity, i).is_zero();
  const bool moves = is_free || !is_still || point.along(found.y, i).norm() > 1e-9 * point.terms;
  change_activity(i, [&](auto& activity) {
    for (int k = 0; k < contact.tangents() && !(moves && contact.in_plane); ++k) {
      activity.share[at(k)] = found.directions[at(i)](k);
    }
  });
  if (!moves) return;
  // Before: without a speed the force of a slip has no size either.
  if (contact.in_plane && is_still) start_slip(moment, i, found.directions[at(i)], x);
  change_activity(i, [](auto& activity) { activity.state = model::Activity::State::slip; });
}

Contacts::Modes Contacts::modes_here() const {
  Modes found;
  for (int i = 0; i < static_cast<int>(contacts_.size()); ++i) {
    found.modes.push_back(mode_of(i));
    if (found.modes.back() != ContactMode::open) found.closed.push_back(i);
  }
  return found;
}

std::optional<std::string> Contacts::jam(const ContactMoment& moment, const std::vector<double>& x) {
  if (none()) return std::nullopt;
  const ContactPoint point = point_at(moment.t, moment.alpha, x);
  auto [modes, closed] = modes_here();
  ContactForces forces;
  if (closed.empty() || !forces_in(point, closed, modes, forces)) return std::nullopt;
  constexpr double without_bound = 1e4;
  const double largest = without_bound * point.acceleration.max_abs();
  std::erase_if(closed, [&](int i) {
    return point.friction[at(i)] == 0.0 || !slips(modes[at(i)]) || forces.z(i) * point.influence(i, i) <= largest;
  });
  if (closed.empty()) return std::nullopt;
  return fmt::format(
      "the normal force of {} grows without bound at t = {:.17g}: its own friction presses it on "
      "(Painleve's paradox)",
      names(closed), moment.t);
}

std::optional<int> Contacts::jump_to_tell() const {
  for (int i = 0; i < static_cast<int>(contacts_.size()); ++i) {
    const bool pushed = impulses_.size() > 0 && impulses_(i) != 0.0;
    if (pushed || (!why_open_.text.empty() && activity(i).is_closed())) return contacts_[at(i)].jump;
  }
  return std::nullopt;
}

std::string Contacts::names(const std::vector<int>& contacts) const {
  std::string text;
  for (const int i : contacts) text += (text.empty() ? "'" : ", '") + contacts_[at(i)].name + "'";
  return text;
}

}  // namespace saltus::event_integrator
