#include "saltus/pipeline/sweep.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <limits>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <thread>
#include <unistd.h>
#include <utility>

#include <fmt/format.h>

#include "saltus/base/contracts.hpp"
#include "saltus/base/symbolic_lock.hpp"
#include "saltus/pipeline/options/option_fields.hpp"
#include "saltus/pipeline/options/stated_run.hpp"

namespace saltus::pipeline {
namespace {

double bytes_of(const result::Trajectory& rows) {
  if (rows.t.empty()) return 0.0;
  const auto numbers = 1 + rows.x.width() + rows.u.width() + rows.alpha.width() + rows.outputs.width();
  return static_cast<double>(rows.t.size()) * static_cast<double>(8 * numbers);
}

double bytes_of_machine() {
  return static_cast<double>(::sysconf(_SC_PHYS_PAGES)) * static_cast<double>(::sysconf(_SC_PAGESIZE));
}

/// Whether nothing else was admissible on the way; false outweighs what was not decided.
std::optional<bool> is_unique(const result::Result& run) {
  if (!run.families.empty()) return false;
  std::optional<bool> unique = true;
  for (std::size_t i = 0; i < run.events.size(); ++i) {
    const auto here = run.events.unique(i);
    if (here == false) return false;
    if (!here) unique = std::nullopt;
  }
  return unique;
}

void leave_what_is_kept(SweepRun& run, Keep keep) {
  run.events = run.result.events.size();
  run.unique = is_unique(run.result);
  if (keep == Keep::trajectory) return;
  run.result.trajectory = {};
  run.result.branches = {};
  run.result.options = {};
  run.result.elements.reset();
  if (keep == Keep::final) run.result.events = {};
}

Error too_much_kept(std::size_t runs, double bytes) {
  return {ErrorCode::invalid_option,
          fmt::format("the trajectories of all {} runs need {:.0f} GB or more; {:.0f} GB are possible", runs,
                      bytes / 1e9, most_kept_bytes / 1e9),
          "keep events or final, or ask for fewer rows: simulate.output.points",
          {},
          {}};
}

/// The least that rows at asked times take in all runs, as far as the first one tells it.
double least_kept_bytes(const SweepOptions& options, StateRun state) {
  if (options.keep != Keep::trajectory) return 0.0;
  const SymbolicLock lock;
  const auto first = state(0);
  if (!first || !end_time(first->options)) return 0.0;
  const auto& [system, asked] = *first;
  const auto states = asked.kept.states ? 0 : system.state_names.size();
  const double rows = number_of_rows(asked.output, asked.from, *end_time(asked));
  return rows * static_cast<double>(8 * (1 + states) * options.runs);
}

/// What all threads work on.
class Workshop {
 public:
  Workshop(const SweepOptions& options, StateRun state, const SweepObservers& observers)
      : options_(options), state_(state), observers_(observers), runs_(options.runs) {
    watch_.on_step = [this](const StepRecord&) { return interrupted() ? Proceed::stop : Proceed::on; };
  }

  /// Takes runs in their order until there are none: whatever comes before a failure has been begun.
  void work() {
    for (std::size_t i = next_++; i < runs_.size() && !failed_; i = next_++) {
      // What is left may be a million runs.
      if (interrupted()) return;
      if (auto done = one(i); !done) fail(i, done.error());
      const std::lock_guard guard(mutex_);
      begun_ = std::max(begun_, i + 1);
      ++done_;
      if (observers_.on_run) observers_.on_run(done_);
    }
  }

  /// What is thrown ends all threads, and is thrown by outcome() again.
  void work_or_note() {
    try {
      work();
    } catch (...) {
      const std::lock_guard guard(mutex_);
      thrown_ = std::current_exception();
      failed_ = true;
    }
  }

  [[nodiscard]] Expected<SweepOutcome> outcome() && {
    if (thrown_) std::rethrow_exception(thrown_);
    for (std::size_t i = 0; i < begun_; ++i) {
      if (!runs_[i].result.states.empty()) continue;
      // Another thread had taken it when the interruption came, and has not begun it.
      runs_[i].result.status = {result::Termination::stopped_by_user, "not begun",
                                std::numeric_limits<double>::quiet_NaN()};
    }
    runs_.resize(begun_);
    if (!error_) return SweepOutcome{std::move(runs_), warnings()};
    if (is_too_much_) return tl::unexpected(std::move(*error_));
    return tl::unexpected(
        with_context(std::move(*error_), fmt::format("in run {}", options_.before + failed_run_ + 1)));
  }

