// What [optimize] states of the problem, as syntax trees with positions.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "saltus/base/error.hpp"
#include "saltus/expression/syntax_tree.hpp"
#include "saltus/model/override.hpp"

namespace saltus::model {

/// Says how a violated constraint is paid for; hard ones are not violated.
enum class ConstraintNorm {
  hard,
  l1,    ///< penalty times the sum of violations
  l2,    ///< of their squares
  linf,  ///< the largest
};
enum class ConstraintPoints { intervals, elements, stages };
enum class CostPoints {
  intervals,
  stages,
  end,
  times,  ///< of measurements
};
enum class Relation { less_equal, greater_equal, equal };

/// Holds sides[0] relations[0] sides[1] (relations[1] sides[2]): one comparison, or the two-sided a <= e <= b.
struct ConstraintDescription {
  std::string text;  ///< as written: its name in results
  std::vector<expression::NodePtr> sides;
  std::vector<Relation> relations;
  ConstraintNorm norm = ConstraintNorm::hard;
  expression::NodePtr penalty;  ///< null for hard ones
  SourceLocation location;
};

struct HorizonDescription {
  expression::NodePtr value;         ///< fixed, or the guess
  expression::NodePtr lower, upper;  ///< of a free one; null otherwise
  bool free = false;
  SourceLocation location;
};

/// Holds one of [[optimize.least_squares]].
struct LeastSquaresDescription {
  std::vector<expression::NodePtr> of;
  std::vector<expression::NodePtr> reference;  ///< one per expression; empty: 0, or samples
  /// Of a file: one row per interval; at CostPoints::times one per time; empty without.
  std::vector<std::vector<double>> samples;
  std::vector<double> times;                             ///< ascending, one per row at CostPoints::times; else empty
  std::vector<SourceLocation> rows;                      ///< of samples
  std::string file;                                      ///< its name, for messages
  std::vector<std::vector<expression::NodePtr>> weight;  ///< one row: the diagonal; else a matrix; empty: ones
  CostPoints at = CostPoints::intervals;
  SourceLocation location;
};

struct PathComplementarityDescription {
  expression::NodePtr first, second;  ///< 0 <= first _|_ second >= 0
  SourceLocation location;
};

/// Holds the guess of a state, a control or a free parameter: an expression of t and parameters.
struct GuessDescription {
  std::string name;
  expression::NodePtr expression;
  SourceLocation location;
};

/// Holds [optimize] without its numerical options.
struct OcpDescription {
  expression::NodePtr from;  ///< null means 0
  HorizonDescription horizon;
  expression::NodePtr running_cost, terminal_cost;  ///< may be null
  expression::NodePtr time_weight;                  ///< of minimize_time; null: none
  std::vector<ConstraintDescription> path_constraints, terminal_constraints;
  ConstraintPoints path_constraints_at = ConstraintPoints::intervals;
  std::vector<PathComplementarityDescription> path_complementarities;
  std::vector<LeastSquaresDescription> least_squares;
  std::vector<GuessDescription> guess;
  std::vector<Override> plant;  ///< parameters and initial values of what the closed loop simulates; empty: as they are
  SourceLocation location;
};

/// Holds lower <= . <= upper of [parameters] name = { initial, lower, upper, free = true }.
struct FreeParameterDescription {
  std::string name;
  expression::NodePtr lower, upper;
  SourceLocation location;
};

/// Holds [time_freezing]: of a model whose regions freeze time by hand, or how it is frozen at contacts and in
/// hysteresis.
struct ClockDescription {
  std::string clock;                                 ///< the state that is physical time; empty: there is none by hand
  expression::NodePtr speed_lower, speed_upper;      ///< null: 1
  expression::NodePtr a_n, stabilisation, transfer;  ///< null: the default
  expression::NodePtr stiffness;                     ///< of elastic contacts in earlier versions; has no effect
  /// { initial = a, final = b }: an optimisation begins with a, and `stabilisation` is b; null: it is fixed.
  expression::NodePtr stabilisation_initial;
  expression::NodePtr eps_t;  ///< tangential speed up to which a contact with two tangents sticks; null: the default
  expression::NodePtr correction;   ///< of held gaps: a speed; null: the default
  expression::NodePtr penetration;  ///< how deep an optimum may be in a contact; null: the default
  SourceLocation location;
};

}  // namespace saltus::model
