// A problem with complementarities that a file states.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "saltus/mpcc/problem.hpp"

namespace saltus::foreign {

/// States the problem of a file, whose variables are those of the file in its order; behind them two for each
/// complementarity with a variable between two bounds (its row = plus - minus). Rows g are the file's, without those
/// that are one side of a pair; behind them those of such complementarities. Functions and first derivatives are
/// evaluated once per point. Made by `parse`.
class Problem final : public mpcc::Problem {
 public:
  struct Implementation;
  explicit Problem(std::unique_ptr<Implementation> implementation);
  ~Problem() override;

  [[nodiscard]] int variables() const override;
  [[nodiscard]] int constraints() const override;
  [[nodiscard]] int pairs() const override;
  [[nodiscard]] const mpcc::Bounds& variable_bounds() const override;
  [[nodiscard]] const mpcc::Bounds& constraint_bounds() const override;
  [[nodiscard]] const std::vector<mpcc::Sign>& signs() const override;
  [[nodiscard]] double objective(mpcc::ConstVectorView w) override;
  void objective_gradient(mpcc::ConstVectorView w, mpcc::VectorView gradient) override;
  void functions(mpcc::ConstVectorView w, mpcc::VectorView c) override;
  void jacobian(mpcc::ConstVectorView w, mpcc::VectorView values) override;
  void hessian(mpcc::ConstVectorView w, double objective_factor, mpcc::ConstVectorView y,
               mpcc::VectorView values) override;
  [[nodiscard]] const mpcc::Pattern& jacobian_pattern() const override;
  [[nodiscard]] const mpcc::Pattern& hessian_pattern() const override;
  [[nodiscard]] linalg::Vector start() const override;
  [[nodiscard]] std::string name(int variable) const override;
  [[nodiscard]] std::string row_name(int row) const override;

  /// Returns the least and the greatest value of rows of (g, G, H) that are affine, within the bounds of the variables
  /// and of rows of one variable; infinite for the others.
  [[nodiscard]] const mpcc::Bounds& row_ranges() const;
  [[nodiscard]] int file_variables() const;
  /// Returns names of the file's variables; empty if it has none.
  [[nodiscard]] const std::vector<std::string>& file_names() const;
  /// Returns an objective in the file's own sense: a file may maximise, `objective` is always minimised.
  [[nodiscard]] double in_sense_of_file(double objective) const;
  /// Returns all variables from those of the file, moved onto their bounds.
  [[nodiscard]] linalg::Vector completed(mpcc::ConstVectorView x) const;
  /// Returns what a person should know of how the file was read.
  [[nodiscard]] const std::vector<std::string>& notes() const;

 private:
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace saltus::foreign
