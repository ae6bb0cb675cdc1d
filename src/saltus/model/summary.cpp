#include "saltus/model/summary.hpp"

#include "saltus/model/layout_of.hpp"
#include "saltus/model/switched_rates.hpp"
#include "saltus/model/system.hpp"

namespace saltus::model {

Summary summary_of(const System& system) {
  Summary summary;
  summary.layout = layout_of(system);
  summary.description = system.description;
  summary.initial_state = system.initial_state;
  summary.state_lower = system.state_lower;
  summary.state_upper = system.state_upper;
  summary.parameter_values = system.parameter_values;
  summary.control_initial = system.control_initial;
  summary.control_lower = system.control_lower;
  summary.control_upper = system.control_upper;
  for (const auto& function : system.switching) summary.inner.push_back(function.inner);
  summary.switched_rates = switched_rates(system);
  for (const auto& cell : system.cells) summary.cell_tables.push_back(cell.table);
  summary.inclusion_differences = system.inclusion_differences;
  summary.warnings = system.warnings;
  return summary;
}

}  // namespace saltus::model
