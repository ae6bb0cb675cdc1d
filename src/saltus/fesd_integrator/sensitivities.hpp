// Derivatives of the discretisation with respect to initial state and parameters, by the implicit function theorem.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "saltus/discretization/butcher_tableau.hpp"
#include "saltus/discretization/tangent_kernel.hpp"
#include "saltus/fesd_integrator/active_set.hpp"
#include "saltus/fesd_integrator/element.hpp"
#include "saltus/result/sensitivities.hpp"

namespace saltus::fesd_integrator {

/// Carries X = d x(t_b) / d q and tau = d t_b / d q, the *total* derivatives at the last boundary t_b of elements, from
/// the start (X = I or 0, tau = 0) to the end, for q = (x(t_0), p).
///
/// An element's equations R(z; x_0, t_0, h, p) = 0 (stages, selections, end) give dz = -R_z^{-1} (R_x0 X + R_t tau +
/// R_h dh + R_p). Within a chain of k equal elements dh is common; it follows from what closes the chain:
///   a switch:       sigma(x_end, t_end, p) = 0, sigma = psi_j, or the selection that reaches 0 or 1,
///   a fixed end:    tau + k dh = 0.
/// X is continuous where the active set changes. Selections that close a chain are those of the projected field.
///
/// Limits: where the end of an element is projected (c_s != 1, sliding) the change of the direction of projection is
/// left out, a term of the order of the local error. Points where a failed step was divided count as fixed.
class SensitivityPropagation {
 public:
  /// The kernel must outlive it.
  SensitivityPropagation(const discretization::TangentKernel& kernel, discretization::ButcherTableau tableau);
  SensitivityPropagation(SensitivityPropagation&&) noexcept;
  ~SensitivityPropagation();

  /// Solved elements of equal length and one active set, one after the other.
  /// @param left     selections of the projected field at the left end of each, and at the right end of the last
  /// @param closing  the condition that is zero at the end; nullptr: the end is fixed
  /// Cost: per element the solution of its linear system for n_x + n_p + 1 right-hand sides. Allocates.
  void chain(std::span<const Element> elements, std::span<const std::vector<double>> left, const ActiveSet& set,
             const double* held, const Condition* closing);
  /// One element of fixed length, an active set for every stage.
  void fixed_step(const Element& element, std::span<const ActiveSet> sets, const double* held);

  /// At the last boundary, which must be the fixed end of the run.
  [[nodiscard]] result::Sensitivities sensitivities(const std::vector<std::string>& parameter_names) const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace saltus::fesd_integrator
