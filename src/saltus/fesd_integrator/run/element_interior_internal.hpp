// State and selections inside a solved element.
#pragma once

#include <span>
#include <vector>

#include "saltus/fesd_integrator/element/selection_margins.hpp"
#include "saltus/fesd_integrator/run/context_internal.hpp"
#include "saltus/fesd_integrator/run/position_internal.hpp"

namespace saltus::fesd_integrator {

/// Holds the point inside an element that was asked for last. Its set is that of the position, without switch detection
/// that of the next stage.
class ElementInterior {
 public:
  /// Both must outlive it.
  ElementInterior(RunContext& context, const Position& position)
      : context_(context), position_(position), set_(&position.set()), x_(context.facts.n_x) {}

  /// Says which sets the stages of the elements from now on have, without switch detection. They must outlive the calls
  /// of go_to().
  void take_stage_sets(std::span<const ActiveSet> sets) { stage_sets_ = sets; }

  [[nodiscard]] std::span<const ActiveSet> stage_sets() const { return stage_sets_; }

  /// Goes to t + theta h of an element; `selections` are those at its left end.
  void go_to(const Element& element, const std::vector<double>& selections, double theta);
  /// Finds selections that hold the surfaces at a state, from `guess`; those nearest to 1/2 where they are not
  /// determined. False, and selections() are anything, where there are none.
  [[nodiscard]] bool project(double t, const std::vector<double>& x, const std::vector<double>& guess);

  [[nodiscard]] const ActiveSet& set() const { return *set_; }
  [[nodiscard]] const std::vector<double>& x() const { return x_; }
  [[nodiscard]] const std::vector<double>& selections() const { return selections_; }

 private:
  [[nodiscard]] bool changes_inside() const;
  void follow_stages(const Element& element, double theta);

  RunContext& context_;
  const Position& position_;
  const ActiveSet* set_;
  std::span<const ActiveSet> stage_sets_;
  SelectionMargins margins_;
  std::vector<double> x_, selections_;
};

}  // namespace saltus::fesd_integrator
