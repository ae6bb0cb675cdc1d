// What an event costs in steps of its own run, for every model of a folder with at least ten events, and as many steps
// without one: a table.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "machine.hpp"
#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/event_integrator/field/mode_field.hpp"
#include "saltus/event_integrator/run/compact_integration.hpp"
#include "saltus/io/toml/toml_model.hpp"
#include "saltus/model/build.hpp"
#include "saltus/ode/bernstein.hpp"
#include "saltus/ode/stepper.hpp"

namespace compare {
namespace {

namespace evaluation = saltus::evaluation;
namespace event_integrator = saltus::event_integrator;
namespace model = saltus::model;
namespace ode = saltus::ode;
using Clock = std::chrono::steady_clock;

constexpr long fewest_events = 10;
constexpr std::size_t fewest_steps = 10;  ///< without an event, by which events are measured
constexpr int fewest_runs = 20;
constexpr int most_runs = 200;
constexpr double wanted_seconds = 0.5;

double nanoseconds_since(Clock::time_point begin) {
  return std::chrono::duration<double, std::nano>(Clock::now() - begin).count();
}

/// Readings of a clock differ by whole ticks, here of ten nanoseconds: what lies between two of them shows in the mean
/// of many readings.
struct ClockCost {
  double reading = 0.0;  ///< what reading it takes, ns
  double tick = 0.0;     ///< ns
};

/// From the differences of successive readings, but for the tenths at both ends: of a row of them, the shortest of
/// many.
ClockCost cost_of_clock() {
  constexpr std::size_t readings = 200;
  ClockCost cost{std::numeric_limits<double>::infinity(), 0.0};
  std::vector<double> differences;
  for (int k = 0; k < 100; ++k) {
    std::vector<Clock::time_point> row(readings);
    for (auto& time : row) time = Clock::now();
    const double all = std::chrono::duration<double, std::nano>(row.back() - row.front()).count();
    cost.reading = std::min(cost.reading, all / static_cast<double>(readings - 1));
    for (std::size_t i = 1; i < readings; ++i) {
      differences.push_back(std::chrono::duration<double, std::nano>(row[i] - row[i - 1]).count());
    }
  }
  std::sort(differences.begin(), differences.end());
  cost.tick = differences[9 * differences.size() / 10] - differences[differences.size() / 10];
  return cost;
}

/// From the end of one step of the run to that of the next one. Every run is the same, so the shortest times of all
/// runs are those in which nothing else was done on the machine.
struct Interval {
  std::vector<double> readings;  ///< one of every run, ns
  long events = 0;

