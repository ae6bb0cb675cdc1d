// A run of the event engine between its rows.
#pragma once

#include <memory>
#include <vector>

#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/result/result.hpp"

namespace saltus::event_integrator {

struct Pieces;

/// Evaluates the polynomials of a run's steps, with inputs, outputs, selections and modes, in a context of its own.
///
/// Rows are those that the run writes at the same times, bit for bit.
class Solution {
 public:
  /// @param kernel  of the system, for this only
  Solution(std::shared_ptr<const Pieces> pieces, evaluation::ModelKernel kernel);
  Solution(Solution&&) noexcept;
  ~Solution();

  /// Returns rows at those of the times, ascending, that lie in a step, its end not included, or at its beginning.
  /// Cost of each: the search of its step, its polynomial, and where the mode slides its field; another mode than that
  /// of the last row is entered first.
  [[nodiscard]] result::Trajectory rows(const std::vector<double>& times);

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace saltus::event_integrator
