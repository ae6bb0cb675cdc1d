#include <algorithm>
#include <cmath>
#include <limits>

#include "saltus/base/at.hpp"
#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/event_integrator/integrate.hpp"
#include "saltus/model/ocp.hpp"
#include "saltus/model/time_freezing/time_freezing.hpp"
#include "saltus/pipeline/optimal_control/guessed_simulation_internal.hpp"

namespace saltus::pipeline {
namespace {

using event_integrator::Integration;
using event_integrator::IntegrationOptions;

/// A guess need not be exact, but should have the switches of the true trajectory.
constexpr ode::Tolerances guess_tolerances{1e-6, 1e-8};
constexpr long most_guess_steps = 20'000;
constexpr long most_guess_events = 2'000;
/// Times the largest of what is given about a state: a problem solver has no use for more.
constexpr double largest_growth = 1e6;

/// Two digits less than the tolerances. What is behind them comes from the lengths of the steps, and would lead
/// problems with many solutions to one or another.
constexpr int known_bits = 13;

constexpr double not_known_yet = std::numeric_limits<double>::quiet_NaN();

IntegrationOptions guess_options(double from, double until, const std::vector<double>& times) {
  IntegrationOptions options;
  options.tolerances = guess_tolerances;
  options.from = from;
  options.until = until;
  options.max_steps = most_guess_steps;
  options.max_events = most_guess_events;
  options.output.rows = event_integrator::OutputTimes::Rows::at_times;
  options.output.times = times;
  auto& output = options.output.times;
  output.erase(std::unique(output.begin(), output.end()), output.end());
  return options;
}

bool is_of_use(const model::System& system, const std::vector<double>& x) {
  for (std::size_t i = 0; i < x.size(); ++i) {
    double measure = std::max(1.0, std::abs(system.initial_state[i]));
    for (const double bound : {system.state_lower[i], system.state_upper[i]}) {
      if (std::isfinite(bound)) measure = std::max(measure, std::abs(bound));
    }
    if (!(std::abs(x[i]) <= largest_growth * measure)) return false;
  }
  return true;
}

/// With the digits that are known of a number whose errors are those of a larger one.
double rounded(double value, double largest) {
  if (!(largest > 0.0)) return value;
  const double unit = std::ldexp(1.0, std::ilogb(largest) - known_bits);
  return unit * std::nearbyint(value / unit);
}

/// States with the digits that are known: errors of a simulation are those of its largest values.
class KnownDigits {
 public:
  KnownDigits(const model::System& system, const result::Trajectory& rows)
      : initial_(system.initial_state), largest_(initial_.size(), 0.0) {
    for (std::size_t row = 0; row < rows.t.size() && is_of_use(system, rows.x[row]); ++row) {
      for (std::size_t i = 0; i < rows.x[row].size(); ++i) {
        largest_[i] = std::max(largest_[i], std::abs(rows.x[row][i]));
      }
    }
  }

  /// A state that has not moved keeps its initial value.
  [[nodiscard]] std::vector<double> of(std::vector<double> x) const {
    for (std::size_t i = 0; i < x.size(); ++i) {
      const double known = rounded(x[i], largest_[i]);
      x[i] = known == rounded(initial_[i], largest_[i]) ? initial_[i] : known;
    }
    return x;
  }

 private:
  const std::vector<double>& initial_;
  std::vector<double> largest_;
};

/// What a row says of the selections; NaN where it says nothing.
std::vector<double> known_selections(const model::System& system, const result::Trajectory& rows, std::size_t row) {
  std::vector<double> known(system.switching.size(), not_known_yet);
  for (std::size_t c = 0; c < system.columns.size(); ++c) {
    const auto& column = system.columns[c];
    const double alpha = rows.alpha[row][c];
    known[at(column.function)] = rounded(column.orientation > 0 ? alpha : 1.0 - alpha, 1.0);
  }
  std::size_t next = 0;
  for (const auto& group : system.mode_groups) {
    for (int i = 0; group.first >= 0 && i < group.regions && !rows.theta.empty(); ++i) {
      known[at(group.first + i)] = rounded(rows.theta[row][next++], 1.0);
    }
  }
  return known;
}

}  // namespace

Expected<GuessedSimulation> simulate_guess(const model::System& system, PointValues& values,
                                           const std::vector<double>& starts,
                                           const std::vector<std::vector<double>>& controls, double until,
                                           const std::vector<double>& times, const model::System* frozen) {
  const auto restated = [&](const std::vector<double>& x, double t) {
    if (frozen == nullptr) return x;
    std::vector<double> all = x;
    all.resize(frozen->state_names.size(), 0.0);
    all[at(frozen->freezing->clock)] = t;
    return all;
  };
  model::System controlled = system;
  controlled.events.clear();  // they would stop it
  controlled = model::with_controls(std::move(controlled), starts, controls);
  auto kernel = evaluation::ModelKernel::compile(controlled);
  if (!kernel) return tl::unexpected(kernel.error());
  const Integration run = event_integrator::integrate(*kernel, guess_options(starts.front(), until, times));

  GuessedSimulation simulation;
  simulation.time_reached = starts.front();
  simulation.last = restated(system.initial_state, starts.front());
  const auto& rows = run.trajectory;
  const KnownDigits digits(system, rows);
  std::size_t next = 0;
  for (std::size_t row = 0; row < rows.t.size() && is_of_use(system, rows.x[row]); ++row) {
    simulation.time_reached = rows.t[row];
    simulation.last = restated(digits.of(rows.x[row]), rows.t[row]);
    // Of two rows at an event the second one, except at the end, where it is behind the horizon.
    const bool is_first = row + 1 < rows.t.size() && rows.t[row + 1] == rows.t[row] && rows.t[row] < until;
    if (is_first) continue;
    for (; next < times.size() && times[next] <= rows.t[row]; ++next) {
      const auto interval = std::upper_bound(starts.begin(), starts.end(), rows.t[row]) - starts.begin();
      const auto& u = controls[at(std::max<std::ptrdiff_t>(interval - 1, 0))];
      simulation.x.push_back(simulation.last);
      const auto known = frozen == nullptr ? known_selections(controlled, rows, row)
                                           : std::vector<double>(frozen->switching.size(), not_known_yet);
      simulation.alpha.push_back(values.selections({rows.t[row], simulation.last, u, system.parameter_values}, known));
    }
  }
  return simulation;
}

}  // namespace saltus::pipeline
