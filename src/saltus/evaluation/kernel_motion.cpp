// The right-hand side: free, or with guards of jumps held at zero.
#include <algorithm>
#include <array>
#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/base/contracts.hpp"
#include "saltus/base/symbolic_lock.hpp"
#include "saltus/evaluation/kernel_internal.hpp"

namespace saltus::evaluation {
void ModelKernel::field(double t, const double* x, const double* alpha, double* xdot) const {
  auto& self = *implementation_;
  prepare_field(alpha, self.constants);
  prepared_field(t, x, self.constants, xdot);
}

void ModelKernel::prepare_field(const double* alpha, FieldConstants& constants) const {
  auto& self = *implementation_;
  auto& function = self.motion->constants;
  constants.values.resize(at(function.function().numel_out(0)));
  constants.alpha.assign(alpha, alpha + self.compiled->n_psi);
  constants.motion = self.field_use.motion = self.motion;
  constants.direct = self.motion->direct;
  constants.steps = self.motion->steps ? &*self.motion->steps : nullptr;
  constants.use = &self.field_use;
  self.count(function);
  function(std::array<const double*, 2>{self.parameters.data(), alpha},
           std::array<double*, 1>{constants.values.data()});
}

void ModelKernel::prepared_field_anyhow(double t, const double* x, const FieldConstants& constants,
                                        double* xdot) const {
  auto& self = *implementation_;
  if (constants.motion != self.motion) return field(t, x, constants.alpha.data(), xdot);
  ++self.field_use.evaluations;
  if (self.motion->direct != nullptr) return self.motion->direct(t, x, constants.values.data(), xdot);
  self.count(self.motion->field);
  if (self.contact_solve.is_needed()) x = self.with_forces(t, x, constants.alpha.data());
  self.motion->field(std::array<const double*, 3>{&t, x, constants.values.data()}, std::array<double*, 1>{xdot});
}

Expected<CompiledMotion*> CompiledModel::held(const std::vector<int>& guards) {
  const SymbolicLock lock;
  if (const auto known = held_.find(guards); known != held_.end()) return &known->second;
  std::vector<HeldGuard> stated;
  for (const int function : guards) {
    SALTUS_ASSERT(first_jump_guard <= function && function < static_cast<int>(phi.numel()));
    stated.push_back(jump_guards[at(function - first_jump_guard)]);
  }
  auto expressions = held_motion(t, x, free.f, stated);
  if (!expressions) return tl::unexpected(expressions.error());
  CompiledMotion& result = held_[guards];
  result.f = expressions->f;
  compile_field(result, "held_field");
  result.pressure = ModelFunction("hold_pressure", {t, x, p, alpha}, {expressions->pressure});
  result.depends = normal_dependencies(result.f);
  result.neighbours = neighbours_in(result.depends);
  return &result;
}

Expected<void> ModelKernel::hold(const std::vector<Hold>& holds) {
  auto& self = *implementation_;
  if (holds.empty()) {
    self.field_use.motion = self.motion = &self.free;
    return {};
  }
  std::vector<int> guards;
  for (const auto& hold : holds) guards.push_back(hold.function);
  auto known = self.held.find(guards);
  if (known == self.held.end()) {
    const SymbolicLock lock;
    const auto motion = self.compiled->held(guards);
    if (!motion) return tl::unexpected(motion.error());
    known = self.held.emplace(guards, **motion).first;
  }
  self.field_use.motion = self.motion = &known->second;
  return {};
}

void ModelKernel::hold_pressure(double t, const double* x, const double* alpha, double* pressure) const {
  auto& self = *implementation_;
  SALTUS_ASSERT(!self.motion->pressure.is_null());
  self.motion->pressure(std::array<const double*, 4>{&t, x, self.parameters_at(t, x, alpha), alpha},
                        std::array<double*, 1>{pressure});
}

}  // namespace saltus::evaluation
