// Higher-order sliding: surfaces on which no selection moves psi at once, held at zero with derivatives along the
// field.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "saltus/event_integrator/held_functions.hpp"
#include "saltus/event_integrator/mode_state.hpp"

namespace saltus::event_integrator {

struct Occasion;
struct Surroundings;

/// grad c . f(t, x, alpha) + d c/dt = 0 for one of the held functions: what determines selections. No selection is in
/// two of them.
struct Balance {
  std::size_t function = 0;       ///< in HigherOrderSet::functions
  std::vector<std::size_t> rows;  ///< of the sliding set: the surfaces whose selections are in it
};

/// Where a solution slides with higher order: psi_I = 0, the derivatives of these that no selection enters, and the
/// balances that hold them. The motion is the field at any selections in the cube that fulfil the balances, which is
/// one and the same for all of them.
struct HigherOrderSet {
  std::vector<HeldFunction> functions;  ///< gradients independent; by order
  std::vector<Balance> balances;
  std::vector<int> undetermined;  ///< surfaces whose selections are not determined: several in one balance, or none
};

/// The range of a balance over the corners of its selections; held while min <= 0 <= max.
struct BalanceRange {
  double min = 0.0, max = 0.0;
  std::size_t lowest = 0, highest = 0;  ///< corners, bit i: selection of rows[i]
  double terms = 0.0;                   ///< of the sum that each is: bounds its rounding
};

/// The field on a higher-order set. Selections lie on the line between the two corners of a balance where its function
/// falls and rises most; the field does not depend on which of the others are taken.
/// Owns its work space; allocates in enter() only. Cost: one evaluation of f per corner of every balance.
class HigherOrderField {
 public:
  explicit HigherOrderField(const evaluation::ModelKernel& kernel);

  void enter(const HigherOrderSet& set, const std::vector<int>& sliding, const std::vector<double>& alpha);
  /// Selections, ranges and f at a point.
  void evaluate(double t, const double* point);
  /// Behind evaluate(): f along the set; not finite where the motion depends on selections that are not determined.
  [[nodiscard]] const std::vector<double>& motion() const { return motion_; }
  [[nodiscard]] const std::vector<double>& alpha() const { return alpha_; }
  [[nodiscard]] const std::vector<BalanceRange>& ranges() const { return ranges_; }
  [[nodiscard]] const HigherOrderSet& set() const { return set_; }
  bool project(double t, double* x) { return functions_.project(t, x); }

 private:
  void evaluate(const Balance& balance, BalanceRange& range, double t, const double* x);
  [[nodiscard]] bool determines(const Balance& balance, const BalanceRange& range) const;
  [[nodiscard]] double selection(std::size_t corner, std::size_t bit) const { return corner >> bit & 1U ? 1.0 : 0.0; }

  const evaluation::ModelKernel& kernel_;
  HigherOrderSet set_;
  std::vector<int> sliding_;
  HeldFunctions functions_;
  std::vector<BalanceRange> ranges_;
  std::vector<double> alpha_, trial_, motion_, x_;
  std::vector<std::vector<double>> corners_;  ///< f of the balance at hand
  std::vector<double> velocities_;
};

/// The set on which all sliding surfaces of a state can be held at (t, x), which is put there; nullopt if there is
/// none: the gradients are dependent, a derivative that no selection enters does not vanish, no selection in [0, 1]
/// holds the others, several balances share a selection, or the motion is not determined. Then `problem` says what.
/// @param resolved  derivatives up to what their function changes by in this time are zero
[[nodiscard]] std::optional<HigherOrderSet> find_higher_order_set(const Surroundings& surroundings,
                                                                  const ModeState& state, double t,
                                                                  std::vector<double>& x, double resolved,
                                                                  std::string& problem);

}  // namespace saltus::event_integrator
