// What a run says of itself where its numbers mean less than they seem to.
#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "saltus/fesd_integrator/run_internal.hpp"

namespace saltus::fesd_integrator {

std::string Run::coarse_message(const Coarseness::Worst& worst) const {
  return fmt::format(
      "the elements are coarse: their estimated errors add up to {:.2g} of the largest |{}|, of the element at t = "
      "{:.6g} alone {:.2g}; take more simulate.fesd.steps",
      worst.sum, facts_.state_names[worst.state], worst.t, worst.error);
}

std::string Run::undetermined_message() const {
  const auto view = recorder_.view(set_, selections_, held_.data());
  std::vector<std::string> names;
  const auto add_zero = [&](int function, const std::string& name) {
    if (view.mode[static_cast<std::size_t>(function)] == 0) names.push_back(name);
  };
  for (const auto& column : facts_.columns) add_zero(column.function, column.name);
  for (const auto& group : facts_.regions) {
    for (std::size_t i = 0; i < group.names.size(); ++i) add_zero(group.first + static_cast<int>(i), group.names[i]);
  }
  const bool regions = std::any_of(facts_.parts.begin(), facts_.parts.end(), [](const Part& p) { return p.simplex; });
  const std::string_view remedy = !facts_.regions.empty() ? "state regions by conditions (when), not by indicators"
                                  : regions               ? "take reformulation = \"step\" or method = \"event\""
                                                          : "take method = \"event\"";
  return fmt::format(
      "from t = {:.10g} the solution is one of many: the equations of sliding on {} do not determine all {}, and these "
      "move the state (unique = false); {}",
      t_, fmt::join(names, ", "), regions ? "weights of regions" : "selections", remedy);
}

}  // namespace saltus::fesd_integrator
