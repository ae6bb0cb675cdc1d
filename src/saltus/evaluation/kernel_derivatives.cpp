// Derivatives of single event functions, made when first asked for, the rows of affine ones, the linear part of f.
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/base/contracts.hpp"
#include "saltus/base/symbolic_lock.hpp"
#include "saltus/evaluation/kernel_internal.hpp"
#include "saltus/evaluation/root_limits_internal.hpp"

namespace saltus::evaluation {
using casadi::SX;

const LimitedFunction& CompiledModel::limited(int function, const std::vector<double>& fixed_values) {
  const SymbolicLock lock;
  const auto [known, is_new] = limited_.try_emplace({function, fixed_values});
  if (is_new) {
    const SX psi = phi(casadi::Slice(0, n_psi));
    auto found = limit_roots(phi_row(function), psi, symbols(), fixed_values);
    rootless.push_back(std::move(found.f));
    known->second = {-static_cast<int>(rootless.size()), std::move(found.rooted)};
  }
  return known->second;
}

SX CompiledModel::lie_expression(CompiledMotion& motion, int j, int order) {
  if (order == 0) return phi_row(j);
  const auto key = std::make_pair(j, order);
  auto& known = motion.lie_expressions;
  if (const auto found = known.find(key); found != known.end()) return found->second;
  const SX previous = lie_expression(motion, j, order - 1);
  const auto used = places.used_by(previous);
  std::vector<SX> moved{SX(0, 1)};
  for (const std::size_t state : used.x.place) moved.push_back(motion.f(static_cast<casadi_int>(state)));
  SX next = SX::mtimes(SX::jacobian(previous, used.x.symbols), SX::vertcat(moved));
  if (used.time) next += SX::jacobian(previous, t);
  known[key] = next;
  return next;
}

const ModelFunction& CompiledModel::gradient(int function) {
  auto& known = functions.gradients[at(function)];
  if (known.is_null()) {
    const SX row = phi_row(function);
    known = ModelFunction("gradient", {t, x, p, alpha}, {SX::jacobian(row, x), SX::jacobian(row, t)});
  }
  return known;
}

/// Whether forces move a derivative below this order: there is no expression of their rates.
bool CompiledModel::is_turned_below(CompiledMotion& motion, int function, int order) {
  if (forces.is_empty()) return false;
  auto& [asked, is_turned] = motion.turned[function];
  for (; !is_turned && asked < order; ++asked) {
    is_turned = SX::depends_on(lie_expression(motion, function, asked), forces);
  }
  return is_turned && asked <= order;
}

const ModelFunction& CompiledModel::lie_derivative(CompiledMotion& motion, int function, int order) {
  auto& known = motion.lie_derivatives[{function, order}];
  if (known.is_null()) {
    if (function >= 0 && is_turned_below(motion, function, order)) return known;
    known = ModelFunction("lie_derivative", {t, x, p, alpha}, {lie_expression(motion, function, order)});
  }
  return known;
}

const ModelFunction& CompiledModel::lie_gradient(CompiledMotion& motion, int function, int order) {
  auto& known = motion.lie_gradients[{function, order}];
  if (known.is_null()) {
    const SX derivative = lie_expression(motion, function, order);
    known = ModelFunction("lie_gradient", {t, x, p, alpha}, {SX::jacobian(derivative, x), SX::jacobian(derivative, t)});
  }
  return known;
}

const AffineRowFunction& CompiledModel::lie_row(CompiledMotion& motion, int function, int fixed_component) {
  const auto [known, is_new] = motion.lie_rows.try_emplace({function, fixed_component});
  if (is_new) {
    const SX rate = lie_expression(motion, function, 1);
    known->second = AffineRowFunction(rate, t, places.used_by(rate), fixed_component);
  }
  return known->second;
}

const LinearFieldFunction& CompiledModel::linear(CompiledMotion& motion) {
  if (!motion.linear) motion.linear.emplace(motion.f, symbols());
  return *motion.linear;
}

/// What a larger field would win is not worth making its derivatives.
const ModelFunction& CompiledModel::jacobian(CompiledMotion& motion, const ode::JacobianPattern* pattern) {
  if (motion.jacobian) return *motion.jacobian;
  motion.jacobian.emplace();
  if (!forces.is_empty()) return *motion.jacobian;
  constexpr double most_operations = 1e5;
  const auto n = x.numel();
  const auto directions = pattern != nullptr ? ode::column_groups(*pattern).size() : at(n);
  const auto operations = motion.field.operations() + motion.constants.operations();
  if (static_cast<double>(directions) * static_cast<double>(operations) > most_operations) return *motion.jacobian;
  std::vector<casadi_int> moving;
  for (casadi_int i = 0; i < n; ++i) {
    if (!discrete[at(i)]) moving.push_back(i);
  }
  const SX columns = SX::jacobian(motion.f, x(moving));
  std::vector<casadi_int> column_start{0};
  for (casadi_int i = 0, k = 0; i < n; ++i) {
    column_start.push_back(columns.sparsity().colind()[discrete[at(i)] ? k : ++k]);
  }
  SX entries(casadi::Sparsity(n, n, column_start, columns.sparsity().get_row()), columns.nonzeros());
  if (pattern != nullptr) {
    const auto integers = [](const std::vector<std::size_t>& list) {
      return std::vector<casadi_int>(list.begin(), list.end());
    };
    entries = SX::project(entries, casadi::Sparsity(n, n, integers(pattern->start), integers(pattern->row)));
    entries = SX(entries.nonzeros());
  }
  return motion.jacobian.emplace("field_jacobian", std::vector<SX>{t, x, p, alpha}, std::vector<SX>{entries});
}

bool ModelKernel::field_jacobian(double t, const double* x, const double* alpha, double* entries) const {
  auto& self = *implementation_;
  auto& motion = *self.motion;
  if (!motion.jacobian) {
    const auto* pattern = jacobian_pattern();
    const SymbolicLock lock;
    motion.jacobian = self.compiled->jacobian(*motion.compiled, pattern);
  }
  auto& jacobian = *motion.jacobian;
  if (jacobian.is_null()) return false;
  jacobian(std::array<const double*, 4>{&t, x, self.parameters.data(), alpha}, std::array<double*, 1>{entries});
  const auto count = jacobian.function().numel_out(0);
  return std::all_of(entries, entries + count, [](double entry) { return std::isfinite(entry); });
}

int ModelKernel::with_limited_roots(int function) const {
  SALTUS_ASSERT(0 <= function && function < event_functions());
  auto& self = *implementation_;
  auto known = self.limited.find(function);
  if (known == self.limited.end()) {
    const auto fixed = static_cast<std::ptrdiff_t>(self.compiled->fixed_parameters);
    const std::vector<double> values(self.parameters.begin(), self.parameters.begin() + fixed);
    known = self.limited.emplace(function, self.compiled->limited(function, values)).first;
  }
  return known->second.number;
}

bool ModelKernel::has_root_inside(int function, int surface) const {
  const int number = with_limited_roots(function);
  const auto& limited = implementation_->limited;
  const auto known =
      std::find_if(limited.begin(), limited.end(), [&](const auto& entry) { return entry.second.number == number; });
  return known->second.rooted[at(surface)];
}

/// Nothing to differentiate, and the same for all selections: of functions that hold none.
const AffineRows& ModelKernel::Implementation::gradients_of_affine() {
  if (!constant_gradients) {
    const std::vector<double> alpha(at(compiled->n_psi), 0.5);
    affine_rows.fill(parameters.data(), alpha.data(), constant_gradients.emplace());
  }
  return *constant_gradients;
}

void ModelKernel::gradient(int function, double t, const double* x, const double* alpha, double* row,
                           double* rate) const {
  SALTUS_ASSERT(0 <= function && function < event_functions());
  auto& self = *implementation_;
  if (is_affine(function) && inner(function).empty()) {
    const auto& rows = self.gradients_of_affine();
    std::fill_n(row, states(), 0.0);
    for (std::size_t k = rows.start[at(function)]; k < rows.start[at(function) + 1]; ++k) {
      row[rows.column[k]] = rows.coefficient[k];
    }
    *rate = rows.rate[at(function)];
    return;
  }
  self.gradient_at(function, t, x, alpha, row, rate);
}

void ModelKernel::Implementation::gradient_at(int function, double t, const double* x, const double* alpha, double* row,
                                              double* rate) {
  auto& gradient = gradients[at(function)];
  if (gradient.is_null()) {
    const SymbolicLock lock;
    gradient = compiled->gradient(function);
  }
  gradient(std::array<const double*, 4>{&t, x, parameters_at(t, x, alpha), alpha}, std::array<double*, 2>{row, rate});
  if (contact_solve.is_needed()) contact_solve.add_to_gradient(function, row, rate);
}

void ModelKernel::gradient(int function, double t, const double* x, const double* alpha, AffineRow& row) const {
  auto& self = *implementation_;
  if (is_affine(function) && inner(function).empty()) {
    const auto& rows = self.gradients_of_affine();
    const auto begin = static_cast<std::ptrdiff_t>(rows.start[at(function)]);
    const auto end = static_cast<std::ptrdiff_t>(rows.start[at(function) + 1]);
    row.column.assign(rows.column.begin() + begin, rows.column.begin() + end);
    row.coefficient.assign(rows.coefficient.begin() + begin, rows.coefficient.begin() + end);
    row.rate = rows.rate[at(function)];
    return;
  }
  auto& all = self.gradient_row;
  all.resize(at(states()));
  gradient(function, t, x, alpha, all.data(), &row.rate);
  row.column.clear();
  row.coefficient.clear();
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i] == 0.0) continue;
    row.column.push_back(i);
    row.coefficient.push_back(all[i]);
  }
}

