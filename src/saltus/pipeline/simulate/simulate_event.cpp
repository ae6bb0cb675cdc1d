#include <memory>
#include <optional>
#include <utility>
#include <variant>

#include "saltus/base/stopwatch.hpp"
#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/event_integrator/integrate.hpp"
#include "saltus/pipeline/continuous/continuous_internal.hpp"
#include "saltus/pipeline/options/element_choices_internal.hpp"
#include "saltus/pipeline/simulate/branches_internal.hpp"
#include "saltus/pipeline/simulate/methods_internal.hpp"
#include "saltus/pipeline/simulate/output_rows_internal.hpp"
#include "saltus/pipeline/simulate/passed_on_internal.hpp"
#include "saltus/pipeline/simulate/step_observer_internal.hpp"

namespace saltus::pipeline {
namespace {

using event_integrator::IntegrationOptions;

switching::SelectionPolicy selection_policy(Selection selection) {
  switch (selection) {
    case Selection::active_dominant:
      return switching::SelectionPolicy::active_dominant;
    case Selection::passive_dominant:
      return switching::SelectionPolicy::passive_dominant;
    case Selection::scaled:
      return switching::SelectionPolicy::scaled;
    case Selection::report:
      return switching::SelectionPolicy::report;
  }
  __builtin_unreachable();
}

/// Whether rows and events may leave the run while it goes on: nothing needs all of them.
bool passes_on(const Simulation& asked) {
  const auto& options = asked.options;
  return asked.observers.on_part && options.event.trajectories == 1 && !options.continuous && !options.error_estimate &&
         !asked.has_bodies;
}

/// Follows one trajectory after the other.
class Trajectories {
 public:
  /// @param watch  of the first one
  Trajectories(const Simulation& asked, evaluation::ModelKernel& kernel, const Stopwatch& watch)
      : asked_(asked),
        kernel_(kernel),
        watch_(watch),
        own_(asked.options.continuous ? own_copy(asked.system) : nullptr),
        options_(event_options(asked, asked.options.event.integrator)) {}

  [[nodiscard]] Followed follow(const Path& path, const Count& count) {
    const auto observer = step_observer(asked_.observers, {options_.from, options_.until, count.number, count.known});
    options_.choices = path;
    std::optional<PassingOn> passing;
    event_integrator::TakeRecorded take;
    if (passes_on(asked_)) {
      std::optional<WantedRows> wanted;
      if (!has_event_rows(asked_.options)) wanted = wanted_rows(asked_.options.output, asked_.times);
      passing.emplace(asked_.observers, asked_.frame, std::move(wanted));
      take = [&](result::Trajectory rows, result::Events events) { passing->take(std::move(rows), std::move(events)); };
    }
    auto run = event_integrator::integrate(kernel_, options_, observer, take);
    Followed followed{asked_.frame, std::move(run.branch_points), std::move(run.family_numbers), run.chosen};
    auto& result = followed.result;
    add_run(run, result);
    result.families = std::move(run.families);
    if (own_) {
      const EventRun of_it{own_, options_, native_code(asked_.options.native), {}};
      result.continuous = continuous(result.trajectory, of_it, kernel_, std::move(run.pieces));
    }
    if (passing) result.passed_on = passing->end();
    if (!has_event_rows(asked_.options)) {
      leave_out_event_rows(wanted_rows(asked_.options.output, asked_.times), result.trajectory);
    }
    result.statistics.wall_seconds = watch_.seconds();
    watch_ = {};
    return followed;
  }

 private:
  const Simulation& asked_;
  evaluation::ModelKernel& kernel_;
  Stopwatch watch_;
  std::shared_ptr<const model::System> own_;  ///< that a solution between rows keeps; null without one
  IntegrationOptions options_;
};

/// Where no decision is known, elements may go on: theirs are solutions of equations. They have no jumps.
void mention_elements(const model::System& system, result::Status& status) {
  if (status.termination != result::Termination::outside_class || !system.jumps.empty()) return;
  status.message += "; --method fesd may go on";
}

}  // namespace

IntegrationOptions event_options(const Simulation& asked, Integrator method) {
  const auto& options = asked.options;
  IntegrationOptions integration;
  integration.chooses_method = method == Integrator::automatic;
  integration.method = named_method(method);
  integration.from = options.from;
  integration.until = *options.until;
  integration.begun = options.begun;
  integration.tolerances = {options.rtol, options.atol};
  integration.max_step = options.event.max_step;
  integration.local_steps = options.event.local_steps;
  integration.max_steps = options.max_steps;
  integration.max_events = options.max_events;
  if (std::holds_alternative<Automatic>(options.output)) integration.output.straight = straight_share;
  if (is_at_times(options.output)) integration.output.rows = event_integrator::OutputTimes::Rows::at_times;
  integration.output.times = asked.times;
  integration.output.pieces = options.continuous;
  integration.initial_mode = asked.forced_mode;
  integration.selection = selection_policy(options.event.selection);
  integration.scaling = asked.scaling;
  return integration;
}

Expected<result::Result> simulate_event(const Simulation& asked, KernelStore& kernels) {
  const Stopwatch watch;
  const auto& options = asked.options;
  auto kept = kernels.take(asked.system, native_code(options.native));
  if (!kept) return tl::unexpected(kept.error());
  Trajectories trajectories(asked, kept->kernel, watch);
  auto result = follow_branches([&](const Path& path, const Count& count) { return trajectories.follow(path, count); },
                                {options.event.trajectories, options.event.members});
  mention_elements(asked.system, result.status);
  kernels.give_back(std::move(*kept));
  return result;
}

}  // namespace saltus::pipeline
