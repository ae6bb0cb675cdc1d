#include <limits>
#include <optional>
#include <utility>

#include "saltus/event_integrator/solution.hpp"
#include "saltus/pipeline/continuous/continuous_internal.hpp"
#include "saltus/pipeline/simulate.hpp"
#include "saltus/pipeline/simulate/simulation_internal.hpp"

namespace saltus::pipeline {
namespace {

/// Another kernel of what is compiled, with the values of a system.
Expected<evaluation::ModelKernel> kernel_of(const std::shared_ptr<evaluation::CompiledModel>& compiled,
                                            const EventRun& run) {
  auto kernel = evaluation::ModelKernel::of(compiled, run.native);
  if (!kernel || kernel->set_values(*run.system)) return kernel;
  return evaluation::ModelKernel::compile(*run.system, run.native);
}

/// Stops the steps behind a time: a shorter span would have another last step.
result::StepObserver until(double latest, const result::StepObserver& observer) {
  return [&observer, latest](const result::Progress& step) {
    const auto wanted = observer ? observer(step) : result::Continue::yes;
    return step.t > latest ? result::Continue::no : wanted;
  };
}

class EventInterior final : public result::Interior {
 public:
  EventInterior(EventRun run, std::shared_ptr<evaluation::CompiledModel> compiled,
                std::shared_ptr<const event_integrator::Pieces> pieces)
      : run_(std::move(run)), compiled_(std::move(compiled)), pieces_(std::move(pieces)) {}

  result::Trajectory rows(const std::vector<double>& times) override {
    if (!solution_) {
      auto kernel = kernel_of(compiled_, run_);
      if (!kernel) return {};
      solution_.emplace(pieces_, std::move(*kernel));
    }
    return restated(solution_->rows(times));
  }

  Expected<result::Trajectory> again(const std::vector<double>& times, const result::StepObserver& observer) override {
    auto kernel = kernel_of(compiled_, run_);
    if (!kernel) return tl::unexpected(kernel.error());
    auto options = run_.options;
    options.output = {event_integrator::OutputTimes::Rows::at_times, times};
    auto again = event_integrator::integrate(*kernel, options, until(times.back(), observer));
    return restated(std::move(again.trajectory));
  }

 private:
  [[nodiscard]] result::Trajectory restated(result::Trajectory rows) const {
    if (run_.restate) run_.restate(rows);
    return rows;
  }

  EventRun run_;
  std::shared_ptr<evaluation::CompiledModel> compiled_;
  std::shared_ptr<const event_integrator::Pieces> pieces_;
  std::optional<event_integrator::Solution> solution_;
};

class SimulatedInterior final : public result::Interior {
 public:
  SimulatedInterior(const model::System& system, SimulateOptions options,
                    std::shared_ptr<fesd_integrator::Solution> solution)
      : system_(own_copy(system)), options_(std::move(options)), solution_(std::move(solution)) {
    options_.event_rows = true;
    options_.kept = {};
    options_.event.trajectories = 1;
    options_.continuous = false;
  }

  result::Trajectory rows(const std::vector<double>& times) override {
    return solution_ ? solution_->rows(times) : result::Trajectory{};
  }

  Expected<result::Trajectory> again(const std::vector<double>& times, const result::StepObserver& observer) override {
    options_.output = AtTimes{times};
    // Steps of frozen time tell a time of their own.
    const auto stop = until(solution_ ? times.back() : std::numeric_limits<double>::infinity(), observer);
    const Observers observers{[&](const StepRecord& step) {
      const auto answer = stop({step.t, step.steps, step.events, step.x});
      return answer == result::Continue::yes ? Proceed::on : Proceed::stop;
    }};
    return simulate(*system_, options_, observers).map([](result::Result run) { return std::move(run.trajectory); });
  }

 private:
  std::shared_ptr<const model::System> system_;
  SimulateOptions options_;
  std::shared_ptr<fesd_integrator::Solution> solution_;  ///< of elements, or null
};

class OptimisedInterior final : public result::Interior {
 public:
  OptimisedInterior(std::shared_ptr<fesd_integrator::Solution> solution,
                    std::function<void(result::Trajectory&)> columns)
      : solution_(std::move(solution)), columns_(std::move(columns)) {}

  result::Trajectory rows(const std::vector<double>& times) override {
    auto rows = solution_->rows(times);
    columns_(rows);
    return rows;
  }
  Expected<result::Trajectory> again(const std::vector<double>&, const result::StepObserver&) override {
    return result::Trajectory{};  // its elements lie one behind the other
  }

 private:
  std::shared_ptr<fesd_integrator::Solution> solution_;
  std::function<void(result::Trajectory&)> columns_;
};

}  // namespace

std::shared_ptr<result::Continuous> continuous(const result::Trajectory& rows, EventRun run,
                                               const evaluation::ModelKernel& kernel,
                                               std::shared_ptr<const event_integrator::Pieces> pieces) {
  return std::make_shared<result::Continuous>(
      rows, std::make_unique<EventInterior>(std::move(run), kernel.compiled(), std::move(pieces)));
}

std::shared_ptr<result::Continuous> continuous(const result::Trajectory& rows, const model::System& system,
                                               const SimulateOptions& options,
                                               std::shared_ptr<fesd_integrator::Solution> solution) {
  return std::make_shared<result::Continuous>(
      rows, std::make_unique<SimulatedInterior>(system, options, std::move(solution)));
}

std::shared_ptr<result::Continuous> continuous(const result::Trajectory& rows,
                                               std::shared_ptr<fesd_integrator::Solution> solution,
                                               std::function<void(result::Trajectory&)> columns) {
  return std::make_shared<result::Continuous>(
      rows, std::make_unique<OptimisedInterior>(std::move(solution), std::move(columns)));
}

}  // namespace saltus::pipeline
