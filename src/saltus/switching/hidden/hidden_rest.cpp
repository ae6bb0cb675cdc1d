// Where two or more selections vary: the tests for rest, and the roots at which or about which it is.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "saltus/base/at.hpp"
#include "saltus/switching/hidden/hidden_trajectory_internal.hpp"

namespace saltus::switching {
namespace {

/// Relative to the largest velocity of a surface: below this a velocity is rounding.
constexpr double rounding_of_velocity = 1e-13;
/// Of selections: nearer to its bound a root is on it.
constexpr double at_bound = 1e-12;

}  // namespace

bool HiddenTrajectory::is_resting() const {
  const auto& free = face_.free();
  return std::all_of(free.begin(), free.end(),
                     [&](int j) { return std::abs(v_[at(j)]) <= rounding_of_velocity * face_.speed(j); });
}

/// The root near the current point, into rest_; nullopt where it is not in the zone, or not stable near by.
std::optional<HiddenTrajectory::RootPlace> HiddenTrajectory::find_root(bool resting) {
  const auto& free = face_.free();
  const std::size_t n = free.size();
  face_.derivatives(u_.data(), v_.data(), derivatives_.data());
  std::vector<double>& here = rest_.jacobian_here();
  here.resize(n * n);
  for (std::size_t i = 0; i < n; ++i) {
    std::copy_n(derivatives_.begin() + static_cast<std::ptrdiff_t>(at(free[i]) * n), n,
                here.begin() + static_cast<std::ptrdiff_t>(i * n));
  }
  // Where J is not stable here, it is not by that margin at a root near by.
  if (!resting && !is_hurwitz(std::span(here), static_cast<int>(n))) return std::nullopt;
  if (!rest_.find(u_)) return std::nullopt;
  // A root on the edge of the zone is one of its points: what crosses the edge there is rounding.
  auto place = RootPlace::inside;
  for (const int j : free) {
    double& selection = rest_.root()[at(j)];
    if (!(-at_bound < selection && selection < 1.0 + at_bound)) return std::nullopt;
    if (!(at_bound < selection && selection < 1.0 - at_bound)) place = RootPlace::at_edge;
    selection = std::clamp(selection, 0.0, 1.0);
  }
  return rest_.attracts() ? std::optional(place) : std::nullopt;
}

/// Which saturated component comes back first while the free ones rest at the root; nullopt where it is too far away to
/// say that.
std::optional<HiddenTrajectory::Return> HiddenTrajectory::first_return() const {
  const auto& free = face_.free();
  const std::size_t n = free.size();
  double distance = 0.0;
  for (const int j : free) distance = std::max(distance, std::abs(rest_.root()[at(j)] - u_[at(j)]));
  Return first;
  for (int j = 0; j < m_; ++j) {
    const int z = zone_[at(j)];
    if (z == 0) continue;
    double influence = 0.0;
    for (std::size_t p = 0; p < n; ++p) {
      influence += std::abs(rest_.derivatives()[at(j) * n + p] * (rest_.root()[at(free[p])] - u_[at(free[p])]));
    }
    const double outwards = z * rest_.velocity()[at(j)];
    const double certain = std::max(10.0 * influence, rounding_of_velocity * face_.speed(j));
    if (outwards > certain) continue;
    if (distance > 1e-11) return std::nullopt;
    if (outwards >= -certain) continue;  // marginal, which settle() says
    const double t = std::abs(u_[at(j)] - boundary(j)) / -outwards;
    if (t < first.time) first = {j, t};
  }
  return first;
}

/// The free components rest while the others move on at constant velocities until the first is back.
void HiddenTrajectory::rest_until(const Return& first) {
  recurrence_.add_time(first.time);
  for (int j = 0; j < m_; ++j) {
    recurrence_.add_selection(j, first.time * std::clamp(u_[at(j)], 0.0, 1.0));
    if (zone_[at(j)] != 0) u_[at(j)] += first.time * rest_.velocity()[at(j)];
  }
  u_[at(first.component)] = boundary(first.component);
  zone_[at(first.component)] = 0;
}

/// Is the current point so close to a stable state of rest of the free components that it must end there? They decay if
/// RestPoint::attracts(), and saturated components keep going outwards if their final velocities exceed ten times what
/// the distance changes in them.
HiddenTrajectory::Rest HiddenTrajectory::look_for_rest() {
  const bool resting = is_resting();
  const auto place = find_root(resting);
  if (!place) {
    if (!resting) return Rest::none;
    perturb();
    return Rest::moved;
  }
  const auto first = first_return();
  if (!first) return Rest::none;
  for (const int j : face_.free()) u_[at(j)] = rest_.root()[at(j)];
  if (first->component < 0) {
    end_.marginal = end_.marginal || *place == RootPlace::at_edge;
    return Rest::settled;
  }
  rest_until(*first);
  return Rest::moved;
}

bool HiddenTrajectory::rests_near(const std::vector<double>& u) {
  constexpr double near = 0.01;
  face_.enter(std::vector<int>(u.size(), 0));
  if (!rest_.find(u)) return false;
  const auto& root = rest_.root();
  for (std::size_t j = 0; j < u.size(); ++j) {
    if (!(0.0 < root[j] && root[j] < 1.0 && std::abs(root[j] - u[j]) < near)) return false;
  }
  return !is_hurwitz(rest_.jacobian(), m_);
}

/// The root that a limit cycle surrounds: with a stabilising scaling if there is one, the nearest to the mean over a
/// turn. Returns false if there is none, which needs three surfaces (in the plane a cycle has a root inside).
bool HiddenTrajectory::enclosed_root(const Turn& turn) {
  face_.enter(turn.side);
  const auto& free = face_.free();
  const std::size_t n = free.size();
  std::vector<double> start(at(m_));
  for (int j = 0; j < m_; ++j) start[at(j)] = turn.side[at(j)] > 0 ? 1.0 : 0.0;
  for (const int j : free) start[at(j)] = turn.mean[at(j)];
  double nearest = infinite;
  const auto consider = [&] {
    if (!rest_.find(start)) return;
    const auto& root = rest_.root();
    double distance = 0.0;
    for (const int j : free) {
      if (!(0.0 < root[at(j)] && root[at(j)] < 1.0)) return;
      distance = std::max(distance, std::abs(root[at(j)] - turn.mean[at(j)]));
    }
    // Distances in the cube are below 1: any root with a stabilising scaling comes before those without.
    if (!(fisher_fuller_margin(rest_.jacobian(), static_cast<int>(n)) > 0.0)) distance += 1.0;
    if (distance >= nearest) return;
    nearest = distance;
    for (const int j : free) end_.alpha[at(j)] = root[at(j)];
  };
  end_.alpha = start;
  consider();
  if (nearest < 1.0) return true;
  std::size_t grid = 1;
  for (std::size_t i = 0; i < std::min<std::size_t>(n, 4); ++i) grid *= 5;
  for (std::size_t point = 0; point < grid; ++point) {
    std::size_t digits = point;
    for (std::size_t i = 0; i < std::min<std::size_t>(n, 4); ++i, digits /= 5) {
      start[at(free[i])] = 0.1 + 0.2 * static_cast<double>(digits % 5);
    }
    consider();
  }
  end_.marginal = end_.marginal || !(nearest < 1.0);
  return std::isfinite(nearest);
}

}  // namespace saltus::switching
