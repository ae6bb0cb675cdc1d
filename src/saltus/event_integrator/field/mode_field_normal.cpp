// The normal directions of the sliding surfaces: what of a motion, or of a state, is removed along them.
#include <algorithm>
#include <cmath>

#include "saltus/event_integrator/field/mode_field.hpp"
#include "saltus/event_integrator/mode/small_internal.hpp"

namespace saltus::event_integrator {

bool ModeField::solve_normal_equations() {
  if (sliding_.size() == 1) {
    residual_[0] /= row_square_;
    return row_square_ > 0.0;
  }
  if (!independent_.empty()) return solve_independent_equations();
  return normal_.solve(residual_);
}

/// Whether the rows of the sliding surfaces are kept from mode to mode. Cells and references change them.
bool ModeField::keeps_rows() const { return kernel_.cells() == 0 && kernel_.region_groups().empty(); }

/// A gradient that was the same in all modes so far.
bool ModeField::take_known_row(std::size_t row) {
  const auto& known = known_rows_[at(sliding_[row])];
  if (!known.known || sliding_.size() == 1) return false;
  normal_.set(row, known.row);
  rates_[static_cast<Eigen::Index>(row)] = known.rate;
  coordinate_[row] = known.row.only();
  constant_row_[row] = true;
  return true;
}

/// The gradient in f_[0].
void ModeField::take_row(std::size_t row) {
  const int j = sliding_[row];
  const auto r = static_cast<Eigen::Index>(row);
  normal_.set(row, f_[0]);
  if (rows_.rows() > 0) rows_.row(r) = Eigen::Map<const Eigen::RowVectorXd>(f_[0].data(), rows_.cols());
  coordinate_[row] = normal_[row].only();
  constant_row_[row] = kernel_.is_affine(j) && kernel_.inner(j).empty();
  if (constant_row_[row] && keeps_rows()) known_rows_[at(j)] = {true, normal_[row], rates_[r]};
}

/// Rows that depend on others follow them.
bool ModeField::solve_independent_equations() {
  take_rows(rows_, independent_, base_rows_);
  base_residual_.resize(base_rows_.rows());
  for (Eigen::Index k = 0; k < base_residual_.size(); ++k) {
    base_residual_[k] = residual_[independent_[at(k)]];
  }
  normal_matrix_.noalias() = base_rows_ * base_rows_.transpose();
  cholesky_.compute(normal_matrix_);
  if (cholesky_.info() != Eigen::Success) return false;
  cholesky_.solveInPlace(base_residual_);
  residual_.setZero();
  for (Eigen::Index k = 0; k < base_residual_.size(); ++k) {
    residual_[independent_[at(k)]] = base_residual_[k];
  }
  return true;
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
    const double factor = normal_velocity(row, f_[0]) / (exits_[row].above - exits_[row].below);
    for (std::size_t i = 0; i < jump_.size(); ++i) f_[0][i] -= jump_[i] * factor;
  }
}

void ModeField::remove_normal_part(double* xdot) {
  for (std::size_t row = 0; row < sliding_.size(); ++row) {
    residual_[static_cast<Eigen::Index>(row)] = normal_velocity(row, f_[0]);
  }
  const bool independent = solve_normal_equations();
  normal_.transposed_times(residual_, correction_);
  for (std::size_t i = 0; i < f_[0].size(); ++i) xdot[i] = independent ? f_[0][i] - correction_[i] : not_a_number;
  for (std::size_t row = 0; row < sliding_.size(); ++row) {
    const auto r = static_cast<Eigen::Index>(row);
    if (const int only = coordinate_[row]; only >= 0 && independent && std::isfinite(xdot[only])) {
      xdot[only] = rates_[r] == 0.0 ? 0.0 : -rates_[r] / normal_[row].value.front();
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
      residual_[static_cast<Eigen::Index>(row)] = psi;
      largest = std::max(largest, std::abs(psi));
    }
    if (largest == 0.0 || !std::isfinite(largest)) return changed;
    gradients(t, x);
    if (!solve_normal_equations()) return changed;
    bool moved = false;
    normal_.transposed_times(residual_, correction_);
    for (std::size_t i = 0; i < f_[0].size(); ++i) {
      const double next = x[i] - correction_[i];
      moved = moved || next != x[i];
      x[i] = next;
    }
    changed = changed || moved;
    if (!moved) return changed;
  }
  return changed;
}

}  // namespace saltus::event_integrator
