// Decisions where the solution is not unique: which there are in a run, and which of their alternatives to follow.
#pragma once

#include <cstddef>
#include <limits>
#include <optional>

namespace saltus::event_integrator {

/// Says what a run goes on with instead of what it decides: an alternative of a decision, or a member of a family.
/// Decisions (with alternatives, or of spirals) and families are counted along a run.
struct Choice {
  long decision = 0;  ///< its number; with `leave_at` or `phase` that of a family
  std::size_t alternative = 0;
  std::optional<double> leave_at{};  ///< a time of a family of later departures
  std::optional<double> phase{};     ///< of a family of spirals: part of a cycle, in logarithms of the size, 0 to 1

  [[nodiscard]] bool of_family() const { return leave_at || phase; }
  [[nodiscard]] double departure() const { return leave_at.value_or(std::numeric_limits<double>::infinity()); }
};

/// Holds an event with alternatives, and the number of the decision that it shows.
struct BranchPoint {
  std::size_t event = 0;
  long decision = 0;
};

}  // namespace saltus::event_integrator
