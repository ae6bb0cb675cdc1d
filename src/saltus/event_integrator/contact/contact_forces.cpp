#include "saltus/event_integrator/contact/contact_forces.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace saltus::event_integrator {
namespace {

using Eigen::VectorXd;

double slip_sign(ContactMode mode) {
  return mode == ContactMode::slip_up ? 1.0 : mode == ContactMode::slip_down ? -1.0 : 0.0;
}

std::vector<ContactMode> mode_options(const ContactPoint& point, int i) {
  if (point.friction[static_cast<std::size_t>(i)] == 0.0) return {ContactMode::closed, ContactMode::open};
  const double slip = point.tangential_velocity(i);
  if (slip > 0.0) return {ContactMode::slip_up, ContactMode::open};
  if (slip < 0.0) return {ContactMode::slip_down, ContactMode::open};
  return {ContactMode::stick, ContactMode::slip_up, ContactMode::slip_down, ContactMode::open};
}

/// The least margin of all conditions.
double margin_of(const ContactPoint& point, const std::vector<int>& resting, const ContactForces& found) {
  const int m = point.contacts();
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
    if (mode == ContactMode::stick) note(mu * found.forces(i) - std::abs(found.forces(m + i)), force);
    const double sign = slip_sign(mode);
    if (sign != 0.0 && point.tangential_velocity(i) == 0.0) note(sign * found.acceleration(m + i), largest);
  }
  return least;
}

}  // namespace

bool forces_in(const ContactPoint& point, const std::vector<int>& resting, const std::vector<ContactMode>& modes,
               ContactForces& result) {
  const int m = point.contacts();
  HeldRows rows(m);
  for (const int i : resting) {
    const auto mode = modes[static_cast<std::size_t>(i)];
    if (mode == ContactMode::open) continue;
    rows.columns(m + i, rows.hold(i)) = -point.friction[static_cast<std::size_t>(i)] * slip_sign(mode);
    if (mode == ContactMode::stick) rows.hold(m + i);
  }
  result.modes = modes;
  if (!rows.solve(point.influence, point.acceleration, result.forces)) return false;
  result.acceleration = point.acceleration + point.influence * result.forces;
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
