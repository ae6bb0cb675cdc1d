// What a kernel evaluates row by row.
#include "saltus/base/contracts.hpp"
#include "saltus/base/symbolic_lock.hpp"
#include "saltus/evaluation/kernel_internal.hpp"

namespace saltus::evaluation {

const std::shared_ptr<const FieldRows>& CompiledModel::rows(CompiledMotion& motion) {
  const SymbolicLock lock;
  if (!motion.rows) motion.rows = forces.is_empty() ? FieldRows::of(motion.field, motion.constants) : nullptr;
  return *motion.rows;
}

/// Of the motion in force.
const FieldRows* ModelKernel::Implementation::rows() {
  if (!motion->rows) {
    motion->rows = compiled->rows(*motion->compiled);
    if (*motion->rows) motion->row_work = (*motion->rows)->work();
  }
  return motion->rows->get();
}

const FieldStructure* ModelKernel::field_structure() const {
  const auto* rows = implementation_->rows();
  return rows == nullptr ? nullptr : &rows->structure();
}

double ModelKernel::field_row(std::size_t row, double t, const double* x, const double* alpha) const {
  auto& self = *implementation_;
  return (*self.rows())(row, t, x, self.parameters.data(), alpha, self.motion->row_work);
}

double ModelKernel::rate(int function, double t, const double* x, const double* alpha) const {
  SALTUS_ASSERT(is_affine(function) && inner(function).empty());
  auto& self = *implementation_;
  const auto& gradients = self.gradients_of_affine();
  const std::size_t begin = gradients.start[at(function)], end = gradients.start[at(function) + 1];
  // A row costs as much, interpreted, as so many states as native code.
  constexpr std::size_t states_of_a_row = 16;
  const bool by_rows = states_of_a_row * (end - begin) < at(states()) && self.rows() != nullptr;
  if (!by_rows) field(t, x, alpha, self.slope.data());
  double rate = gradients.rate[at(function)];
  for (std::size_t k = begin; k < end; ++k) {
    const std::size_t column = gradients.column[k];
    rate += gradients.coefficient[k] * (by_rows ? field_row(column, t, x, alpha) : self.slope[column]);
  }
  return rate;
}

}  // namespace saltus::evaluation
