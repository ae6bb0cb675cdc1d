// An optimal control problem, transcribed, with the point where its solution begins.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "saltus/base/error.hpp"
#include "saltus/discretization/butcher_tableau.hpp"
#include "saltus/discretization/ocp/ocp_problem.hpp"
#include "saltus/pipeline/options/optimize_options.hpp"

namespace saltus::model {
struct Ocp;
}

namespace saltus::reformulation {
struct Dcs;
}

namespace saltus::pipeline {

struct StatedProblem {
  std::shared_ptr<const reformulation::Dcs> dcs;
  std::shared_ptr<discretization::OcpKernel> kernel;
  std::vector<int> elements;                            ///< per interval
  std::unique_ptr<discretization::OcpProblem> problem;  ///< with its start
  discretization::ButcherTableau tableau;
  std::vector<std::string> warnings;  ///< guesses that were moved onto their bounds
};

/// Reformulates the system, compiles its element, transcribes the problem and sets its start.
/// Fails for options that do not fit, models that the method does not cover, and costs or constraints that are not
/// finite at the start.
[[nodiscard]] Expected<StatedProblem> state_problem(const model::Ocp& ocp, const OptimizeOptions& options);

}  // namespace saltus::pipeline
