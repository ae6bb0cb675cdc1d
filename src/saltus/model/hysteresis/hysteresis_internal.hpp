// [[hysteresis]] becomes a discrete state and a jump.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>

#include "saltus/model/description.hpp"
#include "saltus/model/statement/model_scope_internal.hpp"

namespace saltus::model {

/// Holds the thresholds of one hysteresis, over parameters and t, and its start.
struct HysteresisThresholds {
  std::string name;
  SXElem on = 0.0, off = 0.0;
  double initial = 0.0;  ///< 0 or 1
  SourceLocation location{}, input_location{}, on_location{}, off_location{}, initial_location{};
};

/// Holds thresholds that are constant.
struct ConstantThresholds {
  double on = 0.0, off = 0.0;
};

/// Returns the numbers that the thresholds are; nothing where one varies.
[[nodiscard]] std::optional<ConstantThresholds> constant_thresholds(Recognition& recognition,
                                                                    const HysteresisThresholds& thresholds);

/// Returns whether an expression has parameters only, those among them that an optimisation chooses.
[[nodiscard]] bool is_of_parameters(const Statement& statement, const SXElem& expression);

/// Appends the discrete states of all [[hysteresis]] to the statement, behind those of [states]; their values are not
/// known yet.
void declare_hysteresis(const Description& description, Recognition& recognition, Statement& statement);

/// Gives the state number `state` of the statement, a hysteresis, its value at the start. The states of the input have
/// their initial values. Where the input is beyond a constant threshold at the start the side it is on holds, with a
/// warning; beyond one over t its jump is the first event.
/// @return the mistake: on == off, a value that is not finite, an initial value other than 0 and 1, thresholds over
///         states or controls
[[nodiscard]] std::optional<Error> begin_hysteresis(Recognition& recognition, Statement& statement, int state,
                                                    const SXElem& input, const HysteresisThresholds& thresholds);

/// Does the same, and appends the jump that changes it. Where thresholds over t meet the run stops.
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
