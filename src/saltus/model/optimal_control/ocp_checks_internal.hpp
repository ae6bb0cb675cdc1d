// What a problem must not be: each mistake with its message.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "saltus/model/description.hpp"
#include "saltus/model/ocp.hpp"

namespace saltus::model {

[[nodiscard]] std::optional<Error> check_horizon(const OcpHorizon& horizon, const SourceLocation& location);
/// Checks lower <= initial <= upper, both finite: what is free needs both.
[[nodiscard]] std::optional<Error> check_range(const std::string& what, double initial, double lower, double upper,
                                               const SourceLocation& location);
[[nodiscard]] std::optional<Error> check_constraint(const OcpConstraint& constraint, const SourceLocation& location);
[[nodiscard]] Error wrong_sample_width(const LeastSquaresDescription& stated, std::size_t row);
/// Checks that measurements are numbers that ascend within a horizon that is known, where time never stands still.
[[nodiscard]] std::optional<Error> check_times(const OcpLeastSquares& term, const LeastSquaresDescription& stated,
                                               const Ocp& ocp);
[[nodiscard]] std::optional<Error> check_least_squares(const OcpLeastSquares& term,
                                                       const LeastSquaresDescription& stated);
/// Returns whose guess it is, with its output; an error where nothing free has the name, and where it depends on more
/// than t and parameters.
[[nodiscard]] Expected<OcpGuess> guess_of(const GuessDescription& stated, const Ocp& ocp, int output);
[[nodiscard]] std::optional<Error> check_initial_states(const Ocp& ocp, const Description& description);
/// Returns the places of expressions by the names of the switching functions and cells that they make.
[[nodiscard]] std::map<std::string, SourceLocation> switching_places(const Description& description);
/// Refuses what the method does not cover: jumps, discrete states, switching functions of a control, t beside a clock,
/// selections of controls in costs.
[[nodiscard]] std::optional<Error> check(Ocp& ocp, const Description& description);

}  // namespace saltus::model
