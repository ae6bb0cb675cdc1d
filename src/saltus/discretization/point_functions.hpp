// What a result shows of a dynamic complementarity system at a point: columns, outputs, inputs, user events; and what
// is held within a simulation step.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "saltus/base/error.hpp"
#include "saltus/evaluation/model_kernel.hpp"

namespace saltus::reformulation {
struct Dcs;
}

namespace saltus::discretization {

/// Evaluates plain functions of doubles, as in StageKernel.
class PointFunctions {
 public:
  [[nodiscard]] static Expected<PointFunctions> compile(const reformulation::Dcs& dcs, std::vector<double> parameters,
                                                        evaluation::NativeCode native = evaluation::NativeCode::off);
  PointFunctions(PointFunctions&&) noexcept;
  PointFunctions& operator=(PointFunctions&&) noexcept;
  ~PointFunctions();

  /// Evaluates selections of the System's switching functions.
  void alpha(const double* selection, const double* held, double* alpha) const;
  void outputs(double t, const double* x, const double* selection, const double* held, double* values) const;
  void inputs(double t, const double* held, double* values) const;
  /// Evaluates arguments of the held symbols; each depends on the values of those before it.
  void held_arguments(double t, const double* x, const double* held, double* arguments) const;

  /// Returns the number of functions whose zeros are user events: the expressions, then the guards of the conditions,
  /// in the order of the events; and the truth of the condition of an event from the steps of its own guards.
  [[nodiscard]] std::size_t event_functions() const;
  void event_values(double t, const double* x, const double* selection, const double* held, double* values) const;
  [[nodiscard]] bool condition(std::size_t event, double t, const double* x, const double* selection,
                               const double* held, const double* guard_steps) const;

 private:
  struct Implementation;
  explicit PointFunctions(std::unique_ptr<Implementation> implementation);
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace saltus::discretization
