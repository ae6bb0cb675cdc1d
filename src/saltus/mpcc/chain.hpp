// How the variables and rows of a problem hang together along a chain of elements: what a structured solver needs.
#pragma once

#include <vector>

namespace saltus::mpcc {

/// Holds consecutive numbers first, first + 1, ..., first + count - 1.
struct IndexRange {
  int first = 0;
  int count = 0;

  [[nodiscard]] int end() const { return first + count; }
};

/// Says where the parts of one element stand. Elements of one chain are alike in all counts.
struct ElementPlace {
  IndexRange variables;  ///< all of its own
  IndexRange rows;       ///< of g
  IndexRange pairs;
  /// Variables of its right end that the next element uses: the state, then the multipliers.
  std::vector<int> link_state, link_multipliers;
};

/// Holds the elements between two nodes, and what they share.
struct IntervalPlace {
  IndexRange shared;  ///< controls, speed of time and lengths
  int first_element = 0;
  int elements = 0;
};

/// Holds intervals from left to right. `border` is shared by all of them (horizon, free parameters); `start` belongs to
/// the left end of the first (free initial state and its multipliers).
struct Chain {
  std::vector<IntervalPlace> intervals;
  std::vector<ElementPlace> elements;
  IndexRange border;
  IndexRange start;
};

}  // namespace saltus::mpcc
