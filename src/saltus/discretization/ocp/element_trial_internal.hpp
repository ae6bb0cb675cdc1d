// One element by itself: which variables it has behind a given left end, in given modes.
#pragma once

#include <optional>
#include <vector>

#include "saltus/discretization/ocp/element_sides_internal.hpp"

namespace saltus::discretization {

/// Holds a selection that stays at a bound while a gap closes (ClosingGap): a local variable.
struct HeldSelection {
  int local = 0;
  bool at_upper = false;
};
[[nodiscard]] std::vector<HeldSelection> held_while_closing(const OcpKernel::Implementation& kernel,
                                                            const ElementSides::Sides& modes);

/// Returns whether ends of elements are the same but for what is left of zeros.
[[nodiscard]] bool are_near(const std::vector<double>& a, const std::vector<double>& b);

/// By which selections and multipliers may be beyond their bounds.
inline constexpr double allowed_beyond = 1e-8;

/// Solves elements one by one, with the controls and parameters of a point.
class ElementTrial {
 public:
  using Modes = ElementSides::Sides;
  ElementTrial(const OcpStructure& made, mpcc::ConstVectorView w) : made_(made), w_(w) {}

  /// Returns what is left of element `number`: state, time if it matters, multipliers.
  [[nodiscard]] std::vector<double> left_of(std::size_t number) const;
  /// Returns the same of what follows an element.
  [[nodiscard]] std::vector<double> right_of(const linalg::Vector& own) const;
  /// Returns the variables of an element of the point but its length.
  [[nodiscard]] linalg::Vector own_of(std::size_t number) const {
    return w_.segment(made_.element[number].first, made_.kernel.layout.size - 1);
  }
  /// Returns its length, in parts of a control interval.
  [[nodiscard]] double length_of(std::size_t number) const;
  /// Returns whether both sides of a pair are zero in the whole of it.
  [[nodiscard]] bool is_at_edge(std::size_t number) const;
  /// Returns multipliers at a left end.
  [[nodiscard]] std::vector<double> lambda(const std::vector<double>& left) const;
  /// Returns the variables of an element but its length, if its equations have a solution.
  /// @param length  in parts of a control interval
  /// @param near    where to begin: those of another length
  [[nodiscard]] std::optional<linalg::Vector> solve(const std::vector<double>& left, std::size_t interval,
                                                    const Modes& modes, double length,
                                                    const linalg::Vector* near = nullptr) const;
  /// Returns the local variables of such an element.
  [[nodiscard]] std::vector<double> inputs(const std::vector<double>& left, std::size_t interval,
                                           const linalg::Vector& own, double length) const;
  /// Returns derivatives of its equations with respect to its variables, the length first, at local variables.
  [[nodiscard]] linalg::Matrix jacobian(const std::vector<double>& z) const;
  /// Returns those columns of it whose variables are not held.
  [[nodiscard]] static linalg::Matrix columns_of_free(const linalg::Matrix& jacobian, const std::vector<bool>& is_held);
  /// Returns which of its variables, the length first, these modes hold.
  [[nodiscard]] std::vector<bool> held(const Modes& modes) const {
    linalg::Vector local = linalg::Vector::zero(made_.kernel.layout.size);
    return hold(modes, local);
  }
  /// Returns the same where time stands still: until one of the multipliers has come to 0.
  /// @param length  where to begin; then that of the element
  [[nodiscard]] std::optional<linalg::Vector> solve_to_end(const std::vector<double>& left, std::size_t interval,
                                                           const Modes& modes, double& length) const;
  [[nodiscard]] double interval_length() const;
  /// Returns whether selections and multipliers are within their bounds.
  /// @param below  0: by which multipliers may be
  [[nodiscard]] bool is_admissible(const linalg::Vector& own, double below = allowed_beyond) const;
  /// Returns whether the clock stands.
  [[nodiscard]] bool stands_still(const std::vector<double>& left, const linalg::Vector& own) const;

 private:
  [[nodiscard]] std::vector<double> inputs(const std::vector<double>& left, std::size_t interval) const;
  [[nodiscard]] std::vector<bool> hold(const Modes& modes, linalg::View local) const;
  [[nodiscard]] bool hold_beyond(linalg::View local, std::vector<bool>& is_held) const;
  /// @param first  of the element's variables among the local ones
  [[nodiscard]] bool solve(std::vector<double>& local, std::size_t first, const std::vector<bool>& is_held) const;
  void begin_at(const std::vector<double>& left, linalg::View local) const;

  const OcpStructure& made_;
  mpcc::ConstVectorView w_;
};

}  // namespace saltus::discretization
