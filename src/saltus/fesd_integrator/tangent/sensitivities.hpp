// Derivatives of the discretisation with respect to initial state and parameters, by the implicit function theorem.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "saltus/discretization/butcher_tableau.hpp"
#include "saltus/discretization/tangent_kernel.hpp"
#include "saltus/fesd_integrator/element/active_set.hpp"
#include "saltus/fesd_integrator/element/element.hpp"
#include "saltus/result/sensitivities.hpp"

namespace saltus::fesd_integrator {

/// Carries X = d x(t_b) / d q and tau = d t_b / d q from the start (X = I or 0, tau = 0) to the end, for q = (x(t_0),
/// p). These are the *total* derivatives at the last boundary t_b of elements.
///
/// An element's equations R(z; x_0, t_0, h, p) = 0 (stages, selections, end) give dz = -R_z^{-1} (R_x0 X + R_t tau +
/// R_h dh + R_p). Within a chain of k equal elements dh is common; it follows from what closes the chain:
///   a switch:       sigma(x_end, t_end, p) = 0, sigma = psi_j, or the selection that reaches 0 or 1,
///   a time event:   a(t_end, x, p) = const, the argument of something held, over discrete states x,
///   a fixed end:    tau + k dh = 0.
/// X is continuous where the active set changes. Selections that close a chain are those of the projected field.
///
/// Limits: points where a failed step was divided count as fixed. Where several time events that move differently fall
/// on one point, columns that move them apart are not defined.
class SensitivityPropagation {
 public:
  /// The kernel must outlive it.
  SensitivityPropagation(const discretization::TangentKernel& kernel, discretization::ButcherTableau tableau);
  SensitivityPropagation(SensitivityPropagation&&) noexcept;
  ~SensitivityPropagation();

  /// Follows solved elements of equal length and one active set, one after the other.
  /// @param left     selections of the projected field at the left end of each, and at the right end of the last
  /// @param closing  the condition that is zero at the end; nullptr: the end is fixed, or a time event
  /// @param changing what is held up to the end; nullopt: it is not the time of an event
  /// Cost: per element the solution of its linear system for n_x + n_p + 1 right-hand sides. Allocates.
  void chain(std::span<const Element> elements, std::span<const std::vector<double>> left, const ActiveSet& set,
             const double* held, const Condition* closing, std::optional<std::size_t> changing);
  /// Notes that a switch turns out to lie at the last boundary, a fixed end. It moves off it with the field before it.
  /// @param set, selections, held  those before the switch
  void switched_here(double t, const std::vector<double>& x, const std::vector<double>& selections, const double* held,
                     const ActiveSet& set, const Condition& condition);
  /// Follows a step without switch detection. From here `count` elements of equal length go to `end`.
  struct End {
    double t = 0.0;
    const double* x = nullptr;  ///< discrete states are all that counts of it
    const double* held = nullptr;
    std::optional<std::size_t> changing;
  };
  void begin_fixed_steps(int count, const End& end);
  /// Follows one of these elements, or `part` of it; an active set for every stage.
  void fixed_step(const Element& element, std::span<const ActiveSet> sets, const double* held, double part);
  /// Notes that something held has changed at the last boundary from `before` to `behind`; `selections` are those
  /// before it.
  void held_changed(double t, const double* x, const double* selections, const double* before, const double* behind);

  /// Returns those at the last boundary, which must be the fixed end of the run.
  [[nodiscard]] result::Sensitivities sensitivities(const std::vector<std::string>& parameter_names) const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace saltus::fesd_integrator
