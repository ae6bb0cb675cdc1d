// All runs of a sweep as one table.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "saltus/cli/sweep_plan.hpp"
#include "saltus/pipeline/sweep.hpp"

namespace saltus::cli {

/// A column of numbers or of words.
struct TableColumn {
  std::string name;
  std::variant<std::vector<double>, std::vector<std::string>> values;
};

/// A row for every run (Keep::final), event or row of a trajectory: `run` from 1, what was changed ("v(0)" if v is a
/// state, whose value has the column "v"), `status`, then
///   final:       t, states, outputs at the end, `events` (their number);
///   events:      `event` from 1, t, kind, name, surfaces, states before, states behind ("v(after)");
///   trajectory:  t, states, controls, outputs, modes.
[[nodiscard]] std::vector<TableColumn> sweep_table(const SweepPlan& plan, const std::vector<pipeline::SweepRun>& runs,
                                                   pipeline::Keep keep);

/// RFC 4180, numbers as the shortest text that reads back the same.
[[nodiscard]] std::string to_csv(const std::vector<TableColumn>& table);
/// NumPy's archive of arrays, one per column, not compressed.
[[nodiscard]] std::string to_npz(const std::vector<TableColumn>& table);

}  // namespace saltus::cli
