// Model in, trajectory out.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "saltus/base/error.hpp"
#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/pipeline/options/simulate_options.hpp"
#include "saltus/result/result.hpp"

namespace saltus::model {
struct System;
}

namespace saltus::pipeline {

/// Holds what an observer sees after every accepted step.
struct StepRecord {
  double t = 0.0;
  double from = 0.0;
  double until = 0.0;
  long steps = 0;
  long events = 0;
  long trajectory = 1;    ///< number of the one under way, from 1
  long trajectories = 1;  ///< that will be followed, as far as is known
  /// The state at t, valid during the call; empty behind a step that was divided.
  std::span<const double> x{};
};
enum class Proceed { on, stop };

struct Observers {
  std::function<Proceed(const StepRecord&)> on_step{};  ///< may be empty; `stop` ends with stopped_by_user
  /// Takes rows and events in their order while the run goes on, in results that have these and the names of their
  /// columns only; the result of the run has Result::passed_on instead. Called by the event engine where one trajectory
  /// is followed; may be empty.
  std::function<void(const result::Result& part)> on_part{};
};

/// Holds kernels that were compiled before, for runs of systems with the same structure: of one model with other
/// parameters and initial values. For any number of threads.
class KernelStore {
 public:
  struct Kept {
    std::vector<std::uint64_t> structure;
    evaluation::NativeCode native = evaluation::NativeCode::off;
    evaluation::ModelKernel kernel;
  };
  /// Takes a kernel of the system: one that waits here, another one of a model that was compiled here, or a new one, as
  /// of ModelKernel::compile. Results are the same.
  [[nodiscard]] Expected<Kept> take(const model::System& system, evaluation::NativeCode native);
  void give_back(Kept kept);

 private:
  struct Compiled {
    std::vector<std::uint64_t> structure;
    evaluation::NativeCode native = evaluation::NativeCode::off;
    std::shared_ptr<evaluation::CompiledModel> model;
  };
  void remember(Compiled made);

  /// More than threads that run at a time; what is beyond is dropped.
  static constexpr std::size_t most_kept = 64;
  std::mutex mutex_;
  std::vector<Kept> waiting_;
  std::size_t next_ = 0;  ///< to be changed for a newer one
  static constexpr std::size_t most_models = 8;
  std::vector<Compiled> compiled_;
  std::size_t next_model_ = 0;  ///< likewise
};

/// Simulates a system with the chosen method; follows other admissible modes if asked to (EventOptions::trajectories).
/// @param kernels  from earlier runs, and for later ones; may be null
/// @return the result whatever the numerics did (see Result::status); an Error only for options that do not fit the
///         system (unknown names in initial_mode, until not after from, a method that is not available).
[[nodiscard]] Expected<result::Result> simulate(const model::System& system, const SimulateOptions& options,
                                                const Observers& observers = {}, KernelStore* kernels = nullptr);

/// Asks for two rows where nobody keeps them, and nothing is said of them: end and events are the same with any.
void leave_out_rows(const model::System& system, SimulateOptions& options);

}  // namespace saltus::pipeline
