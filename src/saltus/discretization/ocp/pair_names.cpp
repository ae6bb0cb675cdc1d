#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "saltus/base/at.hpp"
#include "saltus/discretization/ocp/ocp_problem_internal.hpp"

namespace saltus::discretization {

std::vector<std::string> names_of_selections(const model::System& system, const reformulation::Dcs& dcs) {
  std::vector<std::string> names(at(dcs.selection.numel()));
  for (const auto& part : dcs.parts) {
    for (int i = 0; i < part.count; ++i) {
      auto& name = names[at(part.first + i)];
      if (part.mode_group >= 0) {
        name = fmt::format("the mode '{}'", system.mode_groups[at(part.mode_group)].mode_names[at(i)]);
      } else if (part.form == reformulation::Form::step) {
        name = fmt::format("the switching function '{}'", dcs.surfaces[at(part.surfaces[at(i)])].name);
      } else {
        std::vector<std::string> all;
        for (const int surface : part.surfaces) all.push_back(dcs.surfaces[at(surface)].name);
        name = fmt::format("the switching function{} '{}'", all.size() == 1 ? "" : "s", fmt::join(all, "', '"));
      }
    }
  }
  return names;
}

std::string OcpProblem::Implementation::interval_name(int interval) const {
  const double share = 1.0 / structure->intervals;
  const auto text = [interval](double from, double length, std::string_view before, std::string_view behind) {
    return fmt::format("interval {} ({}{:.6g} to {:.6g}{})", interval, before, from + interval * length,
                       from + (interval + 1) * length, behind);
  };
  if (structure->horizon >= 0) return text(0.0, share, "", " of the horizon");
  return text(structure->from, share * value(structure->horizon, start), "t = ", "");
}

std::string OcpProblem::Implementation::pair_name(int pair) const {
  const auto& kernel = structure->kernel;
  for (const auto& placed : structure->functions) {
    const int count = placed.function->pairs();
    for (const auto& one : placed.copies) {
      if (count == 0 || pair < one.first_pair || pair >= one.first_pair + count) continue;
      const auto where = one.interval < 0 ? std::string("the start") : interval_name(one.interval);
      const int selections = static_cast<int>(kernel.pairs.size());
      const int cross = count - kernel.correction_pairs;
      const int local = pair - one.first_pair;
      if (placed.function != &kernel.element || local >= cross) return fmt::format("{} in {}", placed.what, where);
      const auto& chosen = kernel.pairs[at(local / (cross / selections))];
      return fmt::format("{} in {}, element {}", selection_names[at(chosen.selection)], where,
                         structure->element[at(one.element)].number);
    }
  }
  return fmt::format("pair {}", pair);
}

}  // namespace saltus::discretization
