// Sets on which selections are not all determined: higher-order sliding (surfaces on which no selection moves psi at
// once, held at zero with derivatives along the field), and surfaces whose gradients depend on each other.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "saltus/event_integrator/field/held_functions.hpp"
#include "saltus/event_integrator/mode/mode_state.hpp"
#include "saltus/switching/selections/selection_balances.hpp"
#include "saltus/switching/selections/selection_range.hpp"

namespace saltus::event_integrator {

struct SwitchingPoint;
struct SwitchingContext;

/// grad c . f(t, x, alpha) + d c/dt = 0 for one of the held functions (numbers in HigherOrderSet::functions), or
/// several that share selections (rows of the sliding set). Into several functions selections enter additively.
using switching::Balance;

/// Velocities of held functions are good to about ten digits where their gradients are differences.
inline constexpr double velocity_accuracy = 1e-9;

/// Says which selection a function away from zero has in each of the regions that meet at the held surfaces inside it:
/// bit i of a region is the side of the i-th of these.
struct NestedSelection {
  int function = 0;
  std::vector<int> inside;
  std::vector<double> alpha;  ///< by region
};

/// Sets them for the regions that the selections of the held surfaces are those of; inner functions come first.
void read_nested(const std::vector<NestedSelection>& nested, std::vector<double>& alpha);

/// Says where a solution slides with higher order: psi_I = 0, the derivatives of these that no selection enters, and
/// the balances that hold them. Of surfaces whose gradients depend on each other the functions are independent ones.
/// The motion is the field at any selections in the cube that fulfil the balances, which is one and the same for all of
/// them.
struct HigherOrderSet {
  std::vector<HeldFunction> functions;  ///< gradients independent; by order
  std::vector<Balance> balances;
  std::vector<int> undetermined;  ///< surfaces whose selections are not determined: several in one balance, or none
  std::vector<NestedSelection> nested = {};  ///< of functions that have both signs there, inner ones first
};

/// Holds the range of a balance over the corners of its selections, in one direction where it has several functions;
/// held while min <= 0 <= max.
struct BalanceRange {
  double min = 0.0, max = 0.0;
  std::size_t lowest = 0, highest = 0;  ///< corners, bit i: selection of rows[i]
  double terms = 0.0;                   ///< of the sum that each is: bounds its rounding
  std::size_t balance = 0;
  std::size_t row = 0;                         ///< of the sliding set: whose exits stand for it
  std::size_t free_below = 0, free_above = 0;  ///< bit i: rows[i] is held on where min, max reach 0
  double exactness = 1.0;                      ///< how much larger its rounding is than that of its terms
};

/// Evaluates the field on a higher-order set. Selections of a balance of one function lie on the line between the two
/// corners where it falls and rises most. Those of several functions lie next to 1/2. The field does not depend on
/// which of the others are taken. Owns its work space. Cost: one evaluation of f per corner of every balance of one
/// function, per selection of others.
class HigherOrderField {
 public:
  explicit HigherOrderField(const evaluation::ModelKernel& kernel);

  void enter(const HigherOrderSet& set, const std::vector<int>& sliding, const std::vector<double>& alpha);
  /// Finds selections, ranges and f at a point.
  void evaluate(double t, const double* point);
  /// Returns, behind evaluate(), f along the set; not finite where the motion depends on selections that are not
  /// determined.
  [[nodiscard]] const std::vector<double>& motion() const { return motion_; }
  [[nodiscard]] const std::vector<double>& alpha() const { return alpha_; }
  [[nodiscard]] const std::vector<BalanceRange>& ranges() const { return ranges_; }
  [[nodiscard]] const HigherOrderSet& set() const { return set_; }
  /// Returns whether a balance has more exits than are looked for: its motion is not finite then.
  [[nodiscard]] bool too_many() const { return too_many_; }
  bool project(double t, double* x) { return functions_.project(t, x); }

 private:
  /// Several functions: what each selection adds to f and to their velocities.
  struct Coupled {
    linalg::Matrix jumps;    ///< n_x x q
    linalg::Matrix effects;  ///< r x q
    linalg::Vector constant;
    switching::SelectionRange range;
    switching::CentralSelections central;
    linalg::Vector selections;
    /// Whether the motion is determined, and where that was looked at: the same jumps and effects have one answer.
    [[nodiscard]] bool determines_motion();
    linalg::Matrix decided_jumps, decided_effects;
    bool determined = false;
  };

  bool hold_one(std::size_t b, double t, const double* x);
  void balance_beside_roots();
  bool hold_several(std::size_t b, double t, const double* x);
  void evaluate(const Balance& balance, BalanceRange& range, double t, const double* x);
  void set_corner(const Balance& balance, std::size_t corner);
  [[nodiscard]] bool determines(const Balance& balance, const BalanceRange& range) const;
  void find_jumps(const Balance& balance, linalg::Matrix& jumps, double t, const double* x);
  void take_selections(std::size_t b);
  [[nodiscard]] double selection(std::size_t corner, std::size_t bit) const { return corner >> bit & 1U ? 1.0 : 0.0; }

  const evaluation::ModelKernel& kernel_;
  HigherOrderSet set_;
  std::vector<int> sliding_;
  HeldFunctions functions_;
  std::vector<BalanceRange> ranges_;
  std::vector<double> alpha_, trial_, low_, motion_, x_, base_, f_;
  std::vector<std::vector<double>> corners_;  ///< f of the current balance
  std::vector<double> velocities_;
  std::vector<Coupled> coupled_;  ///< by balance
  /// What a balance of a function around a root moves, from the corner where it falls most to that where it rises most.
  struct Jump {
    std::size_t function = 0;
    double velocity = 0.0;
    std::vector<double> field;
  };
  std::vector<Jump> jumps_;
  bool too_many_ = false;
};

/// Finds the set on which all sliding surfaces of a state can be held at (t, x), and puts (t, x) there. Returns nullopt
/// if there is none, and `problem` says why:
/// - the gradients are dependent;
/// - a derivative that no selection enters does not vanish;
/// - no selection in [0, 1] holds the others;
/// - several balances share a selection;
/// - the motion is not determined.
/// @param resolved  derivatives up to what their function changes by in this time are zero
[[nodiscard]] std::optional<HigherOrderSet> find_higher_order_set(const SwitchingContext& switching_context,
                                                                  const ModeState& state, double t,
                                                                  std::vector<double>& x, double resolved,
                                                                  std::string& problem);

/// Does the same for surfaces whose gradients depend on each other all along the set where they vanish. An example is
/// x1 - x2, x2 - x3, x1 - x3: selections enter additively, and all that hold the set give the same motion. Also for
/// surfaces whose gradients are independent, but which all selections move alike: velocities of blocks that press on
/// each other. nullopt with an empty `problem` if the gradients are independent, and it finds none.
[[nodiscard]] std::optional<HigherOrderSet> find_dependent_set(const SwitchingContext& switching_context,
                                                               const ModeState& state, double t, std::vector<double>& x,
                                                               std::string& problem);

}  // namespace saltus::event_integrator
