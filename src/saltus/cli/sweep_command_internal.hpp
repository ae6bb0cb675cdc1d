// A sweep as it was typed, and what its two ways, with one table or with a folder, have in common.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "saltus/base/error.hpp"
#include "saltus/cli/exit_code.hpp"
#include "saltus/cli/run_command.hpp"
#include "saltus/frontend/sweep_page.hpp"
#include "saltus/frontend/sweep_plan.hpp"
#include "saltus/frontend/sweep_table.hpp"
#include "saltus/pipeline/sweep.hpp"

namespace saltus::cli {

struct SweepArguments {
  RunArguments run;
  frontend::SweepRequest request;
  std::string keep = "final";
  std::string out, page;
  std::string resume;  ///< the folder
  std::string task;
  std::vector<std::string> join;
  std::optional<long> jobs, seed;
};

/// Holds a sweep of which everything was checked.
struct StatedSweep {
  const SweepArguments& arguments;
  const frontend::ModelInput& model;
  const frontend::SweepPlan& plan;
  pipeline::Keep keep;
  std::size_t jobs;
  frontend::SweepPage page;
  std::string mark;
};

/// Writes --out and --report.
[[nodiscard]] Expected<void> write_files(const SweepArguments& arguments,
                                         const std::vector<frontend::TableColumn>& table,
                                         const frontend::SweepPage& page);

/// Returns "98 completed, 2 iteration_limit".
[[nodiscard]] std::string counted(const std::map<std::string, std::size_t>& statuses);
/// Returns "; 1 not unique", or nothing.
[[nodiscard]] std::string doubts(std::size_t others, std::size_t undecided);

/// Returns what shows on a terminal how many of `all` runs are done, of which `before` were there before.
[[nodiscard]] pipeline::SweepObservers sweep_observers(const SweepArguments& arguments, std::size_t all,
                                                       std::size_t before = 0);

/// Simulates so many runs of the sweep, from `begin` on.
[[nodiscard]] Expected<pipeline::SweepOutcome> simulate_runs(const StatedSweep& sweep, std::size_t begin,
                                                             std::size_t count,
                                                             const pipeline::SweepObservers& observers);

/// Computes the shares that the folder of --resume lacks, then writes --out and --report of all.
[[nodiscard]] ExitCode resume_sweep(const StatedSweep& sweep);

}  // namespace saltus::cli
