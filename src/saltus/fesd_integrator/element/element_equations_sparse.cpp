// The linear systems of an element by their entries.
#include <algorithm>
#include <cmath>

#include "saltus/fesd_integrator/element/element_equations_internal.hpp"

namespace saltus::fesd_integrator {

using linalg::Index;

ElementEquations::Matrix ElementEquations::first_matrix(double h) const {
  constexpr double near = 0.3;  // less than that times h |f_x| of a step is left by the next one
  const bool serves = saves_factors() && keeps_matrix() && std::abs(h - sparse_.h) <= near * sparse_.h &&
                      sparse_.sets.size() == at(one_set_ ? 1 : n_s_) &&
                      std::equal(sparse_.sets.begin(), sparse_.sets.end(), sets_.begin(),
                                 [](const ActiveSet& made_for, const ActiveSet* set) { return made_for == *set; });
  return serves ? Matrix::of_the_step_before : Matrix::its_own;
}

void ElementEquations::assemble_entries(const Element& element) {
  sparse_.h = element.h;
  sparse_.sets.resize(at(one_set_ ? 1 : n_s_));
  for (std::size_t m = 0; m < sparse_.sets.size(); ++m) sparse_.sets[m] = *sets_[m];
  for (Index m = 0; m < n_s_; ++m) {
    for (Index l = 0; l < n_s_; ++l) {
      const double weight = element.h * A_(m, l);
      if (weight == 0.0) continue;
      const auto f_x = field_by_state(values_[at(l)]);
      for (Index j = 0; j < n_x_; ++j) {
        for (const auto [row, value] : f_x.along(j)) system_.add(place(m) + row, place(l) + j, -weight * value);
      }
      for (Index k = 0; k < unknowns(l); ++k) {
        for (const auto [row, value] : sparse_.directions[at(l)].along(k)) {
          system_.add(place(m) + row, place(l) + n_x_ + k, -A_(m, l) * value);
        }
      }
    }
    for (Index i = 0; i < n_x_; ++i) system_.add(place(m) + i, place(m) + i, 1.0);
  }
  for (Index m = 0; m < n_s_; ++m) {
    if (unknowns(m) > 0) assemble_surface_entries(element, m);
  }
}

void ElementEquations::assemble_surface_entries(const Element& element, Index stage) {
  const Index point = point_of(stage);
  const SparseRows surfaces = sliding_surfaces(set(stage), values_[at(point)]);
  const Index first = place(stage) + n_x_;
  const auto add = [&](const SparseRows& rows, Index first_column, double factor) {
    for (Index k = 0; k < rows.rows(); ++k) {
      for (const auto [column, value] : rows.along(k)) system_.add(first + k, first_column + column, factor * value);
    }
  };
  if (point < n_s_) return add(surfaces, place(point), 1.0);
  for (Index l = 0; l < n_s_; ++l) {
    add(surfaces * linalg::by_rows(field_by_state(values_[at(l)])), place(l), element.h * b_(l));
    if (unknowns(l) > 0) add(surfaces * linalg::by_rows(sparse_.directions[at(l)]), place(l) + n_x_, b_(l));
  }
}

std::optional<double> ElementEquations::move_onto_surfaces_by_entries(const ActiveSet& active, Element& element) {
  const auto& here = values_[at(n_s_)];
  const SparseColumns& along = sparse_.directions[at(n_s_)];
  const SparseRows surfaces = sliding_surfaces(active, here);
  const SparseRows matrix = surfaces * linalg::by_rows(along);
  projection_.reset(matrix.rows());
  auto right = projection_.right();
  for (Index k = 0; k < matrix.rows(); ++k) {
    for (const auto [column, value] : matrix.along(k)) projection_.add(k, column, value);
    right(k) = -active.surface(static_cast<std::size_t>(k), here.indicator.data());
  }
  const double steepest = linalg::ConstView(surfaces.values()).max_abs();
  if (!projection_.solve(negligible(element) * steepest)) return std::nullopt;
  const linalg::Vector moved = along * projection_.right();
  linalg::View(element.end.data(), n_x_) += moved;
  return moved.max_abs();
}

}  // namespace saltus::fesd_integrator