  /// The mean of those that the tick of the clock alone keeps apart from the shortest.
  [[nodiscard]] double nanoseconds(const ClockCost& clock) const {
    const double shortest = *std::min_element(readings.begin(), readings.end());
    double sum = 0.0, count = 0.0;
    for (const double reading : readings) {
      if (reading > shortest + 1.5 * clock.tick) continue;
      sum += reading;
      count += 1.0;
    }
    return sum / count - clock.reading;
  }
};

struct Cost {
  long events = 0;
  std::size_t steps = 0;  ///< that end at no event
  double step = 0.0;      ///< median over these, ns
  double event = 0.0;     ///< median of the time that a step to an event takes longer than such a step, by its events
};

double median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

Cost cost_of(const std::vector<Interval>& intervals, const ClockCost& clock) {
  std::vector<double> steps, events;
  Cost cost;
  for (const auto& interval : intervals) {
    if (interval.events == 0) steps.push_back(interval.nanoseconds(clock));
  }
  cost.steps = steps.size();
  if (steps.empty()) return cost;
  cost.step = median(steps);
  for (const auto& interval : intervals) {
    if (interval.events == 0) continue;
    cost.events += interval.events;
    const double longer = interval.nanoseconds(clock) - cost.step;
    for (long k = 0; k < interval.events; ++k) events.push_back(longer / static_cast<double>(interval.events));
  }
  if (!events.empty()) cost.event = median(events);
  return cost;
}

/// No events if the run does not complete.
Cost measure(evaluation::ModelKernel& kernel, const event_integrator::IntegrationOptions& options,
             const ClockCost& clock) {
  std::vector<Interval> intervals;
  const auto begin = Clock::now();
  for (int run = 0; run < fewest_runs || (run < most_runs && nanoseconds_since(begin) < 1e9 * wanted_seconds); ++run) {
    std::size_t number = 0;
    long events_before = -1;
    Clock::time_point last;
    const auto observe = [&](const event_integrator::Progress& progress) {
      const double passed = nanoseconds_since(last);
      if (events_before >= 0) {  // the first step has the start of the run before it
        if (number == intervals.size()) intervals.emplace_back();
        auto& interval = intervals[number++];
        interval.readings.push_back(passed);
        interval.events = progress.events - events_before;
      }
      events_before = progress.events;
      last = Clock::now();
      return event_integrator::Continue::yes;
    };
    const auto result = event_integrator::integrate_compact(kernel, options, observe);
    if (result.status.termination != saltus::result::Termination::completed) return {};
  }
  return cost_of(intervals, clock);
}

/// What an event takes of what every event needs, ns: the dense output of a step, the zero of one state less a number
/// along it, the step once more up to there, and the right-hand sides on both sides. No search among several
/// functions, no decision, nothing recorded. By the library's own steps, from the end of a run; NaN where that is not
/// possible.
double floor_of_events(evaluation::ModelKernel& kernel, const event_integrator::IntegrationOptions& options) {
  const auto result = event_integrator::integrate_compact(kernel, options, {});
  const auto& recording = result.recording;
  const auto n = static_cast<std::size_t>(kernel.states());
  const double t = recording.row_times.back();
  const std::vector<double> x(recording.row_states.end() - kernel.states(), recording.row_states.end());
  const double h = (t - options.from) / static_cast<double>(std::max(result.statistics.steps, 1L));
  event_integrator::ModeState region;
  region.alpha.assign(static_cast<std::size_t>(kernel.switching_functions()), 1.0);
  std::vector<double> values(static_cast<std::size_t>(kernel.event_functions()));
  kernel.functions(t, x.data(), region.alpha.data(), values.data());
  for (std::size_t j = 0; j < region.alpha.size(); ++j) {
    region.mode.push_back(values[j] > 0.0 ? 1 : -1);
    region.alpha[j] = values[j] > 0.0 ? 1.0 : 0.0;
  }
  event_integrator::ModeField field(kernel, true);
  field.enter(region);
  ode::Stepper stepper(options.method, kernel.states()), retaken(options.method, kernel.states());
  ode::DenseStep dense;
  std::vector<double> slope(n), other(n), there(n);
  field(t, x.data(), slope.data());
  const auto f = [&](double time, const double* state, double* xdot) { field(time, state, xdot); };
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  constexpr int repeats = 200, rounds = 50;
  if (field.attempt(stepper, t, x.data(), slope.data(), h, options.tolerances) == ode::Attempt::undefined) return none;
  if (stepper.dense(f, dense) == ode::Attempt::undefined) return none;
  dense.evaluate(0.37, there.data());
  std::size_t moving = 0;
  while (moving < n && there[moving] == x[moving]) ++moving;
  if (moving == n) return none;
  double shortest = std::numeric_limits<double>::infinity();
  double sum = 0.0;
  for (int round = 0; round < rounds; ++round) {
    const auto begin = Clock::now();
    for (int k = 0; k < repeats; ++k) {
      if (stepper.dense(f, dense) == ode::Attempt::undefined) return none;
      auto along = dense.bernstein(moving);
      for (double& b : along) b -= there[moving];
      const auto change = ode::first_sign_change(along, along.front() > 0.0 ? 1 : -1, 0, 0.0);
      const double theta = change ? change->lower : 0.5;
      sum += ode::derivative(along, theta);
      static_cast<void>(field.attempt(retaken, t, x.data(), slope.data(), theta * h, options.tolerances));
      for (int side = 0; side < 2; ++side) field(t + theta * h, retaken.x_new(), other.data());
    }
    shortest = std::min(shortest, nanoseconds_since(begin) / repeats);
  }
  return std::isfinite(sum) ? shortest : none;
}

struct Summary {
  std::vector<double> in_steps, in_bare_steps, floors;

