// An element without switch detection: every stage has its own active set.
#pragma once

#include <span>
#include <vector>

#include "saltus/discretization/stage_kernel.hpp"
#include "saltus/fesd_integrator/element/active_set.hpp"
#include "saltus/fesd_integrator/element/element.hpp"

namespace saltus::fesd_integrator {

/// Solves the Runge-Kutta equations of the complementarity system with the complementarities of every stage for itself
/// and no others: time-stepping, of order 1 through switches whatever the method ([nurkanovic2024], section 4.1).
///
/// The sets are found by pivoting from those of the element before, and regions likewise:
/// - a function on the wrong side changes to the other one;
/// - one that has done so before slides;
/// - one whose selection leaves [0, 1] goes to that side.
///
/// That may go round in circles. Then all combinations of modes are tried that what it has touched can have at the
/// stages. Those of the element before come first. Explicit methods have no unknown selections: the sign at a stage is
/// that of its state.
class FixedElement {
 public:
  /// All must outlive it.
  FixedElement(const discretization::StageKernel& kernel, std::span<const Part> parts, ElementSolver& solver);

  /// Solves the element; false if no sets are found. `before` is the set of the last stage of the element before.
  [[nodiscard]] bool solve(const Point& left, double h, const ActiveSet& before, const double* held, Element& element);
  /// Returns the sets of the stages.
  [[nodiscard]] std::span<const ActiveSet> sets() const { return sets_; }
  /// Returns the set of the last stage.
  [[nodiscard]] const ActiveSet& end_set() const { return sets_.back(); }
  [[nodiscard]] const std::vector<double>& end_selections() const { return end_selections_; }

 private:
  enum class Search { found, stuck };
  [[nodiscard]] Search by_pivoting(const Point& left, double h, const double* held, Element& element);
  [[nodiscard]] Search by_enumeration(const Point& left, double h, const ActiveSet& before, const double* held,
                                      Element& element);
  void to_level(double level, Element& element) const;
  [[nodiscard]] bool is_violated(std::size_t stage, const Condition& condition, const Element& element) const;
  /// Evaluates the indicators at a stage, for is_violated.
  void look_at(std::size_t stage, const Element& element, const double* held);
  [[nodiscard]] bool all_hold(const Element& element, const double* held);
  [[nodiscard]] const Part& part_of(int selection) const;
  [[nodiscard]] bool has_active_region(const Part& part, const std::vector<int>& modes) const;
  [[nodiscard]] bool pivot(std::size_t stage, const Element& element, const double* held);

  const discretization::StageKernel& kernel_;
  std::span<const Part> parts_;
  ElementSolver& solver_;
  std::vector<ActiveSet> sets_;
  std::vector<std::vector<int>> modes_;
  std::vector<std::vector<int>> flips_;  ///< per stage and selection: how often it was on the wrong side
  std::vector<bool> touched_;            ///< per selection: pivoting has changed it at some stage
  std::size_t first_stage_ = 0;          ///< whose set is in the equations
  std::vector<double> indicators_, end_selections_;
  double rounding_ = 0.0;
};

}  // namespace saltus::fesd_integrator
