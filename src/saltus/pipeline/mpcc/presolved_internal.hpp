// What presolve leaves of a foreign problem, and its multipliers as those of the whole.
#pragma once

#include <optional>

#include "saltus/foreign/problem.hpp"
#include "saltus/mpcc/presolve.hpp"
#include "saltus/result/mpcc_result.hpp"
#include "saltus/solver/solve.hpp"

namespace saltus::pipeline {

class Presolved {
 public:
  explicit Presolved(foreign::Problem& problem);

  [[nodiscard]] const mpcc::Presolve& found() const { return found_; }
  [[nodiscard]] result::PresolveCounts counts() const;
  /// The smaller problem, or the whole one where there is nothing to leave out.
  [[nodiscard]] mpcc::Problem& problem();
  /// The row of (g, G, H) of the whole problem.
  [[nodiscard]] int row_of_whole(int row) const { return smaller_ ? smaller_->row_of_whole(row) : row; }
  /// Multipliers of the whole problem; sides that hold variables get what those bounds bear.
  [[nodiscard]] solver::MpccMultipliers multipliers_of_whole(const solver::Solution& solution);

 private:
  foreign::Problem& whole_;
  mpcc::Presolve found_;
  std::optional<mpcc::PresolvedProblem> smaller_;
};

}  // namespace saltus::pipeline