  static void print(std::vector<double>& steps, const char* which) {
    std::sort(steps.begin(), steps.end());
    const auto below = std::count_if(steps.begin(), steps.end(), [](double number) { return number < 5.0; });
    std::printf("%s median %.2f steps, from %.1f to %.1f, in %td of %zu models less than 5; ", which,
                steps[steps.size() / 2], steps.front(), steps.back(), below, steps.size());
  }

  void print(const char* method) {
    if (in_steps.empty()) return;
    std::printf("- %s:", method);
    print(in_steps, "");
    print(in_bare_steps, "bare");
    std::erase_if(floors, [](double floor) { return std::isnan(floor); });
    std::sort(floors.begin(), floors.end());
    std::printf("floor %.1f\n", floors.empty() ? std::nan("") : floors[floors.size() / 2]);
  }
};

int table(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() == ".toml") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  const ClockCost clock = cost_of_clock();
  const struct {
    ode::Method method;
    const char* name;
  } methods[]{{ode::Method::dop853, "dop853"}, {ode::Method::dopri5, "dopri5"}};
  Summary summaries[2];
  double load = 0.0;
  static_cast<void>(getloadavg(&load, 1));
  std::printf(
      "# Events in steps of their own runs\n\n"
      "On %s. Made by `compare_catalogue_events`: rtol 1e-8, native code, load average before %.1f; a row at every "
      "step (the "
      "default), bare: rows at events only. How to read it: "
      "[benchmarks/README.md](../README.md).\n\n",
      machine_and_day().c_str(), load);
  std::printf(
      "| model | method | events | other steps | step, ns | event, ns | event in steps | bare step, ns | bare event, "
      "ns "
      "| in bare steps | floor in bare steps |\n");
  std::printf("| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |\n");
  for (const auto& file : files) {
    const auto read = saltus::io::read_model(file);
    if (!read) continue;
    const auto system = model::build(read->description);
    if (!system) continue;
    auto kernel = evaluation::ModelKernel::compile(*system, evaluation::NativeCode::on);
    if (!kernel) continue;
    event_integrator::IntegrationOptions options;
    options.tolerances = {1e-8, 1e-10};
    options.from = read->simulate.from;
    options.until = read->simulate.until.value_or(1.0);
    for (std::size_t m = 0; m < 2; ++m) {
      options.method = methods[m].method;
      options.output.rows = event_integrator::OutputTimes::Rows::at_times;
      const Cost bare = measure(*kernel, options, clock);
      options.output.rows = event_integrator::OutputTimes::Rows::at_steps;
      const Cost cost = measure(*kernel, options, clock);
      if (cost.events < fewest_events || cost.steps < fewest_steps || !(cost.step > 0.0)) continue;
      // What is left of spirals are the steps behind their limits, which are others.
      if (cost.steps < static_cast<std::size_t>(cost.events) / 4) continue;
      summaries[m].in_steps.push_back(cost.event / cost.step);
      summaries[m].in_bare_steps.push_back(bare.event / bare.step);
      const double floor = floor_of_events(*kernel, options) / bare.step;
      summaries[m].floors.push_back(floor);
      std::printf("| %s | %s | %ld | %zu | %.0f | %.0f | %.1f | %.0f | %.0f | %.1f | ", file.stem().c_str(),
                  methods[m].name, cost.events, cost.steps, cost.step, cost.event, cost.event / cost.step, bare.step,
                  bare.event, bare.event / bare.step);
      std::printf(std::isnan(floor) ? "- |\n" : "%.1f |\n", floor);
      std::fflush(stdout);
    }
  }
  std::printf("\n");
  for (std::size_t m = 0; m < 2; ++m) summaries[m].print(methods[m].name);
  return 0;
}

}  // namespace
}  // namespace compare

int main(int count, char** arguments) {
  if (count == 2) return compare::table(arguments[1]);
  std::fprintf(stderr, "usage: compare_catalogue_events FOLDER\n");
  return 2;
}
