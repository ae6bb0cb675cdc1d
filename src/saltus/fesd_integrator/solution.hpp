// A run of elements between its rows.
#pragma once

#include <memory>
#include <vector>

#include "saltus/discretization/point_functions.hpp"
#include "saltus/discretization/stage_kernel.hpp"
#include "saltus/fesd_integrator/integration.hpp"
#include "saltus/result/result.hpp"

namespace saltus::fesd_integrator {

struct ElementPiece;
struct Facts;

/// Evaluates the polynomials of a run's elements, with inputs, outputs, selections and modes, in a context of its own.
///
/// Rows are those that the run writes at the same times, bit for bit. Is dropped under the SymbolicLock.
class Solution {
 public:
  /// @param kernel, functions  of the run, for this only from now on
  Solution(discretization::StageKernel kernel, discretization::PointFunctions functions, const Facts& facts,
           const IntegrationOptions& options, std::vector<ElementPiece> pieces);
  ~Solution();

  /// Returns rows at those of the times, ascending, that lie in an element, its right end not included.
  [[nodiscard]] result::Trajectory rows(const std::vector<double>& times);

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace saltus::fesd_integrator
