// One evaluation per iterate, none twice.
#pragma once

#include "saltus/mpcc/problem.hpp"

namespace saltus::solver {

/// Keeps c(w) and the values of dc/dw of a problem, evaluated again only where w differs from the last one asked for.
/// Solvers ask for values, Jacobian and Hessian at the same w one after the other. Refers to the problem.
class CachedFunctions {
 public:
  explicit CachedFunctions(mpcc::Problem& problem)
      : problem_(&problem), c_(problem.rows()), jacobian_(problem.jacobian_pattern().entries()) {}

  /// Returns what is valid until the next call.
  [[nodiscard]] const linalg::Vector& functions(mpcc::ConstVectorView w) {
    move_to(w);
    if (!has_functions_) problem_->functions(w_, c_);
    has_functions_ = true;
    return c_;
  }
  [[nodiscard]] const linalg::Vector& jacobian(mpcc::ConstVectorView w) {
    move_to(w);
    if (!has_jacobian_) problem_->jacobian(w_, jacobian_);
    has_jacobian_ = true;
    return jacobian_;
  }
  /// Is called when parameters of the problem have changed.
  void forget() { w_.resize(0); }

 private:
  void move_to(mpcc::ConstVectorView w) {
    // NaN is equal to nothing, so that a point with one is never taken for the last.
    if (w_.size() == w.size() && w_ == w) return;
    w_ = w;
    has_functions_ = has_jacobian_ = false;
  }

  mpcc::Problem* problem_;
  linalg::Vector w_;
  linalg::Vector c_;
  linalg::Vector jacobian_;
  bool has_functions_ = false;
  bool has_jacobian_ = false;
};

}  // namespace saltus::solver
