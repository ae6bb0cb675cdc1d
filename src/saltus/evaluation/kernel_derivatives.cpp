// Derivatives of single event functions, made when first asked for, the rows of affine ones, the linear part of f.
#include <algorithm>
#include <array>
#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/base/contracts.hpp"
#include "saltus/base/symbolic_lock.hpp"
#include "saltus/evaluation/kernel_internal.hpp"
#include "saltus/evaluation/root_limits_internal.hpp"

namespace saltus::evaluation {
namespace {

using casadi::SX;

}  // namespace

int ModelKernel::with_limited_roots(int function) const {
  SALTUS_ASSERT(0 <= function && function < event_functions());
  auto& self = *implementation_;
  const auto [known, is_new] = self.rootless_numbers.try_emplace(function, 0);
  if (is_new) {
    const SymbolicLock lock;
    const std::vector<double> fixed(self.parameters.begin(),
                                    self.parameters.begin() + static_cast<std::ptrdiff_t>(self.fixed_parameters));
    const SX psi = self.phi(casadi::Slice(0, self.n_psi));
    auto limited = limit_roots(self.phi_row(function), psi, self.symbols(), fixed);
    self.rootless.push_back(std::move(limited.f));
    self.roots_inside.push_back(std::move(limited.rooted));
    known->second = -static_cast<int>(self.rootless.size());
  }
  return known->second;
}

bool ModelKernel::has_root_inside(int function, int surface) const {
  const auto number = at(-1 - with_limited_roots(function));
  return implementation_->roots_inside[number][at(surface)];
}

SX ModelKernel::Implementation::lie_expression(int j, int order) {
  if (order == 0) return phi_row(j);
  const auto key = std::make_pair(j, order);
  auto& known = motion->lie_expressions;
  if (const auto found = known.find(key); found != known.end()) return found->second;
  const SX previous = lie_expression(j, order - 1);
  const auto used = places.used_by(previous);
  std::vector<SX> moved{SX(0, 1)};
  for (const std::size_t state : used.x.place) moved.push_back(motion->f(static_cast<casadi_int>(state)));
  SX next = SX::mtimes(SX::jacobian(previous, used.x.symbols), SX::vertcat(moved));
  if (used.time) next += SX::jacobian(previous, t);
  known[key] = next;
  return next;
}

void ModelKernel::gradient(int function, double t, const double* x, const double* alpha, double* row,
                           double* rate) const {
  SALTUS_ASSERT(0 <= function && function < event_functions());
  auto& self = *implementation_;
  if (is_affine(function) && inner(function).empty()) {  // nothing to differentiate
    if (!self.constant_gradients) affine_rows(alpha, self.constant_gradients.emplace());
    const auto& rows = *self.constant_gradients;
    std::fill_n(row, self.x.numel(), 0.0);
    for (std::size_t k = rows.start[at(function)]; k < rows.start[at(function) + 1]; ++k) {
      row[rows.column[k]] = rows.coefficient[k];
    }
    *rate = rows.rate[at(function)];
    return;
  }
  auto& gradient = self.gradients[at(function)];
  if (gradient.is_null()) {
    const SymbolicLock lock;
    const SX phi = self.phi_row(function);
    gradient = ModelFunction("gradient", {self.t, self.x, self.p, self.alpha},
                             {SX::jacobian(phi, self.x), SX::jacobian(phi, self.t)});
  }
  gradient(std::array<const double*, 4>{&t, x, self.parameters.data(), alpha}, std::array<double*, 2>{row, rate});
}

double ModelKernel::lie_derivative(int function, int order, double t, const double* x, const double* alpha) const {
  SALTUS_ASSERT(function < 0 ? order >= 0 : function < event_functions() && order >= 1);
  auto& self = *implementation_;
  auto& compiled = self.motion->lie_derivatives[{function, order}];
  if (compiled.is_null()) {
    const SymbolicLock lock;
    compiled =
        ModelFunction("lie_derivative", {self.t, self.x, self.p, self.alpha}, {self.lie_expression(function, order)});
  }
  double value = 0.0;
  compiled(std::array<const double*, 4>{&t, x, self.parameters.data(), alpha}, std::array<double*, 1>{&value});
  return value;
}

void ModelKernel::lie_gradient(int function, int order, double t, const double* x, const double* alpha, double* row,
                               double* rate) const {
  SALTUS_ASSERT(function < 0 ? order >= 0 : function < event_functions() && order >= 1);
  auto& self = *implementation_;
  auto& compiled = self.motion->lie_gradients[{function, order}];
  if (compiled.is_null()) {
    const SymbolicLock lock;
    const SX derivative = self.lie_expression(function, order);
    compiled = ModelFunction("lie_gradient", {self.t, self.x, self.p, self.alpha},
                             {SX::jacobian(derivative, self.x), SX::jacobian(derivative, self.t)});
  }
  compiled(std::array<const double*, 4>{&t, x, self.parameters.data(), alpha}, std::array<double*, 2>{row, rate});
}

bool ModelKernel::is_affine(int function) const { return implementation_->affine[at(function)]; }
void ModelKernel::affine_rows(const double* alpha, AffineRows& rows) const {
  implementation_->affine_rows.fill(implementation_->parameters.data(), alpha, rows);
}

bool ModelKernel::lie_row(int function, FixedState fixed, const double* alpha, AffineRow& row) const {
  auto& self = *implementation_;
  const auto [entry, is_new] = self.motion->lie_rows.try_emplace({function, fixed.component});
  if (is_new) {
    const SymbolicLock lock;
    const SX motion_of_psi = self.lie_expression(function, 1);
    entry->second = AffineRowFunction(motion_of_psi, self.t, self.places.used_by(motion_of_psi), fixed.component);
  }
  if (!entry->second.is_affine()) return false;
  entry->second.fill(fixed, self.parameters.data(), alpha, row);
  return true;
}

const ode::LinearField* ModelKernel::linear_field(const double* alpha, ode::LinearField& own) const {
  auto& self = *implementation_;
  auto& motion = *self.motion;
  if (motion.linear_always) return &*motion.linear_always;
  if (!motion.linear) {
    const SymbolicLock lock;
    motion.linear.emplace(motion.f, self.symbols());
  }
  if (!motion.linear->is_affine()) return nullptr;
  const double* p = self.parameters.data();
  // Cells and references change constants among the parameters.
  if (motion.linear->is_constant() && self.cells.size() == 0 && self.regions.groups().empty()) {
    motion.linear->fill(p, alpha, motion.linear_always.emplace());
    return &*motion.linear_always;
  }
  motion.linear->fill(p, alpha, own);
  return &own;
}

bool ModelKernel::has_root(int surface) const { return implementation_->rooted[at(surface)]; }
bool ModelKernel::root_is_continued(int surface) const { return implementation_->continued_roots[at(surface)]; }
bool ModelKernel::is_time_only(int function) const { return implementation_->time_only[at(function)]; }
const std::vector<int>& ModelKernel::inner(int function) const { return implementation_->inner[at(function)]; }
const std::vector<int>& ModelKernel::neighbours(int surface) const {
  return implementation_->motion->neighbours[at(surface)];
}
bool ModelKernel::depends(int surface, int alpha) const {
  return implementation_->motion->depends[at(surface)][at(alpha)];
}

}  // namespace saltus::evaluation
