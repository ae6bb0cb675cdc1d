// Which options say nothing to the method that runs.
#pragma once

#include <string>
#include <string_view>

#include "saltus/pipeline/options/simulate_options.hpp"

namespace saltus::pipeline {

/// Returns the name of a method, and of its table in [simulate].
[[nodiscard]] std::string_view name(Method method);

/// Says why an option has no effect on a simulation with these options.
/// @param key  dotted, as in simulate_keys()
/// @return words that go on "has no effect: "; empty if it has one
[[nodiscard]] std::string without_effect(const SimulateOptions& options, std::string_view key);

/// Returns whether an option stands in the table of the method that runs.
[[nodiscard]] bool is_of_method(const SimulateOptions& options, std::string_view key);

}  // namespace saltus::pipeline
