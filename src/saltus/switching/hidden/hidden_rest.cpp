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

/// Newton's method on the free components of the current zone: u becomes a point where they rest, v of all components
/// there is in point_velocity_, its derivatives in derivatives_, the square part in matrix_.
bool HiddenTrajectory::polish_rest(double* u) {
  const auto& free = face_.free();
  const std::size_t n = free.size();
  LuFactors lu(static_cast<int>(n));
  double size = 0.0;
  for (int k = 0; k < 12; ++k) {
    face_.velocity(u, point_velocity_.data());
    face_.derivatives(u, point_velocity_.data(), derivatives_.data());
    for (std::size_t i = 0; i < n; ++i) {
      step_[i] = point_velocity_[at(free[i])];
      std::copy_n(derivatives_.begin() + static_cast<std::ptrdiff_t>(at(free[i]) * n), n,
                  matrix_.begin() + static_cast<std::ptrdiff_t>(i * n));
    }
    if (!lu.factor(std::span(matrix_).first(n * n))) return false;
    lu.solve(step_.data());
    size = 0.0;
    for (std::size_t i = 0; i < n; ++i) size = std::max(size, std::abs(step_[i]));
    if (!(size < 0.25)) return false;
    if (size < 1e-14) return true;
    for (std::size_t i = 0; i < n; ++i) u[free[i]] -= step_[i];
  }
  return size < 1e-10;
}

/// Is the current point so close to a stable state of rest of the free components that it must end there?
///
/// With e = root - u and the Jacobian J at the root, e' = (J + D) e where |D| is at most the change of J over e. It
/// decays if J + 10 |D| I is stable, and saturated components keep going outwards if their final velocities exceed ten
/// times what e changes in them. The factor 10 stands for the non-normality of J.
HiddenTrajectory::Rest HiddenTrajectory::look_for_rest() {
  const auto& free = face_.free();
  const std::size_t n = free.size();
  bool resting = true;
  for (const int j : free) resting = resting && std::abs(v_[at(j)]) <= rounding_of_velocity * face_.speed(j);
  face_.derivatives(u_.data(), v_.data(), derivatives_.data());
  jacobian_here_.resize(n * n);
  for (std::size_t i = 0; i < n; ++i) {
    std::copy_n(derivatives_.begin() + static_cast<std::ptrdiff_t>(at(free[i]) * n), n,
                jacobian_here_.begin() + static_cast<std::ptrdiff_t>(i * n));
  }
  // Where J is not stable here, it is not by that margin at a root near by.
  const bool may_settle = resting || is_hurwitz(std::span(jacobian_here_), static_cast<int>(n));
  root_ = u_;
  const bool found = may_settle && polish_rest(root_.data());
  // A root on the edge of the zone is one of its points: what crosses the edge there is rounding.
  bool inside = found;
  bool at_edge = false;
  for (const int j : free) {
    double& selection = root_[at(j)];
    inside = inside && -at_bound < selection && selection < 1.0 + at_bound;
    at_edge = at_edge || !(at_bound < selection && selection < 1.0 - at_bound);
    if (inside) selection = std::clamp(selection, 0.0, 1.0);
  }
  if (!inside) {
    if (!resting) return Rest::none;
    perturb();
    return Rest::moved;
  }
  double change = 0.0;
  for (std::size_t i = 0; i < n * n; ++i) change += (matrix_[i] - jacobian_here_[i]) * (matrix_[i] - jacobian_here_[i]);
  const double shift = 10.0 * std::sqrt(change);
  for (std::size_t i = 0; i < n; ++i) matrix_[i * n + i] += shift;
  if (!is_hurwitz(std::span(matrix_).first(n * n), static_cast<int>(n))) {
    if (!resting) return Rest::none;
    perturb();
    return Rest::moved;
  }
  double distance = 0.0;
  for (const int j : free) distance = std::max(distance, std::abs(root_[at(j)] - u_[at(j)]));
  double returns = infinite;
  int first = -1;
  for (int j = 0; j < m_; ++j) {
    const int z = zone_[at(j)];
    if (z == 0) continue;
    double influence = 0.0;
    for (std::size_t p = 0; p < n; ++p) {
      influence += std::abs(derivatives_[at(j) * n + p] * (root_[at(free[p])] - u_[at(free[p])]));
    }
    const double outwards = z * point_velocity_[at(j)];
    const double certain = std::max(10.0 * influence, rounding_of_velocity * face_.speed(j));
    if (outwards > certain) continue;
    if (distance > 1e-11) return Rest::none;
    if (outwards >= -certain) continue;  // marginal, which settle() says
    const double t = std::abs(u_[at(j)] - boundary(j)) / -outwards;
    if (t < returns) {
      returns = t;
      first = j;
    }
  }
  for (const int j : free) u_[at(j)] = root_[at(j)];
  if (first < 0) {
    end_.marginal = end_.marginal || at_edge;
    return Rest::settled;
  }
  // The free components rest while the others move on at constant velocities until the first is back.
  recurrence_.add_time(returns);
  for (int j = 0; j < m_; ++j) {
    recurrence_.add_selection(j, returns * std::clamp(u_[at(j)], 0.0, 1.0));
    if (zone_[at(j)] != 0) u_[at(j)] += returns * point_velocity_[at(j)];
  }
  u_[at(first)] = boundary(first);
  zone_[at(first)] = 0;
  return Rest::moved;
}

bool HiddenTrajectory::rests_near(const std::vector<double>& u) {
  constexpr double near = 0.01;
  face_.enter(std::vector<int>(u.size(), 0));
  root_ = u;
  if (!polish_rest(root_.data())) return false;
  for (std::size_t j = 0; j < u.size(); ++j) {
    if (!(0.0 < root_[j] && root_[j] < 1.0 && std::abs(root_[j] - u[j]) < near)) return false;
  }
  return !is_hurwitz(matrix_, m_);
}

/// The root that a cycle surrounds: with a stabilising scaling if there is one, the nearest to the mean over the lap.
/// Returns false if there is none, which needs three surfaces (in the plane a cycle has a root inside).
bool HiddenTrajectory::enclosed_root(const Lap& lap) {
  face_.enter(lap.side);
  const auto& free = face_.free();
  const std::size_t n = free.size();
  std::vector<double> start(at(m_));
  for (int j = 0; j < m_; ++j) start[at(j)] = lap.side[at(j)] > 0 ? 1.0 : 0.0;
  for (const int j : free) start[at(j)] = lap.mean[at(j)];
  double nearest = infinite;
  const auto consider = [&] {
    root_ = start;
    if (!polish_rest(root_.data())) return;
    double distance = 0.0;
    for (const int j : free) {
      if (!(0.0 < root_[at(j)] && root_[at(j)] < 1.0)) return;
      distance = std::max(distance, std::abs(root_[at(j)] - lap.mean[at(j)]));
    }
    // Distances in the cube are below 1: any root with a stabilising scaling comes before those without.
    if (!(fisher_fuller_margin(std::span(matrix_).first(n * n), static_cast<int>(n)) > 0.0)) distance += 1.0;
    if (distance >= nearest) return;
    nearest = distance;
    for (const int j : free) end_.alpha[at(j)] = root_[at(j)];
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
