// From a System to what of it is no expression.
#pragma once

#include "saltus/model/layout.hpp"

namespace saltus::model {

struct System;

/// Returns what of a system is no expression. What a compiled model adds is left at its default. Cost: that of copying
/// the names; no expression is looked at.
[[nodiscard]] Layout layout_of(const System& system);

}  // namespace saltus::model
