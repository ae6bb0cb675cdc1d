// The table of a sweep as a page that works offline.
#pragma once

#include <string>
#include <vector>

#include "saltus/frontend/sweep_plan.hpp"
#include "saltus/frontend/sweep_table.hpp"
#include "saltus/result/caption.hpp"

namespace saltus::frontend {

/// Rows that a page draws; of a longer table the last ones of every run, which it says.
inline constexpr std::size_t rows_of_page = 100'000;

/// Holds what the page says beside the table.
struct SweepPage {
  std::string title;               ///< empty: not known
  std::string command;             ///< that runs one of them, without its values; empty: not known
  std::vector<std::string> names;  ///< what was changed, as --set takes it
  bool grid = true;                ///< of two names every pair is there once
  result::Captions captions{};     ///< of the model
};

/// Draws values over one parameter as lines, over two as a map, number of events, status, values at events (bifurcation
/// diagram); a click on a run shows its command.
[[nodiscard]] std::string sweep_page(const std::vector<TableColumn>& table, const SweepPage& page);

}  // namespace saltus::frontend
