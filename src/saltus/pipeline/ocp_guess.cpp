#include "saltus/pipeline/ocp_guess.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "saltus/base/at.hpp"
#include "saltus/pipeline/guessed_simulation_internal.hpp"
#include "saltus/pipeline/linear_targets_internal.hpp"
#include "saltus/pipeline/point_values_internal.hpp"

namespace saltus::pipeline {
namespace {

using model::Ocp;
using model::OcpGuess;

struct Bounds {
  double lower = 0.0, upper = 0.0;
};

class Guess {
 public:
  Guess(const Ocp& ocp, PointValues& values, int intervals, const std::vector<double>& fractions)
      : ocp_(ocp), values_(values), intervals_(intervals) {
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
    if (error_) return tl::unexpected(*error_);
    if (auto done = take_states(); !done) return tl::unexpected(done.error());
    if (error_) return tl::unexpected(*error_);
    return std::move(start_);
  }

 private:
  [[nodiscard]] double time(double fraction) const { return ocp_.from + fraction * ocp_.horizon.value; }
  [[nodiscard]] double until() const { return time(1.0); }

  [[nodiscard]] const OcpGuess* stated(OcpGuess::Kind kind, std::size_t index) const {
    for (const auto& guess : ocp_.guess) {
      if (guess.kind == kind && at(guess.index) == index) return &guess;
    }
    return nullptr;
  }

  /// The expression of a guess. It says nothing of states and controls, which have their initial values here.
  [[nodiscard]] double value_of(const OcpGuess& guess, double t) {
    const double value = output_at(guess, t);
    if (!std::isfinite(value) && !error_) {
      error_ = Error{ErrorCode::invalid_model,
                     fmt::format("the initial guess of '{}' is {} at t = {:.6g}", name_of(guess), value, t),
                     "give an expression that is finite over the whole horizon",
                     {},
                     {"in optimize.initial_guess"}};
    }
    return value;
  }
  [[nodiscard]] double output_at(const OcpGuess& guess, double t) {
    return values_.outputs(
        {t, ocp_.system.initial_state, ocp_.system.control_initial, start_.parameters})[at(guess.output)];
  }

  [[nodiscard]] const std::string& name_of(const OcpGuess& guess) const {
    const auto& system = ocp_.system;
    if (guess.kind == OcpGuess::Kind::parameter) return system.parameter_names[at(guess.index)];
    return (guess.kind == OcpGuess::Kind::state ? system.state_names : system.control_names)[at(guess.index)];
  }

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
      const auto* guess = stated(OcpGuess::Kind::parameter, i);
      parameters[i] = guess != nullptr ? value_of(*guess, ocp_.from) : parameters[i];
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
      if (const auto* guess = stated(OcpGuess::Kind::state, i)) value = value_of(*guess, ocp_.from);
      value = moved(value, state_bounds(i),
                    fmt::format("the initial guess of '{}' at the start", ocp_.system.state_names[i]));
    }
  }

  void take_controls() {
    const auto& system = ocp_.system;
    for (int k = 0; k < intervals_; ++k) {
      auto u = system.control_initial;
      for (std::size_t i = 0; i < u.size(); ++i) {
        const auto* guess = stated(OcpGuess::Kind::control, i);
        if (guess != nullptr) u[i] = value_of(*guess, time((k + 0.5) / intervals_));
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
          if (row.is_slack) raise_slack(row, point);
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
      guesses[i] = stated(OcpGuess::Kind::state, i);
      needs_simulation = needs_simulation || (guesses[i] == nullptr && !is_line(targets[i]));
    }
    GuessedSimulation simulation;
    if (needs_simulation) {
      auto system = ocp_.system;
      system.parameter_values = start_.parameters;
      system.initial_state = start_.initial_state;
      auto run = simulate_guess(system, values_, starts_, start_.controls, until(), times_);
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
    return {};
  }

  [[nodiscard]] bool is_line(const std::optional<double>& target) const { return ocp_.horizon.free && target; }

  double stated_value(const OcpGuess& guess, std::size_t row) {
    const auto& name = ocp_.system.state_names[at(guess.index)];
    return moved(value_of(guess, times_[row]), state_bounds(at(guess.index)),
                 fmt::format("the initial guess of '{}'", name));
  }

  /// Of a line, or of a simulation and what follows where it stops; quietly onto the bounds.
  [[nodiscard]] double unstated_value(std::size_t i, std::size_t row, const std::optional<double>& target,
                                      const GuessedSimulation& simulation) const {
    double value = 0.0;
    if (is_line(target)) {
      value = on_line({ocp_.from, start_.initial_state[i]}, *target, times_[row]);
    } else if (row < simulation.x.size()) {
      value = simulation.x[row][i];
    } else {
      const LineStart from{simulation.time_reached, simulation.last[i]};
      value = target ? on_line(from, *target, times_[row]) : from.value;
    }
    const auto bounds = state_bounds(i);
    return std::max(bounds.lower, std::min(value, bounds.upper));
  }

  struct LineStart {
    double t = 0.0;
    double value = 0.0;
  };
  [[nodiscard]] double on_line(const LineStart& from, double target, double t) const {
    if (!(until() > from.t)) return target;
    return from.value + (target - from.value) * ((t - from.t) / (until() - from.t));
  }

  const Ocp& ocp_;
  PointValues& values_;
  int intervals_;
  OcpStart start_;
  std::vector<double> starts_, times_;
  std::set<std::string> warned_;
  std::optional<Error> error_;
};

}  // namespace

Expected<OcpStart> guess_start(const Ocp& ocp, int intervals, const std::vector<double>& fractions) {
  auto values = PointValues::make(ocp.system);
  if (!values) return tl::unexpected(values.error());
  return Guess(ocp, *values, intervals, fractions).run();
}

}  // namespace saltus::pipeline
