// A system with contacts or hysteresis as one whose time stands still there.
#pragma once

#include "saltus/base/error.hpp"
#include "saltus/model/system.hpp"

namespace saltus::model {

/// Holds what a system with contacts or hysteresis is when it is frozen, or why it cannot be.
struct FrozenSystem {
  Expected<System> system;
};

/// Returns a frozen system with the parameters and initial values that the system it stands for has by now.
[[nodiscard]] System with_values_of(System frozen, const System& system);

}  // namespace saltus::model
