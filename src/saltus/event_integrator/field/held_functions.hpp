// Switching functions and their derivatives along the field as functions of the state: values, gradients, projection.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/event_integrator/sliding/normal_rows.hpp"
#include "saltus/linalg/matrix.hpp"

namespace saltus::event_integrator {

/// Holds the derivative of this order of psi_surface along the field; order 0: psi itself.
struct HeldFunction {
  int surface = 0;
  int order = 0;
};

/// Evaluates c_i(t, x) = 0 for a list of such functions, ordered by `order`; those of order >= 1 must not depend on the
/// selections of the sliding surfaces where the functions before them are zero. Their derivatives are taken along the
/// set where the functions of lower order vanish, in time, too, where that moves, by central differences: a field need
/// not be differentiable across its surface. Beside roots of psi (super-twisting), which are 0 with all their
/// derivatives there, by forms: what surfaces are near may have roots, too, which differences are too wide for. Owns
/// its work space; allocates in set() only. Cost: two evaluations of c_i per state and function of order >= 1. Of
/// functions that hold the selections of others in the list what is left where these are 0 counts, with selections of
/// 1/2 and without roots: v + sqrt(abs(x))*sign(x) and x are held as v and x.
class HeldFunctions {
 public:
  explicit HeldFunctions(const evaluation::ModelKernel& kernel);

  /// Takes the functions.
  /// @param alpha  n_psi selections to evaluate with, 1/2 for the sliding surfaces
  void set(std::vector<HeldFunction> functions, std::vector<double> alpha);
  [[nodiscard]] const std::vector<HeldFunction>& list() const { return functions_; }
  [[nodiscard]] const std::vector<double>& alpha() const { return alpha_; }
  [[nodiscard]] double value(std::size_t i, double t, const double* x) const;
  /// Finds the gradients and d c/dt at a point.
  void differentiate(double t, const double* x);
  [[nodiscard]] const linalg::Matrix& rows() const { return rows_; }
  [[nodiscard]] const linalg::Vector& rates() const { return rates_; }
  /// Returns, behind differentiate(), the part of gradient i that the ones before do not span, relative to it; 0 if it
  /// is 0.
  [[nodiscard]] double independent_part(std::size_t i) const { return parts_[static_cast<linalg::Index>(i)]; }
  /// Returns, behind differentiate(), grad c_i . f + d c_i/dt; and the sum of the sizes of its terms.
  [[nodiscard]] double velocity(std::size_t i, const std::vector<double>& f) const;
  [[nodiscard]] double velocity_terms(std::size_t i, const std::vector<double>& f) const;
  /// Takes from f, behind differentiate(), its part normal to the set, for a motion that stays in it.
  void remove_normal_part(std::vector<double>& f);
  /// Returns whether psi_i, held itself, is around a root that is not limited.
  [[nodiscard]] bool is_beside_root(std::size_t i) const { return beside_root_[i]; }
  /// Takes Newton steps onto c = 0; returns whether x changed. Low orders first.
  bool project(double t, double* x);
  /// Returns, behind differentiate(), x moved by about `step` (relative to 1 + |x_i|) along the tangent space, in a
  /// direction that `pattern` says, and projected; equal to x if the tangent space is empty.
  [[nodiscard]] std::vector<double> displaced(double t, const double* x, double step, unsigned pattern);

 private:
  struct Part {
    NormalRows gradients;
    linalg::Vector residual;  ///< one per function
  };
  void find_forms();
  [[nodiscard]] bool is_by_form(std::size_t i) const { return rooted_ || forms_[i] < 0; }
  [[nodiscard]] std::size_t below(std::size_t i) const;
  [[nodiscard]] bool tangent_direction(std::size_t state, std::size_t lower, std::vector<double>& direction) const;
  void find_drift(std::size_t lower);
  [[nodiscard]] double value_along(std::size_t i, double t, const double* x, double width);
  void extend_basis(std::size_t i);
  bool correct(Part& part, double t, double* x);
  NormalRows& gradients_of(Part& part);

  const evaluation::ModelKernel& kernel_;
  std::vector<HeldFunction> functions_;
  std::vector<double> alpha_, row_, direction_, point_;
  std::vector<int> forms_;  ///< numbers of the kernel: negative where roots are limited
  std::vector<bool> beside_root_;
  bool rooted_ = false;  ///< whether f has a root of one of the surfaces' functions
  mutable std::vector<double> values_;
  linalg::Matrix rows_, basis_;  ///< gradients, row by row; an orthonormal basis of their span, column by column
  linalg::Vector rates_, parts_;
  std::array<Part, 2> onto_;  ///< the first functions, the switching functions themselves; and all
};

}  // namespace saltus::event_integrator