double ModelKernel::lie_derivative(int function, int order, double t, const double* x, const double* alpha) const {
  SALTUS_ASSERT(function < 0 ? order >= 0 : function < event_functions() && order >= 1);
  auto& self = *implementation_;
  auto& derivative = self.motion->lie_derivatives[{function, order}];
  if (derivative.is_null()) {
    const SymbolicLock lock;
    derivative = self.compiled->lie_derivative(*self.motion->compiled, function, order);
  }
  if (derivative.is_null()) return derivative_by_differences(function, order, t, x, alpha);
  double value = 0.0;
  derivative(std::array<const double*, 4>{&t, x, self.parameters_at(t, x, alpha), alpha},
             std::array<double*, 1>{&value});
  return value;
}

void ModelKernel::lie_gradient(int function, int order, double t, const double* x, const double* alpha, double* row,
                               double* rate) const {
  SALTUS_ASSERT(function < 0 ? order >= 0 : function < event_functions() && order >= 1);
  auto& self = *implementation_;
  auto& gradient = self.motion->lie_gradients[{function, order}];
  if (gradient.is_null()) {
    const SymbolicLock lock;
    gradient = self.compiled->lie_gradient(*self.motion->compiled, function, order);
  }
  gradient(std::array<const double*, 4>{&t, x, self.parameters_at(t, x, alpha), alpha},
           std::array<double*, 2>{row, rate});
}

