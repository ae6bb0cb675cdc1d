#include <vector>

#include <casadi/core/function.hpp>

#include "saltus/foreign/derivatives_internal.hpp"

namespace saltus::foreign {
namespace {

using casadi::DM;
using casadi::SX;

/// The matrix of an expression that is linear in v, column by column.
DM matrix_of(const SX& expression, const SX& v) {
  const casadi::Function product("product", {v}, {SX::densify(expression)});
  const std::vector<bool> moves = SX::which_depends(expression, v, 1, /*tr=*/false);
  std::vector<casadi_int> rows, columns;
  std::vector<double> values;
  std::vector<double> unit(moves.size(), 0.0), column(static_cast<std::size_t>(expression.numel()));
  for (std::size_t j = 0; j < moves.size(); ++j) {
    if (!moves[j]) continue;
    unit[j] = 1.0;
    product(std::vector<const double*>{unit.data()}, std::vector<double*>{column.data()});
    unit[j] = 0.0;
    for (std::size_t i = 0; i < column.size(); ++i) {
      if (column[i] == 0.0) continue;
      rows.push_back(static_cast<casadi_int>(i));
      columns.push_back(static_cast<casadi_int>(j));
      values.push_back(column[i]);
    }
  }
  return DM::triplet(rows, columns, values, expression.numel(), v.numel());
}

/// Rows that are affine in w, and the others.
struct Parts {
  std::vector<casadi_int> affine, curved;
};

Parts parts_of(const SX& c, const SX& w) {
  Parts parts;
  if (c.numel() == 0) return parts;
  const std::vector<bool> is_curved = SX::which_depends(c, w, 2, /*tr=*/true);
  for (std::size_t i = 0; i < is_curved.size(); ++i) {
    (is_curved[i] ? parts.curved : parts.affine).push_back(static_cast<casadi_int>(i));
  }
  return parts;
}

}  // namespace

SX jacobian_of(const SX& c, const SX& w) {
  const auto [affine, curved] = parts_of(c, w);
  if (affine.empty()) return SX::jacobian(c, w);
  const SX v = SX::sym("v", w.numel());
  const SX constant = matrix_of(SX::jtimes(c(affine), w, v), v);
  const SX parts = SX::vertcat({constant, SX::jacobian(c(curved), w)});
  std::vector<casadi_int> place(static_cast<std::size_t>(c.numel()));
  casadi_int next = 0;
  for (const auto& rows : {affine, curved}) {
    for (const casadi_int row : rows) place[static_cast<std::size_t>(row)] = next++;
  }
  return parts(place, casadi::Slice());
}

SX hessian_of(const SX& f, const SX& c, const SX& w, const SX& factor, const SX& y) {
  const auto curved = parts_of(c, w).curved;
  const SX v = SX::sym("v", w.numel());
  const SX bend = SX::jtimes(SX::gradient(f, w), w, v);
  const SX of_rows = SX::dot(y(curved), c(curved));
  if (SX::depends_on(bend, w)) return SX::tril(SX::hessian(factor * f + of_rows, w));
  const SX of_objective = SX(DM::tril(matrix_of(bend, v))) * factor;
  return curved.empty() ? of_objective : of_objective + SX::tril(SX::hessian(of_rows, w));
}

}  // namespace saltus::foreign