 private:
  [[nodiscard]] bool interrupted() const { return observers_.is_interrupted && observers_.is_interrupted(); }

  Expected<void> one(std::size_t i) {
    std::optional<StatedRun> stated;
    {
      const SymbolicLock lock;
      auto made = state_(i);
      if (!made) return tl::unexpected(made.error());
      stated.emplace(std::move(*made));
      // Under the same lock: other threads note theirs.
      for (const auto& warning : stated->system.warnings) warned_[warning].insert(options_.before + i + 1);
    }
    if (options_.keep != Keep::trajectory) leave_out_rows(stated->system, stated->options);
    auto result = simulate(stated->system, stated->options, watch_, &kernels_);
    {
      const SymbolicLock lock;
      stated.reset();
    }
    if (!result) return tl::unexpected(result.error());
    runs_[i].result = std::move(*result);
    leave_what_is_kept(runs_[i], options_.keep);
    const double kept = bytes_of(runs_[i].result.trajectory);
    // One run tells where all of them would go far beyond it.
    constexpr double far = 10.0;
    const bool hopeless = kept * static_cast<double>(options_.runs) > far * most_kept_bytes;
    if (kept > 0.0 && ((kept_bytes_ += kept) > most_kept_bytes || hopeless)) {
      is_too_much_ = true;
      const double all = hopeless ? kept * static_cast<double>(options_.runs) : kept_bytes_.load();
      return tl::unexpected(too_much_kept(options_.runs, all));
    }
    return {};
  }

  /// In the order of their first runs, however the threads were.
  [[nodiscard]] std::vector<SweepWarning> warnings() const {
    std::vector<SweepWarning> warnings;
    for (const auto& [text, runs] : warned_) warnings.push_back({text, {runs.begin(), runs.end()}});
    std::stable_sort(warnings.begin(), warnings.end(),
                     [](const auto& a, const auto& b) { return a.runs.front() < b.runs.front(); });
    return warnings;
  }

  void fail(std::size_t run, const Error& error) {
    const std::lock_guard guard(mutex_);
    if (!error_ || run < failed_run_) {
      error_ = error;
      failed_run_ = run;
    }
    failed_ = true;
  }

  const SweepOptions& options_;
  StateRun state_;
  const SweepObservers& observers_;
  std::vector<SweepRun> runs_;
  std::map<std::string, std::set<std::size_t>> warned_;  ///< numbers of runs, by warning
  KernelStore kernels_;
  Observers watch_;
  std::atomic<std::size_t> next_ = 0;
  std::atomic<bool> failed_ = false;
  std::atomic<double> kept_bytes_ = 0.0;
  std::atomic<bool> is_too_much_ = false;  ///< no mistake of a run
  std::mutex mutex_;
  std::size_t done_ = 0;
  std::size_t begun_ = 0;  ///< all before this one have been begun, but for an interruption
  std::optional<Error> error_;
  std::size_t failed_run_ = 0;
  std::exception_ptr thrown_;
};

}  // namespace

Expected<SweepOutcome> sweep(const SweepOptions& options, StateRun state, const SweepObservers& observers) {
  SALTUS_ASSERT(options.jobs >= 1);
  constexpr double names_and_values = 1500.0;  // bytes, of a model with a few states
  const double needed = static_cast<double>(options.runs) * (static_cast<double>(sizeof(SweepRun)) + names_and_values);
  if (needed > bytes_of_machine()) {
    return tl::unexpected(
        Error{ErrorCode::invalid_option,
              fmt::format("{} runs need about {:.0f} GB of memory at once, and the machine has {:.0f}", options.runs,
                          needed / 1e9, bytes_of_machine() / 1e9),
              "fill a folder, with one share of them in memory at a time: --resume FOLDER",
              {},
              {}});
  }
  if (const double kept = least_kept_bytes(options, state); kept > most_kept_bytes) {
    return tl::unexpected(too_much_kept(options.runs, kept));
  }
  Workshop workshop(options, state, observers);
  std::vector<std::thread> helpers;
  for (std::size_t k = 1; k < std::min(options.jobs, options.runs); ++k) {
    helpers.emplace_back([&workshop] { workshop.work_or_note(); });
  }
  workshop.work_or_note();
  for (auto& helper : helpers) helper.join();
  return std::move(workshop).outcome();
}

}  // namespace saltus::pipeline
