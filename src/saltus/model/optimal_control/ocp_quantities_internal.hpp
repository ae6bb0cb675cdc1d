// The expressions of an optimal control problem, collected to be built together with its system.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "saltus/linalg/matrix.hpp"
#include "saltus/model/description.hpp"
#include "saltus/model/ocp.hpp"
#include "saltus/model/statement/build_internal.hpp"

namespace saltus::model {

/// Collects expressions, each of which becomes an output, and reads their values once the system is built.
class OcpQuantities {
 public:
  explicit OcpQuantities(const Description& description) : description_(description) {}

  /// @return the number of the quantity
  int add(const expression::NodePtr& expression, const std::string& name);
  [[nodiscard]] const std::vector<NamedExpression>& expressions() const { return expressions_; }

  /// Returns whether an expression is made of numbers and parameters that are not free.
  [[nodiscard]] bool is_constant(const expression::NodePtr& expression) const;

  /// Builds the system with these quantities; frozen with contacts or hysteresis.
  [[nodiscard]] Expected<System> build(const std::vector<Override>& overrides);
  /// Does the same for the event engine, which freezes nothing.
  [[nodiscard]] Expected<System> build_physical(const std::vector<Override>& overrides) const;
  /// Returns the value of a quantity that is constant, once built; an error that names it otherwise.
  [[nodiscard]] Expected<double> value(int quantity) const;
  /// Returns the output that a quantity is in the system.
  [[nodiscard]] int output(int quantity) const { return user_outputs_ + quantity; }
  [[nodiscard]] int user_outputs() const { return user_outputs_; }
  [[nodiscard]] int count() const { return static_cast<int>(expressions_.size()); }

 private:
  const Description& description_;
  std::vector<NamedExpression> expressions_;
  int user_outputs_ = 0;
  std::vector<double> values_;  ///< NaN where a quantity is not constant
  std::vector<bool> constant_;
};

[[nodiscard]] bool is_free(const Description& description, const std::string& parameter);

}  // namespace saltus::model
