#include "saltus/pipeline/optimal_control/ocp_guess.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "saltus/base/at.hpp"
#include "saltus/model/ocp.hpp"
#include "saltus/model/time_freezing/time_freezing.hpp"
#include "saltus/pipeline/optimal_control/guessed_simulation_internal.hpp"
#include "saltus/pipeline/optimal_control/linear_targets_internal.hpp"
#include "saltus/pipeline/optimal_control/named_states_internal.hpp"
#include "saltus/pipeline/optimal_control/point_values_internal.hpp"

namespace saltus::pipeline {
namespace {

using model::Ocp;
using model::OcpGuess;

struct Bounds {
  double lower = 0.0, upper = 0.0;
};

/// The expressions of initial_guess, which say nothing of states and controls: these have their initial values here.
class StatedGuesses {
 public:
  StatedGuesses(const Ocp& ocp, PointValues& values) : ocp_(ocp), values_(values) {}

  /// Null if nothing is said of this quantity.
  [[nodiscard]] const OcpGuess* find(OcpGuess::Kind kind, std::size_t index) const {
    for (const auto& guess : ocp_.guess.list) {
      if (guess.kind == kind && at(guess.index) == index) return &guess;
    }
    return nullptr;
  }

  [[nodiscard]] double value(const OcpGuess& guess, double t, const std::vector<double>& parameters) {
    ModelPoint point{t, ocp_.system.initial_state, ocp_.system.control_initial, parameters};
    if (ocp_.clock) point.x[at(ocp_.clock->state)] = t;
    const double value = values_.outputs(point)[at(guess.output)];
    if (!std::isfinite(value) && !error_) {
      // Member by member: g++ 12 takes the aggregate for uninitialised.
      Error& error = error_.emplace();
      error.code = ErrorCode::invalid_model;
      error.message = fmt::format("the initial guess of '{}' is {} at t = {:.6g}", name(guess), value, t);
      error.remedy = "give an expression that is finite over the whole horizon";
      error.context.emplace_back("in optimize.initial_guess");
    }
    return value;
  }

  /// The first value that was not finite.
  [[nodiscard]] const std::optional<Error>& error() const { return error_; }

 private:
  [[nodiscard]] const std::string& name(const OcpGuess& guess) const {
    const auto& system = ocp_.system;
    if (guess.kind == OcpGuess::Kind::parameter) return system.parameter_names[at(guess.index)];
    return (guess.kind == OcpGuess::Kind::state ? system.state_names : system.control_names)[at(guess.index)];
  }

  const Ocp& ocp_;
  PointValues& values_;
  std::optional<Error> error_;
};

struct Place {
  double t = 0.0;
  double value = 0.0;
};

double on_line(const Place& from, const Place& to, double t) {
  if (!(to.t > from.t)) return to.value;
  return from.value + (to.value - from.value) * ((t - from.t) / (to.t - from.t));
}

class Guess {
 public:
  Guess(const Ocp& ocp, PointValues& values, PointValues& guessed, int intervals, const std::vector<double>& fractions)
      : ocp_(ocp), values_(values), stated_(ocp, guessed), intervals_(intervals) {
    start_.horizon = ocp.horizon.value;
    start_.parameters = ocp.system.parameter_values;
    for (int k = 0; k < intervals; ++k) starts_.push_back(time(static_cast<double>(k) / intervals));
    for (const double fraction : fractions) times_.push_back(time(fraction));
  }

  [[nodiscard]] Expected<OcpStart> run() {
    take_parameters();
    take_initial_state();
    take_controls();
    raise_slacks();
    if (stated_.error()) return tl::unexpected(*stated_.error());
    if (auto done = take_states(); !done) return tl::unexpected(done.error());
    if (stated_.error()) return tl::unexpected(*stated_.error());
    return std::move(start_);
  }

 private:
  [[nodiscard]] double time(double fraction) const { return ocp_.from + fraction * ocp_.horizon.value; }
  [[nodiscard]] double until() const { return time(1.0); }

  /// Onto the bounds, with one warning for every quantity.
  double moved(double value, const Bounds& bounds, const std::string& what) {
    const double inside = std::max(bounds.lower, std::min(value, bounds.upper));
    if (inside != value && warned_.insert(what).second) {
      start_.warnings.push_back(fmt::format("{} is {:.6g} and was moved onto the bounds [{:.6g}, {:.6g}]", what, value,
                                            bounds.lower, bounds.upper));
    }
    return inside;
  }

  [[nodiscard]] Bounds state_bounds(std::size_t i) const {
    return {ocp_.system.state_lower[i], ocp_.system.state_upper[i]};
  }

