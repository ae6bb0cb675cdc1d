// initial(q) in terminal constraints and costs: the start of the horizon, as parameters.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "saltus/model/description.hpp"

namespace saltus::model {

/// Replaces initial(q) in terminal_cost and terminal_constraints by parameters behind those of the description: p = q
/// at the start, free within the bounds of q where its initial value is free.
class InitialValues {
 public:
  InitialValues(const Description& description, const std::vector<Override>& overrides);

  /// Returns the description with these parameters.
  [[nodiscard]] const Description& description() const { return description_; }
  /// Returns the overrides, those of initial values for their parameters, too.
  [[nodiscard]] const std::vector<Override>& overrides() const { return overrides_; }
  [[nodiscard]] std::vector<Override> with_parameters(std::vector<Override> overrides) const;
  /// Returns the states whose initial values are spoken of; their parameters are parameter_of.
  [[nodiscard]] const std::vector<std::string>& states() const { return states_; }
  [[nodiscard]] static std::string parameter_of(const std::string& state) { return "saltus_initial_" + state; }
  /// Returns the first mistake: an argument that is no state.
  [[nodiscard]] const std::optional<Error>& error() const { return error_; }

 private:
  [[nodiscard]] expression::NodePtr replaced(const expression::NodePtr& node);
  [[nodiscard]] expression::NodePtr parameter(const expression::Call& call, const SourceLocation& location);

  Description description_;
  std::vector<std::string> states_;
  std::vector<Override> overrides_;
  std::optional<Error> error_;
};

}  // namespace saltus::model
