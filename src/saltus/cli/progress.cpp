#include "saltus/cli/progress.hpp"

#include <algorithm>
#include <cstdio>
#include <unistd.h>

#include <fmt/format.h>

#include "saltus/cli/interrupt.hpp"

namespace saltus::cli {
namespace {

constexpr auto interval = std::chrono::milliseconds(100);
/// A run that ends before this shows no line at all: it would only flicker.
constexpr auto patience = std::chrono::milliseconds(300);

/// "t = 12.5   31 %   1234 steps   6 events"; with several trajectories "3 of 7" stands in front of it.
std::string progress_text(const pipeline::StepRecord& step) {
  const double share = (step.t - step.from) / (step.until - step.from);
  const auto which = step.trajectories > 1 ? fmt::format("{} of {}   ", step.trajectory, step.trajectories) : "";
  return which + fmt::format("t = {:.6g}   {:.0f} %   {} steps   {} events", step.t,
                             100.0 * std::clamp(share, 0.0, 1.0), step.steps, step.events);
}

}  // namespace

PreparationScope preparation_shown(ProgressLine& progress) {
  return PreparationScope([&progress](const Preparation& preparation) {
    progress.show([&] { return "preparing   " + preparation.text(); });
    return progress.has_begun() || !interrupted();
  });
}

pipeline::Observers watched(ProgressLine& progress) {
  catch_interrupt();
  pipeline::Observers observers;
  observers.on_step = [&progress](const pipeline::StepRecord& step) {
    progress.update(step);
    return interrupted() ? pipeline::Proceed::stop : pipeline::Proceed::on;
  };
  return observers;
}

ProgressLine::ProgressLine(ShowProgress show)
    : shown_(show == ShowProgress::when_terminal && ::isatty(STDERR_FILENO) == 1), next_(Clock::now() + patience) {}

void ProgressLine::update(const pipeline::StepRecord& step) {
  has_begun_ = true;
  show([&] { return progress_text(step); });
}

void ProgressLine::show(FunctionRef<std::string()> make_text) {
  if (!shown_) return;
  const auto now = Clock::now();
  if (now < next_) return;
  next_ = now + interval;
  const auto text = make_text();
  std::fputs(fmt::format("\r{:<{}}", text, width_).c_str(), stderr);
  std::fflush(stderr);
  width_ = std::max(width_, text.size());
}

void ProgressLine::clear() {
  if (width_ == 0) return;
  std::fputs(fmt::format("\r{:{}}\r", "", width_).c_str(), stderr);
  std::fflush(stderr);
  width_ = 0;
}

}  // namespace saltus::cli
