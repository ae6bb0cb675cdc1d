#include <utility>

#include "saltus/discretization/local_function_internal.hpp"

namespace saltus::discretization {
namespace {

using casadi::SX;

mpcc::Pattern pattern_of(const SX& matrix) {
  mpcc::Pattern pattern;
  const auto rows = matrix.sparsity().get_row();
  const auto columns = matrix.sparsity().get_col();
  for (std::size_t e = 0; e < rows.size(); ++e) pattern.add(static_cast<int>(rows[e]), static_cast<int>(columns[e]));
  return pattern;
}

/// The entries of a sparse matrix as a dense column.
SX entries_of(const SX& matrix) { return SX(casadi::Sparsity::dense(matrix.nnz(), 1), SX(matrix.nonzeros())); }

SX column_of(const std::vector<SX>& scalars) { return scalars.empty() ? SX(0, 1) : SX::vertcat(scalars); }

}  // namespace

VectorFunction::VectorFunction(const std::string& name, const std::vector<SX>& in, const std::vector<SX>& out) {
  std::vector<SX> dense;
  for (const auto& expression : out) dense.push_back(SX::densify(expression));
  function_ = casadi::Function(name, in, dense);
  arguments_.resize(function_.sz_arg());
  results_.resize(function_.sz_res());
  integers_.resize(function_.sz_iw());
  work_.resize(function_.sz_w());
}

void VectorFunction::operator()(const std::vector<const double*>& in, const std::vector<double*>& out) {
  for (std::size_t i = 0; i < in.size(); ++i) arguments_[i] = in[i];
  for (std::size_t i = 0; i < out.size(); ++i) results_[i] = out[i];
  function_(arguments_.data(), results_.data(), integers_.data(), work_.data(), 0);
}

LocalFunction::LocalFunction(const std::string& name, const SX& z, const SX& parameters,
                             const LocalExpressions& expressions)
    : variables_(static_cast<int>(z.numel())),
      equations_(static_cast<int>(expressions.g.size())),
      pairs_(static_cast<int>(expressions.G.size())),
      has_objective_(!expressions.objective.is_zero()),
      signs_(expressions.G_signs) {
  signs_.insert(signs_.end(), expressions.H_signs.begin(), expressions.H_signs.end());
  std::vector<SX> all = expressions.g;
  all.insert(all.end(), expressions.G.begin(), expressions.G.end());
  all.insert(all.end(), expressions.H.begin(), expressions.H.end());
  const SX rows = column_of(all);
  const SX factor = SX::sym("factor");
  const SX y = SX::sym("y", rows.numel());
  const SX jacobian = SX::jacobian(rows, z);
  const SX gradient = SX::gradient(expressions.objective, z);
  const SX hessian = SX::tril(SX::hessian(factor * expressions.objective + SX::dot(y, rows), z));
  jacobian_pattern_ = pattern_of(jacobian);
  hessian_pattern_ = pattern_of(hessian);
  values_ = VectorFunction(name, {z, parameters}, {expressions.objective, rows});
  gradient_ = VectorFunction(name + "_gradient", {z, parameters}, {gradient});
  jacobian_ = VectorFunction(name + "_jacobian", {z, parameters}, {entries_of(jacobian)});
  hessian_ = VectorFunction(name + "_hessian", {z, parameters, factor, y}, {entries_of(hessian)});
}

void LocalFunction::values(const double* z, const double* parameters, double* objective, double* rows) {
  values_({z, parameters}, {objective, rows});
}
void LocalFunction::gradient(const double* z, const double* parameters, double* gradient) {
  gradient_({z, parameters}, {gradient});
}
void LocalFunction::jacobian(const double* z, const double* parameters, double* values) {
  jacobian_({z, parameters}, {values});
}
void LocalFunction::hessian(const double* z, const double* parameters, double factor, const double* y, double* values) {
  hessian_({z, parameters, &factor, y}, {values});
}
long LocalFunction::operations() const {
  return values_.operations() + gradient_.operations() + jacobian_.operations() + hessian_.operations();
}

}  // namespace saltus::discretization
