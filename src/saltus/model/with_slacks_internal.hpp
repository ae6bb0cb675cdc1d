// Kinks of controls in costs and constraints, |u| and the like, as slack variables with inequalities.
#pragma once

#include <string>
#include <vector>

#include "saltus/model/description.hpp"

namespace saltus::model {

/// What an expression may be replaced by at its kinks of controls.
enum class Curvature {
  convex,   ///< something above it: it is minimised, or bounded from above
  concave,  ///< something below it
  linear,   ///< nothing
};

/// Replaces abs, max, min of expressions with controls by slacks s, further controls of the description, with rows
/// e <= 0: of abs(a) in a convex place a - s and -a - s. The optimum is the same where they enter convexly.
class ControlSlacks {
 public:
  explicit ControlSlacks(const Description& description);

  /// @param place  "running_cost", for messages
  /// @return the expression without such kinks, or an error where one does not enter convexly, or where its argument
  ///         depends on more than controls and parameters.
  [[nodiscard]] Expected<expression::NodePtr> replace(const expression::NodePtr& expression, Curvature curvature,
                                                      const std::string& place);

  /// The description with a control per slack behind its own, and without inputs of a simulation.
  [[nodiscard]] const Description& description() const { return description_; }
  [[nodiscard]] const std::vector<expression::NodePtr>& rows() const { return rows_; }
  [[nodiscard]] int user_controls() const { return user_controls_; }

 private:
  [[nodiscard]] bool has_kink_of_controls(const expression::Node& node) const;
  [[nodiscard]] bool speaks_of_controls(const expression::Node& node) const;
  [[nodiscard]] const expression::NodePtr* definition(const std::string& name) const;
  [[nodiscard]] Expected<expression::NodePtr> in_binary(const expression::NodePtr& node, Curvature curvature,
                                                        const std::string& place);
  [[nodiscard]] Expected<expression::NodePtr> slack(const expression::NodePtr& node, Curvature curvature,
                                                    const std::string& place);
  [[nodiscard]] std::string not_of_controls(const expression::Node& node) const;

  Description description_;
  int user_controls_ = 0;
  std::vector<expression::NodePtr> rows_;
};

}  // namespace saltus::model
