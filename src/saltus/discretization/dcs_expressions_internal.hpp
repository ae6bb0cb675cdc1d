// What expressions of a Dcs become before they are evaluated.
#pragma once

#include <casadi/core/sx.hpp>

#include "saltus/reformulation/dcs.hpp"

namespace saltus::discretization {

/// Replaces controls by their values during a simulation.
[[nodiscard]] inline casadi::SX with_inputs(const reformulation::Dcs& dcs, const casadi::SX& expression) {
  return dcs.u.numel() == 0 ? expression : casadi::SX::substitute(expression, dcs.u, casadi::SX::densify(dcs.input));
}

/// Returns the entries of a sparse matrix as a dense column.
[[nodiscard]] inline casadi::SX entries_of(const casadi::SX& matrix) {
  return casadi::SX(casadi::Sparsity::dense(matrix.nnz(), 1), casadi::SX(matrix.nonzeros()));
}

/// Replaces lifted variables by their products: row k of the lifting is beta_k less a product of earlier ones.
[[nodiscard]] inline casadi::SX without_lifting(const reformulation::Dcs& dcs, casadi::SX expression) {
  for (casadi_int k = dcs.lifted.numel(); k-- > 0;) {
    // Solved for beta_k by its value at 0: whether beta_k - (beta_k - product) is simplified depends on how it was
    // written.
    const casadi::SX product = -casadi::SX::substitute(dcs.lifting(k), dcs.lifted(k), 0.0);
    expression = casadi::SX::substitute(expression, dcs.lifted(k), product);
  }
  return expression;
}

}  // namespace saltus::discretization
