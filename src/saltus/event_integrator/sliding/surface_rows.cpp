#include "saltus/event_integrator/sliding/surface_rows.hpp"

namespace saltus::event_integrator {

bool IndependentRows::solve(const NormalRows& gradients, std::size_t columns, linalg::Vector& residual) {
  if (at(part_residual_.size()) != rows.size()) part_.resize(rows.size(), columns);
  part_residual_.resize(static_cast<linalg::Index>(rows.size()));
  for (linalg::Index k = 0; k < part_residual_.size(); ++k) {
    const auto row = at(rows[at(k)]);
    part_.copy(at(k), gradients[row], gradients.size(row));
    part_residual_[k] = residual[rows[at(k)]];
  }
  if (!part_.solve(part_residual_)) return false;
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
  return independent.rows.empty() ? normal.solve(residual) : independent.solve(normal, at(dense.cols()), residual);
}

}  // namespace saltus::event_integrator
