// What a person may write under [optimize] beside the problem itself.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "saltus/pipeline/options/simulate_options.hpp"
#include "saltus/result/result.hpp"
#include "saltus/solver/solve.hpp"

namespace saltus::pipeline {

enum class StartValues { neutral, simulated };
enum class Feedback { optimal, tracking };

/// Holds the numerical keys of [optimize] and [optimize.mpcc]; defaults as in docs/options.md.
struct OptimizeOptions {
  long control_intervals = 0;     ///< >= 1; there is no default
  std::vector<long> elements{3};  ///< one number, or one per interval
  /// scheme, stages, representation, reformulation, lifting, cross_complementarity, step_equilibration, step_bounds,
  /// rho, equilibration_scale; its other members are not used.
  ElementOptions element{.error_limit = std::nullopt,
                         .cross_complementarity = CrossComplementarity::fe_fe,
                         .step_equilibration = StepEquilibration::heuristic_mean};
  bool switch_detection = true;
  Native native = Native::automatic;
  StartValues start = StartValues::neutral;
  double verification_tolerance = 1e-3;
  std::optional<bool> closed_loop;                     ///< simulate with feedback, too; nothing: with contacts
  Feedback feedback = Feedback::optimal;               ///< of the closed loop
  std::optional<std::string> start_result{};           ///< file: initial_guess = { result = FILE } or --start
  std::shared_ptr<const result::Result> start_from{};  ///< that file as read, by whoever calls pipeline::optimize
  solver::SolveOptions mpcc{};                         ///< its time limit is that of [optimize] time_limit
};

}  // namespace saltus::pipeline
