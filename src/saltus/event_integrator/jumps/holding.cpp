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
  constexpr double dependent = 1e-6;  // rows are good to about ten digits
  basis_ = {index(row_.size()), index(guards.size() + loose.size()), dependent};
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
    const linalg::Index dimension = basis_.size();
    const bool independent = (still || pressed) && is_independent(loose[k], t, alpha, x);
    if (still && !independent) held_.followers.push_back(loose[k]);
    if (pressed && !independent) return "their guards press on each other and cannot be held at rest together";
    if (!pressed || !can_rest(loose[k], t, alpha, x)) {
      basis_.shrink(dimension);
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
  static_cast<void>(find_rate_row(guard.hold, absorbing_, t, alpha, x));
  return basis_.takes({row_.data(), index(row_.size())});
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
  rows_.resize(held_.guards.size(), row_.size());
  residual_.resize(index(held_.guards.size()));
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
      if (layout_.discrete_states[i]) row_[i] = 0.0;
    }
    rows_.set(k, row_);
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
    rows_.set(k, row_);
  }
  return true;
}

bool Holding::project(double t, const std::vector<double>& alpha, std::vector<double>& x) {
  bool changed = contacts_ != nullptr && contacts_->project(t, alpha, x);
  if (held_.guards.empty()) return changed;
  // Newton with a slope good to ten digits: the second step is at rounding, the others settle its last bits.
  for (int iteration = 0; iteration < 4; ++iteration) {
    const bool placed = find_positions(t, alpha, x) && rows_.correct(residual_, x.data());
    const bool rested = find_rates(t, alpha, x) && rows_.correct(residual_, x.data());
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
