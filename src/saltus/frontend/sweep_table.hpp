// All runs of a sweep as one table.
#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "saltus/frontend/sweep_plan.hpp"
#include "saltus/io/atomic_file.hpp"
#include "saltus/pipeline/sweep.hpp"

namespace saltus::frontend {

/// Holds a column of numbers or of words.
struct TableColumn {
  std::string name;
  std::variant<std::vector<double>, std::vector<std::string>> values;
};

/// Returns a row for every run (Keep::final), event or row of a trajectory: `run` from 1, what was changed ("v(0)" if v
/// is a state, whose value has the column "v"), `status`, `unique` (1; 0 if other solutions are admissible; -1 if that
/// was not decided), then
///   final:       t, states, outputs at the end, `events` (their number);
///   events:      `events`, `event` from 1, t, kind, name, surfaces, states before, states after ("v(after)"), time and
///   states
///                at the end of the run ("t(end)", "v(end)"), the same in all of its rows; a run without an event has a
///                row whose `event` is 0, without time and kind;
///   trajectory:  `events`, t, states, controls, outputs, modes.
/// Where runs have different states, outputs or switching functions there is a column for each that one of them has; it
/// is NaN in the rows of the others.
/// @param begin  which run of the plan is the first of `runs`, from 0
[[nodiscard]] std::vector<TableColumn> sweep_table(const SweepPlan& plan, const std::vector<pipeline::SweepRun>& runs,
                                                   pipeline::Keep keep, std::size_t begin = 0);

[[nodiscard]] inline std::size_t rows_of(const TableColumn& column) {
  return std::visit([](const auto& values) { return values.size(); }, column.values);
}

/// Writes RFC 4180, numbers as the shortest text that reads back the same.
[[nodiscard]] std::string to_csv(const std::vector<TableColumn>& table);
/// Writes NumPy's archive of arrays, one per column, of any size; false if the sink did not take everything.
bool write_npz(const std::vector<TableColumn>& table, io::Sink sink);

}  // namespace saltus::frontend
