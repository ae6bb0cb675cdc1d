#include <optional>
#include <string>
#include <utility>

#include "saltus/adapters/ipopt/ipopt_solver.hpp"
#include "saltus/base/stopwatch.hpp"
#include "saltus/base/symbolic_lock.hpp"
#include "saltus/fesd_integrator/integrate.hpp"
#include "saltus/fesd_integrator/step_problem.hpp"
#include "saltus/model/system.hpp"
#include "saltus/model/time_freezing/time_freezing.hpp"
#include "saltus/model/vanishing_norm.hpp"
#include "saltus/pipeline/continuous/continuous_internal.hpp"
#include "saltus/pipeline/options/element_choices_internal.hpp"
#include "saltus/pipeline/simulate/methods_internal.hpp"
#include "saltus/pipeline/simulate/output_rows_internal.hpp"
#include "saltus/pipeline/simulate/step_observer_internal.hpp"
#include "saltus/reformulation/dcs.hpp"

namespace saltus::pipeline {
namespace {

/// Whether lengths are determined exactly, so that active sets can be predicted.
bool is_exact(StepEquilibration wanted) {
  return wanted == StepEquilibration::direct || wanted == StepEquilibration::mlcp;
}

/// Selections at stages; of larger runs the result has none, it would consist of little else.
constexpr double most_recorded_values = 1e5;

Error no_sensitivities() {
  return {ErrorCode::invalid_option,
          "sensitivities need the lengths of elements as functions of the initial state",
          "step_equilibration = \"direct\" or \"mlcp\", or no sensitivities",
          {},
          {}};
}

fesd_integrator::IntegrationOptions element_run_options(const Simulation& asked, const ElementOptions& wanted,
                                                        discretization::ButcherTableau tableau) {
  const auto& options = asked.options;
  fesd_integrator::IntegrationOptions integration;
  integration.switches = options.method == Method::fesd ? fesd_integrator::IntegrationOptions::Switches::detected
                                                        : fesd_integrator::IntegrationOptions::Switches::fixed;
  integration.tableau = std::move(tableau);
  integration.from = options.from;
  integration.until = *options.until;
  integration.steps = wanted.steps;
  integration.elements = static_cast<int>(wanted.elements);
  integration.error_limit = wanted.error_limit;
  integration.step_bounds = wanted.step_bounds;
  integration.max_steps = options.max_steps;
  integration.max_events = options.max_events;
  integration.native = native_code(options.native);
  integration.sensitivities = wanted.sensitivities;
  integration.initial_mode = asked.forced_mode;
  if (asked.system.freezing) integration.clock = static_cast<std::size_t>(asked.system.freezing->clock);
  integration.pieces = options.continuous && !integration.clock;
  if (std::holds_alternative<Automatic>(options.output)) integration.straight = straight_share;
  if (is_at_times(options.output)) integration.rows = fesd_integrator::IntegrationOptions::Rows::at_times;
  integration.times = asked.times;
  return integration;
}

/// Elements end where switching functions vanish, and a direction that ends is none: no element is short enough there.
void add_vanishing_norm(const model::System& system, fesd_integrator::Integration& run) {
  if (result::is_done(run.status.termination) || !system.contacts.empty()) return;
  const std::string norm = model::vanishing_norm(system, run.status.time_reached, run.final.x);
  if (!norm.empty()) run.status.message += norm + ", or method = \"event\", which finds where such friction ends";
}

}  // namespace

Expected<result::Result> simulate_elements(const Simulation& asked) {
  const SymbolicLock lock;  // its problems are made while it runs
  const Stopwatch stopwatch;
  const auto& system = asked.system;
  const auto& options = asked.options;
  const bool detected = options.method == Method::fesd;
  const ElementOptions& wanted = detected ? options.fesd : options.timestepping;
  auto tableau = discretization::butcher_tableau(wanted.scheme, static_cast<int>(wanted.stages));
  if (!tableau) return tl::unexpected(tableau.error());
  const auto dcs = reformulation::reformulate(system, reformulation_options(wanted));
  if (!dcs) return tl::unexpected(dcs.error());

  const double values = static_cast<double>(wanted.steps) * static_cast<double>(wanted.elements * wanted.stages) *
                        static_cast<double>(dcs->selection.numel());
  auto integration = element_run_options(asked, wanted, std::move(*tableau));
  integration.record_elements = values > 0.0 && values <= most_recorded_values;
  std::optional<adapters::IpoptSolver> ipopt;
  std::optional<fesd_integrator::StepProblem> step_problem;
  const auto make_problem = [&]() -> Expected<fesd_integrator::StepProblem*> {
    if (step_problem) return &*step_problem;
    const SymbolicLock again;  // the run has let go of it
    ipopt.emplace();
    auto made =
        fesd_integrator::StepProblem::make(*dcs, system.parameter_values, integration.tableau, fesd_options(wanted),
                                           integration.elements, *ipopt, native_code(options.native));
    if (!made) return tl::unexpected(made.error());
    return &step_problem.emplace(std::move(*made));
  };
  if (detected && !is_exact(wanted.step_equilibration)) {
    if (wanted.sensitivities) return tl::unexpected(no_sensitivities());
    auto made = make_problem();
    if (!made) return tl::unexpected(made.error());
    integration.step_problem = *made;
  } else if (detected) {
    integration.fallback = [&] { return make_problem().value_or(nullptr); };
  }
  const auto observer = step_observer(asked.observers, {integration.from, integration.until});
  auto run = fesd_integrator::integrate(system, *dcs, integration, observer);
  if (!run) return tl::unexpected(run.error());
  add_vanishing_norm(system, *run);
  auto result = asked.frame;
  add_run(*run, result);
  result.sensitivities = std::move(run->sensitivities);
  result.elements = std::move(run->elements);
  if (options.continuous) {
    result.continuous = continuous(result.trajectory, system, options, std::move(run->solution));
  }
  if (!has_event_rows(options)) leave_out_event_rows(wanted_rows(options.output, asked.times), result.trajectory);
  result.statistics.wall_seconds = stopwatch.seconds();
  return result;
}

}  // namespace saltus::pipeline
