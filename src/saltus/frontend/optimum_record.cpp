#include "saltus/frontend/optimum_record.hpp"

#include <string_view>

#include <fmt/format.h>

#include "saltus/expression/parser.hpp"
#include "saltus/model/ocp.hpp"
#include "saltus/model/system.hpp"
#include "saltus/pipeline/surfaces.hpp"

namespace saltus::frontend {

std::optional<std::string> complete_optimum(const ModelInput& input, result::Result& result) {
  auto told = complete_record(input, result);
  const auto& problem = *input.file.description.optimize;
  const auto note = [&](std::string_view key, const expression::NodePtr& tree) {
    if (tree) result.options.emplace_back(fmt::format("optimize.{}", key), expression::to_text(*tree));
  };
  note("from", problem.from);
  note(problem.horizon.free ? "horizon.initial" : "horizon", problem.horizon.value);
  note("horizon.lower", problem.horizon.lower);
  note("horizon.upper", problem.horizon.upper);
  note("running_cost", problem.running_cost);
  note("terminal_cost", problem.terminal_cost);
  note("minimize_time", problem.time_weight);
  if (input.file.optimize->start_result) {
    result.options.emplace_back("optimize.initial_guess.result", *input.file.optimize->start_result);
  }
  return told;
}

void add_surfaces(const model::Ocp& ocp, result::Result& result) {
  if (result.model.parameters.size() != ocp.system.parameter_values.size()) return;
  auto system = ocp.system;
  for (std::size_t i = 0; i < system.parameter_values.size(); ++i) {
    system.parameter_values[i] = result.model.parameters[i].second;
  }
  result.surfaces = pipeline::surfaces(system, result);
}

}  // namespace saltus::frontend