  void take_parameters() {
    auto parameters = start_.parameters;
    for (std::size_t i = 0; i < parameters.size(); ++i) {
      const auto& name = ocp_.system.parameter_names[i];
      if (!ocp_.free_parameters[i]) continue;
      const Bounds bounds{ocp_.parameter_lower[i], ocp_.parameter_upper[i]};
      const auto* guess = stated_.find(OcpGuess::Kind::parameter, i);
      parameters[i] = guess != nullptr ? stated_.value(*guess, ocp_.from, start_.parameters) : parameters[i];
      parameters[i] = moved(parameters[i], bounds, fmt::format("the initial guess of parameter '{}'", name));
    }
    start_.parameters = std::move(parameters);
  }

  /// A value that is not free stays as it is.
  void take_initial_state() {
    start_.initial_state = ocp_.system.initial_state;
    for (std::size_t i = 0; i < start_.initial_state.size(); ++i) {
      if (!ocp_.free_states[i]) continue;
      double& value = start_.initial_state[i];
      if (const auto* guess = stated_.find(OcpGuess::Kind::state, i))
        value = stated_.value(*guess, ocp_.from, start_.parameters);
      value = moved(value, state_bounds(i),
                    fmt::format("the initial guess of '{}' at the start", ocp_.system.state_names[i]));
    }
  }

  void take_controls() {
    const auto& system = ocp_.system;
    for (int k = 0; k < intervals_; ++k) {
      auto u = system.control_initial;
      for (std::size_t i = 0; i < u.size(); ++i) {
        const auto* guess = stated_.find(OcpGuess::Kind::control, i);
        if (guess != nullptr) u[i] = stated_.value(*guess, time((k + 0.5) / intervals_), start_.parameters);
        if (i < at(ocp_.user_controls)) {
          const auto what = fmt::format("the initial guess of control '{}'", system.control_names[i]);
          u[i] = moved(u[i], {system.control_lower[i], system.control_upper[i]}, what);
        }
      }
      start_.controls.push_back(std::move(u));
    }
  }

  /// Slacks are as large, or small, as their inequalities ask for; these are over controls and parameters.
  void raise_slacks() {
    const std::size_t n = ocp_.system.control_names.size(), first = at(ocp_.user_controls);
    for (int k = 0; k < intervals_ && first < n; ++k) {
      ModelPoint point{time((k + 0.5) / intervals_), start_.initial_state, start_.controls[at(k)], start_.parameters};
      for (std::size_t pass = first; pass < n; ++pass) {  // slacks may hold others
        for (const auto& row : ocp_.path) {
          if (row.is_slack && !row.at_stages) raise_slack(row, point);
        }
      }
      start_.controls[at(k)] = std::move(point.u);
    }
  }

  /// The first slack of a row is its own: those behind it are of inner kinks.
  void raise_slack(const model::OcpConstraint& row, ModelPoint& point) {
    const double value = values_.outputs(point)[at(row.output)];
    const double missing = value < row.lower ? row.lower - value : value > row.upper ? row.upper - value : 0.0;
    if (missing == 0.0) return;
    for (std::size_t i = at(ocp_.user_controls); i < point.u.size(); ++i) {
      ModelPoint other = point;
      other.u[i] += 1.0;
      const double slope = values_.outputs(other)[at(row.output)] - value;
      if (!(std::abs(slope) > 0.0)) continue;
      point.u[i] += missing / slope;
      return;
    }
  }

  [[nodiscard]] Expected<void> take_states() {
    const std::size_t n = start_.initial_state.size();
    std::vector<std::optional<double>> targets(n);
    if (auto found = linear_targets(ocp_, start_.parameters, values_)) {
      targets = std::move(*found);
    } else {
      return tl::unexpected(found.error());
    }
    std::vector<const OcpGuess*> guesses(n);
    bool needs_simulation = false;
    for (std::size_t i = 0; i < n; ++i) {
      guesses[i] = stated_.find(OcpGuess::Kind::state, i);
      needs_simulation = needs_simulation || (guesses[i] == nullptr && !is_line(targets[i]) && !is_hidden(i));
    }
    GuessedSimulation simulation;
    if (needs_simulation) {
      auto system = ocp_.physical ? *ocp_.physical : ocp_.system;
      const std::size_t own = system.parameter_values.size();  // the method's parameters come behind them
      system.parameter_values.assign(start_.parameters.begin(),
                                     start_.parameters.begin() + static_cast<std::ptrdiff_t>(own));
      auto& initial = system.initial_state;
      initial = start_.initial_state;
      if (ocp_.physical) initial.resize(at(ocp_.system.freezing->first_hidden));
      auto run = simulate_guess(system, values_, starts_, start_.controls, until(), times_,
                                ocp_.physical ? &ocp_.system : nullptr);
      if (!run) return tl::unexpected(run.error());
      simulation = std::move(*run);
    }
    for (std::size_t row = 0; row < times_.size(); ++row) {
      std::vector<double> x(n);
      for (std::size_t i = 0; i < n; ++i) {
        x[i] = guesses[i] != nullptr ? stated_value(*guesses[i], row) : unstated_value(i, row, targets[i], simulation);
      }
      start_.states.push_back(std::move(x));
      start_.alpha.push_back(row < simulation.alpha.size() ? simulation.alpha[row] : std::vector<double>{});
    }
    if (needs_simulation) add_others(guesses, targets, simulation);
    return {};
  }

