// A finite element and the boundary between two as symbolic expressions of their variables.
#pragma once

#include <vector>

#include <casadi/core/sx.hpp>

#include "saltus/base/error.hpp"
#include "saltus/discretization/butcher_tableau.hpp"
#include "saltus/discretization/fesd_options.hpp"
#include "saltus/discretization/fesd_problem.hpp"
#include "saltus/discretization/local_function_internal.hpp"
#include "saltus/discretization/variable_layout.hpp"
#include "saltus/reformulation/dcs.hpp"

namespace saltus::discretization {

/// Returns all pairs of a system, in the order of lambda: of step selection j first lambda_n,j, then lambda_p,j.
[[nodiscard]] std::vector<SelectionPair> selection_pairs(const reformulation::Dcs& dcs);

/// Holds the variables of one element as matrices with one column per stage or point.
struct ElementVariables {
  casadi::SX h;
  casadi::SX stage;       ///< n_x by n_s
  casadi::SX selection;   ///< n_selections by n_s
  casadi::SX lifted;      ///< n_lifted by n_s
  casadi::SX lambda;      ///< n_lambda by points
  casadi::SX simplex;     ///< n_simplices by points
  casadi::SX end_state;   ///< n_x by 1, or empty
  casadi::SX end_time;    ///< 1 by 1, or empty
  casadi::SX correction;  ///< n_selections by 2, or empty
};

/// Holds the sides of the pairs at the points of an element, columns.
struct ElementPairs {
  casadi::SX a;       ///< n_pairs by n_s
  casadi::SX lambda;  ///< n_pairs by 1 + points: the left end first
};
[[nodiscard]] ElementPairs element_pairs(const std::vector<SelectionPair>& pairs, const ElementVariables& variables,
                                         const casadi::SX& left_lambda);

/// Adds the complementarities within an element; for `paper` those of the same stage.
void add_cross_complementarities(CrossComplementarity mode, const ElementPairs& pairs, LocalExpressions& expressions);

/// Holds both elements of a boundary.
struct Boundary {
  ElementPairs before, after;
  casadi::SX h_before, h_after;
  casadi::SX own;  ///< variables of the boundary itself
};

/// Adds eq. (38): products of all components and different points of both elements.
void add_paper_cross_complementarity(const Boundary& boundary, LocalExpressions& expressions);

/// Returns eta with the indicator of each pair (StepEquilibration).
[[nodiscard]] casadi::SX switch_indicator(const Boundary& boundary);
/// Returns eta as printed in section 4.4 of [nurkanovic2024]; of Stewart's form, where theta takes part, as in the
/// other modes.
[[nodiscard]] casadi::SX printed_switch_indicator(const std::vector<SelectionPair>& kinds, const Boundary& boundary);

/// Returns how many variables a boundary has, with their bounds.
[[nodiscard]] mpcc::Bounds boundary_bounds(StepEquilibration mode, int pairs);

/// Returns values of these variables with which the rows of mode mlcp hold: from the first sides of its pairs where the
/// variables are zero, and h_n - h_(n-1).
[[nodiscard]] linalg::Vector boundary_values(const linalg::Vector& first_sides, double difference);
void add_step_equilibration(const FesdOptions& options, const std::vector<SelectionPair>& kinds,
                            const Boundary& boundary, LocalExpressions& expressions);

/// Holds what elements share in an optimal control problem.
struct SharedInputs {
  casadi::SX symbols;        ///< local inputs of every element: controls, free parameters, horizon and the like
  casadi::SX length_factor;  ///< h = length_factor times the element's variable
  bool needs_time = false;   ///< whether something else than the dynamics depends on time
};

/// Holds the time, state and selections at a stage or at the right end, over the inputs of the element.
struct ElementPoint {
  casadi::SX t, x, selection;
};

/// Holds all symbols and expressions of the kernel.
struct ElementExpressions {
  ElementLayout layout;
  std::vector<SelectionPair> pairs;
  casadi::SX parameters;  ///< p, held, T/N; of an optimal control problem what the caller makes of it
  /// Left state, left time (if it matters), left lambda, shared inputs, the element's variables.
  casadi::SX element_inputs;
  LocalExpressions element;
  casadi::SX boundary_inputs;   ///< left lambda and variables of the element before, variables of the one after, own
  LocalExpressions neighbours;  ///< complementarities across the boundary (mode paper)
  LocalExpressions boundary;    ///< step equilibration
  casadi::SX h;                 ///< length
  std::vector<ElementPoint> stages;
  ElementPoint left, end;  ///< the left end has no selections
  mpcc::Bounds boundary_own_bounds;
  bool depends_on_time = false;
};

/// Fails (not_available) for Lobatto IIIA: the selections of its first stage are in no equation while sliding.
/// @param shared  null in a simulation: controls are their inputs, all parameters are constants
[[nodiscard]] Expected<ElementExpressions> element_expressions(const reformulation::Dcs& dcs,
                                                               const ButcherTableau& tableau,
                                                               const FesdOptions& options,
                                                               const SharedInputs* shared = nullptr);

}  // namespace saltus::discretization
