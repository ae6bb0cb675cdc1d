// What a person may write under [simulate].
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "saltus/discretization/fesd_options.hpp"
#include "saltus/ode/stepper.hpp"

namespace saltus::pipeline {

enum class Method { event, fesd, timestepping, smoothed };
enum class Integrator {
  automatic = -1,
  dopri5 = static_cast<int>(ode::Method::dopri5),
  dop853 = static_cast<int>(ode::Method::dop853),
  radau5 = static_cast<int>(ode::Method::radau5),
  radau9 = static_cast<int>(ode::Method::radau9),
  radau13 = static_cast<int>(ode::Method::radau13),
  taylor = static_cast<int>(ode::Method::taylor),
};
/// Returns the method that has this name; of `automatic` an explicit one.
[[nodiscard]] constexpr ode::Method named_method(Integrator integrator) {
  return integrator == Integrator::automatic ? ode::Method::dopri5 : static_cast<ode::Method>(integrator);
}
enum class Native { automatic, on, off };
enum class Selection { active_dominant, passive_dominant, scaled, report };

/// Asks for rows of the trajectory beside the two of every event.
struct Automatic {};  ///< at steps and, between them, as many as keep straight lines close to the solution
struct EveryStep {};
struct EveryInterval {
  double interval = 0.0;
};
struct NumberOfPoints {
  int points = 0;
};  ///< both ends among them, >= 2
struct AtTimes {
  std::vector<double> times;
};
using OutputGrid = std::variant<Automatic, EveryStep, EveryInterval, NumberOfPoints, AtTimes>;

/// Holds columns of the rows: names, or patterns in which * stands for any letters; nullopt: all.
struct KeptNames {
  std::optional<std::vector<std::string>> states{};    ///< of x
  std::optional<std::vector<std::string>> surfaces{};  ///< switching functions, of alpha and mode
};

/// Holds [simulate.event].
struct EventOptions {
  Integrator integrator = Integrator::automatic;
  std::optional<double> max_step{};  ///< none by default
  Selection selection = Selection::active_dominant;
  std::vector<std::pair<std::string, double>> scaling{};
  bool local_steps = true;  ///< of many states only those that a switch moves are integrated anew behind it
  long trajectories = 1;    ///< at most so many along other admissible modes; 1: those are only listed in the events
  long members = 0;         ///< followed of every family of solutions (later departures, spirals), if others are
};

/// Holds [simulate.smoothed].
struct SmoothedOptions {
  double epsilon = 1e-6;  ///< half width of the layer around every surface, in the units of its switching function
};

using Scheme = discretization::TableauFamily;
enum class Reformulation { step, stewart };
using discretization::CrossComplementarity;
using discretization::Representation;
using discretization::StepEquilibration;

/// Holds [simulate.fesd], [simulate.timestepping].
struct ElementOptions {
  Scheme scheme = Scheme::radau_iia;
  long stages = 2;
  long steps = 100;   ///< simulation steps of equal length
  long elements = 2;  ///< per simulation step
  Representation representation = Representation::integral;
  std::optional<double> error_limit{};  ///< of the sum of elements' estimated errors; beyond it steps are divided
  double step_bounds = 1.0;             ///< lengths of elements are within (1 - this, 1 + this) times their mean
  double rho = 1.0;
  double equilibration_scale = 1.0;
  Reformulation reformulation = Reformulation::step;
  CrossComplementarity cross_complementarity = CrossComplementarity::fe_stage;
  StepEquilibration step_equilibration = StepEquilibration::direct;
  std::optional<long> lifting = 2;  ///< most factors per product; nullopt: off
  bool sensitivities = false;       ///< derivatives of the end state
};

/// Holds [simulate]; defaults as in docs/options.md. `until` has none: it, or times of rows, must be given in the file
/// or on the command line. See end_time.
struct SimulateOptions {
  std::optional<double> until{};
  double from = 0.0;
  std::optional<double> begun{};  ///< start of the first run, where this one goes on at the end of another
  Method method = Method::event;
  double rtol = 1e-8;
  double atol = 1e-10;
  OutputGrid output = Automatic{};
  KeptNames kept{};
  /// Rows before and after every event; without them no two rows have the same time. Not stated: see has_event_rows.
  std::optional<bool> event_rows{};
  bool error_estimate = false;  ///< asks for Result::error_estimate
  bool continuous = false;      ///< asks for Result::continuous
  Native native = Native::automatic;
  long max_steps = 1000000;
  long max_events = 100000;
  std::vector<std::pair<std::string, int>> initial_mode{};  ///< switching function -> -1, 0, 1
  EventOptions event{};
  SmoothedOptions smoothed{};
  ElementOptions fesd{.error_limit = 0.03}, timestepping{};
};

/// Returns the end of a run: what is stated, else the last of given times of rows; nothing without either.
[[nodiscard]] inline std::optional<double> end_time(const SimulateOptions& options) {
  const auto* rows = std::get_if<AtTimes>(&options.output);
  return options.until || rows == nullptr || rows->times.empty() ? options.until : rows->times.back();
}

/// Returns whether there are rows at events: what is stated, else everywhere but at given times, which are all rows.
[[nodiscard]] inline bool has_event_rows(const SimulateOptions& options) {
  return options.event_rows.value_or(!std::holds_alternative<AtTimes>(options.output));
}

}  // namespace saltus::pipeline
