// Where a switch is: the common length of the elements before it.
#pragma once

#include <optional>

#include "saltus/fesd_integrator/run/chain_internal.hpp"

namespace saltus::fesd_integrator {

/// Holds a chain of elements that ends where a condition does.
struct Located {
  int count = 0;
  double h = 0.0;
  Condition condition;
  bool coarse = false;   ///< too coarse to be taken
  bool divides = false;  ///< what is behind is a step of its own: lengths cannot be within their bounds
};

/// Holds the lengths of elements before and behind a switch at tau of the current part: within (1 -+ bounds) of their
/// mean.
struct PartDivision {
  int elements = 0;
  double remaining = 0.0;  ///< length of the part
  double mean = 0.0;       ///< length of elements of a part without switches
  double bounds = 1.0;

  /// Returns the number of elements before a switch nearest to `count` with which all lengths are within the bounds;
  /// nullopt if there is none.
  [[nodiscard]] std::optional<int> elements_before(double tau, int count) const;
};

class SwitchLocator {
 public:
  /// All must outlive it.
  SwitchLocator(RunContext& context, const Position& position, PartLength& length, Chain& chain)
      : context_(context), position_(position), length_(length), chain_(chain) {}

  /// Goes from the first violation of a trial, seen in the last element solved, to the chain that ends at the earliest
  /// switch; left in the chain. nullopt if it was not found.
  [[nodiscard]] std::optional<Located> find(int elements, double remaining, Violation violation);

 private:
  /// Lengths such that `count` elements end where the condition does: h, or nullopt if it does not end there.
  struct Search {
    int count = 0;
    double guess = 0.0, longest = 0.0;
    TimeWarp warp;
  };
  [[nodiscard]] std::optional<double> locate(const Search& search, const Violation& violation);
  /// What the located elements are: whether all other conditions hold along them.
  struct Check {
    enum class Answer { all_hold, ends_earlier, not_finite };
    Answer answer = Answer::all_hold;
    bool coarse = false;
    double tau = 0.0;         ///< of what ends earlier
    std::size_t element = 0;  ///< in which it does
    Violation violation;
  };
  [[nodiscard]] Check check(int count, double h, const Violation& violation);

  RunContext& context_;
  const Position& position_;
  PartLength& length_;
  Chain& chain_;
};

}  // namespace saltus::fesd_integrator
