// The functions of a kernel that need nothing but a call. Others: kernel_motion.cpp, kernel_derivatives.cpp.
#include "saltus/evaluation/model_kernel.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/base/symbolic_lock.hpp"
#include "saltus/evaluation/kernel_internal.hpp"

namespace saltus::evaluation {
ModelKernel::ModelKernel(std::unique_ptr<Implementation> implementation) : implementation_(std::move(implementation)) {}
ModelKernel::ModelKernel(ModelKernel&&) noexcept = default;
ModelKernel& ModelKernel::operator=(ModelKernel&& other) noexcept {
  std::swap(implementation_, other.implementation_);
  return *this;
}
ModelKernel::~ModelKernel() {
  if (!implementation_) return;
  const SymbolicLock lock;
  implementation_.reset();
}

std::shared_ptr<CompiledModel> ModelKernel::compiled() const { return implementation_->compiled; }

int ModelKernel::states() const { return static_cast<int>(implementation_->compiled->x.numel()); }
int ModelKernel::switching_functions() const { return implementation_->compiled->n_psi; }
int ModelKernel::event_functions() const { return static_cast<int>(implementation_->compiled->phi.numel()); }
int ModelKernel::outputs() const { return static_cast<int>(implementation_->compiled->outputs.numel()); }
int ModelKernel::controls() const { return static_cast<int>(implementation_->compiled->input.numel()); }
long ModelKernel::field_evaluations() const { return implementation_->field_use.evaluations; }
const void* ModelKernel::motion() const { return implementation_->motion; }

void ModelKernel::functions(double t, const double* x, const double* alpha, double* values) const {
  auto& self = *implementation_;
  self.count(self.functions);
  self.functions(std::array<const double*, 4>{&t, x, self.parameters_at(t, x, alpha), alpha},
                 std::array<double*, 1>{values});
}

void ModelKernel::ranges(double t, const double* x, const double* alpha, const double* radii, double* middle,
                         double* radius) const {
  auto& self = *implementation_;
  if (self.ranges.is_null()) {
    std::fill_n(radius, event_functions(), std::numeric_limits<double>::infinity());
    return;
  }
  self.count(self.ranges);
  self.ranges(std::array<const double*, 5>{&t, x, self.parameters_at(t, x, alpha), alpha, radii},
              std::array<double*, 2>{middle, radius});
  for (int j = self.compiled->first_jump_guard; self.contact_solve.is_needed() && j < event_functions(); ++j) {
    if (self.contact_solve.moves(j)) radius[j] = std::numeric_limits<double>::infinity();
  }
}

void ModelKernel::scales(double t, const double* x, const double* alpha, double* magnitude, double* slope) const {
  auto& self = *implementation_;
  auto& last = self.last_scales;
  const double* p = self.parameters_at(t, x, alpha);
  if (!last.point.is_at(self.point(&t, x, alpha))) {
    last.magnitude.resize(at(event_functions()));
    last.slope.resize(last.magnitude.size());
    self.scales(std::array<const double*, 4>{&t, x, p, alpha},
                std::array<double*, 2>{last.magnitude.data(), last.slope.data()});
    if (self.contact_solve.is_needed()) self.scale_forces(t, x, alpha);
  }
  std::copy(last.magnitude.begin(), last.magnitude.end(), magnitude);
  std::copy(last.slope.begin(), last.slope.end(), slope);
}

void ModelKernel::outputs(double t, const double* x, const double* alpha, double* values) const {
  auto& self = *implementation_;
  self.output_function(std::array<const double*, 4>{&t, x, self.parameters_at(t, x, alpha), alpha},
                       std::array<double*, 1>{values});
}

void ModelKernel::inputs(double t, const double* alpha, double* values) const {
  auto& self = *implementation_;
  self.input_function(std::array<const double*, 4>{&t, nullptr, self.parameters.data(), alpha},
                      std::array<double*, 1>{values});
}

bool ModelKernel::condition(int event, double t, const double* x, const double* alpha,
                            const double* guard_alpha) const {
  auto& self = *implementation_;
  double value = 0.0;
  self.conditions[at(event)](std::array<const double*, 5>{&t, x, self.parameters.data(), alpha, guard_alpha},
                             std::array<double*, 1>{&value});
  return value > 0.5;
}

bool ModelKernel::is_listed_only(int function) const {
  return function >= switching_functions() && function < implementation_->compiled->first_jump_guard;
}

int ModelKernel::jump_guard(int jump, int guard) const { return implementation_->jumps.guard(jump, guard); }

bool ModelKernel::jump_condition(int jump, double t, const double* x, const double* alpha,
                                 const double* guard_alpha) const {
  auto& self = *implementation_;
  return self.jumps.condition(jump, {&t, x, self.parameters.data(), alpha}, guard_alpha);
}

void ModelKernel::jump_values(int jump, double t, const double* x, const double* alpha, double* values) const {
  auto& self = *implementation_;
  self.jumps.values(jump, {&t, x, self.parameters.data(), alpha}, values);
}

double ModelKernel::jump_priority(int jump, double t, const double* x, const double* alpha) const {
  auto& self = *implementation_;
  return self.jumps.priority(jump, {&t, x, self.parameters.data(), alpha});
}

double ModelKernel::jump_delay(int jump, double t, const double* x, const double* alpha) const {
  auto& self = *implementation_;
  return self.jumps.delay(jump, {&t, x, self.parameters.data(), alpha});
}

const std::vector<RegionRange>& ModelKernel::region_groups() const { return implementation_->regions.groups(); }
int ModelKernel::reference(std::size_t group) const { return implementation_->regions.reference(group); }

void ModelKernel::set_reference(std::size_t group, int function) {
  auto& self = *implementation_;
  if (!self.regions.set_reference(group, function, self.parameters)) return;
  self.constant_gradients.reset();
}

bool ModelKernel::has_fixed_constants() const { return implementation_->has_fixed_constants(); }
int ModelKernel::cells() const { return implementation_->cells.size(); }
int ModelKernel::cell_function(int cell) const { return event_functions() - 2 * (cells() - cell); }
const model::CellTable& ModelKernel::cell_table(int cell) const { return implementation_->cells.table(cell); }
long ModelKernel::cell(int cell) const { return implementation_->cells.index(cell); }

void ModelKernel::set_cell(int cell, long target) {
  auto& self = *implementation_;
  self.cells.move(cell, target, self.parameters);
  self.constant_gradients.reset();
}

double ModelKernel::cell_argument(int cell, double t, const double* x, const double* alpha) const {
  return implementation_->cells.argument(cell, {&t, x, implementation_->parameters.data(), alpha});
}

bool ModelKernel::depends_on_cell(int function, int cell) const {
  return implementation_->compiled->on_cells[at(function)][at(cell)];
}

}  // namespace saltus::evaluation
