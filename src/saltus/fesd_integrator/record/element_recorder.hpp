// The complementarities of elements at their points, in the form of the result.
#pragma once

#include <optional>
#include <vector>

#include "saltus/discretization/butcher_tableau.hpp"
#include "saltus/discretization/stage_kernel.hpp"
#include "saltus/fesd_integrator/element/element.hpp"
#include "saltus/fesd_integrator/element/facts.hpp"
#include "saltus/result/elements.hpp"

namespace saltus::fesd_integrator {

class ElementRecorder {
 public:
  /// Kernel and facts must outlive it.
  ElementRecorder(const discretization::StageKernel& kernel, const Facts& facts,
                  const discretization::ButcherTableau& tableau);

  /// Adds an element. `left`, `right`: selections at its ends, limits from its inside; `end`: its right end. Selections
  /// that are not determined are not finite. Cost: an evaluation of the indicators per point.
  void add(const Element& element, const std::vector<double>& left, const std::vector<double>& right, double end,
           const ActiveSet& set, const double* held);
  [[nodiscard]] result::Elements take() { return std::move(elements_); }

 private:
  void point(double t, const double* x, const double* selections, const double* held);

  const discretization::StageKernel& kernel_;
  const Facts& facts_;
  std::vector<double> nodes_;
  std::vector<double> indicators_;
  std::vector<int> undetermined_;  ///< selections of the current element
  result::Elements elements_;
};

}  // namespace saltus::fesd_integrator
