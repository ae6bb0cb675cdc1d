// Where two or more selections vary: Runge-Kutta steps with ends on the boundaries of zones, and the tests for rest.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>

#include "saltus/ode/bernstein.hpp"
#include "saltus/ode/step_control.hpp"
#include "saltus/switching/hidden_trajectory_internal.hpp"

namespace saltus::switching {
namespace {

/// Steps between two looks for a state of rest: each costs some of them, and says nothing on a long way.
constexpr int shortest_pause = 4;
constexpr int longest_pause = 32;
/// Relative to the largest velocity of a surface: below this a velocity is rounding.
constexpr double rounding = 1e-13;
/// Of selections: nearer to its bound a root is on it.
constexpr double edge = 1e-12;

std::size_t at(int j) { return static_cast<std::size_t>(j); }

}  // namespace

HiddenTrajectory::Status HiddenTrajectory::cross_interior() {
  const auto f = [this](double /*t*/, const double* u, double* v) { face_.velocity(u, v); };
  double fastest = 0.0;
  for (int j = 0; j < m_; ++j) fastest = std::max(fastest, face_.speed(j));
  if (!(fastest > 0.0)) return settle("no velocity depends on the selections", v_.data());
  double h = h_ > 0.0 ? h_ : 0.05 / fastest;
  h_ = 0.0;
  ode::StiffnessWatch watch;
  ode::StepControl control(stiff_ ? ode::Method::radau5 : options_.method);
  if (stiff_stepper_) stiff_stepper_->restart();
  int next_look = 0;
  int pause = shortest_pause;
  for (int steps = 0; used_ < options_.budget; ++steps, ++used_) {
    if (steps == next_look) {
      const Rest rest = look_for_rest();
      next_look += pause;
      pause = std::min(2 * pause, longest_pause);
      if (rest == Rest::settled) return settle("the hidden dynamics comes to rest: sliding", point_velocity_.data());
      if (rest == Rest::moved) return Status::goes_on;
    }
    auto& made = stiff_ ? stiff_stepper_ : stepper_;
    if (!made) made.emplace(stiff_ ? ode::Method::radau5 : options_.method, m_);
    ode::Stepper& stepper = *made;
    const double tolerance = tolerance_here();
    const ode::Tolerances tolerances{tolerance, tolerance};
    if (stepper.attempt(f, 0.0, u_.data(), v_.data(), h, tolerances) != ode::Attempt::finite) {
      h *= 0.25;
      continue;
    }
    if (stepper.error_norm() > 1.0) {
      h *= control.rejected(stepper.error_norm());
      continue;
    }
    const StepEvent event = first_event(stepper);
    const double* next = event.kind == StepEvent::Kind::none ? stepper.x_new() : point_.data();
    const double duration = event.theta * h;
    recurrence_.add_time(duration);
    for (int j = 0; j < m_; ++j) {
      recurrence_.add_selection(j, 0.5 * duration * (std::clamp(u_[at(j)], 0.0, 1.0) + std::clamp(next[j], 0.0, 1.0)));
      u_[at(j)] = next[j];
    }
    if (event.kind != StepEvent::Kind::none) {
      face_.velocity(u_.data(), v_.data());
      if (event.kind == StepEvent::Kind::boundary) return at_boundary(event.component);
      h_ = h * control.accepted(stepper.error_norm());
      return pass_section(static_cast<std::uint64_t>(2 * m_ + event.component));
    }
    std::copy_n(stepper.slope_new(), m_, v_.begin());
    h *= control.accepted(stepper.error_norm());
    if (!stiff_ && watch.looks_stiff(stepper)) {
      stiff_ = true;
      control = ode::StepControl(ode::Method::radau5);
    }
  }
  return Status::goes_on;
}

double HiddenTrajectory::tolerance_here() const {
  double distance = 0.0;
  for (int j = 0; j < m_; ++j) distance = std::max(distance, std::abs(u_[at(j)] - start_[at(j)]));
  return std::clamp(distance * options_.tolerance_away, options_.tolerance, options_.tolerance_away);
}

/// The first boundary or maximum within an accepted step, with point_ there.
HiddenTrajectory::StepEvent HiddenTrajectory::first_event(ode::Stepper& stepper) {
  const auto f = [this](double /*t*/, const double* u, double* v) { face_.velocity(u, v); };
  StepEvent event;
  bool is_dense = false;
  if (!stepper.bounds(low_.data(), high_.data())) {
    is_dense = stepper.dense(f, dense_) == ode::Attempt::finite;
    dense_.bounds(low_.data(), high_.data());
  }
  const auto may_cross = [&](int j) {
    const int z = zone_[at(j)];
    return z == 0 ? low_[at(j)] < 0.0 || high_[at(j)] > 1.0 : z < 0 ? high_[at(j)] > 0.0 : low_[at(j)] < 1.0;
  };
  const double* slope_new = stepper.slope_new();
  // Of two components that cycle within the square either one has maxima.
  const int only = m_ == 2 && face_.free().size() == 2 ? 0 : -1;
  const auto has_maximum = [&](int j) {
    return (only < 0 || j == only) && zone_[at(j)] == 0 && v_[at(j)] > 0.0 && slope_new[j] < 0.0 &&
           v_[at(j)] - slope_new[j] > 1e-7 * face_.speed(j);  // else it has come to rest
  };
  bool any = false;
  bool any_may_cross = false;
  for (int j = 0; j < m_; ++j) {
    any_may_cross = any_may_cross || may_cross(j);
    any = any || has_maximum(j);
  }
  if (!any && !any_may_cross) return event;
  if (!is_dense) stepper.dense(f, dense_);
  for (std::size_t node = 0; any_may_cross && node < ode::event_nodes; ++node) {
    dense_.evaluate(ode::interpolation_nodes()[node], samples_.data() + node * at(m_));
  }
  for (int j = 0; j < m_; ++j) {
    if (may_cross(j)) look_for_boundary(j, event);
  }
  for (int j = 0; j < m_; ++j) {
    if (has_maximum(j)) look_for_maximum(j, stepper, event);
  }
  if (event.kind == StepEvent::Kind::none) return event;
  dense_.evaluate(event.theta, point_.data());
  if (event.kind == StepEvent::Kind::boundary) {
    // at_boundary tells the ends of [0, 1] apart by where the component is.
    point_[at(event.component)] = point_[at(event.component)] > 0.5 ? 1.0 : 0.0;
  }
  return event;
}

void HiddenTrajectory::look_for_boundary(int j, StepEvent& event) {
  const int z = zone_[at(j)];
  for (const double limit : {0.0, 1.0}) {
    if ((z < 0 && limit > 0.0) || (z > 0 && limit < 1.0)) continue;
    // Positive on this side of the boundary.
    const double side = (limit == 0.0) == (z == 0) ? 1.0 : -1.0;
    std::array<double, ode::event_nodes> values{};
    for (std::size_t node = 0; node < values.size(); ++node) {
      values[node] = side * (samples_[node * at(m_) + at(j)] - limit);
    }
    const double noise = 1e-15 * (1.0 + std::abs(u_[at(j)]));
    const int zero_order = values[0] == 0.0 ? 1 : 0;
    const auto change = ode::first_sign_change(ode::to_bernstein(values), 1, zero_order, noise);
    if (change && change->upper < event.theta) event = {StepEvent::Kind::boundary, j, change->upper};
    if (change && change->upper == event.theta && event.kind != StepEvent::Kind::boundary) {
      event = {StepEvent::Kind::boundary, j, change->upper};
    }
  }
}

/// v_j passes from + to -: located on the velocity at the dense output, whose own derivative is less accurate. Regula
/// falsi with halved ends (Illinois); the end at which v_j is not positive any more.
void HiddenTrajectory::look_for_maximum(int j, const ode::Stepper& stepper, StepEvent& event) {
  constexpr double resolution = 0x1p-44;
  double low = 0.0;
  double high = 1.0;
  double at_low = v_[at(j)];
  double at_high = stepper.slope_new()[j];
  int kept = 0;  // > 0: the lower end was, < 0: the upper one
  for (int i = 0; i < 44 && high - low > resolution; ++i) {
    double middle = low + (high - low) * (at_low / (at_low - at_high));
    // At least a little beyond an end that is as good as the zero.
    middle = std::clamp(middle, low + 0.5 * resolution, high - 0.5 * resolution);
    dense_.evaluate(middle, point_.data());
    face_.velocity(point_.data(), point_velocity_.data());
    const double value = point_velocity_[at(j)];
    if (value > 0.0) {
      low = middle;
      at_low = value;
      if (kept < 0) at_high *= 0.5;
      kept = -1;
    } else {
      high = middle;
      at_high = value;
      if (kept > 0) at_low *= 0.5;
      kept = 1;
    }
    if (value == 0.0) break;
  }
  if (high < event.theta) event = {StepEvent::Kind::maximum, j, high};
}

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
  for (const int j : free) resting = resting && std::abs(v_[at(j)]) <= rounding * face_.speed(j);
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
    inside = inside && -edge < selection && selection < 1.0 + edge;
    at_edge = at_edge || !(edge < selection && selection < 1.0 - edge);
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
    const double certain = std::max(10.0 * influence, rounding * face_.speed(j));
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
