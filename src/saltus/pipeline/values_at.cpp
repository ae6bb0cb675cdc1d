#include "saltus/pipeline/values_at.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "saltus/base/without_repeats.hpp"
#include "saltus/model/system.hpp"
#include "saltus/result/continuous.hpp"

namespace saltus::pipeline {
Expected<result::Trajectory> values_at(const model::System& system, const SimulateOptions& options,
                                       const std::vector<double>& asked, SideOfEvent side, const Observers& observers) {
  SimulateOptions again = options;
  again.until = end_time(options);
  again.event_rows = true;
  again.kept = {};
  again.event.trajectories = 1;
  again.continuous = false;
  auto times = asked;
  if (again.until) {
    for (double& t : times) {
      t = result::moved_to_end(t, again.from, *again.until);
      if (!(again.from <= t && t <= *again.until)) return tl::unexpected(result::outside(t, again.from, *again.until));
    }
  }
  AtTimes rows{times};
  drop_repeats(rows.times);
  again.output = std::move(rows);
  double latest = times.empty() ? again.from : *std::max_element(times.begin(), times.end());
  // Steps of frozen time tell a time of their own.
  if (system.frozen && again.method != Method::event) latest = std::numeric_limits<double>::infinity();
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
    if (!result::append_row_at(t, side, all, values)) {
      return tl::unexpected(result::outside(t, again.from, all.t.back()));
    }
  }
  return values;
}

}  // namespace saltus::pipeline
