// [[hysteresis]] becomes a discrete state and a jump.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>

#include "saltus/model/description.hpp"
#include "saltus/model/statement/model_scope_internal.hpp"

namespace saltus::model {

/// Holds the thresholds and the start of one hysteresis, in numbers.
struct HysteresisThresholds {
  std::string name;
  double on = 0.0, off = 0.0;
  double initial = 0.0;  ///< 0 or 1
  SourceLocation location{}, input_location{}, on_location{}, off_location{}, initial_location{};
};

/// Appends the discrete states of all [[hysteresis]] to the statement, behind those of [states]; their values are not
/// known yet.
void declare_hysteresis(const Description& description, Recognition& recognition, Statement& statement);

/// Gives the state number `state` of the statement, a hysteresis, its value at the start. The states of the input have
/// their initial values. Where the input is beyond a threshold at the start the side it is on holds, with a warning.
/// @return the mistake: on == off, a value that is not finite, an initial value other than 0 and 1
[[nodiscard]] std::optional<Error> begin_hysteresis(Recognition& recognition, Statement& statement, int state,
                                                    const SXElem& input, const HysteresisThresholds& thresholds);

/// Does the same, and appends the jump that changes it.
[[nodiscard]] std::optional<Error> state_hysteresis(Recognition& recognition, Statement& statement, int state,
                                                    const SXElem& input, const HysteresisThresholds& thresholds);

/// What is done with one: its state, its input, its thresholds.
using StateHysteresis = std::function<std::optional<Error>(int, const SXElem&, const HysteresisThresholds&)>;

/// Does the same for every entry of a description.
/// @param initial  the value of one at the start that replaces the one of the file, by name
[[nodiscard]] std::optional<Error> state_all_hysteresis(const Description& description, ModelScope& scope,
                                                        const std::map<std::string, double>& initial,
                                                        const StateHysteresis& take);

}  // namespace saltus::model
