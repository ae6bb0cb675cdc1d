// Whether two results of one model say the same, to tolerances.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "saltus/base/error.hpp"
#include "saltus/result/result.hpp"

namespace saltus::result {

/// Holds numbers a and b are the same if |a - b| <= atol + rtol max(|a|, |b|); two that are missing (NaN) are, too.
struct Tolerances {
  double rtol = 1e-6;
  /// By default that of each column: rtol times its range in both results, and no less than the absolute tolerance with
  /// which they were computed.
  std::optional<double> atol{};
};

/// Holds two numbers of one meaning; of a state the pair that is farthest apart.
struct NumberDifference {
  std::string what;  ///< "x", "t of event 3"
  double a = 0.0, b = 0.0;
};

struct Difference {
  std::vector<NumberDifference> parameters;  ///< those that are not equal; they make no difference by themselves
  std::vector<NumberDifference> end_state;   ///< states, then outputs, that differ at the end, and the end time
  std::vector<NumberDifference> rows;        ///< states that differ at a time that both have, with the worst time
  std::size_t common_times = 0;
  std::size_t between_times =
      0;  ///< at which one has a row and the other a line between two, true to a part of the range
  std::size_t common_states = 0;  ///< that the rows of both have
  std::size_t events_a = 0, events_b = 0;
  std::string first_event;  ///< what differs in the first event that does; empty if none
  std::string ends;         ///< how the runs ended, if differently
  [[nodiscard]] bool is_none() const {
    return end_state.empty() && rows.empty() && first_event.empty() && ends.empty() && events_a == events_b;
  }
};

/// Says the first equation that two results state differently ("v' = -9.81 and v' = -8.81"); empty if there is none, or
/// if one of them states none.
[[nodiscard]] std::string differing_equation(const Result& a, const Result& b);

/// Compares end states, events (kind, name, surfaces, time, state) and the rows at common times; with the lines
/// between rows of `output = "auto"` also those of the other one, but not beside events.
/// @return the differences, or an error: results of different models (another name, other states, switching functions
///         or outputs).
[[nodiscard]] Expected<Difference> difference(const Result& a, const Result& b, const Tolerances& tolerances);

}  // namespace saltus::result
