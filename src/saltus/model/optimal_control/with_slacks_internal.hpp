// Kinks of controls in costs and constraints, |u| and the like, as slack variables with inequalities.
#pragma once

#include <string>
#include <vector>

#include "saltus/model/description.hpp"

namespace saltus::model {

/// Says what an expression may be replaced by at its kinks of controls.
enum class Curvature {
  convex,   ///< something above it: it is minimised, or bounded from above
  concave,  ///< something below it
  linear,   ///< nothing
};

/// Holds a row e <= 0 of a slack.
struct SlackRow {
  expression::NodePtr expression;
  bool at_stages = false;  ///< of a slack with a value per stage
};

/// Replaces abs, max, min of expressions with controls by slacks s, further controls of the description, with rows
/// e <= 0: of abs(a) in a convex place a - s and -a - s. The optimum is the same where they enter convexly.
/// A slack has one value per interval if its argument is one of controls and parameters, else one per stage.
class ControlSlacks {
 public:
  explicit ControlSlacks(const Description& description);

  /// @param place  "running_cost", for messages
  /// @return the expression without such kinks, or an error where one does not enter convexly.
  [[nodiscard]] Expected<expression::NodePtr> in_running_cost(const expression::NodePtr& expression,
                                                              const std::string& place);
  /// @return as above; an error, too, where the argument of a kink depends on more than controls and parameters.
  [[nodiscard]] Expected<expression::NodePtr> in_terminal_cost(const expression::NodePtr& expression,
                                                               const std::string& place);
  /// @return expressions that are bounded as the one given is, all of them: abs(a) <= b is a <= b and -a <= b.
  [[nodiscard]] Expected<std::vector<expression::NodePtr>> in_constraint(const expression::NodePtr& expression,
                                                                         Curvature curvature, const std::string& place);

  /// Returns the description with a control per slack behind its own, and without inputs of a simulation.
  [[nodiscard]] const Description& description() const { return description_; }
  [[nodiscard]] const std::vector<SlackRow>& rows() const { return rows_; }
  [[nodiscard]] int user_controls() const { return user_controls_; }
  /// Returns numbers of the controls that are slacks with a value per stage.
  [[nodiscard]] const std::vector<int>& stage_slacks() const { return stage_slacks_; }

 private:
  /// What becomes of a kink whose argument depends on more than controls and parameters.
  enum class Mixed { refused, slack_per_stage, branch };

  [[nodiscard]] Expected<expression::NodePtr> replace(const expression::NodePtr& expression, Curvature curvature,
                                                      const std::string& place);
  [[nodiscard]] bool has_kink_of_controls(const expression::Node& node) const;
  [[nodiscard]] bool has_mixed_kink(const expression::Node& node) const;
  [[nodiscard]] bool speaks_of_controls(const expression::Node& node) const;
  [[nodiscard]] const expression::NodePtr* definition(const std::string& name) const;
  [[nodiscard]] Expected<expression::NodePtr> in_binary(const expression::NodePtr& node, Curvature curvature,
                                                        const std::string& place);
  [[nodiscard]] Expected<expression::NodePtr> slack(const expression::NodePtr& node, Curvature curvature,
                                                    const std::string& place);
  [[nodiscard]] Expected<expression::NodePtr> branch(const expression::NodePtr& node, Curvature curvature,
                                                     const std::string& place);
  [[nodiscard]] std::string not_of_controls(const expression::Node& node) const;

  Description description_;
  int user_controls_ = 0;
  std::vector<SlackRow> rows_;
  std::vector<int> stage_slacks_;
  Mixed mixed_ = Mixed::refused;
  std::size_t kinks_seen_ = 0;
  std::vector<std::size_t> chosen_, choices_;  ///< branch: argument taken of each kink, and how many it has
};

}  // namespace saltus::model
