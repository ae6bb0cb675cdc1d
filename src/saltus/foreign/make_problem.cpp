#include "saltus/foreign/make_problem.hpp"

#include <cmath>
#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/foreign/derivatives_internal.hpp"
#include "saltus/foreign/functions_internal.hpp"
#include "saltus/foreign/row_ranges_internal.hpp"
#include "saltus/foreign/signs_internal.hpp"

namespace saltus::foreign {
namespace {

using casadi::SX;

mpcc::Pattern pattern_of(const SX& matrix) {
  mpcc::Pattern pattern;
  const auto rows = matrix.sparsity().get_row(), columns = matrix.sparsity().get_col();
  for (std::size_t e = 0; e < rows.size(); ++e) pattern.add(static_cast<int>(rows[e]), static_cast<int>(columns[e]));
  return pattern;
}

/// The entries of a sparse matrix as a dense column.
SX entries_of(const SX& matrix) { return SX(casadi::Sparsity::dense(matrix.nnz(), 1), SX(matrix.nonzeros())); }

SX column_of(const std::vector<SX>& scalars) { return scalars.empty() ? SX(0, 1) : SX::densify(SX::vertcat(scalars)); }

void set_bounds(Problem::Implementation& all) {
  const auto& statement = all.statement;
  all.variable_bounds.lower = linalg::ConstView(statement.lower);
  all.variable_bounds.upper = linalg::ConstView(statement.upper);
  all.constraint_bounds.lower.resize(index(statement.rows.size()));
  all.constraint_bounds.upper.resize(index(statement.rows.size()));
  for (std::size_t i = 0; i < statement.rows.size(); ++i) {
    all.constraint_bounds.lower[index(i)] = statement.rows[i].lower;
    all.constraint_bounds.upper[index(i)] = statement.rows[i].upper;
  }
}

}  // namespace

std::unique_ptr<Problem> make_problem(Statement statement) {
  auto all = std::make_unique<Problem::Implementation>();
  all->statement = std::move(statement);
  set_bounds(*all);
  const auto& pairs = all->statement.pairs;
  std::vector<SX> scalars, bodies;
  for (const auto& row : all->statement.rows) scalars.push_back(row.expression);
  for (const auto& pair : pairs) scalars.push_back(pair.G);
  for (const auto& pair : pairs) scalars.push_back(pair.H);
  for (const auto& split : all->statement.splits) bodies.push_back(split.body);

  const SX w = column_of(all->statement.symbols), c = column_of(scalars);
  const SX f =
      SX::densify(all->statement.sense == Sense::maximize ? -all->statement.objective : all->statement.objective);
  const SX factor = SX::sym("factor"), y = SX::sym("y", c.numel());
  const SX jacobian = jacobian_of(c, w), hessian = hessian_of(f, c, w, factor, y);
  all->jacobian_pattern = pattern_of(jacobian);
  all->hessian_pattern = pattern_of(hessian);
  const casadi::Slice sides(static_cast<casadi_int>(all->statement.rows.size()), c.numel());
  all->signs = signs_of(w, c(sides), jacobian(sides, casadi::Slice()), all->variable_bounds);
  all->row_ranges = ranges_of(w, c, jacobian,
                              with_rows_of_one_variable(w, c, jacobian, all->variable_bounds, all->constraint_bounds));
  all->values = CachedFunction("values", w, f, c);
  all->derivatives = CachedFunction("derivatives", w, SX::densify(SX::gradient(f, w)), entries_of(jacobian));
  all->hessian = model::ModelFunction("hessian", {w, factor, y}, {entries_of(hessian)});
  all->bodies = model::ModelFunction("bodies", {w}, {column_of(bodies)});
  return std::make_unique<Problem>(std::move(all));
}

}  // namespace saltus::foreign
