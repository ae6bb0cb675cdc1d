// Roots at the stages of an element: unknowns of Newton's method that are eliminated from its linear systems.
#pragma once

#include <cstddef>
#include <vector>

#include "saltus/discretization/stage_kernel.hpp"

namespace saltus::fesd_integrator {

/// Holds the values r of Dcs::roots at every stage, with the equations |r|^(1/c) sign(r) = base(x). As a function of x
/// a root has an infinite derivative at 0, and Newton's method jumps between both sides; as equations in (x, r)
/// everything has finite ones. The step of r is eliminated:
///   dr = (base_x dx + rho) / d,   rho = base - |r|^(1/c) sign(r),   d = |r|^(1/c - 1) / c,
/// so f gets f_root rho / d, and f_x gets f_root base_x / d.
class RootUnknowns {
 public:
  RootUnknowns(const discretization::StageKernel& kernel, std::size_t stages);
  [[nodiscard]] bool empty() const { return exponents_.empty(); }

  /// Starts from the base at a guess of the state.
  void start(std::size_t stage, double t, const double* x, const double* selections, const double* held);
  /// Evaluates the values and derivatives of a stage with the step of its roots eliminated.
  void evaluate(std::size_t stage, double t, const double* x, const double* selections, const double* held,
                discretization::StageValues& values);
  /// Takes the step of the roots that belongs to this one of the state of the last evaluate().
  /// @return the largest change of a root, relative to its largest value at the stages; 0 if nobody depends on the
  /// stage
  double update(std::size_t stage, const double* step, bool felt);
  /// Evaluates f of a stage at its roots.
  void field(std::size_t stage, double t, const double* x, const double* selections, const double* held, double* f);

 private:
  [[nodiscard]] double* roots(std::size_t stage) { return roots_.data() + stage * exponents_.size(); }

  const discretization::StageKernel& kernel_;
  std::vector<double> exponents_;
  std::vector<double> roots_, residual_, slope_;  ///< n_roots per stage
  std::vector<discretization::RootValues> values_;
  discretization::StageValues scratch_;
};

}  // namespace saltus::fesd_integrator
