// The normal directions of the sliding surfaces: what of a motion, or of a state, is removed along them.
#include <algorithm>
#include <cmath>

#include "saltus/event_integrator/field/mode_field.hpp"
#include "saltus/event_integrator/mode/small_internal.hpp"

namespace saltus::event_integrator {

/// The gradient in f_[0].
void ModeField::take_row(std::size_t row) {
  const int j = sliding_[row];
  rows_.take(row, at(j), f_[0], kernel_.is_affine(j) && kernel_.inner(j).empty(), kernel_.has_fixed_constants());
}

/// Towards the zero of a root motions vanish that are differences of terms of the size of the jump: what rounding of
/// the selection has left of psi' is taken from the states that it moves, not from those of the root.
void ModeField::balance_beside_roots(double t, const double* x) {
  jump_.resize(f_[0].size());
  for (const std::size_t row : rooted_rows_) {
    trial_ = alpha_;
    for (const double side : {0.0, 1.0}) {
      trial_[at(sliding_[row])] = side;
      kernel_.field(t, x, trial_.data(), (side == 0.0 ? jump_ : f_[1]).data());
    }
    for (std::size_t i = 0; i < jump_.size(); ++i) jump_[i] = f_[1][i] - jump_[i];
    const double factor = rows_.velocity(row, f_[0]) / (exits_[row].above - exits_[row].below);
    for (std::size_t i = 0; i < jump_.size(); ++i) f_[0][i] -= jump_[i] * factor;
  }
}

void ModeField::remove_normal_part(double* xdot) {
  for (std::size_t row = 0; row < sliding_.size(); ++row) {
    rows_.residual[static_cast<linalg::Index>(row)] = rows_.velocity(row, f_[0]);
  }
  if (!rows_.solve_normal_equations()) return static_cast<void>(std::fill_n(xdot, f_[0].size(), not_a_number));
  std::copy(f_[0].begin(), f_[0].end(), xdot);
  rows_.normal.subtract_transposed(rows_.residual, xdot);
  for (std::size_t row = 0; row < sliding_.size(); ++row) {
    const auto r = static_cast<linalg::Index>(row);
    if (const int only = rows_.coordinate[row]; only >= 0 && std::isfinite(xdot[only])) {
      xdot[only] = rows_.rates[r] == 0.0 ? 0.0 : -rows_.rates[r] / rows_.factor[row];
    }
  }
}

bool ModeField::project(double t, double* x) {
  if (solve_ == SlidingSolve::none) return false;
  if (solve_ == SlidingSolve::higher_order) return higher_order_->project(t, x);
  bool changed = false;
  // Newton converges quadratically from O(tolerance): three steps reach rounding, the fourth proves it.
  for (int iteration = 0; iteration < 4; ++iteration) {
    kernel_.functions(t, x, start_alpha_.data(), values_.data());
    double largest = 0.0;
    for (std::size_t row = 0; row < sliding_.size(); ++row) {
      const double psi = values_[at(sliding_[row])];
      rows_.residual[static_cast<linalg::Index>(row)] = psi;
      largest = std::max(largest, std::abs(psi));
    }
    if (largest == 0.0 || !std::isfinite(largest)) return changed;
    gradients(t, x);
    if (!rows_.solve_normal_equations()) return changed;
    const bool moved = rows_.normal.subtract_transposed(rows_.residual, x);
    changed = changed || moved;
    if (!moved) return changed;
  }
  return changed;
}

}  // namespace saltus::event_integrator
