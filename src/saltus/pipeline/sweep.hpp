// One model many times: every run with its own values.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "saltus/base/error.hpp"
#include "saltus/base/function_ref.hpp"
#include "saltus/pipeline/simulate.hpp"
#include "saltus/result/result.hpp"

namespace saltus::pipeline {

/// Says what is left of a run: its end; its events, too; or everything.
enum class Keep { final, events, trajectory };

struct SweepOptions {
  std::size_t runs = 0;
  Keep keep = Keep::final;
  std::size_t jobs = 1;    ///< threads, >= 1
  std::size_t before = 0;  ///< of a share of a sweep: runs that others do before these; for messages
};

struct StatedRun;  // options/stated_run.hpp

/// States run number i, from 0. Called by all threads, one at a time, under the symbolic lock.
using StateRun = FunctionRef<Expected<StatedRun>(std::size_t run)>;

struct SweepObservers {
  std::function<void(std::size_t done)> on_run{};  ///< after every run, by any thread, one at a time; may be empty
  std::function<bool()> is_interrupted{};          ///< after every step, by all threads; may be empty
};

struct SweepRun {
  result::Result result;
  std::size_t events = 0;  ///< how many there were, also where they are not kept
  std::optional<bool>
      unique;  ///< whether no event and no family of solutions told of another one; nullopt: not decided
};

/// Holds a warning of the model, and the runs whose values it is about.
struct SweepWarning {
  std::string text;
  std::vector<std::size_t> runs;  ///< their numbers in the whole sweep, from 1, ascending
};

struct SweepOutcome {
  std::vector<SweepRun> runs;
  std::vector<SweepWarning> warnings;  ///< each text once
};

/// Memory that kept trajectories may take; beyond it a sweep is refused.
inline constexpr double most_kept_bytes = 4e9;

/// Simulates all runs. What is computed does not depend on the number of threads; kernels are compiled once per thread
/// and structure.
/// @return a run for each, whatever its numerics did; behind an interruption those up to the last one that was begun,
///         where one that was not is stopped_by_user at its start. An Error for the first run that cannot be stated or
///         started ("in run 17" in its context), or if what is kept is too much.
[[nodiscard]] Expected<SweepOutcome> sweep(const SweepOptions& options, StateRun state,
                                           const SweepObservers& observers = {});

}  // namespace saltus::pipeline
