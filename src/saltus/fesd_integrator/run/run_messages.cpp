// What a run says of itself where its numbers mean less than they seem to.
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "saltus/base/at.hpp"
#include "saltus/fesd_integrator/run/run_internal.hpp"

namespace saltus::fesd_integrator {

std::string Run::coarse_message(const Coarseness::Worst& worst) const {
  return fmt::format(
      "the elements are coarse: their estimated errors add up to {:.2g} of the largest |{}|, of the element at t = "
      "{:.6g} alone {:.2g}; take more simulate.fesd.steps",
      worst.sum, facts_.state_names[worst.state], worst.t, worst.error);
}

std::optional<std::string> Run::undefined_beyond() {
  kernel_.evaluate(t_, x_.data(), selections_.data(), held_.data(), at_switch_);
  const std::vector<double> slope = at_switch_.f;
  std::vector<double> ahead(x_.size());
  constexpr double first = 1e-14, last = 1e-3, factor = 8.0;  // of a simulation step
  for (double part = first; part <= last; part *= factor) {
    const double h = part * nominal_;
    for (std::size_t k = 0; k < x_.size(); ++k) ahead[k] = x_[k] + h * slope[k];
    kernel_.evaluate(t_ + h, ahead.data(), selections_.data(), held_.data(), at_switch_);
    const auto undefined = [](const std::vector<double>& values) {
      return static_cast<std::size_t>(
          std::find_if(values.begin(), values.end(), [](double v) { return !std::isfinite(v); }) - values.begin());
    };
    const auto message = [&](std::string_view what, const std::string& name) {
      return fmt::format(
          "the {} of '{}' is not finite beyond t = {:.10g}; guard the expression with if(…), or end the "
          "simulation before",
          what, name, t_);
    };
    if (const auto k = undefined(at_switch_.f); k < x_.size()) return message("right-hand side", facts_.state_names[k]);
    if (const auto j = undefined(at_switch_.indicator); j < facts_.selections.size())
      return message("switching function", facts_.selections[j].name);
  }
  return std::nullopt;
}

std::string Run::undetermined_message() const {
  const auto view = recorder_.view(set_, selections_, held_.data());
  std::vector<std::string> names;
  const auto add_zero = [&](int function, const std::string& name) {
    if (view.mode[at(function)] == 0) names.push_back(name);
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
