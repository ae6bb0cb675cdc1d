// What a run of the event engine is asked for.
#pragma once

#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "saltus/event_integrator/choices.hpp"
#include "saltus/ode/stepper.hpp"
#include "saltus/result/progress.hpp"
#include "saltus/switching/selection_policy.hpp"

namespace saltus::event_integrator {

/// So many rows show a trajectory on any screen, and in a part of a hundredth of it.
inline constexpr std::size_t many_rows = 250000;

/// Says which rows the trajectory has beside the two of every event and the last one.
struct OutputTimes {
  enum class Rows { at_times, at_steps };
  Rows rows = Rows::at_steps;
  std::vector<double> times;  ///< ascending, inside [from, until]; for at_times
  /// For at_steps: between the steps as many rows as keep straight lines within this part of the range of every state,
  /// input, output and selection, so far; behind many_rows rows none closer than the span / many_rows; 0: none.
  double straight = 0.0;
  std::size_t selections = 0;  ///< so many of the last outputs are selections, cut to [0, 1]
  bool pieces = false;         ///< asks for the polynomials of all steps, Integration::pieces
};

/// Holds the layers of a regularised system: inside one, psi + half_width > 0 > psi - half_width.
struct ThinLayers {
  struct Corners {
    int lower = 0, upper = 0;  ///< switching functions psi + half_width and psi - half_width
  };
  std::vector<Corners> corners;
  double half_width = 0.0;
  /// Of soft minima: switching functions half_width (log theta_i) + weight_range, positive where a weight matters.
  std::vector<int> weights;
  double weight_range = 0.0;
  [[nodiscard]] bool empty() const { return corners.empty() && weights.empty(); }
};

/// Holds options that the pipeline has checked: from < until, rtol > 0, atol >= 0, max_step > 0.
struct IntegrationOptions {
  ode::Method method = ode::Method::dopri5;
  bool chooses_method = false;  ///< `method` is what steps begin with; what they are taken by follows from them
  ode::Tolerances tolerances;
  double from = 0.0;
  double until = 1.0;
  /// Start of the first run where this one goes on at the end of another: periods of jumps count from there, and what
  /// was due by `from` has happened.
  std::optional<double> begun;
  std::optional<double> max_step;
  OutputTimes output;
  long max_steps = 1000000;
  long max_events = 100000;
  std::vector<std::pair<int, int>> initial_mode;  ///< switching function -> forced mode at the start
  /// Where the limit of regularised solutions depends on their scaling.
  switching::SelectionPolicy selection = switching::SelectionPolicy::active_dominant;
  std::vector<double> scaling;  ///< for SelectionPolicy::scaled: a factor per switching function; empty = ones
  /// Ascending: what to go on with instead of what is decided. The result begins at the last of these decisions.
  std::vector<Choice> choices;
  bool local_steps = true;  ///< where a switch moves few states of many, only these are integrated anew behind it
  ThinLayers layers;        ///< inside them tolerances are lowered to what they allow
};

using result::Continue;
using result::Progress;
using result::StepObserver;

}  // namespace saltus::event_integrator
