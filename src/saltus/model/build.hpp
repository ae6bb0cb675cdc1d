// Syntax trees -> System: resolves names, recognises nonsmooth terms, shares switching functions, checks.
#pragma once

#include <vector>

#include "saltus/model/description.hpp"
#include "saltus/model/system.hpp"

namespace saltus::model {

/// Builds the system a description states, with the overrides applied.
/// @return the system, or the first error with file, line, column and remedy.
[[nodiscard]] Expected<System> build(const Description& description, const std::vector<Override>& overrides = {});

}  // namespace saltus::model
