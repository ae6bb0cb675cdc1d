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
  const auto m = static_cast<Eigen::Index>(guards_.size());
  rows_.resize(m, kernel_.states());
  residual_.resize(m);
  normal_.resize(m, m);
  // The kernel's functions are the model's own ones; what they hold is a state of the run, which is its only user.
  auto done = const_cast<evaluation::ModelKernel&>(kernel_).hold(holds);
  if (!done) return done.error().message;
  return std::nullopt;
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

/// Values and gradients of the held guards in the continuous states; whether any is not 0.
bool Holding::find_positions(double t, const std::vector<double>& alpha, const std::vector<double>& x) {
  kernel_.functions(t, x.data(), alpha.data(), values_.data());
  bool away = false;
  for (std::size_t k = 0; k < guards_.size(); ++k) {
    const auto r = static_cast<Eigen::Index>(k);
    residual_[r] = values_[at(guards_[k].hold.function)];
    away = away || residual_[r] != 0.0;
  }
  if (!away) return false;
  for (std::size_t k = 0; k < guards_.size(); ++k) {
    double rate = 0.0;
    kernel_.gradient(guards_[k].hold.function, t, x.data(), alpha.data(), row_.data(), &rate);
    for (std::size_t i = 0; i < row_.size(); ++i) {
      rows_(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(i)) = system_.discrete_states[i] ? 0.0 : row_[i];
    }
  }
  return true;
}

/// The same for their rates, in the states that the jumps set.
bool Holding::find_rates(double t, const std::vector<double>& alpha, std::vector<double>& x) {
  bool away = false;
  for (std::size_t k = 0; k < guards_.size(); ++k) {
    const auto r = static_cast<Eigen::Index>(k);
    residual_[r] = kernel_.lie_derivative(guards_[k].hold.function, 1, t, x.data(), alpha.data());
    away = away || residual_[r] != 0.0;
  }
  if (!away) return false;
  for (std::size_t k = 0; k < guards_.size(); ++k) {
    static_cast<void>(find_rate_row(guards_[k].hold, t, alpha, x));
    for (std::size_t i = 0; i < row_.size(); ++i) {
      rows_(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(i)) = row_[i];
    }
  }
  return true;
}

/// x less the shortest vector that makes the residuals 0; returns whether x changed.
bool Holding::correct(std::vector<double>& x) {
  if (guards_.size() == 1) {
    residual_ /= rows_.squaredNorm();  // one division: a guard that is a coordinate becomes exactly 0
  } else {
    normal_.noalias() = rows_ * rows_.transpose();
    cholesky_.compute(normal_);
    if (cholesky_.info() != Eigen::Success) return false;
    cholesky_.solveInPlace(residual_);
  }
  if (!residual_.allFinite()) return false;
  bool moved = false;
  for (std::size_t i = 0; i < x.size(); ++i) {
    double correction = 0.0;
    for (Eigen::Index r = 0; r < residual_.size(); ++r) {
      correction += rows_(r, static_cast<Eigen::Index>(i)) * residual_[r];
    }
    const double next = x[i] - correction;
    moved = moved || next != x[i];
    x[i] = next;
  }
  return moved;
}

bool Holding::project(double t, const std::vector<double>& alpha, std::vector<double>& x) {
  if (guards_.empty()) return false;
  bool changed = false;
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
  for (const auto& guard : guards_) {
    const double rate = kernel_.lie_derivative(guard.hold.function, 1, t, x.data(), alpha.data());
    largest = std::isfinite(rate) ? std::max(largest, std::abs(rate)) : rate;
  }
  return largest;
}

}  // namespace saltus::event_integrator
