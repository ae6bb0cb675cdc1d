// Where a run is: the one owner of time, state, active set and selections.
#pragma once

#include <utility>
#include <vector>

#include "saltus/fesd_integrator/decide/transition.hpp"
#include "saltus/fesd_integrator/element/active_set.hpp"
#include "saltus/fesd_integrator/element/element.hpp"

namespace saltus::fesd_integrator {

/// Changes in three ways only: along an element (move_to), to another set in place (continue_with), and to the limit of
/// a sequence of switches (jump_to).
class Position {
 public:
  Position() = default;
  /// Puts all `selections` of the set on the side where they are 0 until continue_with().
  Position(double t, std::vector<double> x, std::size_t selections);

  [[nodiscard]] double t() const { return t_; }
  [[nodiscard]] const std::vector<double>& x() const { return x_; }
  [[nodiscard]] const ActiveSet& set() const { return set_; }
  [[nodiscard]] const std::vector<double>& selections() const { return selections_; }
  /// Returns Continuation::determined of the set.
  [[nodiscard]] bool is_determined() const { return determined_; }
  /// Returns how the first guess at an element is made. Where nothing determines selections they stay what they are at
  /// its left end: along polynomials that are continued they would grow from element to element, out of their bounds.
  [[nodiscard]] ElementSolver::Guess first_guess() const {
    return determined_ ? ElementSolver::Guess::left_end : ElementSolver::Guess::field;
  }
  /// Returns the largest state of late: what roundings are relative to. Halved with every element, as what was large a
  /// long time ago has left no roundings.
  [[nodiscard]] double size() const { return size_; }
  /// Returns the left end of an element that begins here; the reference is valid until the next call.
  [[nodiscard]] Point& left_end();
  /// Returns the selections that slide, with their references: they are on their surfaces, whatever the rounding.
  [[nodiscard]] std::vector<int> on_surfaces() const;

  /// Moves to the right end of an element, or to a point inside it; allocates nothing.
  void move_to(double t, const Element& element, const std::vector<double>& selections);
  void stop_inside(double t, const std::vector<double>& x, const std::vector<double>& selections);
  void continue_with(const Continuation& next);
  void continue_with(const ActiveSet& set, const std::vector<double>& selections);
  void jump_to(double t, std::vector<double> x);

 private:
  double t_ = 0.0;
  std::vector<double> x_, selections_;
  ActiveSet set_;
  bool determined_ = true;
  double size_ = 0.0;
  Point left_;  ///< a member, so that steps do not allocate
};

}  // namespace saltus::fesd_integrator
