// An optimised trajectory of a frozen system, as the event engine takes it.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/model/ocp.hpp"
#include "saltus/pipeline/optimal_control/touching_bodies_internal.hpp"
#include "saltus/pipeline/optimal_control/verify.hpp"

namespace saltus::pipeline {

/// Returns the problem over Ocp::physical instead of the frozen system: controls and constraints are the same ones.
[[nodiscard]] model::Ocp physical_ocp(const model::Ocp& ocp);

/// Holds Ocp::physical with the parameters of a solution, compiled, and its bodies.
class PhysicalBodies {
 public:
  /// @param parameters  behind those of the physical system may be that of a stabilisation which is followed down
  [[nodiscard]] static Expected<std::unique_ptr<PhysicalBodies>> make(const model::Ocp& ocp,
                                                                      const std::vector<double>& parameters);
  [[nodiscard]] const model::System& system() const { return system_; }
  [[nodiscard]] TouchingBodies& touching() { return touching_; }

 private:
  PhysicalBodies(model::System system, evaluation::ModelKernel kernel)
      : system_(std::move(system)), kernel_(std::move(kernel)), touching_(kernel_) {}

  model::System system_;
  evaluation::ModelKernel kernel_;
  TouchingBodies touching_;
};

/// Returns the path in physical time over the states of Ocp::physical. At nodes a hysteresis is 0 or 1, closed gaps are
/// 0, and modes of contacts are open: the event engine finds them.
/// @param run  trajectory and events of the result, in physical time
[[nodiscard]] OptimizedPath physical_path(const model::Ocp& ocp, PhysicalBodies& bodies, const OptimizedPath& path,
                                          const result::Result& run);

/// Gives the impacts of an optimised trajectory their impulses, and the contacts that have one: a frozen system of an
/// optimisation does not sum them up.
void add_impulses(PhysicalBodies& bodies, result::Result& run);

}  // namespace saltus::pipeline
