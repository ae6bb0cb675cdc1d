// Leaving a surface on which the field has an infinite derivative (a root of |psi|): explicit steps from there
// overshoot however short they are.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/event_integrator/field/mode_field.hpp"
#include "saltus/event_integrator/mode/mode_state.hpp"
#include "saltus/ode/stepper.hpp"

namespace saltus::event_integrator {

/// Takes steps of implicit Euler, extrapolated, that begin on a surface and go into the region of a mode. The unknowns
/// are the states, one of them replaced by v > 0 with psi = +-v^(1/q), in which |psi|^q is smooth (q is found): the
/// equations
///   x = x_k + h f(t + h, x)
/// have a regular solution where the solution leaves, and none where it does not.
/// Owns its work space. Cost: n_x + 1 evaluations of f per iteration, some four of these per substep.
class RootedExit {
 public:
  RootedExit(const evaluation::ModelKernel& kernel, bool affine_in_alpha, const ModeState& state, int surface);

  /// Returns whether short steps from (t, x), on the surface, find a solution inside the region: over h and parts of
  /// it.
  [[nodiscard]] bool leads_away(double t, const std::vector<double>& x, double h);
  /// Returns the state at t + h, if its error, estimated from the last two extrapolations, is within the tolerances.
  [[nodiscard]] std::optional<std::vector<double>> step(double t, const std::vector<double>& x, double h,
                                                        const ode::Tolerances& tolerances);
  /// Returns whether dpsi/dt falls with a root of psi from the surface on, so that its derivative there is infinite.
  [[nodiscard]] bool has_root(double t, const std::vector<double>& x);
  /// Returns -d(dpsi/dt)/d psi beside the surface: what limits the steps of explicit methods; 0 where it is not
  /// positive.
  [[nodiscard]] double stiffness(double t, const std::vector<double>& x);

 private:
  [[nodiscard]] double psi(double t, const std::vector<double>& x);
  [[nodiscard]] double velocity(double t, const std::vector<double>& x);
  bool place(double t, const std::vector<double>& unknowns, std::vector<double>& x);
  bool residual(double t, double h, const std::vector<double>& unknowns, std::vector<double>& result);
  bool implicit_euler(double t, double h, std::vector<double>& unknowns);
  bool substeps(double t, const std::vector<double>& x, double h, int count, std::vector<double>& unknowns);
  void find_replaced(double t, const std::vector<double>& x);
  [[nodiscard]] double change_beside(double t, const std::vector<double>& x, double width);
  void find_degree(double t, const std::vector<double>& x);

  const evaluation::ModelKernel& kernel_;
  ModeField field_;
  ModeState state_;
  int surface_;
  double side_;
  std::size_t replaced_ = 0;  ///< the state with the largest part in grad psi, which v stands for
  double noise_ = 0.0;        ///< rounding of psi
  double degree_ = 0.0;       ///< 1/q, once it was looked at: on the surface
  std::vector<double> row_, values_, from_, x_, f_;
};

}  // namespace saltus::event_integrator
