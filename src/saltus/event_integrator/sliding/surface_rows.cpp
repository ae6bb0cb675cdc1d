#include "saltus/event_integrator/sliding/surface_rows.hpp"

#include "saltus/event_integrator/mode/region_ties.hpp"

namespace saltus::event_integrator {

bool IndependentRows::solve(const linalg::Matrix& gradients, linalg::Vector& residual) {
  take_rows(gradients, rows, part_);
  part_residual_.resize(part_.rows());
  for (linalg::Index k = 0; k < part_residual_.size(); ++k) part_residual_[k] = residual[rows[at(k)]];
  matrix_.resize(part_.rows(), part_.rows());
  linalg::multiply(part_, part_.transpose(), matrix_);
  cholesky_.compute(matrix_);
  if (!cholesky_.is_positive()) return false;
  cholesky_.solve_in_place(part_residual_);
  residual.set_zero();
  for (linalg::Index k = 0; k < part_residual_.size(); ++k) residual[rows[at(k)]] = part_residual_[k];
  return true;
}

void SurfaceRows::resize(std::size_t m, std::size_t states, bool with_dense) {
  const auto rows = static_cast<linalg::Index>(m);
  normal.resize(m, states);
  dense.resize(with_dense ? rows : 0, static_cast<linalg::Index>(states));
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
  rates[static_cast<linalg::Index>(row)] = known.rate;
  note(row, true);
  return true;
}

void SurfaceRows::take(std::size_t row, std::size_t surface, const std::vector<double>& gradient, bool constant,
                       bool keep) {
  const auto r = static_cast<linalg::Index>(row);
  normal.set(row, gradient);
  if (dense.rows() > 0) dense.row(r) = linalg::ConstView(gradient.data(), dense.cols());
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
