#include "saltus/pipeline/optimal_control/describe_ocp.hpp"

#include <cstddef>

#include <fmt/format.h>

#include "saltus/base/at.hpp"
#include "saltus/model/ocp.hpp"
#include "saltus/model/optimal_control/ocp_influence.hpp"
#include "saltus/model/system.hpp"
#include "saltus/mpcc/chain.hpp"
#include "saltus/pipeline/optimal_control/ocp_problem.hpp"
#include "saltus/pipeline/optimal_control/point_values_internal.hpp"

namespace saltus::pipeline {
namespace {

std::vector<OcpCounts> counts_of_intervals(const mpcc::Problem& problem) {
  std::vector<OcpCounts> counts;
  const auto* chain = problem.chain();
  if (chain == nullptr) return counts;
  std::vector<int> owner(at(problem.variables()), -1);
  const auto own = [&](const mpcc::IndexRange& range, int interval) {
    for (int i = range.first; i < range.end(); ++i) owner[at(i)] = interval;
  };
  for (const auto& interval : chain->intervals) {
    const int number = static_cast<int>(counts.size());
    auto& count = counts.emplace_back();
    own(interval.shared, number);
    count.variables = interval.shared.count;
    for (int i = interval.first_element; i < interval.first_element + interval.elements; ++i) {
      const auto& element = chain->elements[at(i)];
      own(element.variables, number);
      count.variables += element.variables.count;
      count.equations += element.rows.count;
      count.pairs += element.pairs.count;
    }
  }
  for (const int column : problem.jacobian_pattern().column) {
    if (owner[at(column)] >= 0) ++counts[at(owner[at(column)])].nonzeros;
  }
  return counts;
}

/// Functions that are 0 where the solution begins.
std::vector<std::string> surfaces_at_start(const model::Ocp& ocp) {
  std::vector<std::string> names;
  auto values = PointValues::make(ocp.system);
  if (!values) return names;
  const auto& system = ocp.system;
  const auto alpha =
      values->selections({ocp.from, system.initial_state, system.control_initial, system.parameter_values});
  for (std::size_t j = 0; j < alpha.size() && j < system.switching.size(); ++j) {
    if (alpha[j] == 0.5 && system.switching[j].role == model::SwitchingRole::listed) {
      names.push_back(system.switching[j].name);
    }
  }
  return names;
}

}  // namespace

Expected<OcpOverview> describe_ocp(const model::Ocp& ocp, const OptimizeOptions& options) {
  auto stated = state_problem(ocp, options);
  if (!stated) return tl::unexpected(stated.error());
  const auto& problem = *stated->problem;
  OcpOverview overview;
  overview.intervals = counts_of_intervals(problem);
  overview.problem = {problem.variables(), problem.constraints(), problem.pairs(),
                      problem.jacobian_pattern().entries()};
  for (const auto& name : surfaces_at_start(ocp)) {
    overview.warnings.push_back(
        fmt::format("the initial state is on the surface {} = 0: its complementarity begins with both sides 0", name));
  }
  overview.warnings.insert(overview.warnings.end(), stated->warnings.begin(), stated->warnings.end());
  const auto idle = model::idle_costs(ocp);
  overview.warnings.insert(overview.warnings.end(), idle.begin(), idle.end());
  return overview;
}

}  // namespace saltus::pipeline
