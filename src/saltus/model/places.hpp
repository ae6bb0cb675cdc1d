// Where the vectors of a System, and rows of its results, have what a name says.
#pragma once

#include <cstddef>
#include <string>

#include "saltus/base/error.hpp"

namespace saltus::model {

struct System;

/// Returns the place of a parameter in System::parameter_values, of a state in initial_state and in states of results,
/// of a control in control_initial. Fails (unknown_name) for another name: the remedy says which there are.
[[nodiscard]] Expected<std::size_t> parameter_place(const System& system, const std::string& name);
[[nodiscard]] Expected<std::size_t> state_place(const System& system, const std::string& name);
[[nodiscard]] Expected<std::size_t> control_place(const System& system, const std::string& name);

}  // namespace saltus::model
