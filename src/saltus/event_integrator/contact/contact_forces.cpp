#include "saltus/event_integrator/contact/contact_forces.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace saltus::event_integrator {
namespace {

using Eigen::VectorXd;

using Eigen::Vector2d;

std::vector<ContactMode> mode_options(const ContactPoint& point, int i) {
  if (point.friction[static_cast<std::size_t>(i)] == 0.0) return {ContactMode::closed, ContactMode::open};
  if (point.in_plane(i)) {
    std::vector<ContactMode> modes{ContactMode::slip};
    if (point.along(point.velocity, i).isZero(0.0)) modes.insert(modes.begin(), ContactMode::stick);
    if (point.has_gap[static_cast<std::size_t>(i)]) modes.push_back(ContactMode::open);
    return modes;
  }
  const double slip = point.velocity(point.tangent_row(i, 0));
  if (slip > 0.0) return {ContactMode::slip_up, ContactMode::open};
  if (slip < 0.0) return {ContactMode::slip_down, ContactMode::open};
  return {ContactMode::stick, ContactMode::slip_up, ContactMode::slip_down, ContactMode::open};
}

/// The least margin of all conditions.
double margin_of(const ContactPoint& point, const std::vector<int>& resting, const ContactForces& found) {
  // Where a body leaves a gap, what is left of its force and acceleration is the rounding of their terms.
  constexpr double rounded = 1e-5;
  const double largest = std::max(
      rounded * point.terms, (point.acceleration.cwiseAbs() + (point.influence * found.forces).cwiseAbs()).maxCoeff());
  const double response = point.influence.cwiseAbs().maxCoeff();
  const double force =
      std::max(response > 0.0 ? rounded * point.terms / response : 0.0, found.forces.cwiseAbs().maxCoeff());
  const auto part = [](double value, double size) { return size > 0.0 ? value / size : 0.0; };
  double least = std::numeric_limits<double>::infinity();
  const auto note = [&](double value, double size) { least = std::min(least, part(value, size)); };
  for (const int i : resting) {
    const auto mode = found.modes[static_cast<std::size_t>(i)];
    const double mu = point.friction[static_cast<std::size_t>(i)];
    if (mode == ContactMode::open) {
      note(found.acceleration(i), largest);
      continue;
    }
    note(found.forces(i), force);
    if (mode == ContactMode::stick) note(mu * found.forces(i) - point.along(found.forces, i).norm(), force);
    if (slips(mode) && point.along(point.velocity, i).isZero(0.0)) {
      note(found.directions[static_cast<std::size_t>(i)].dot(point.along(found.acceleration, i)), largest);
    }
  }
  return least;
}

bool solve_forces(const ContactPoint& point, const std::vector<int>& resting, ContactForces& result) {
  HeldRows rows(point.velocity.size());
  for (const int i : resting) {
    const auto k = static_cast<std::size_t>(i);
    const auto mode = result.modes[k];
    if (mode == ContactMode::open) continue;
    const bool given = !point.has_gap[k];
    if (given) rows.given(i) = 1.0;
    const int normal = given ? -1 : rows.hold(i);
    for (int tangent = 0; tangent < point.tangents[k]; ++tangent) {
      const int row = point.tangent_row(i, tangent);
      (given ? rows.given(row) : rows.columns(row, normal)) = -point.friction[k] * result.directions[k](tangent);
      if (mode == ContactMode::stick) rows.hold(row);
    }
  }
  if (!rows.solve(point.influence, point.acceleration, result.forces)) return false;
  result.acceleration = point.acceleration + point.influence * result.forces;
  return true;
}

/// Against the forces that would keep these contacts from slipping.
void guess_directions(const ContactPoint& point, const std::vector<int>& resting, const std::vector<int>& free,
                      ContactForces& result) {
  ContactForces sticking = result;
  for (const int i : free) sticking.modes[static_cast<std::size_t>(i)] = ContactMode::stick;
  const bool solved = solve_forces(point, resting, sticking);
  for (const int i : free) {
    const Vector2d needed = solved ? Vector2d(-point.along(sticking.forces, i)) : point.along(point.acceleration, i);
    result.directions[static_cast<std::size_t>(i)] = needed.norm() > 0.0 ? needed.normalized() : Vector2d(1.0, 0.0);
  }
}

}  // namespace

bool forces_in(const ContactPoint& point, const std::vector<int>& resting, const std::vector<ContactMode>& modes,
               ContactForces& result) {
  result.modes = modes;
  result.directions.assign(modes.size(), Vector2d::Zero());
  std::vector<int> free;
  for (const int i : resting) {
    const auto mode = modes[static_cast<std::size_t>(i)];
    auto& direction = result.directions[static_cast<std::size_t>(i)];
    const Vector2d velocity = point.along(point.velocity, i);
    if (mode == ContactMode::slip_up) direction = {1.0, 0.0};
    if (mode == ContactMode::slip_down) direction = {-1.0, 0.0};
    if (mode != ContactMode::slip) continue;
    if (velocity.isZero(0.0)) {
      free.push_back(i);
    } else {
      direction = velocity.normalized();
    }
  }
  const auto solve = [&] { return solve_forces(point, resting, result); };
  if (!free.empty()) guess_directions(point, resting, free, result);
  const bool solved = free.empty()
                          ? solve()
                          : find_directions(point, free, result.directions, result.forces, result.acceleration, solve);
  if (!solved) return false;
  result.margin = margin_of(point, resting, result);
  return true;
}

std::vector<ContactForces> admissible_forces(const ContactPoint& point, const std::vector<int>& resting,
                                             const std::vector<std::vector<ContactMode>>& excluded) {
  std::vector<std::vector<ContactMode>> all;
  for (const int i : resting) {
    auto some = mode_options(point, i);
    const auto& without = excluded[static_cast<std::size_t>(i)];
    std::erase_if(some,
                  [&](ContactMode mode) { return std::find(without.begin(), without.end(), mode) != without.end(); });
    if (some.empty()) return {};
    all.push_back(std::move(some));
  }
  std::vector<ContactForces> result;
  std::vector<std::size_t> number(all.size(), 0);
  std::vector<ContactMode> modes(point.friction.size(), ContactMode::open);
  constexpr long most = 100000;
  for (long tried = 0; tried < most; ++tried) {
    for (std::size_t k = 0; k < all.size(); ++k) modes[static_cast<std::size_t>(resting[k])] = all[k][number[k]];
    ContactForces found;
    // Rounding of solves, and of the place where a mode was found to end.
    if (forces_in(point, resting, modes, found) && found.margin >= -1e-8) result.push_back(std::move(found));
    std::size_t k = 0;
    while (k < all.size() && ++number[k] == all[k].size()) number[k++] = 0;
    if (k == all.size()) break;
    if (result.size() > 16) break;
  }
  return result;
}

}  // namespace saltus::event_integrator
