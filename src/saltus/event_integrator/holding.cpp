#include "saltus/event_integrator/holding.hpp"

#include <algorithm>
#include <cmath>

#include "saltus/event_integrator/small_internal.hpp"

namespace saltus::event_integrator {

Holding::Holding(const evaluation::ModelKernel& kernel, const model::System& system)
    : kernel_(kernel), system_(system), values_(at(kernel.event_functions())), row_(at(kernel.states())) {}

Holding::~Holding() { static_cast<void>(set({})); }

bool Holding::holds(int function) const {
  return std::any_of(guards_.begin(), guards_.end(),
                     [function](const HeldGuard& guard) { return guard.hold.function == function; });
}

std::optional<std::string> Holding::set(std::vector<HeldGuard> guards) {
  if (guards.empty() && guards_.empty()) return std::nullopt;
  std::vector<evaluation::Hold> holds;
  for (const auto& guard : guards) holds.push_back(guard.hold);
  guards_ = std::move(guards);
  // The kernel's functions are the model's own ones; what they hold is a state of the run, which is its only user.
  auto done = const_cast<evaluation::ModelKernel&>(kernel_).hold(holds);
  if (!done) return done.error().message;
  return std::nullopt;
}

bool Holding::put_on_zero(const HeldGuard& guard, double t, const std::vector<double>& alpha, std::vector<double>& x) {
  kernel_.functions(t, x.data(), alpha.data(), values_.data());
  const double value = values_[at(guard.hold.function)];
  if (value == 0.0 || !std::isfinite(value)) return false;
  double rate = 0.0;
  kernel_.gradient(guard.hold.function, t, x.data(), alpha.data(), row_.data(), &rate);
  double square = 0.0;
  for (std::size_t i = 0; i < row_.size(); ++i) {
    if (system_.discrete_states[i]) row_[i] = 0.0;
    square += row_[i] * row_[i];
  }
  if (!(square > 0.0 && std::isfinite(square))) return false;
  bool moved = false;
  for (std::size_t i = 0; i < row_.size(); ++i) {
    const double next = x[i] - value * row_[i] / square;
    moved = moved || next != x[i];
    x[i] = next;
  }
  return moved;
}

/// d (dg/dt) / dx in the states that the jump sets, in row_; returns its square.
double Holding::find_rate_row(const evaluation::Hold& hold, double t, const std::vector<double>& alpha,
                              std::vector<double>& x) {
  const auto rate_of = [&] { return kernel_.lie_derivative(hold.function, 1, t, x.data(), alpha.data()); };
  const double rate = rate_of();
  double square = 0.0;
  std::fill(row_.begin(), row_.end(), 0.0);
  for (const int target : system_.jumps[at(hold.jump)].targets) {
    // dg/dt is affine in velocities, or nearly: a difference over 2^-20 of the state is good to ten digits.
    const double kept = x[at(target)];
    x[at(target)] = kept + std::ldexp(std::exp2(std::ceil(std::log2(std::abs(kept) + 1.0))), -20);
    row_[at(target)] = (rate_of() - rate) / (x[at(target)] - kept);
    x[at(target)] = kept;
    square += row_[at(target)] * row_[at(target)];
  }
  return square;
}

bool Holding::can_rest(const evaluation::Hold& hold, double t, const std::vector<double>& alpha,
                       const std::vector<double>& x) {
  std::vector<double> point = x;
  const double square = find_rate_row(hold, t, alpha, point);
  return square > 0.0 && std::isfinite(square);
}

bool Holding::bring_to_rest(const HeldGuard& guard, double t, const std::vector<double>& alpha,
                            std::vector<double>& x) {
  const double rate = kernel_.lie_derivative(guard.hold.function, 1, t, x.data(), alpha.data());
  if (rate == 0.0 || !std::isfinite(rate)) return false;
  const double square = find_rate_row(guard.hold, t, alpha, x);
  if (!(square > 0.0 && std::isfinite(square))) return false;
  bool moved = false;
  for (const int target : system_.jumps[at(guard.hold.jump)].targets) {
    if (row_[at(target)] == 0.0) continue;
    const double next = x[at(target)] - rate * row_[at(target)] / square;
    moved = moved || next != x[at(target)];
    x[at(target)] = next;
  }
  return moved;
}

bool Holding::project(double t, const std::vector<double>& alpha, std::vector<double>& x) {
  bool changed = false;
  // Newton with a slope good to ten digits: the second step is at rounding, the others settle its last bits.
  for (int iteration = 0; iteration < 4; ++iteration) {
    bool moved = false;
    for (const auto& guard : guards_) {
      const bool placed = put_on_zero(guard, t, alpha, x);
      const bool rested = bring_to_rest(guard, t, alpha, x);
      moved = moved || placed || rested;
    }
    changed = changed || moved;
    if (!moved) break;
  }
  return changed;
}

double Holding::largest_rate(double t, const std::vector<double>& alpha, const std::vector<double>& x) const {
  double largest = 0.0;
  for (const auto& guard : guards_) {
    const double rate = kernel_.lie_derivative(guard.hold.function, 1, t, x.data(), alpha.data());
    largest = std::isfinite(rate) ? std::max(largest, std::abs(rate)) : rate;
  }
  return largest;
}

}  // namespace saltus::event_integrator
