// Saltus in the comparison: a model file through the library, the parts of the time apart.
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <sys/resource.h>
#include <utility>

#include "protocol.hpp"
#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/event_integrator/integrate.hpp"
#include "saltus/event_integrator/run/compact_integration.hpp"
#include "saltus/io/toml/toml_model.hpp"
#include "saltus/model/build.hpp"
#include "value_or_exit.hpp"

namespace compare {
namespace {

namespace evaluation = saltus::evaluation;
namespace event_integrator = saltus::event_integrator;
namespace model = saltus::model;

event_integrator::IntegrationOptions options_of(const Request& request, double until) {
  event_integrator::IntegrationOptions options;
  if (request.method == "dopri5") {
    options.method = saltus::ode::Method::dopri5;
  } else if (request.method == "dop853") {
    options.method = saltus::ode::Method::dop853;
  } else if (request.method == "taylor") {
    options.method = saltus::ode::Method::taylor;
  } else {
    unknown(request);
  }
  options.until = until;
  // The competitors keep events and end state; `trajectory` is what a user gets by default: every step.
  if (request.variant != "trajectory") options.output.rows = event_integrator::OutputTimes::Rows::at_times;
  options.max_steps = 100000000;
  return options;
}

evaluation::NativeCode native_code_of(const Request& request) {
  if (request.variant == "native" || request.variant == "trajectory") return evaluation::NativeCode::on;
  if (request.variant == "interpreted") return evaluation::NativeCode::off;
  unknown(request);
}

/// Together with the processes it has started and waited for: the compiler of the native code is one.
double all_cpu_seconds() {
  rusage children{};
  getrusage(RUSAGE_CHILDREN, &children);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return cpu_seconds() + seconds(children.ru_utime) + seconds(children.ru_stime);
}

Run run_of(const event_integrator::Integration& integration) {
  Run run;
  run.status = std::string(saltus::result::name(integration.status.termination));
  run.x = integration.final.x;
  for (const auto& event : integration.events) {
    if (event.kind != saltus::result::EventKind::start) run.events.push_back(event.t);
  }
  run.steps = static_cast<long>(integration.statistics.steps);
  run.evaluations = static_cast<long>(integration.statistics.rhs_evaluations);
  return run;
}

/// PROBLEM is the path of a model file; its name is that of the problem, its [simulate] has the end.
void sweep(Request request) {
  const std::filesystem::path file = request.problem;
  request.problem = file.stem().string();
  const double begin = all_cpu_seconds();
  const auto model_file = value_or_exit(saltus::io::read_model(file));
  const model::System system = value_or_exit(model::build(model_file.description));
  const double built = all_cpu_seconds();
  auto kernel = value_or_exit(evaluation::ModelKernel::compile(system, native_code_of(request)));
  const double compiled = all_cpu_seconds();
  auto options = options_of(request, model_file.simulate.until.value_or(1.0));
  char parts[120];
  std::snprintf(parts, sizeof parts, ",\"build_seconds\":%.6g,\"compile_seconds\":%.6g", built - begin,
                compiled - built);
  for (const double tolerance : request.tolerances) {
    options.tolerances = {tolerance, 0.01 * tolerance};
    const long before = kernel.field_evaluations();
    Run run = run_of(event_integrator::integrate(kernel, options));
    run.evaluations = kernel.field_evaluations() - before;
    const Timing timing = median_time(request.seconds, [&] {
      if (request.variant == "trajectory") {
        static_cast<void>(event_integrator::integrate(kernel, options));
      } else {
        static_cast<void>(event_integrator::integrate_compact(kernel, options));
      }
    });
    print(request, tolerance, timing, run, parts);
  }
}

}  // namespace
}  // namespace compare

int main(int count, char** arguments) { compare::sweep(compare::request_from(count, arguments)); }
