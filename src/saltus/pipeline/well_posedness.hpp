// The ranks of a model's complementarity systems along its solution.
#pragma once

#include <string>
#include <vector>

#include "saltus/pipeline/simulate.hpp"
#include "saltus/reformulation/reformulation_options.hpp"
#include "saltus/result/status.hpp"

namespace saltus::pipeline {

/// Holds the worst of one form on one active set.
struct FormRank {
  reformulation::Form form = reformulation::Form::step;
  int unknowns = 0;
  int rank = 0;                          ///< the smallest one met
  double smallest_singular_value = 0.0;  ///< the smallest one met
};

/// Holds a set of surfaces, or regions of groups by `indicator`, on which the solution slides.
struct MetActiveSet {
  std::vector<std::string> names;
  double first = 0.0;  ///< time
  long rows = 0;       ///< of the trajectory
  std::vector<FormRank> forms;
};

struct RanksAlongSolution {
  std::vector<MetActiveSet> active_sets;  ///< in the order they were met
  result::Status status;                  ///< of the simulation
};

/// Simulates with the event engine and the options of the model, and looks at every row (Assumption 7 of
/// [nurkanovic2024]; reformulation::WellPosedness). Forms that do not cover the model are left out.
/// @return as simulate
[[nodiscard]] Expected<RanksAlongSolution> ranks_along_solution(const model::System& system, SimulateOptions options,
                                                                const Observers& observers = {});

}  // namespace saltus::pipeline
