// What was decided with the values of parameters when a system was built.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "saltus/base/error.hpp"

namespace saltus::model {

struct System;

/// Says why a system may not be simulated with the values it holds: as many as it has names, and of parameters those
/// with which everything would be decided as it was: what folds, what coincides, where nothing jumps. Others have to be
/// stated before the system is built. Cost: nothing for the values it was built with, else less than building it.
[[nodiscard]] std::optional<Error> find_stale(const System& system);

/// Returns in words which row of the mass matrix makes it lose its positive definiteness in a state; nothing where none
/// does.
[[nodiscard]] std::optional<std::string> find_indefinite_mass(const System& system, const std::vector<double>& x);

}  // namespace saltus::model
