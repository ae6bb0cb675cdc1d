#include <array>
#include <utility>

#include "saltus/discretization/dcs_expressions_internal.hpp"
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

/// The lower triangle of the Hessian. Colours of a symmetric matrix save derivatives where it is sparse; to find them
/// takes minutes where it is dense, as behind step equilibration with hundreds of selections.
SX lower_hessian(const SX& lagrangian, const SX& z) {
  const SX gradient = SX::gradient(lagrangian, z);
  const bool is_dense = 2 * SX::jacobian_sparsity(gradient, z).nnz() > z.numel() * z.numel();
  return SX::tril(SX::jacobian(gradient, z, {{"symmetric", !is_dense}}));
}

SX column_of(const std::vector<SX>& scalars) { return scalars.empty() ? SX(0, 1) : SX::vertcat(scalars); }

}  // namespace

LocalExpressions LocalExpressions::joined(const LocalExpressions& other) const {
  LocalExpressions all = *this;
  all.objective += other.objective;
  all.g.insert(all.g.end(), other.g.begin(), other.g.end());
  all.G.insert(all.G.end(), other.G.begin(), other.G.end());
  all.H.insert(all.H.end(), other.H.begin(), other.H.end());
  all.G_signs.insert(all.G_signs.end(), other.G_signs.begin(), other.G_signs.end());
  all.H_signs.insert(all.H_signs.end(), other.H_signs.begin(), other.H_signs.end());
  return all;
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
  const SX hessian = lower_hessian(factor * expressions.objective + SX::dot(y, rows), z);
  jacobian_pattern_ = pattern_of(jacobian);
  hessian_pattern_ = pattern_of(hessian);
  values_ = model::ModelFunction(name, {z, parameters}, {expressions.objective, rows});
  gradient_ = model::ModelFunction(name + "_gradient", {z, parameters}, {gradient});
  jacobian_ = model::ModelFunction(name + "_jacobian", {z, parameters}, {entries_of(jacobian)});
  hessian_ = model::ModelFunction(name + "_hessian", {z, parameters, factor, y}, {entries_of(hessian)});
}

void LocalFunction::values(const double* z, const double* parameters, double* objective, double* rows) {
  native_->call(values_, std::array<const double*, 2>{z, parameters}, std::array<double*, 2>{objective, rows});
}
void LocalFunction::gradient(const double* z, const double* parameters, double* gradient) {
  native_->call(gradient_, std::array<const double*, 2>{z, parameters}, std::array<double*, 1>{gradient});
}
void LocalFunction::jacobian(const double* z, const double* parameters, double* values) {
  native_->call(jacobian_, std::array<const double*, 2>{z, parameters}, std::array<double*, 1>{values});
}
void LocalFunction::hessian(const double* z, const double* parameters, double factor, const double* y, double* values) {
  native_->call(hessian_, std::array<const double*, 4>{z, parameters, &factor, y}, std::array<double*, 1>{values});
}
void LocalFunction::join(evaluation::NativeFunctions& native, std::vector<model::ModelFunction*>& functions) {
  native_ = &native;
  functions.insert(functions.end(), {&values_, &gradient_, &jacobian_, &hessian_});
}
long LocalFunction::operations() const {
  return values_.operations() + gradient_.operations() + jacobian_.operations() + hessian_.operations();
}

}  // namespace saltus::discretization
