// One line on a terminal that shows how far a simulation is.
#pragma once

#include <chrono>
#include <cstddef>
#include <memory>
#include <string>

#include "saltus/base/function_ref.hpp"
#include "saltus/base/preparation.hpp"
#include "saltus/pipeline/simulate.hpp"

namespace saltus::cli {

enum class ShowProgress { when_terminal, never };

/// Rewrites its line on standard error at most ten times a second; silent if standard error is no terminal.
class ProgressLine {
 public:
  explicit ProgressLine(ShowProgress show);
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;
  ~ProgressLine() { clear(); }

  void update(const pipeline::StepRecord& step);
  /// Returns whether a run has told of itself: what is prepared behind that does not end it.
  [[nodiscard]] bool has_begun() const { return has_begun_; }
  /// Shows a text, unless one was shown just before. Made only if it is shown.
  void show(FunctionRef<std::string()> text);
  /// Takes the line away.
  void clear();

 private:
  using Clock = std::chrono::steady_clock;

  bool shown_;
  bool has_begun_ = false;
  std::size_t width_ = 0;
  Clock::time_point next_;
};

/// Shows the progress of a run and has it stop at Ctrl-C, which is caught from here on.
/// @param progress  must outlive what is returned
[[nodiscard]] pipeline::Observers watched(ProgressLine& progress);

/// Shows what is done before the first step, and has it stop at a Ctrl-C that `watched` catches: Stopped is thrown.
/// @param progress  must outlive what is returned
[[nodiscard]] PreparationScope preparation_shown(ProgressLine& progress);

}  // namespace saltus::cli
