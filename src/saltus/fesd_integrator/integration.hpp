// What a run of FESD is asked for, and what it gives.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "saltus/discretization/butcher_tableau.hpp"
#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/result/elements.hpp"
#include "saltus/result/progress.hpp"
#include "saltus/result/result.hpp"
#include "saltus/result/sensitivities.hpp"

namespace saltus::fesd_integrator {

class Solution;
class StepProblem;

/// Holds options that the pipeline has checked: from < until, steps >= 1, elements >= 1 (2 with switch detection), 0 <
/// step_bounds <= 1.
struct IntegrationOptions {
  enum class Switches {
    detected,  ///< lengths of elements follow the switches
    fixed,     ///< equal lengths, every stage with its own active set: the Runge-Kutta method of the inclusion
  };
  Switches switches = Switches::detected;
  discretization::ButcherTableau tableau;
  double from = 0.0;
  double until = 1.0;
  long steps = 100;
  int elements = 2;
  /// Simulation steps are divided where their elements' estimated errors (statistics.error_estimate) would add up to
  /// more than this over the run; nullopt: they are not.
  std::optional<double> error_limit;
  double step_bounds = 1.0;  ///< gamma: lengths within (1 - gamma, 1 + gamma) times their mean
  long max_steps = 1000000;  ///< elements, and simulation steps that were divided
  long max_events = 100000;
  /// Asks for rows at these times instead of at the ends of all elements; ascending, inside [from, until].
  enum class Rows { at_elements, at_times };
  Rows rows = Rows::at_elements;
  std::vector<double> times;
  /// The state that is physical time: `times` are values of it.
  std::optional<std::size_t> clock;
  /// For at_elements: inside elements as many rows as keep straight lines within this part of the range of every state,
  /// input, output and selection, so far; 0: none.
  double straight = 0.0;
  /// With switch detection: simulation steps solved by this, and not by predicting active sets; it must outlive the
  /// run.
  StepProblem* step_problem = nullptr;
  /// Else: makes what solves a simulation step for which no active sets are found (nullptr: cannot be made); called
  /// when that happens first, the problem must outlive the run. Not used with sensitivities: its points have none.
  std::function<StepProblem*()> fallback;
  std::vector<std::pair<int, int>> initial_mode;  ///< index into System::switching -> forced mode at the start
  evaluation::NativeCode native = evaluation::NativeCode::off;  ///< of everything that is evaluated
  bool sensitivities = false;                                   ///< asks for Integration::sensitivities
  bool record_elements = false;                                 ///< asks for Integration::elements
  bool pieces = false;                                          ///< asks for Integration::solution
};

using result::Continue;
using result::Progress;
using result::StepObserver;

/// Holds the parts of a result that an engine computes; `final` is the last row.
struct Integration {
  result::Status status;
  result::Final final;
  std::vector<result::Event> events;
  result::Trajectory trajectory;
  result::Statistics statistics;  ///< steps: elements; rejected: simulation steps that were divided
  std::optional<result::Sensitivities> sensitivities;  ///< of a completed run, if asked for
  std::optional<result::Elements> elements;            ///< if asked for; an element that an event stops is not in it
  std::shared_ptr<Solution> solution{};                ///< if asked for
};

}  // namespace saltus::fesd_integrator
