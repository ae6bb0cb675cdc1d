// What the guessed controls do, as far as it can be simulated.
#pragma once

#include <vector>

#include "saltus/base/error.hpp"
#include "saltus/pipeline/optimal_control/point_values_internal.hpp"

namespace saltus::model {
struct System;
}

namespace saltus::pipeline {

/// Holds the event-driven simulation of a guess at some times.
struct GuessedSimulation {
  std::vector<std::vector<double>> x;      ///< rows at the times that it reaches
  std::vector<std::vector<double>> alpha;  ///< as System::alpha
  double time_reached = 0.0;
  std::vector<double> last;  ///< state there
};

/// @param system  with its guessed parameters and initial state
/// @param starts  of the intervals, ascending
/// @param controls  row per interval
/// @param until  end of the last interval
/// @param times  ascending, within the intervals; equal ones are possible
/// @param frozen  the system of which the states and selections are wanted, where `system` is what it stands for; else
///                nullptr. Its hidden states are 0 but for the clock.
/// @return what was computed up to where the simulation ends, or states leave all measure.
[[nodiscard]] Expected<GuessedSimulation> simulate_guess(const model::System& system, PointValues& values,
                                                         const std::vector<double>& starts,
                                                         const std::vector<std::vector<double>>& controls, double until,
                                                         const std::vector<double>& times,
                                                         const model::System* frozen = nullptr);

}  // namespace saltus::pipeline