  void add_others(const std::vector<const OcpGuess*>& guesses, const std::vector<std::optional<double>>& targets,
                  const GuessedSimulation& simulation) {
    const std::vector<std::vector<double>> constant(times_.size(), start_.initial_state);
    const auto add = [&](std::string name, std::vector<std::vector<double>> states) {
      for (std::size_t row = 0; row < times_.size(); ++row) {
        for (std::size_t i = 0; i < states[row].size(); ++i) {
          if (is_hidden(i) || (ocp_.clock && at(ocp_.clock->state) == i) || guesses[i] != nullptr) {
            states[row][i] = start_.states[row][i];
          }
          const auto bounds = state_bounds(i);
          states[row][i] = std::max(bounds.lower, std::min(states[row][i], bounds.upper));
        }
      }
      const auto is_same = [&](const OtherStates& other) { return other.states == states; };
      const bool is_known = states == start_.states || std::any_of(start_.others.begin(), start_.others.end(), is_same);
      if (!is_known) start_.others.push_back({std::move(name), std::move(states)});
    };
    add("constant states", constant);
    // A free horizon has lines to its targets instead, which may cross no surface in the way that a motion does.
    std::vector<std::vector<double>> moving = simulation.x;
    moving.resize(times_.size(), simulation.last);
    add("the motion of the guessed controls", std::move(moving));
    add("states that costs and terminal constraints name", named_states(ocp_, values_, start_, targets, times_));
  }

  /// The clock and depths of contacts: nobody guesses them.
  [[nodiscard]] bool is_hidden(std::size_t i) const {
    return ocp_.physical && i >= at(ocp_.system.freezing->first_hidden);
  }
  [[nodiscard]] bool is_line(const std::optional<double>& target) const { return ocp_.horizon.free && target; }

  double stated_value(const OcpGuess& guess, std::size_t row) {
    const auto& name = ocp_.system.state_names[at(guess.index)];
    return moved(stated_.value(guess, times_[row], start_.parameters), state_bounds(at(guess.index)),
                 fmt::format("the initial guess of '{}'", name));
  }

  /// Of a line, or of a simulation and what follows where it stops; quietly onto the bounds.
  [[nodiscard]] double unstated_value(std::size_t i, std::size_t row, const std::optional<double>& target,
                                      const GuessedSimulation& simulation) const {
    double value = 0.0;
    if (is_hidden(i)) {
      return at(ocp_.clock->state) == i ? times_[row] : 0.0;
    } else if (is_line(target)) {
      value = on_line({ocp_.from, start_.initial_state[i]}, {until(), *target}, times_[row]);
    } else if (row < simulation.x.size()) {
      value = simulation.x[row][i];
    } else {
      const Place from{simulation.time_reached, simulation.last[i]};
      value = target ? on_line(from, {until(), *target}, times_[row]) : from.value;
    }
    const auto bounds = state_bounds(i);
    return std::max(bounds.lower, std::min(value, bounds.upper));
  }

  const Ocp& ocp_;
  PointValues& values_;
  StatedGuesses stated_;
  int intervals_;
  OcpStart start_;
  std::vector<double> starts_, times_;
  std::set<std::string> warned_;
};

}  // namespace

Expected<OcpStart> guess_start(const Ocp& ocp, int intervals, const std::vector<double>& fractions) {
  auto values = PointValues::make(ocp.system);
  if (!values) return tl::unexpected(values.error());
  if (!ocp.guess.system) return Guess(ocp, *values, *values, intervals, fractions).run();
  auto guessed = PointValues::make(*ocp.guess.system);
  if (!guessed) return tl::unexpected(guessed.error());
  return Guess(ocp, *values, *guessed, intervals, fractions).run();
}

}  // namespace saltus::pipeline
