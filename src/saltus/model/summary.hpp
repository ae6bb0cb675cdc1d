// What of a System is told to people, without its expressions.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "saltus/model/cells.hpp"
#include "saltus/model/layout.hpp"

namespace saltus::model {

struct System;

/// Holds names and numbers of a System: its layout, its values, and what depends on its selections.
struct Summary {
  Layout layout;
  std::string description;
  std::vector<double> initial_state, state_lower, state_upper;
  std::vector<double> parameter_values;
  std::vector<double> control_initial, control_lower, control_upper;
  std::vector<std::vector<int>> inner;           ///< by surface: those whose selection its function contains
  std::vector<std::vector<int>> switched_rates;  ///< by surface: states whose right-hand side has its selection
  std::vector<std::shared_ptr<const CellTable>> cell_tables;
  std::vector<std::string> inclusion_differences;
  std::vector<std::string> warnings;
};

/// Returns the summary of a system. Cost: that of copying, and of switched_rates().
[[nodiscard]] Summary summary_of(const System& system);

}  // namespace saltus::model
