// The linear part of the motion in a mode, where that is affine: of a region, and of sliding on one surface.
#pragma once

#include <optional>
#include <vector>

#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/ode/linear_field.hpp"

namespace saltus::event_integrator {

/// Finds the linear motion of a mode once, when it is first asked for.
class LinearMotion {
 public:
  /// Holds the gradient of a surface, constant; `only`: its only component that is not 0, or -1.
  struct Normal {
    const double* row = nullptr;
    int only = -1;
  };

  LinearMotion() = default;
  LinearMotion(const LinearMotion&) = delete;  // known_ points into it
  LinearMotion& operator=(const LinearMotion&) = delete;

  /// Forgets it, as another mode begins.
  void forget() { known_.reset(); }
  /// Returns null where the field is not affine. Valid until forget().
  [[nodiscard]] const ode::LinearField* of_region(const evaluation::ModelKernel& kernel,
                                                  const evaluation::FieldConstants& region);
  /// Does the same for sliding between two regions. With f+ - f- = d, J d /= 0, f- = A x + b + c t,
  ///   xdot = f- + s d,  s = -(J f- + d psi/dt) / (J d),
  /// is affine where d is constant: A - d (J A) / (J d) and c - d (J c) / (J d); null otherwise.
  [[nodiscard]] const ode::LinearField* on_surface(const evaluation::ModelKernel& kernel,
                                                   const evaluation::FieldConstants& below,
                                                   const evaluation::FieldConstants& above, Normal normal);

 private:
  [[nodiscard]] bool find_difference(const evaluation::ModelKernel& kernel, const evaluation::FieldConstants& below,
                                     const evaluation::FieldConstants& above);
  void project(const ode::LinearField& field, Normal normal, double closing);

  std::optional<const ode::LinearField*> known_;
  ode::LinearField own_[2], sliding_;
  std::vector<double> origin_, difference_, above_;
  std::vector<double> row_;     ///< of A
  std::vector<double> normal_;  ///< J A / (J d)
};

}  // namespace saltus::event_integrator
