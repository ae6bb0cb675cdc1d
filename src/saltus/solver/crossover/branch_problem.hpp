// The problem with one side of every pair fixed: a nonlinear program in what is left.
#pragma once

#include <vector>

#include "saltus/solver/cached_functions.hpp"
#include "saltus/solver/crossover/reduction.hpp"

namespace saltus::solver::crossover {

/// States the problem of one branch:
///   min f(w(v))   subject to   the rows and bounds of a Reduction.
/// w(v) has the held variables at their values and equal ones at that of their place. Refers to the problem.
class BranchProblem final : public mpcc::Problem {
 public:
  BranchProblem(mpcc::Problem& problem, Reduction reduction);

  [[nodiscard]] const Reduction& reduction() const { return reduction_; }
  [[nodiscard]] linalg::Vector full(mpcc::ConstVectorView v) const;     ///< w(v)
  [[nodiscard]] linalg::Vector reduced(mpcc::ConstVectorView w) const;  ///< v, moved onto its bounds
  /// Keeps variables (of the whole problem) above a part of what they are in w.
  void keep_above(const std::vector<int>& variables, mpcc::ConstVectorView w);
  /// Leaves rows out, by their numbers here.
  void drop_rows(const std::vector<int>& rows);
  /// Returns the rows that were left out so, by their numbers in the whole problem.
  [[nodiscard]] const std::vector<int>& left_out() const { return left_out_; }

  [[nodiscard]] int variables() const override { return reduction_.variables(); }
  [[nodiscard]] int constraints() const override { return static_cast<int>(reduction_.rows.size()); }
  [[nodiscard]] int pairs() const override { return 0; }
  [[nodiscard]] const mpcc::Bounds& variable_bounds() const override { return reduction_.bounds; }
  [[nodiscard]] const mpcc::Bounds& constraint_bounds() const override { return reduction_.row_bounds; }
  [[nodiscard]] const std::vector<mpcc::Sign>& signs() const override { return no_signs_; }
  [[nodiscard]] double objective(mpcc::ConstVectorView v) override { return problem_.objective(full(v)); }
  void objective_gradient(mpcc::ConstVectorView v, mpcc::VectorView gradient) override;
  void functions(mpcc::ConstVectorView v, mpcc::VectorView c) override;
  void jacobian(mpcc::ConstVectorView v, mpcc::VectorView values) override;
  void hessian(mpcc::ConstVectorView v, double objective_factor, mpcc::ConstVectorView y,
               mpcc::VectorView values) override;
  [[nodiscard]] const mpcc::Pattern& jacobian_pattern() const override { return jacobian_pattern_; }
  [[nodiscard]] const mpcc::Pattern& hessian_pattern() const override { return hessian_pattern_; }
  [[nodiscard]] std::vector<int> elimination_blocks() const override;

 private:
  /// Entries of the problem's Hessian that are left, and 2 where both triangles fall on one diagonal entry.
  struct HessianEntry {
    int entry;
    double factor;
  };
  void find_patterns();

  mpcc::Problem& problem_;
  Reduction reduction_;
  std::vector<int> left_out_;
  CachedFunctions cache_;
  std::vector<mpcc::Sign> no_signs_;
  std::vector<int> jacobian_entries_;
  std::vector<HessianEntry> hessian_entries_;
  mpcc::Pattern jacobian_pattern_;
  mpcc::Pattern hessian_pattern_;
};

}  // namespace saltus::solver::crossover
