// What a simulation is asked for, checked; and where its result is put together.
#pragma once

#include <memory>
#include <string_view>
#include <utility>
#include <vector>

#include "saltus/base/error.hpp"
#include "saltus/pipeline/options/simulate_options.hpp"
#include "saltus/pipeline/simulate.hpp"
#include "saltus/result/result.hpp"

namespace saltus::model {
struct System;
}

namespace saltus::pipeline {

/// Holds a system with options that fit it; what it refers to must outlive it.
struct Simulation {
  const model::System& system;
  SimulateOptions options;  ///< with the end of the run
  const Observers& observers;
  result::Result frame;                          ///< the result without its run, with the columns that are kept
  std::vector<double> times;                     ///< row_times() in physical time
  std::vector<std::pair<int, int>> forced_mode;  ///< index into System::switching -> mode at the start
  std::vector<double> scaling{};                 ///< a factor per switching function, or none
  bool has_bodies = false;                       ///< that touch or are drawn: of all rows together
};

/// Finds the names of the options in the system; fails for the first option that does not fit.
[[nodiscard]] Expected<Simulation> checked_simulation(const model::System& system, const SimulateOptions& options,
                                                      const Observers& observers);

/// Returns a copy that a result may keep. Takes the SymbolicLock where it is made, and where it is dropped.
[[nodiscard]] std::shared_ptr<const model::System> own_copy(const model::System& system);

/// Returns a result that names the system and its columns, as a simulation and an optimum have them.
[[nodiscard]] result::Result begin_result(const model::System& system, std::string_view method);

/// Adds what an engine has computed.
template <class Integration>
void add_run(Integration& run, result::Result& result) {
  result.status = std::move(run.status);
  result.final = std::move(run.final);
  result.events = std::move(run.events);
  result.trajectory = std::move(run.trajectory);
  result.statistics = run.statistics;
}

/// Adds how deep bodies are in each other, and leaves the columns that are kept.
void finish_result(const model::System& system, result::Result& result);

}  // namespace saltus::pipeline
