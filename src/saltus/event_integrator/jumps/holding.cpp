#include "saltus/event_integrator/jumps/holding.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include <fmt/format.h>

#include "saltus/base/without_repeats.hpp"
#include "saltus/event_integrator/jumps/jumps.hpp"
#include "saltus/event_integrator/mode/small_internal.hpp"

namespace saltus::event_integrator {

bool HeldGuards::holds(int function) const {
  const auto is_it = [function](const HeldGuard& guard) { return guard.hold.function == function; };
  return std::any_of(guards.begin(), guards.end(), is_it) || std::any_of(followers.begin(), followers.end(), is_it);
}

std::vector<HeldGuard> HeldGuards::all() const {
  std::vector<HeldGuard> both = guards;
  both.insert(both.end(), followers.begin(), followers.end());
  return both;
}

Holding::Holding(evaluation::ModelKernel& kernel)
    : kernel_(kernel), layout_(kernel.layout()), values_(at(kernel.event_functions())), row_(at(kernel.states())) {}

Holding::~Holding() { release_all(); }

void Holding::release_all() {
  if (held_.empty()) return;
  held_ = {};
  static_cast<void>(kernel_.hold({}));
}

double Holding::second_derivative(const HeldGuard& guard, double t, const std::vector<double>& alpha,
                                  const std::vector<double>& x) const {
  return kernel_.lie_derivative(guard.hold.function, 2, t, x.data(), alpha.data());
}

std::optional<std::string> Holding::hold(std::vector<HeldGuard> guards, std::vector<HeldGuard> loose, double t,
                                         const std::vector<double>& alpha, std::vector<double>& x) {
  release_all();
  absorbing_.clear();
  basis_.clear();
  for (const auto* list : {&guards, &loose}) {
    for (const auto& guard : *list) {
      const auto& targets = layout_.jumps[at(guard.hold.jump)].targets;
      absorbing_.insert(absorbing_.end(), targets.begin(), targets.end());
      pressing_ = std::max(pressing_, std::abs(second_derivative(guard, t, alpha, x)));
    }
  }
  drop_repeats(absorbing_);
  // Guards whose own jumps hold them come first: the others may be left to follow.
  std::stable_partition(guards.begin(), guards.end(),
                        [&](const HeldGuard& guard) { return can_rest(guard, t, alpha, x); });
  for (const auto& guard : guards) {
    auto& list = is_independent(guard, t, alpha, x) ? held_.guards : loose;
    list.push_back(guard);
  }
  if (auto problem = set(t, alpha, x)) return problem;
  for (std::size_t k = 0; k < loose.size();) {
    const double second = second_derivative(loose[k], t, alpha, x);
    const bool still = std::abs(second) <= 1e-9 * pressing_;
    const bool pressed = !still && second * loose[k].inward > 0.0;
    const std::size_t dimension = basis_.size();
    const bool independent = (still || pressed) && is_independent(loose[k], t, alpha, x);
    if (still && !independent) held_.followers.push_back(loose[k]);
    if (pressed && !independent) return "their guards press on each other and cannot be held at rest together";
    if (!pressed || !can_rest(loose[k], t, alpha, x)) {
      basis_.resize(dimension);
      ++k;
      continue;
    }
    held_.guards.push_back(loose[k]);
    loose.erase(loose.begin() + static_cast<std::ptrdiff_t>(k));
    loose.insert(loose.end(), held_.followers.begin(), held_.followers.end());
    held_.followers.clear();
    if (auto problem = set(t, alpha, x)) return problem;
    k = 0;
  }
  return std::nullopt;
}

/// Whether the rate of a guard does not depend on those in the basis, in the states that the jumps set; it is in the
/// basis then.
bool Holding::is_independent(const HeldGuard& guard, double t, const std::vector<double>& alpha,
                             std::vector<double>& x) {
  const double square = find_rate_row(guard.hold, absorbing_, t, alpha, x);
  if (!(square > 0.0)) return false;
  std::vector<double> rest = row_;
  for (const auto& direction : basis_) {
    double part = 0.0;
    for (std::size_t i = 0; i < rest.size(); ++i) part += rest[i] * direction[i];
    for (std::size_t i = 0; i < rest.size(); ++i) rest[i] -= part * direction[i];
  }
  double rest_square = 0.0;
  for (const double entry : rest) rest_square += entry * entry;
  // Rows are good to about ten digits.
  if (!(rest_square > 1e-12 * square)) return false;
  for (double& entry : rest) entry /= std::sqrt(rest_square);
  basis_.push_back(std::move(rest));
  return true;
}

std::vector<evaluation::Hold> Holding::holds() const {
  std::vector<evaluation::Hold> holds;
  for (const auto& guard : held_.guards) holds.push_back(guard.hold);
  return holds;
}

std::vector<double> Holding::free_field(double t, const std::vector<double>& alpha,
                                        const std::vector<double>& x) const {
  std::vector<double> f(x.size());
  static_cast<void>(kernel_.hold({}));
  kernel_.field(t, x.data(), alpha.data(), f.data());
  // Known to the kernel already: this does not fail.
  static_cast<void>(kernel_.hold(holds()));
  return f;
}

void Holding::resize_rows() {
  const auto m = static_cast<linalg::Index>(held_.guards.size());
  rows_.resize(m, kernel_.states());
  residual_.resize(m);
  normal_.resize(m, m);
}

bool Holding::put(const std::vector<HeldGuard>& guards) {
  release_all();
  if (guards.empty()) return true;
  held_.guards = guards;
  resize_rows();
  return kernel_.hold(holds()).has_value();
}

/// The kernel holds guards(), and x is there.
std::optional<std::string> Holding::set(double t, const std::vector<double>& alpha, std::vector<double>& x) {
  resize_rows();
  if (auto problem = moves_what_is_compared(t, alpha, x)) return problem;
  auto done = kernel_.hold(holds());
  if (!done) return done.error().message;
  static_cast<void>(project(t, alpha, x));
  return std::nullopt;
}

/// A state of rate 0 is discrete: comparisons of it are read at jumps only. While it holds a guard it moves.
std::optional<std::string> Holding::moves_what_is_compared(double t, const std::vector<double>& alpha,
                                                           std::vector<double>& x) {
  for (const auto& guard : held_.guards) {
    static_cast<void>(find_rate_row(guard.hold, layout_.jumps[at(guard.hold.jump)].targets, t, alpha, x));
    for (std::size_t i = 0; i < row_.size(); ++i) {
      if (row_[i] == 0.0 || !layout_.discrete_states[i]) continue;
      const auto compared = compared_at_jumps_only(layout_, static_cast<int>(i));
      if (!compared) continue;
      return fmt::format(
          "the state '{}' would have to move to hold the guard of '{}' at 0, but its right-hand side is 0, so '{}' is "
          "read at jumps only: give the state a parameter of value 0 as its right-hand side",
          layout_.state_names[i], layout_.jumps[at(guard.hold.jump)].name, *compared);
    }
  }
  return std::nullopt;
}

/// d (dg/dt) / dx in some states, in row_; returns its square.
double Holding::find_rate_row(const evaluation::Hold& hold, const std::vector<int>& states, double t,
                              const std::vector<double>& alpha, std::vector<double>& x) {
  const auto rate_of = [&] { return kernel_.lie_derivative(hold.function, 1, t, x.data(), alpha.data()); };
  const double rate = rate_of();
  double square = 0.0;
  std::fill(row_.begin(), row_.end(), 0.0);
  for (const int target : states) {
    // dg/dt is affine in velocities, or nearly: a difference over 2^-20 of the state is good to ten digits.
    const double kept = x[at(target)];
    x[at(target)] = kept + std::ldexp(std::exp2(std::ceil(std::log2(std::abs(kept) + 1.0))), -20);
    row_[at(target)] = (rate_of() - rate) / (x[at(target)] - kept);
    x[at(target)] = kept;
    square += row_[at(target)] * row_[at(target)];
  }
  return square;
}

bool Holding::can_rest(const HeldGuard& guard, double t, const std::vector<double>& alpha,
                       const std::vector<double>& x) {
  std::vector<double> point = x;
  const auto& targets = layout_.jumps[at(guard.hold.jump)].targets;
  const double square = find_rate_row(guard.hold, targets, t, alpha, point);
  return square > 0.0 && std::isfinite(square) && !lets_go_on(guard, square, t, alpha, std::move(point));
}

/// Whether a motion inward, as slow as the differences in row_ resolve, goes on behind the jump.
bool Holding::lets_go_on(const HeldGuard& guard, double square, double t, const std::vector<double>& alpha,
                         std::vector<double> point) const {
  const auto& targets = layout_.jumps[at(guard.hold.jump)].targets;
  const auto rate_of = [&] { return kernel_.lie_derivative(guard.hold.function, 1, t, point.data(), alpha.data()); };
  double size = 1.0;
  for (const int target : targets) size = std::max(size, std::abs(point[at(target)]));
  const double step = std::ldexp(size, -20) * guard.inward / std::sqrt(square);
  const double rest = rate_of();
  for (const int target : targets) point[at(target)] += step * row_[at(target)];
  const double moved = rate_of() - rest;
  std::vector<double> values(targets.size());
  kernel_.jump_values(guard.hold.jump, t, point.data(), alpha.data(), values.data());
  for (std::size_t i = 0; i < targets.size(); ++i) point[at(targets[i])] = values[i];
  // Differences are good to ten digits: a stop leaves less than a thousandth.
  return (rate_of() - rest) * guard.inward > 1e-3 * std::abs(moved);
}

/// Values and gradients of the held guards in the continuous states; whether any is not 0.
bool Holding::find_positions(double t, const std::vector<double>& alpha, const std::vector<double>& x) {
  kernel_.functions(t, x.data(), alpha.data(), values_.data());
  bool away = false;
  for (std::size_t k = 0; k < held_.guards.size(); ++k) {
    const auto r = static_cast<linalg::Index>(k);
    residual_[r] = values_[at(held_.guards[k].hold.function)];
    away = away || residual_[r] != 0.0;
  }
  if (!away) return false;
  for (std::size_t k = 0; k < held_.guards.size(); ++k) {
    double rate = 0.0;
    kernel_.gradient(held_.guards[k].hold.function, t, x.data(), alpha.data(), row_.data(), &rate);
    for (std::size_t i = 0; i < row_.size(); ++i) {
      rows_(static_cast<linalg::Index>(k), static_cast<linalg::Index>(i)) = layout_.discrete_states[i] ? 0.0 : row_[i];
    }
  }
  return true;
}

/// The same for their rates, in the states that the jumps set.
bool Holding::find_rates(double t, const std::vector<double>& alpha, std::vector<double>& x) {
  bool away = false;
  for (std::size_t k = 0; k < held_.guards.size(); ++k) {
    const auto r = static_cast<linalg::Index>(k);
    residual_[r] = kernel_.lie_derivative(held_.guards[k].hold.function, 1, t, x.data(), alpha.data());
    away = away || residual_[r] != 0.0;
  }
  if (!away) return false;
  for (std::size_t k = 0; k < held_.guards.size(); ++k) {
    const auto& targets = layout_.jumps[at(held_.guards[k].hold.jump)].targets;
    static_cast<void>(find_rate_row(held_.guards[k].hold, targets, t, alpha, x));
    for (std::size_t i = 0; i < row_.size(); ++i) {
      rows_(static_cast<linalg::Index>(k), static_cast<linalg::Index>(i)) = row_[i];
    }
  }
  return true;
}

/// x less the shortest vector that makes the residuals 0; returns whether x changed.
bool Holding::correct(std::vector<double>& x) {
  if (held_.guards.size() == 1) {
    residual_ /= rows_.squared_norm();  // one division: a guard that is a coordinate becomes exactly 0
  } else {
    linalg::multiply(rows_, rows_.transpose(), normal_);
    cholesky_.compute(normal_);
    if (!cholesky_.is_positive()) return false;
    cholesky_.solve_in_place(residual_);
  }
  if (!residual_.all_finite()) return false;
  bool moved = false;
  for (std::size_t i = 0; i < x.size(); ++i) {
    double correction = 0.0;
    for (linalg::Index r = 0; r < residual_.size(); ++r) {
      correction += rows_(r, static_cast<linalg::Index>(i)) * residual_[r];
    }
    const double next = x[i] - correction;
    moved = moved || next != x[i];
    x[i] = next;
  }
  return moved;
}

bool Holding::project(double t, const std::vector<double>& alpha, std::vector<double>& x) {
  bool changed = contacts_ != nullptr && contacts_->project(t, alpha, x);
  if (held_.guards.empty()) return changed;
  // Newton with a slope good to ten digits: the second step is at rounding, the others settle its last bits.
  for (int iteration = 0; iteration < 4; ++iteration) {
    const bool placed = find_positions(t, alpha, x) && correct(x);
    const bool rested = find_rates(t, alpha, x) && correct(x);
    changed = changed || placed || rested;
    if (!placed && !rested) break;
  }
  return changed;
}

double Holding::largest_rate(double t, const std::vector<double>& alpha, const std::vector<double>& x) const {
  double largest = 0.0;
  const auto note = [&](int function, const std::vector<double>& point) {
    const double rate = kernel_.lie_derivative(function, 1, t, point.data(), alpha.data());
    largest = std::isfinite(rate) ? std::max(largest, std::abs(rate)) : rate;
  };
  for (const auto& guard : held_.all()) {
    note(guard.hold.function, x);
    const auto& targets = layout_.jumps[at(guard.hold.jump)].targets;
    std::vector<double> behind = x, values(targets.size());
    kernel_.jump_values(guard.hold.jump, t, x.data(), alpha.data(), values.data());
    for (std::size_t i = 0; i < targets.size(); ++i) behind[at(targets[i])] = values[i];
    note(guard.hold.function, behind);
  }
  return largest;
}

}  // namespace saltus::event_integrator
