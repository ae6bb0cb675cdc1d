// A branch problem whose zero sides have a price: it is solved where the branch itself has no solution.
#pragma once

#include <vector>

#include "saltus/solver/cached_functions.hpp"

namespace saltus::solver::crossover {

/// States min f(w) + price sum_i side_i(w), where side_i >= 0 is the one of G_i and H_i that the branch has at zero;
/// its closure and the rows of the problem hold. Where the price is large, sides that are still paid for are those that
/// a motion near this one has not. Refers to the problem.
class PricedSides final : public mpcc::Problem {
 public:
  PricedSides(mpcc::Problem& problem, const std::vector<mpcc::ActiveSide>& zero, double price);

  [[nodiscard]] int variables() const override { return problem_.variables(); }
  [[nodiscard]] int constraints() const override { return static_cast<int>(rows_.size() + equal_.size()); }
  [[nodiscard]] int pairs() const override { return 0; }
  [[nodiscard]] const mpcc::Bounds& variable_bounds() const override { return variable_bounds_; }
  [[nodiscard]] const mpcc::Bounds& constraint_bounds() const override { return bounds_; }
  [[nodiscard]] const std::vector<mpcc::Sign>& signs() const override { return no_signs_; }
  [[nodiscard]] double objective(mpcc::ConstVectorView w) override;
  void objective_gradient(mpcc::ConstVectorView w, mpcc::VectorView gradient) override;
  void functions(mpcc::ConstVectorView w, mpcc::VectorView c) override;
  void jacobian(mpcc::ConstVectorView w, mpcc::VectorView values) override;
  void hessian(mpcc::ConstVectorView w, double objective_factor, mpcc::ConstVectorView y,
               mpcc::VectorView values) override;
  [[nodiscard]] const mpcc::Pattern& jacobian_pattern() const override { return jacobian_pattern_; }
  [[nodiscard]] const mpcc::Pattern& hessian_pattern() const override { return problem_.hessian_pattern(); }
  [[nodiscard]] std::vector<int> elimination_blocks() const override { return problem_.elimination_blocks(); }

 private:
  mpcc::Problem& problem_;
  CachedFunctions cache_;
  std::vector<int> rows_;                   ///< of the problem
  std::vector<std::pair<int, int>> equal_;  ///< variables
  mpcc::Bounds bounds_, variable_bounds_;
  std::vector<mpcc::Sign> no_signs_;
  std::vector<int> entries_;  ///< of its Jacobian
  mpcc::Pattern jacobian_pattern_;
  linalg::Vector price_;  ///< per row of the problem
};

}  // namespace saltus::solver::crossover
