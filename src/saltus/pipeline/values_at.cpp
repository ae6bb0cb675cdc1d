#include "saltus/pipeline/values_at.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

#include <fmt/format.h>

#include "saltus/base/without_repeats.hpp"

namespace saltus::pipeline {
namespace {

Error outside(double t, double from, double until) {
  return {ErrorCode::invalid_option,
          fmt::format("t = {} lies outside the solution, which is known from {} to {}", t, from, until),
          "choose times within its span",
          {},
          {}};
}

void append_row(const result::Trajectory& from, std::size_t row, result::Trajectory& to) {
  to.t.push_back(from.t[row]);
  to.x.push_back(from.x[row]);
  to.u.push_back(from.u[row]);
  to.alpha.push_back(from.alpha[row]);
  to.mode.push_back(from.mode[row]);
  to.outputs.push_back(from.outputs[row]);
  if (from.regions.empty()) return;
  to.regions.push_back(from.regions[row]);
  to.theta.push_back(from.theta[row]);
}

}  // namespace

Expected<result::Trajectory> values_at(const model::System& system, const SimulateOptions& options,
                                       const std::vector<double>& times, SideOfEvent side, const Observers& observers) {
  SimulateOptions again = options;
  again.event_rows = true;
  again.kept = {};
  again.event.trajectories = 1;
  if (again.until) {
    for (const double t : times) {
      if (!(again.from <= t && t <= *again.until)) return tl::unexpected(outside(t, again.from, *again.until));
    }
  }
  AtTimes rows{times};
  drop_repeats(rows.times);
  again.output = std::move(rows);
  const double latest = times.empty() ? again.from : *std::max_element(times.begin(), times.end());
  Observers watching = observers;
  watching.on_step = [&](const StepRecord& step) {
    const auto wanted = observers.on_step ? observers.on_step(step) : Proceed::on;
    return step.t > latest ? Proceed::stop : wanted;  // a shorter span would have another last step
  };
  const auto run = simulate(system, again, watching);
  if (!run) return tl::unexpected(run.error());
  const auto& all = run->trajectory;
  result::Trajectory values;
  for (const double t : times) {
    const auto [first, last] = std::equal_range(all.t.begin(), all.t.end(), t);
    if (first == last) return tl::unexpected(outside(t, again.from, all.t.back()));
    const auto row = side == SideOfEvent::before ? first - all.t.begin() : last - all.t.begin() - 1;
    append_row(all, static_cast<std::size_t>(row), values);
  }
  return values;
}

}  // namespace saltus::pipeline
