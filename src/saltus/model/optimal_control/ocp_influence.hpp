// Costs of an optimal control problem that nothing influences.
#pragma once

#include <string>
#include <vector>

namespace saltus::model {

struct Ocp;

/// Returns one sentence per cost on which nothing free has any influence, by the structure of the expressions. Free are
/// controls, states, parameters and the horizon. An example is "running_cost" of a state that no control reaches. One,
/// too, if nothing is minimised. Cost: sparsity of the derivatives of the model.
[[nodiscard]] std::vector<std::string> idle_costs(const Ocp& ocp);

}  // namespace saltus::model
