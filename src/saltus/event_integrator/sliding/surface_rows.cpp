#include "saltus/event_integrator/sliding/surface_rows.hpp"

#include "saltus/event_integrator/mode/region_ties.hpp"

namespace saltus::event_integrator {

bool IndependentRows::solve(const Eigen::MatrixXd& gradients, Eigen::VectorXd& residual) {
  take_rows(gradients, rows, part_);
  part_residual_.resize(part_.rows());
  for (Eigen::Index k = 0; k < part_residual_.size(); ++k) part_residual_[k] = residual[rows[at(k)]];
  matrix_.noalias() = part_ * part_.transpose();
  cholesky_.compute(matrix_);
  if (cholesky_.info() != Eigen::Success) return false;
  cholesky_.solveInPlace(part_residual_);
  residual.setZero();
  for (Eigen::Index k = 0; k < part_residual_.size(); ++k) residual[rows[at(k)]] = part_residual_[k];
  return true;
}

void SurfaceRows::resize(std::size_t m, std::size_t states, bool with_dense) {
  const auto rows = static_cast<Eigen::Index>(m);
  normal.resize(m, states);
  dense.resize(with_dense ? rows : 0, static_cast<Eigen::Index>(states));
  rates.resize(rows);
  residual.resize(rows);
  coordinate.assign(m, -1);
  factor.assign(m, 0.0);
  is_constant.assign(m, false);
  varying = m;
}

void SurfaceRows::note(std::size_t row, bool constant) {
  coordinate[row] = normal[row].only();
  if (coordinate[row] >= 0) factor[row] = normal[row].value.front();
  if (constant && !is_constant[row]) --varying;
  is_constant[row] = constant;
}

bool SurfaceRows::take_known(std::size_t row, std::size_t surface) {
  const auto& known = known_[surface];
  if (!known.known || coordinate.size() == 1) return false;
  normal.set(row, known.row, known.size);
  rates[static_cast<Eigen::Index>(row)] = known.rate;
  note(row, true);
  return true;
}

void SurfaceRows::take(std::size_t row, std::size_t surface, const std::vector<double>& gradient, bool constant,
                       bool keep) {
  const auto r = static_cast<Eigen::Index>(row);
  normal.set(row, gradient);
  if (dense.rows() > 0) dense.row(r) = Eigen::Map<const Eigen::RowVectorXd>(gradient.data(), dense.cols());
  note(row, constant);
  if (constant && keep) known_[surface] = {true, normal[row], rates[r], normal.size(row)};
}

bool SurfaceRows::solve_normal_equations() {
  if (coordinate.size() == 1) {
    residual[0] /= square;
    return square > 0.0;
  }
  return independent.rows.empty() ? normal.solve(residual) : independent.solve(dense, residual);
}

}  // namespace saltus::event_integrator