bool ModelKernel::is_affine(int function) const { return implementation_->compiled->affine[at(function)]; }
void ModelKernel::affine_rows(const double* alpha, AffineRows& rows) const {
  implementation_->affine_rows.fill(implementation_->parameters.data(), alpha, rows);
}

bool ModelKernel::lie_row(int function, FixedState fixed, const double* alpha, AffineRow& row) const {
  auto& self = *implementation_;
  if (self.contact_solve.is_needed()) return false;
  const auto [entry, is_new] = self.motion->lie_rows.try_emplace({function, fixed.component});
  if (is_new) {
    const SymbolicLock lock;
    entry->second = self.compiled->lie_row(*self.motion->compiled, function, fixed.component);
  }
  if (!entry->second.is_affine()) return false;
  entry->second.fill(fixed, self.parameters.data(), alpha, row);
  return true;
}

const ode::LinearField* ModelKernel::linear_field(const double* alpha, ode::LinearField& own) const {
  auto& self = *implementation_;
  auto& motion = *self.motion;
  if (self.contact_solve.is_needed()) return nullptr;
  if (motion.linear_always) return &*motion.linear_always;
  if (!motion.linear) {
    const SymbolicLock lock;
    motion.linear = self.compiled->linear(*motion.compiled);
  }
  if (!motion.linear->is_affine()) return nullptr;
  const double* p = self.parameters.data();
  if (motion.linear->is_constant() && self.has_fixed_constants()) {
    motion.linear->fill(p, alpha, motion.linear_always.emplace());
    return &*motion.linear_always;
  }
  motion.linear->fill(p, alpha, own);
  return &own;
}

bool ModelKernel::has_root(int surface) const { return implementation_->compiled->rooted[at(surface)]; }
bool ModelKernel::root_is_continued(int surface) const {
  return implementation_->compiled->continued_roots[at(surface)];
}
bool ModelKernel::is_discrete_guard(int function) const {
  return implementation_->compiled->discrete_guards[at(function)];
}

const std::vector<int>& ModelKernel::inner(int function) const {
  return implementation_->compiled->inner[at(function)];
}
const std::vector<int>& ModelKernel::neighbours(int surface) const {
  return implementation_->motion->compiled->neighbours[at(surface)];
}
bool ModelKernel::depends(int surface, int alpha) const {
  const auto& selections = implementation_->motion->compiled->depends[at(surface)];
  return std::binary_search(selections.begin(), selections.end(), alpha);
}

}  // namespace saltus::evaluation
