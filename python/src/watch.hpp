// What Python hears of a run: Ctrl-C and progress.
#pragma once

#include <chrono>
#include <nanobind/nanobind.h>
#include <optional>
#include <string>

#include "saltus/base/preparation.hpp"
#include "saltus/pipeline/simulate.hpp"

namespace saltus::python {

/// Looks for signals, and tells progress, some ten times a second. The interpreter's lock need not be held.
class Watch {
 public:
  /// @param progress  None, or called with (t, from, until, steps, events); its `prepare`, if it has one, before that
  ///                  with (phase, done, of): of = 0 where nobody knows how many
  explicit Watch(nanobind::object progress) : progress_(std::move(progress)) {}

  [[nodiscard]] pipeline::Observers observers();
  /// Whether a handler of signals or `progress` has raised an exception: then the run is to end.
  [[nodiscard]] bool look(const pipeline::StepRecord* step = nullptr);
  /// Looks for signals, and tells what is prepared to `progress.prepare` where there is one. Returns whether to go on:
  /// always, once a step was taken.
  [[nodiscard]] bool goes_on(const Preparation& preparation);
  /// Calls `function` with a line of text; what it raises ends the run.
  void call(const nanobind::object& function, const std::string& line);
  /// Calls `function` with two numbers, at most ten times a second; likewise.
  void tell(const nanobind::object& function, double done, double total);
  /// Raises that exception, with `result` as its attribute.
  void raise_what_came(const nanobind::object& result);

 private:
  /// Keeps what `action` raises; does nothing if something has come before.
  template <class Action>
  void attempt(Action action) {
    if (came_) return;
    const nanobind::gil_scoped_acquire held;
    try {
      action();
    } catch (nanobind::python_error& error) {
      came_.emplace(std::move(error));
    }
  }

  using Clock = std::chrono::steady_clock;
  static constexpr auto interval = std::chrono::milliseconds(50);

  nanobind::object progress_;
  bool has_begun_ = false;
  std::optional<nanobind::python_error> came_;
  Clock::time_point next_ = Clock::now() + interval;
  Clock::time_point next_telling_{};
};

}  // namespace saltus::python
