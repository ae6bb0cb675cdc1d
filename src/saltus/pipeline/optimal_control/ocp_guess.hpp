// Where an optimisation begins: a trajectory from expressions, a simulation of the guessed controls, or straight lines.
#pragma once

#include <string>
#include <vector>

#include "saltus/base/error.hpp"

namespace saltus::model {
struct Ocp;
}

namespace saltus::pipeline {

/// Holds other states for the same controls, rows as OcpStart::states.
struct OtherStates {
  std::string name;
  std::vector<std::vector<double>> states;
};

struct OcpStart {
  double horizon = 0.0;
  std::vector<double> parameters;             ///< all of System::p
  std::vector<std::vector<double>> controls;  ///< row per interval, all controls
  std::vector<double> initial_state;
  /// Rows at the asked fractions of the horizon.
  std::vector<std::vector<double>> states;
  /// Selections there as far as a simulation knows them, columns as System::alpha; empty rows where none does.
  std::vector<std::vector<double>> alpha;
  std::vector<OtherStates> others;    ///< guesses of the states that `initial_guess` does not state
  std::vector<std::string> warnings;  ///< values outside their bounds that were moved onto them
};

/// Guesses in this order (docs/optimal-control.md): `initial_guess`; else an event-driven simulation of the guessed
/// controls from the guessed initial state; from where that stops, or with a free horizon whose terminal constraint
/// names a state linearly, the straight line; else the initial values.
/// @param intervals  N >= 1
/// @param fractions  ascending, in [0, 1], of the horizon
[[nodiscard]] Expected<OcpStart> guess_start(const model::Ocp& ocp, int intervals,
                                             const std::vector<double>& fractions);

}  // namespace saltus::pipeline
