// What bounds alone decide of a problem: rows without variables, pairs with one side that cannot be zero,
// contradictions.
#pragma once

#include <string>
#include <vector>

#include "saltus/mpcc/problem.hpp"

namespace saltus::mpcc {

/// Holds what was found; rows by their numbers in (g, G, H) of the problem.
struct Presolve {
  int fixed_variables = 0;  ///< bounds are equal
  int empty_rows = 0;       ///< of g, without a variable or without a finite bound
  int forced_pairs = 0;     ///< one side is positive for all w, so that the other one is zero
  int fixed_pairs = 0;      ///< one side is zero for all w, so that nothing is left but the sign of the other
  /// "row: 2 to 3 within the bounds of the variables, but -1 to 1 is asked for", for each contradiction.
  std::vector<std::string> infeasible;

  std::vector<int> kept_rows;  ///< of g
  std::vector<int> kept_pairs;
  std::vector<int> zero_sides;      ///< rows of G and H that are zero
  std::vector<int> positive_sides;  ///< those that need only be >= 0

  [[nodiscard]] bool changes_rows() const { return empty_rows + forced_pairs + fixed_pairs > 0; }
};

/// @param ranges  of each row of (g, G, H): the least and the greatest value that it has within the bounds of the
///                variables; infinite where nothing is known
/// Cost: one pass over bounds and the pattern of the Jacobian.
[[nodiscard]] Presolve presolve(const Problem& problem, const Bounds& ranges);

/// States the problem that presolve leaves, in the same variables: rows of g are those that are kept, then zero and
/// positive sides. Implied sides that are zero fix their variables instead. Refers to the problem.
class PresolvedProblem final : public Problem {
 public:
  PresolvedProblem(Problem& problem, Presolve found);

  /// Returns the row of the whole problem that row i of (g, G, H) here is.
  [[nodiscard]] int row_of_whole(int row) const { return rows_[static_cast<std::size_t>(row)]; }

  [[nodiscard]] int variables() const override { return problem_.variables(); }
  [[nodiscard]] int constraints() const override { return static_cast<int>(constraint_bounds_.lower.size()); }
  [[nodiscard]] int pairs() const override { return static_cast<int>(found_.kept_pairs.size()); }
  [[nodiscard]] const Bounds& variable_bounds() const override { return variable_bounds_; }
  [[nodiscard]] const Bounds& constraint_bounds() const override { return constraint_bounds_; }
  [[nodiscard]] const std::vector<Sign>& signs() const override { return signs_; }
  [[nodiscard]] double objective(ConstVectorView w) override { return problem_.objective(w); }
  void objective_gradient(ConstVectorView w, VectorView gradient) override { problem_.objective_gradient(w, gradient); }
  void functions(ConstVectorView w, VectorView c) override;
  void jacobian(ConstVectorView w, VectorView values) override;
  void hessian(ConstVectorView w, double objective_factor, ConstVectorView y, VectorView values) override;
  [[nodiscard]] const Pattern& jacobian_pattern() const override { return jacobian_pattern_; }
  [[nodiscard]] const Pattern& hessian_pattern() const override { return problem_.hessian_pattern(); }
  [[nodiscard]] linalg::Vector start() const override { return problem_.start(); }
  [[nodiscard]] std::string name(int variable) const override { return problem_.name(variable); }
  [[nodiscard]] std::string row_name(int row) const override { return problem_.row_name(row_of_whole(row)); }

 private:
  void fix_zero_sides();
  void find_pattern();

  Problem& problem_;
  Presolve found_;
  Bounds variable_bounds_, constraint_bounds_;
  std::vector<Sign> signs_;
  std::vector<int> rows_;  ///< of the whole problem
  std::vector<int> jacobian_entries_;
  Pattern jacobian_pattern_;
};

}  // namespace saltus::mpcc
