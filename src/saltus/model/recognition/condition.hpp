// Truth values over a model: comparisons joined by and, or, not.
#pragma once

#include <memory>
#include <string>

#include <casadi/core/sx.hpp>
#include <casadi/core/sx_elem.hpp>

namespace saltus::model {

/// Says the value of a comparison where both sides are equal: > and < are false there, >= and <= are true. It matters
/// for constants, for discrete states and for the guards of events and jumps; on the surface of a switching function
/// that moves the selection is set-valued all the same.
enum class AtEquality { is_false, is_true };

/// Says which quantities may stand in a comparison.
enum class Sides {
  any,
  still,  ///< only what is constant between jumps: a moving quantity is equal to something for an instant at most
};

/// States difference > 0; `name` is what the switching function is called if it has no name yet.
struct Comparison {
  casadi::SX difference;
  AtEquality at_equality = AtEquality::is_false;
  std::string name;
  Sides sides = Sides::any;
};

/// Holds a condition as it was written; which switching functions it consists of is decided where it is used.
class Condition {
 public:
  enum class Kind { comparison, conjunction, disjunction, negation, constant };

  explicit Condition(Comparison comparison);
  /// Returns a condition that always or never holds.
  static Condition always();
  static Condition never();

  [[nodiscard]] Kind kind() const;
  [[nodiscard]] const Comparison& comparison() const;  ///< of kind comparison
  [[nodiscard]] const Condition& left() const;         ///< of conjunction, disjunction and negation
  [[nodiscard]] const Condition& right() const;        ///< of conjunction and disjunction
  [[nodiscard]] double truth() const;                  ///< of kind constant: 0 or 1

  friend Condition operator&&(const Condition& a, const Condition& b);
  friend Condition operator||(const Condition& a, const Condition& b);
  friend Condition operator!(const Condition& a);

 private:
  struct Node;
  explicit Condition(std::shared_ptr<const Node> node);
  // Shared: conditions are small immutable trees that are copied into larger ones.
  std::shared_ptr<const Node> node_;
};

/// States a > b and so on, for scalar a and b; the switching function is a - b (greater) or b - a (less), named by its
/// text unless a name is given.
[[nodiscard]] Condition greater(const casadi::SX& a, const casadi::SX& b, const std::string& name = "");
[[nodiscard]] Condition greater_equal(const casadi::SX& a, const casadi::SX& b, const std::string& name = "");
[[nodiscard]] Condition less(const casadi::SX& a, const casadi::SX& b, const std::string& name = "");
[[nodiscard]] Condition less_equal(const casadi::SX& a, const casadi::SX& b, const std::string& name = "");

/// States a == b, for constants, parameters and discrete states: a >= b and b >= a, named by their texts.
[[nodiscard]] Condition equal(const casadi::SX& a, const casadi::SX& b, const std::string& name = "",
                              const std::string& reverse_name = "");
[[nodiscard]] Condition not_equal(const casadi::SX& a, const casadi::SX& b);

}  // namespace saltus::model
