// Where in an element the signs of its active set end.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "saltus/discretization/stage_kernel.hpp"
#include "saltus/fesd_integrator/element/active_set.hpp"
#include "saltus/fesd_integrator/element/element.hpp"
#include "saltus/fesd_integrator/element/projected_field.hpp"
#include "saltus/fesd_integrator/element/selection_margins.hpp"
#include "saltus/fesd_integrator/watch/defect.hpp"

namespace saltus::fesd_integrator {

/// Holds a condition that does not hold behind `theta` of an element.
struct Violation {
  Condition condition;
  double theta = 0.0;  ///< a part of the time
  double slope = 0.0;  ///< d value / dt there
};

/// Finds the rounding level of every indicator: a few roundings of its largest term. `size` is that of the largest
/// state around: Newton's method is accurate relative to it.
void indicator_noise(const discretization::StageValues& values, double t, double size, std::vector<double>& noise);

/// Looks at the conditions of an active set in solved elements: at the points of the method, and between them along
/// their interpolant, of which no sign change is missed.
class Watch {
 public:
  Watch(const discretization::StageKernel& kernel, const ElementSolver& solver);

  /// Finds the earliest violation; a condition that is zero at the left end or at the right one, within rounding, holds
  /// there. Selections that slide are those of the projected field.
  /// @param selections  at the left end; left at those of the right end
  /// @param only        conditions of these selections, all if it is empty
  /// Cost: an evaluation of the indicators per watch point, of f and derivatives while sliding.
  enum class Answer { holds, violated, not_finite };
  [[nodiscard]] Answer look(const Element& element, const ActiveSet& set, const double* held,
                            std::vector<double>& selections, Violation& earliest, std::span<const int> only = {});
  /// Returns, of the element last looked at, how far its polynomial is from a solution, by component (Defect::errors).
  [[nodiscard]] const std::vector<double>& errors() const { return errors_; }
  /// Returns whether a condition of the element last looked at, which holds along its polynomial, may end along the
  /// solution all the same: it comes nearer to zero than twice the error.
  [[nodiscard]] bool may_miss() const { return may_miss_; }
  /// Returns the value of a condition at the left and at the right end of the element last looked at, and its rounding.
  [[nodiscard]] double left_value(const ActiveSet& set, const Condition& condition) const;
  [[nodiscard]] double end_value(const ActiveSet& set, const Condition& condition) const;
  [[nodiscard]] double noise(const Condition& condition) const;

 private:
  void find_left_rates();
  void first_change(const ActiveSet& set, const Element& element, const Condition& condition, Violation& earliest,
                    bool& found);
  /// What an error of the state makes of a condition.
  [[nodiscard]] double error_of(const ActiveSet& set, const Condition& condition) const;
  void find_errors(const Element& element, const ActiveSet& set, const double* held,
                   const std::vector<double>& selections);
  void note_margins(const ActiveSet& set, std::size_t point, double* selections);
  [[nodiscard]] double value_at(const ActiveSet& set, const Condition& condition, std::size_t point) const;
  [[nodiscard]] bool stage_holds(const Element& element, const ActiveSet& set, std::size_t point) const;
  void take_from_stages(const Element& element, const ActiveSet& set, std::size_t point, double* selections);
  void find_warped_errors(const Element& element, const ActiveSet& set, const double* f, const double* held,
                          const std::vector<double>& selections);

  const discretization::StageKernel& kernel_;
  const ElementSolver& solver_;
  ProjectedField projected_;
  Defect defect_;
  std::size_t points_ = 0;
  /// At the watch points, in time: where a root is zero signs bend less in time than in tau.
  struct Interpolation {
    TimeWarp warp;
    std::vector<double> thetas;    ///< of the watch points
    std::vector<double> to_nodes;  ///< values at ode::interpolation_nodes() from those at watch points
    double lebesgue = 1.0;
  };
  [[nodiscard]] Interpolation interpolation_for(const TimeWarp& warp) const;
  [[nodiscard]] std::size_t find_interpolation(const TimeWarp& warp);
  std::vector<Interpolation> interpolations_;
  std::size_t interpolation_ = 0;   ///< of the current element
  std::vector<double> indicators_;  ///< one row per watch point
  std::vector<double> selections_;
  SelectionMargins margins_;
  std::vector<double> lower_, upper_;  ///< margins of selections that are not determined; as selections_
  std::vector<double> values_, x_, noise_, left_rates_;
  discretization::StageValues left_;
  bool may_miss_ = false;
  std::vector<double> errors_, indicator_errors_, slope_, at_place_;
};

}  // namespace saltus::fesd_integrator
