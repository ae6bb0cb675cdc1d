#include <algorithm>
#include <cmath>
#include <limits>

#include <casadi/core/function.hpp>
#include <fmt/format.h>

#include "saltus/base/at.hpp"
#include "saltus/expression/parser.hpp"
#include "saltus/model/optimal_control/ocp_quantities_internal.hpp"

namespace saltus::model {

using casadi::SX;

bool is_free(const Description& description, const std::string& parameter) {
  const auto& free = description.free_parameters;
  return std::any_of(free.begin(), free.end(), [&](const auto& one) { return one.name == parameter; });
}

int OcpQuantities::add(const expression::NodePtr& expression, const std::string& name) {
  expressions_.push_back({name, expression, expression->location});
  return static_cast<int>(expressions_.size()) - 1;
}

bool OcpQuantities::is_constant(const expression::NodePtr& expression) const {
  for (const auto& name : expression::names_in(*expression)) {
    if (name == "pi") continue;
    const auto& parameters = description_.parameters;
    const bool known =
        std::any_of(parameters.begin(), parameters.end(), [&](const auto& one) { return one.name == name; });
    if (!known || is_free(description_, name)) return false;
  }
  return true;
}

Expected<System> OcpQuantities::build(const std::vector<Override>& overrides) {
  Quantities quantities{expressions_, {}};
  for (const auto& parameter : description_.free_parameters) quantities.varying_parameters.insert(parameter.name);
  if (stands_still(description_)) quantities.time = TimeForm::frozen;
  auto system = build_with(description_, overrides, &quantities);
  if (!system) return system;
  user_outputs_ = static_cast<int>(description_.outputs.size());
  // Constants are evaluated at the parameters' values; those of free ones are NaN, so that what depends on them shows.
  std::vector<double> p = system->parameter_values;
  for (std::size_t i = 0; i < p.size(); ++i) {
    if (is_free(description_, system->parameter_names[i])) p[i] = std::numeric_limits<double>::quiet_NaN();
  }
  SX moving = SX::vertcat({system->t, system->x, system->u, system->alpha});
  for (const auto& cell : system->cells) moving = SX::vertcat({moving, cell.symbols});
  const casadi::Function outputs("saltus_constants", {system->p, moving}, {system->outputs});
  const auto nan = casadi::DM::nan(moving.size1(), moving.size2());
  const std::vector<double> all =
      casadi::DM::densify(outputs(std::vector<casadi::DM>{casadi::DM(p), nan}).front()).nonzeros();
  for (std::size_t i = 0; i < expressions_.size(); ++i) {
    const std::size_t row = static_cast<std::size_t>(user_outputs_) + i;
    constant_.push_back(is_constant(expressions_[i].expression));
    values_.push_back(all[row]);
  }
  return system;
}

Expected<System> OcpQuantities::build_physical(const std::vector<Override>& overrides) const {
  Quantities quantities{expressions_, {}};
  for (const auto& parameter : description_.free_parameters) quantities.varying_parameters.insert(parameter.name);
  return build_with(description_, overrides, &quantities);
}

Expected<double> OcpQuantities::value(int quantity) const {
  const auto& stated = expressions_[at(quantity)];
  const double value = values_[at(quantity)];
  if (constant_[at(quantity)] && std::isfinite(value)) return value;
  const std::string text = expression::to_text(*stated.expression);
  const bool finite = !constant_[at(quantity)];
  return tl::unexpected(
      Error{ErrorCode::invalid_model,
            finite ? fmt::format("{} has to be a constant, found '{}'", stated.name, text)
                   : fmt::format("{} is {}, not a finite number", stated.name, value),
            finite ? "use numbers and parameters that are not free" : "check the expression and the parameters in it",
            stated.location,
            {"in [optimize]"}});
}

}  // namespace saltus::model
