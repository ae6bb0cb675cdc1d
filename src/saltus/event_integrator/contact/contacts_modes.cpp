// The modes that follow: the point problem of what touches, and which of its solutions a run takes.
#include <algorithm>
#include <iterator>
#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "saltus/base/at.hpp"
#include "saltus/event_integrator/contact/contacts.hpp"

namespace saltus::event_integrator {

std::optional<std::string> Contacts::find_modes(const ContactMoment& moment, const std::vector<int>& touching,
                                                std::vector<std::vector<ContactMode>> excluded, ContactPoint& point,
                                                std::vector<double>& x) {
  std::vector<int> resting;
  switching::PointSolutions found;
  const auto solve = [&](const std::vector<std::vector<ContactMode>>& without) {
    resting.clear();
    std::copy_if(touching.begin(), touching.end(), std::back_inserter(resting),
                 [&](int i) { return point.normal_velocity(i) == 0.0; });
    found = forces_of(point, resting, {without, modes_here().modes});
    return !found.all.empty();
  };
  const std::vector<std::vector<ContactMode>> none(contacts_.size());
  const bool any = solve(excluded) || solve(none);
  // Painleve: no forces keep the contacts closed, and none let them open. An impact without a collision follows.
  for (std::size_t k = 0; !any && found.all.empty() && k < touching.size(); ++k) {
    const int pushed = touching[k];
    if (point.friction[at(pushed)] == 0.0 || point.normal_velocity(pushed) != 0.0) continue;
    auto x_behind = x;
    auto point_behind = point;
    if (!collide(moment, touching, pushed, point_behind, x_behind)) continue;
    x = std::move(x_behind);
    point = std::move(point_behind);
    static_cast<void>(solve(none));
    if (found.all.empty()) break;
  }
  if (found.all.empty()) {
    return fmt::format(
        "no contact forces continue the motion of {} at t = {:.17g} (Painleve's paradox, or bodies that "
        "jam)",
        names(touching), moment.t);
  }
  const std::size_t chosen = best_ahead(moment, point, resting, found.all, x);
  const auto one = switching::is_one_motion(problem_of(point, resting), found, chosen);
  why_open_.is_undecided = why_open_.is_undecided || !one;
  if (one == false) {
    if (!why_open_.text.empty()) why_open_.text += "; ";
    why_open_.text += "the forces of what touches leave more than one motion open";
  }
  put_at_rest(point, resting, x);
  enter(moment, point, resting, found.all[chosen], x);
  static_cast<void>(project(moment.t, moment.alpha, x, touching));
  bound_speeds(moment, x);
  return std::nullopt;
}

void Contacts::move_ahead(const ContactMoment& moment, double h, std::vector<double>& x) const {
  std::vector<double> rate(x.size());
  kernel_.field(moment.t, x.data(), moment.alpha.data(), rate.data());
  for (std::size_t i = 0; i < x.size(); ++i) x[i] += h * rate[i];
}

/// The point a little later in the motion of these modes. Values and activities are those at x, and stay so.
void Contacts::read_ahead(const ContactMoment& moment, const ContactPoint& point, const std::vector<int>& resting,
                          const ContactForces& found, const std::vector<double>& x, ContactPoint& later) {
  const double h = ahead_by * moment.time_scale;
  const Activities own = activities();
  const evaluation::ContactValues values = values_;
  ContactPoint here = point;
  here.velocity = values_.velocity;
  auto ahead = x;
  enter(moment, here, resting, found, ahead);
  move_ahead(moment, h, ahead);
  kernel_.set_activities(own);
  read_motion(moment.t + h, moment.alpha, ahead, later);
  values_ = values;
  later.terms = point.terms;
  for (const int i : resting) {
    // The sign of the slip is that of the mode; where it begins without an acceleration, that of a rounding.
    const auto mode = found.faces[at(i)];
    const bool begins = slips(mode) && !point.in_plane(i) && point.along(point.velocity, i).is_zero();
    if (mode != ContactMode::stick && !begins) continue;
    for (int tangent = 0; tangent < later.tangents[at(i)]; ++tangent) {
      later.velocity(later.tangent_row(i, tangent)) = 0.0;
    }
  }
}

/// Of modes that hold here the first one that clearly holds a little later, too, else the one with the largest margin:
/// with those contacts idle that will be. Contacts that would press on each other for no reason are left open, if the
/// others hold without them.
std::size_t Contacts::best_ahead(const ContactMoment& moment, const ContactPoint& point,
                                 const std::vector<int>& resting, std::vector<ContactForces>& found,
                                 const std::vector<double>& x) {
  constexpr double clear = 1e-4, same = 1e-14;
  if (found.size() == 1 && (found[0].idle.empty() || found[0].margin > clear)) return 0;
  std::size_t best = 0;
  double largest = -std::numeric_limits<double>::infinity();
  std::vector<int> idle = found[0].idle;
  std::optional<std::size_t> stressed;
  std::vector<std::size_t> others;
  ContactPoint later;
  for (std::size_t k = 0; k < found.size(); ++k) {
    read_ahead(moment, point, resting, found[k], x, later);
    ContactForces forces;
    if (!forces_in(later, resting, found[k].faces, forces)) continue;
    const double held = std::min(found[k].margin, forces.margin);
    // Forces that are not unique, of bodies that rest: those without a slip are the first.
    if (held > clear && !forces.is_stressed) return k;
    if (held > clear && !stressed) stressed = k;
    const bool may_do = held >= switching::face_holds && !forces.is_stressed &&
                        switching::margin_of_forces(problem_of(later, resting), forces) > clear;
    if (may_do) others.push_back(k);
    if (held > largest + same) {
      largest = held;
      best = k;
      idle = forces.idle;
    }
  }
  if (stressed) {
    const auto leaves_open = [&](std::size_t k) {
      return switching::is_same_with_open(problem_of(point, resting), found[*stressed], found[k]);
    };
    const auto unpressed = std::find_if(others.begin(), others.end(), leaves_open);
    return unpressed != others.end() ? *unpressed : *stressed;
  }
  if (ContactForces carried = found[best];
      idle != carried.idle && switching::solve_without(problem_of(point, resting), idle, carried)) {
    found[best] = std::move(carried);
  }
  return best;
}

}  // namespace saltus::event_integrator
