// The numeric side of the model's expressions: one numbered list of operations, shared by all of them. Sharing of
// switching functions, constancy, kinks and chains are decided on it; it knows CasADi's operation codes and nothing
// else of CasADi.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "saltus/base/at.hpp"
#include "saltus/model/cells.hpp"

namespace saltus::model {

enum class VariableKind {
  time,
  state,     ///< moves
  discrete,  ///< a state that changes by jumps only
  control,
  sampled_control,  ///< piecewise constant in time
  parameter,
  alpha,
  cell,      ///< a constant of a cell; in a set of kinds: of one that jumps
  activity,  ///< a constant of the mode of a contact
  force,     ///< of a contact, where it is no expression
};

/// Set of variable kinds, one bit each.
using KindSet = unsigned;
[[nodiscard]] constexpr KindSet kind_bit(VariableKind kind) { return 1U << static_cast<unsigned>(kind); }

/// What changes during a simulation.
inline constexpr KindSet changing_kinds = kind_bit(VariableKind::time) | kind_bit(VariableKind::state) |
                                          kind_bit(VariableKind::discrete) | kind_bit(VariableKind::control) |
                                          kind_bit(VariableKind::sampled_control) | kind_bit(VariableKind::cell) |
                                          kind_bit(VariableKind::activity) | kind_bit(VariableKind::force);
/// What changes by jumps only.
inline constexpr KindSet jumping_kinds = kind_bit(VariableKind::discrete) | kind_bit(VariableKind::sampled_control) |
                                         kind_bit(VariableKind::cell) | kind_bit(VariableKind::activity);
/// What changes between jumps.
inline constexpr KindSet moving_kinds = changing_kinds & ~jumping_kinds;

struct Variable {
  VariableKind kind = VariableKind::time;
  int index = 0;       ///< among those of its kind; of a discrete state among all states
  double value = 0.0;  ///< of a parameter; the initial one of a state or control
  int number = -1;     ///< what its draws are seeded with: its own, in a part that of the whole tape
};

struct TapeNode {
  int operation = 0;          ///< casadi::Operation; OP_CONST and OP_PARAMETER for the leaves
  int left = -1, right = -1;  ///< smaller node numbers; right is -1 for one operand
  int variable = -1;          ///< of a leaf or a constant of a cell
  int psi = -1;               ///< of an alpha: the node of its switching function, a smaller number
  double constant = 0.0;
  KindSet written = 0;            ///< kinds of the variables in the expression
  KindSet reached = 0;            ///< the same, with those in the switching functions of its alphas
  bool may_be_nonfinite = false;  ///< can overflow or be NaN for moderate arguments
  bool polynomial = true;         ///< the expression as written is one in what changes
  int number = -1;                ///< its own; in a part that of the whole tape
};

/// A constant of the cell in which the operand `left` lies; its variable holds it (NaN: looked up at the point).
inline constexpr int cell_operation = 1000;

/// Says whether the walk down an expression stops at an alpha or goes on into its switching function.
enum class Links { written, through_alpha };

/// Holds operations in topological order; equal ones (same operation, same operands) get the same number.
class Tape {
 public:
  int constant(double value);
  int variable(const Variable& variable);
  int alpha(int index, int psi);
  int operation(int operation, int left, int right);
  /// Returns constant number `column` of the cell of a table in which `argument` lies.
  int cell(int argument, const std::shared_ptr<const CellTable>& table, int column);

  [[nodiscard]] const TapeNode& operator[](int node) const { return nodes_[at(node)]; }
  [[nodiscard]] int size() const { return static_cast<int>(nodes_.size()); }
  [[nodiscard]] const std::vector<Variable>& variables() const { return variables_; }
  /// Returns the value of an operation for given operands; a constant of a cell by looking it up.
  [[nodiscard]] double operate(const TapeNode& node, double left, double right) const;
  /// Returns the table of a constant of a cell.
  [[nodiscard]] const CellTable& table_of(const TapeNode& node) const {
    return *cells_[at(variables_[at(node.variable)].index)].table;
  }
  void set_value(int variable, double value) { variables_[at(variable)].value = value; }
  /// Makes a variable a state; what depends on it moves by then. Cost: linear in the size.
  void restate_as_state(int variable, int index);

  /// Returns all nodes the roots consist of, ascending (hence in order of evaluation). Negative roots are skipped.
  [[nodiscard]] std::vector<int> cone(std::span<const int> roots, Links links) const;
  /// Counts the nodes of all cones that this thread has asked for: tests compare it with the size of models.
  [[nodiscard]] static std::size_t walked() { return walked_; }

  /// Returns the nodes of a cone (through alphas) as a tape of their own, in the same order: what is asked of it costs
  /// as much as they are, however long this one is. Nothing is to be added to it.
  [[nodiscard]] Tape part(std::span<const int> roots) const;
  /// Returns the place in a part: where node `number` of the whole tape is, -1 if it is not in it.
  [[nodiscard]] int place_of(int number) const;
  /// Makes a part a whole tape, of which there may be parts: numbers are places from now on.
  void renumber();

 private:
  int append(TapeNode node);
  void make_room();
  void set_kinds(TapeNode& node) const;

  inline static thread_local std::size_t walked_ = 0;
  std::vector<TapeNode> nodes_;
  std::vector<Variable> variables_;
  struct CellConstant {
    std::shared_ptr<const CellTable> table;
    int column = 0;
  };
  std::vector<CellConstant> cells_;  ///< by the index of their variables
  std::vector<int> places_;          ///< of nodes, where their hashes find them, or beyond (open addressing); -1: none
};

/// One value per variable of a tape. NaN for an alpha means: the step of its switching function at this point; for a
/// constant of a cell: that of the cell in which the argument lies at this point.
using Point = std::vector<double>;

/// Returns parameters at their values, alphas by the sign of their psi, cells where their arguments are, everything
/// else 0.
[[nodiscard]] Point blank_point(const Tape& tape);

/// Holds values by node number; meaningful for the nodes of the cone evaluated last.
struct TapeValues {
  std::vector<double> value;
  std::vector<double> bound;  ///< first-order bound, see evaluate_with_bounds
};

void evaluate(const Tape& tape, std::span<const int> cone, const Point& point, TapeValues& values);

/// Evaluates values, and bounds b = sum |d node / d operand| b_operand + local |value|, plus `scale` at a variable
/// (empty: 0). No scale and local = machine epsilon bound the rounding error; a scale of the variables' size bounds
/// what an error in the position does. The bound of an alpha is 0.
void evaluate_with_bounds(const Tape& tape, std::span<const int> cone, const Point& point,
                          std::span<const double> scale, double local, TapeValues& values);

/// Returns d root / d variable, one entry per variable, alphas held fixed; `values` must be those of a cone that
/// contains root.
[[nodiscard]] std::vector<double> gradient(const Tape& tape, const TapeValues& values, int root);

/// Returns step of the paper's Table 1 at a point: 1, 1/2, 0 (NaN stays NaN).
[[nodiscard]] double step_value(double psi);

}  // namespace saltus::model
