// The functions that an optimal control problem is made of, compiled once, whatever the number of intervals.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "saltus/discretization/element_expressions_internal.hpp"
#include "saltus/discretization/ocp/ocp_problem.hpp"
#include "saltus/model/ocp.hpp"

namespace saltus::discretization {

/// Holds a row of a path or terminal constraint: of constraint number `constraint`, with its slack if it is soft.
struct ConstraintRow {
  int constraint = 0;
  double lower = 0.0, upper = 0.0;
  int soft = -1;  ///< number of the slack among those of the point
};

/// Holds sizes of the shared inputs of an interval, in their order: controls, free parameters, held values, T, s,
/// samples.
struct SharedSizes {
  int controls = 0, parameters = 0, held = 0, samples = 0;
  [[nodiscard]] int speed() const { return controls + parameters + held + 1; }  ///< where s stands
  [[nodiscard]] int size() const { return speed() + 1 + samples; }
};

/// Holds pairs that say of an element whether a contact without restitution is open or closed, and that it closes.
/// While it closes it is one of both throughout: closed if its gap stays 0.
///
/// Nothing else says so. At the end of a collision the rate of the gap is 0, so that the gap stands whatever its
/// selection is; a collision could begin an element, and time move at its last stages.
struct ClosingGap {
  int open = 0;     ///< of a selection that is 0 where the gap is closed
  int closed = 0;   ///< of one that is 0 where it is open
  int closing = 0;  ///< of one that is 0 where the gap closes
  /// First pair of a second selection of its rate (decision 26), in the step form; -1: there is none.
  int held = -1;
};

struct OcpKernel::Implementation {
  ButcherTableau tableau;
  FesdOptions options;
  ElementLayout layout;
  bool depends_on_time = false;
  bool moves = true;  ///< lengths are variables
  int states = 0, selections = 0, simplices = 0;
  int clock = -1;  ///< state that is physical time; -1: none
  std::vector<SelectionPair> pairs;
  std::vector<reformulation::DcsPart> parts;
  std::vector<ClosingGap> closing_gaps;
  std::vector<std::pair<int, int>> simplex_parts;  ///< first selection and count
  SharedSizes shared;
  std::vector<int> free_parameters;  ///< indices into System::p
  std::vector<double> fixed_parameters;
  mpcc::Bounds boundary_bounds;

  LocalFunction element, running, stage_squares, stage_rows, node_squares, node_rows, first_rows, slack_rows, terminal,
      end_squares, measured_squares, terminal_rows, start, equilibration, neighbours, departure;
  std::vector<ConstraintRow> stage_bounds;  ///< of stage_rows: constraint -1 - i is the bound of state i
  std::vector<ConstraintRow> node_bounds, first_bounds, slack_bounds, terminal_bounds;
  std::vector<ConstraintRow> running_bounds;  ///< of rows of `running`: kinks of states and controls at stages
  int soft_per_point = 0, soft_at_end = 0;
  int correction_pairs = 0;  ///< behind those of the cross complementarity, per element
  bool has_start_pairs = false;
  std::vector<bool> start_is_constant;  ///< per row of Dcs::indicator

  casadi::Function indicator;       ///< (t, x, known) -> Dcs::indicator
  casadi::Function held_arguments;  ///< (t, x, known) -> arguments of held symbols
  evaluation::NativeFunctions native;
};

/// Holds symbols and expressions on the way to the functions.
struct OcpExpressions {
  casadi::SX known;   ///< p, held, u
  casadi::SX shared;  ///< SharedSizes
  casadi::SX horizon, speed, samples;
  casadi::SX parameters;  ///< fixed p, 1/N
  ElementExpressions element;
  LocalExpressions running, stage_squares, stage_rows, node_squares, node_rows, first_rows, slack_rows, terminal,
      end_squares, measured_squares, terminal_rows, start, departure;
  casadi::SX stage_inputs;    ///< of the element, and its slacks
  casadi::SX running_inputs;  ///< of the element, and slacks of kinks: Ocp::stage_slacks of each stage
  /// Of the element, the time of a measurement, and of every term at times 1 or 0 and its samples.
  casadi::SX measured_inputs;
  casadi::SX node_inputs, node_row_inputs, terminal_row_inputs, slack_inputs, start_inputs;
};

/// Returns whether a problem has least squares at times.
[[nodiscard]] bool has_measurements(const model::Ocp& ocp);

/// Fills the expressions, and in the kernel what goes with them.
[[nodiscard]] Expected<OcpExpressions> ocp_expressions(const model::Ocp& ocp, const reformulation::Dcs& dcs,
                                                       OcpKernel::Implementation& kernel);

}  // namespace saltus::discretization
