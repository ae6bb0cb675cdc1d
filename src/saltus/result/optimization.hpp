// What an optimisation leaves beside a trajectory: how the path went, what the point is, what the other engine says of
// it.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "saltus/result/status.hpp"

namespace saltus::result {

enum class HomotopyPhase {
  relaxed,  ///< complementarities relaxed by sigma
  branch,   ///< one side of every pair fixed
  lpcc,     ///< linear program over the biactive pairs
};
[[nodiscard]] std::string_view name(HomotopyPhase phase);
/// Returns the inverse of name; nullopt if there is none of that name.
[[nodiscard]] std::optional<HomotopyPhase> homotopy_phase_named(std::string_view name);

/// Holds one problem of a path, as it was left.
struct HomotopyStep {
  HomotopyPhase phase = HomotopyPhase::relaxed;
  std::string solver;  ///< "ipopt", "highs", "enumeration"
  double sigma = 0.0;  ///< of the relaxation; of other phases that of the last relaxed problem
  int iterations = 0;
  double objective = 0.0;  ///< the user's, without terms of the method
  double primal_infeasibility = 0.0;
  double complementarity_residual = 0.0;  ///< max_i min(|G_i|, |H_i|)
  Termination termination = Termination::completed;
  double seconds = 0.0;
  std::string message;  ///< why it was not taken, or what the solver said; empty if all is well
};

/// Holds what came of one start of several.
struct StartOutcome {
  int seed = 0;  ///< 0: the start itself
  Termination termination = Termination::not_converged;
  double objective = 0.0;
  double infeasibility = 0.0;  ///< of rows, bounds and pairs
  int iterations = 0;
  double seconds = 0.0;
  bool is_taken = false;
};

enum class StationarityType { S, M, C, A, W };
[[nodiscard]] std::string_view name(StationarityType type);
/// Returns the inverse of name; nullopt if there is none of that name.
[[nodiscard]] std::optional<StationarityType> stationarity_type_named(std::string_view name);

/// Says what holds at a point; definitions: docs/result-file.md. Residuals that could not be found are NaN.
struct Certificate {
  double primal_infeasibility = 0.0;
  double complementarity_residual = 0.0;
  double stationarity = 0.0;
  int biactive = 0;
  std::optional<StationarityType> stationarity_type;
  std::optional<bool> b_stationary;  ///< nullopt: not decided
  std::optional<double> lpcc_decrease;
  /// Other sides with which the same point can be written were tried to the end, and none is better; nullopt: not
  /// known.
  std::optional<bool> other_sides_tried;
  // Of the branch problem, if it is solved; nullopt: not known.
  std::optional<bool> licq;            ///< gradients of active constraints are linearly independent
  int dependent_rows = 0;              ///< as many are combinations of others
  std::vector<std::string> dependent;  ///< the first rows that take part
  std::optional<bool> unique_multipliers;
  std::optional<bool> strict_complementarity;  ///< no active inequality has a zero multiplier
  std::optional<bool> ulsc;                    ///< no side of a biactive pair has one
  std::optional<bool> sosc;                    ///< second-order sufficient
};

/// Holds the multiplier of a terminal, path or boundary constraint; positive where an upper bound or `<=` presses.
struct ConstraintMultiplier {
  std::string name;
  double time = 0.0;
  double value = 0.0;           ///< NaN where it is not unique
  std::vector<double> range{};  ///< the least and the greatest, where it is not unique; not finite: without a limit
};

/// Holds how controls are corrected from a time on, until the next one or the end of the interval.
struct FeedbackGain {
  double t = 0.0;
  int interval = 0;
  std::vector<std::vector<double>> K;  ///< a row per control, a column per state of the result
};

/// Holds the controls over the whole horizon, from the start on.
struct OpenLoop {
  double end_state_error = 0.0;  ///< max over states, scaled like interval defects
  double terminal_violation = 0.0;
  Termination termination = Termination::completed;
  std::string message;
  double amplification = 0.0;  ///< 2-norm of d x(T) / d x(from) of the discretisation; NaN if it is not known
  std::vector<double> t;       ///< rows of the simulation, for the picture
  std::vector<std::vector<double>> x;
  std::vector<FeedbackGain> gains;  ///< of a simulation with feedback
};

/// Says how deep bodies are in each other: the largest -gap of all contacts, 0 without any.
struct Penetration {
  double solution = 0.0;    ///< at the nodes and stages that the optimisation has
  double simulation = 0.0;  ///< of the event engine, interval by interval
};

/// Says where a simulation leaves a path constraint, or the bounds of a state, furthest.
struct PathViolation {
  std::string name;  ///< as written; of bounds the state
  double time = 0.0;
  double value = 0.0;
  double share = 0.0;  ///< of the range that the constrained expression has in the simulation
};

/// Holds what the event engine says of an optimised trajectory.
struct Verification {
  double tolerance = 0.0;
  double interval_defect = 0.0;  ///< relative to the range of the state
  int interval = -1;             ///< where it is largest
  std::string state;
  double switch_time_error = 0.0;
  int switches_missed = 0;                     ///< of the simulation, not found in the solution
  int switches_extra = 0;                      ///< of the solution, not found in the simulation
  double path_violation = 0.0;                 ///< the largest one
  std::vector<PathViolation> path_violations;  ///< with the largest share first
  OpenLoop open_loop;
  std::optional<OpenLoop> closed_loop;  ///< with u_k + K_k (x(t_k) - x_k), if asked for
  /// Parameters and initial values of the closed loop's system that are not those of the model.
  std::vector<std::pair<std::string, double>> plant;
  std::optional<Penetration> penetration;  ///< of a system with contacts
  std::string message;                     ///< why an interval could not be simulated; empty otherwise
};

struct ObjectiveTerms {
  double running = 0.0, terminal = 0.0, least_squares = 0.0, time = 0.0, penalties = 0.0;
};

struct OptimizationStatistics {
  int iterations = 0;
  int variables = 0, equations = 0, pairs = 0;
  double build_seconds = 0.0, evaluation_seconds = 0.0, linear_algebra_seconds = 0.0;
  double wall_seconds = 0.0;
};

/// Holds what `saltus optimize` finds beside the trajectory of a Result.
struct Optimization {
  double objective = 0.0;
  ObjectiveTerms terms;
  double horizon = 0.0;
  std::vector<std::pair<std::string, double>> parameters;  ///< free ones
  std::vector<double> grid;                                ///< N + 1 times of the intervals
  std::vector<std::vector<double>> u;                      ///< row per interval
  std::vector<std::vector<double>> h;                      ///< lengths of the elements of each interval, in its time
  std::vector<double> speed_of_time;                       ///< per interval; empty without time-freezing
  std::vector<std::vector<double>> nodes;                  ///< N + 1 states, for a warm start
  std::vector<double> state_lower, state_upper, control_lower, control_upper;  ///< bounds, for the picture
  std::vector<ConstraintMultiplier> multipliers;
  std::vector<HomotopyStep> homotopy;
  std::vector<StartOutcome> starts;  ///< where there were several
  Certificate certificate;
  std::optional<Verification> verification;
  OptimizationStatistics statistics;
  /// All unknowns and multipliers in the order of the transcription, for a start of the same structure.
  std::vector<double> primal, dual_rows, dual_lower, dual_upper;
};

}  // namespace saltus::result
