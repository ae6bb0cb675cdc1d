#include <fmt/format.h>

#include "saltus/base/at.hpp"
#include "saltus/evaluation/held_motion_internal.hpp"

namespace saltus::evaluation {
namespace {

using casadi::SX;

Error cannot_hold(const std::string& why) {
  return {ErrorCode::invalid_model,
          why,
          "state what happens behind the limit by another jump or mode, e.g. a jump that ends the motion",
          {},
          {}};
}

/// Whether a matrix has no entry that can be other than 0.
bool vanishes(const SX& matrix) { return SX::sparsify(matrix).nnz() == 0; }

class HeldMotionSearch {
 public:
  HeldMotionSearch(const SX& t, const SX& x, const SX& f, const std::vector<HeldGuard>& guards)
      : t_(t), x_(x), f_(f), guards_(guards) {}

  [[nodiscard]] Expected<HeldMotion> run() {
    std::vector<SX> rates, second, directions;
    for (const auto& held : guards_) {
      const SX rate = along_f(held.guard);
      const SX normal = SX::jacobian(rate, x_);
      auto direction = absorbed(held, normal);
      if (!direction) return tl::unexpected(direction.error());
      rates.push_back(normal);
      second.push_back(along_f(rate));
      directions.push_back(*direction);
    }
    const SX all = SX::horzcat(directions);
    for (const auto& held : guards_) {
      if (!vanishes(SX::mtimes(SX::jacobian(held.guard, x_), all))) {
        return tl::unexpected(cannot_hold(
            fmt::format("the jumps accumulate at the guard of '{}', which depends on the states that absorb its motion",
                        held.jump)));
      }
    }
    const SX matrix = SX::sparsify(SX::mtimes(SX::vertcat(rates), all));
    if (SX::sprank(matrix) < static_cast<casadi_int>(guards_.size())) {
      return tl::unexpected(
          cannot_hold("the jumps accumulate, but the states they set cannot hold all their guards at 0"));
    }
    const SX mu = SX::solve(matrix, -SX::vertcat(second));
    return HeldMotion{f_ + SX::mtimes(all, mu), -SX::diag(SX::densify(matrix)) * mu};
  }

 private:
  [[nodiscard]] SX along_f(const SX& e) const { return SX::mtimes(SX::jacobian(e, x_), f_) + SX::jacobian(e, t_); }

  /// A state that moves does. So does one of rate 0 that is in the guard's rate: the velocity of a free ball, as
  /// opposed to a counter of its impacts.
  [[nodiscard]] bool absorbs(const HeldGuard& held, int state, const SX& normal) const {
    return !held.discrete_states[at(state)] || !vanishes(normal(0, state));
  }

  /// d_k, a column of n_x.
  [[nodiscard]] Expected<SX> absorbed(const HeldGuard& held, const SX& normal) const {
    const SX all_changes = SX::sparsify(SX::jacobian(held.values, x_));
    std::vector<casadi_int> states, rows;
    for (casadi_int i = 0; i < all_changes.size1(); ++i) {
      const int state = held.targets[at(i)];
      if (!absorbs(held, state, normal)) continue;
      states.push_back(state);
      rows.push_back(i);
    }
    SX direction = SX::zeros(x_.numel(), 1);
    if (!states.empty()) {
      const SX weights = normal(casadi::Slice(0), states).T();
      const SX change = all_changes(rows, states) - SX::eye(static_cast<casadi_int>(states.size()));
      direction(states) = SX::mtimes(change, weights);
    }
    if (!vanishes(SX::mtimes(normal, direction))) return direction;
    return tl::unexpected(cannot_hold(
        fmt::format("the jumps accumulate at the guard of '{}', but the states it sets do not change the guard's rate",
                    held.jump)));
  }

  const SX& t_;
  const SX& x_;
  const SX& f_;
  const std::vector<HeldGuard>& guards_;
};

}  // namespace

Expected<HeldMotion> held_motion(const SX& t, const SX& x, const SX& f, const std::vector<HeldGuard>& guards) {
  return HeldMotionSearch(t, x, f, guards).run();
}

}  // namespace saltus::evaluation
