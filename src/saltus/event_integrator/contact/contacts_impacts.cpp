// Impacts of contacts, and what counts as one.
#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include "saltus/base/at.hpp"
#include "saltus/base/rounding_unit.hpp"
#include "saltus/event_integrator/contact/contacts.hpp"
#include "saltus/event_integrator/contact/impact.hpp"
#include "saltus/event_integrator/contact/impact_orders.hpp"

namespace saltus::event_integrator {
namespace {

using linalg::Vector;

/// Of velocities behind an impact, from the size of those before it: slips end as they do in the process.
void drop_roundings(double size, ContactPoint& point) {
  for (linalg::Index row = 0; row < point.velocity.size(); ++row) {
    const double rounding = row < point.contacts() ? 64.0 * rounding_unit : slip_rounding;
    if (std::abs(point.velocity(row)) <= rounding * size) point.velocity(row) = 0.0;
  }
}

/// What is left of a slip in a plane that an impact ends while it turns.
void end_turning_slips(double fastest, ContactPoint& point) {
  constexpr double left = 1e-10;
  for (int i = 0; i < point.contacts(); ++i) {
    if (!point.in_plane(i) || point.along(point.velocity, i).norm() > left * fastest) continue;
    for (int tangent = 0; tangent < 2; ++tangent) point.velocity(point.tangent_row(i, tangent)) = 0.0;
  }
}

}  // namespace

/// Says of a coefficient that varies where it has left its range: friction of what touches, restitution of what hits.
std::optional<std::string> Contacts::out_of_range(const ContactMoment& moment, const std::vector<int>& touching,
                                                  const ContactPoint& point) const {
  for (const int i : touching) {
    const double friction = values_.friction(i), restitution = values_.restitution(i);
    if (contacts_[at(i)].friction_varies && !(friction >= -model::no_friction)) {
      return fmt::format("the friction of '{}' turns negative ({:.6g}) at t = {:.17g}, while bodies touch",
                         contacts_[at(i)].name, friction, moment.t);
    }
    if (point.normal_velocity(i) < 0.0 && !(restitution >= 0.0 && restitution <= 1.0)) {
      return fmt::format("the restitution of '{}' is {:.6g} at the impact at t = {:.17g}: it is in [0, 1]",
                         contacts_[at(i)].name, restitution, moment.t);
    }
  }
  return std::nullopt;
}

/// The impulses, and the velocities behind them.
std::optional<Vector> Contacts::push(const ContactMoment& moment, const std::vector<int>& touching,
                                     std::optional<int> pushed, ContactPoint& point, std::vector<double>& x) {
  auto impulses = impact(point, touching, pushed);
  if (!impulses) return impulses;
  const Vector change = values_.responses * *impulses;
  for (std::size_t k = 0; k < layout_.velocities.size(); ++k) {
    x[at(layout_.velocities[k])] += change(static_cast<linalg::Index>(k));
  }
  impulses_ = impulses_.size() > 0 ? Vector(impulses_ + *impulses) : *impulses;
  const double size = point.velocity.max_abs();
  read_point(moment.t, moment.alpha, x, point);
  drop_roundings(size, point);
  return impulses;
}

void Contacts::compare_orders(const ContactPoint& before, const std::vector<int>& touching, const Vector& impulses) {
  const auto other = find_other_end(before, touching, impulses);
  if (!other) return;
  const std::string axis =
      other->tangent && before.in_plane(other->contact) ? fmt::format(" {}", *other->tangent + 1) : "";
  why_open_.text = fmt::format("one behind the other ({}{}) they would end elsewhere: {} of {} is {:.6g}, not {:.6g}",
                               names(other->order), other->are_more ? ", …" : "",
                               other->tangent ? "the velocity along tangent" + axis : "the rate of the gap",
                               names({other->contact}), other->velocity, other->together);
}

/// Brings what has fallen by nothing to rest without an impact, and sets nothing beside it in motion. Else contacts of
/// which each opens another one would bounce for ever.
/// @return false where rates do not vanish together
bool Contacts::come_to_rest(const ContactMoment& moment, const std::vector<int>& touching, ContactPoint& point,
                            std::vector<double>& x) {
  const double size = point.velocity.max_abs(), closing = -point.velocity.selected_rows(touching).min();
  std::vector<int> rows;
  linalg::RowBasis basis = no_rows();
  const auto stop = [&](int row) {
    if (basis.takes(values_.rows.row(row))) rows.push_back(row);
  };
  for (const int i : touching) {
    if (point.velocity(i) <= closing) stop(i);
  }
  for (const int i : touching) {
    for (int k = 0; k < point.tangents[at(i)]; ++k) {
      if (point.velocity(point.tangent_row(i, k)) == 0.0) stop(point.tangent_row(i, k));
    }
  }
  const auto x_before = x;
  const auto before = point;
  change_velocities(rows, -values_.velocity.selected_rows(rows), x);
  read_point(moment.t, moment.alpha, x, point);
  for (const int row : rows) point.velocity(row) = 0.0;
  drop_roundings(size, point);
  const bool rests = point.velocity.selected_rows(touching).min() >= 0.0;
  if (!rests) {
    x = x_before;
    point = before;
    kernel_.contacts(moment.t, x.data(), moment.alpha.data(), values_);
  }
  return rests;
}

/// An impact. What would rise by nothing has no restitution: its impulses, too, are those of bodies that come to rest.
bool Contacts::collide(const ContactMoment& moment, const std::vector<int>& touching, std::optional<int> pushed,
                       ContactPoint& point, std::vector<double>& x) {
  const double fastest = point.velocity.max_abs();
  const auto x_before = x;
  const Vector impulses_before = impulses_;
  auto before = point;
  for (bool again = true; again;) {
    x = x_before;
    point = before;
    impulses_ = impulses_before;
    const auto impulses = push(moment, touching, pushed, point, x);
    if (!impulses) return false;
    again = false;
    for (const int i : touching) {
      double& restitution = before.restitution[at(i)];
      if (restitution == 0.0 || point.velocity(i) == 0.0 || !rises_by_nothing(moment, i, point, x)) continue;
      restitution = 0.0;
      again = true;
    }
    if (!again && !pushed) compare_orders(before, touching, *impulses);
  }
  // Without restitution it rises by what the others do to it, and their speeds are that small, too.
  std::vector<int> still;
  linalg::RowBasis basis = no_rows();
  for (const int i : touching) {
    if (point.velocity(i) == 0.0 || !rises_by_nothing(moment, i, point, x)) continue;
    if (basis.takes(values_.rows.row(i))) still.push_back(i);
  }
  if (!still.empty()) {
    // What is at rest, along the ground, too, stays so.
    for (const int i : touching) {
      for (int row = i; row < static_cast<int>(point.velocity.size()); row += point.contacts()) {
        if (point.velocity(row) == 0.0 && basis.takes(values_.rows.row(row))) still.push_back(row);
      }
    }
    change_velocities(still, -values_.velocity.selected_rows(still), x);
    read_point(moment.t, moment.alpha, x, point);
    for (const int row : still) point.velocity(row) = 0.0;
    drop_roundings(fastest, point);
  }
  end_turning_slips(fastest, point);
  return true;
}

}  // namespace saltus::event_integrator
