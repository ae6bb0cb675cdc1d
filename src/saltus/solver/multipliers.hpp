// Multipliers of a problem with complementarities, as the solver finds them.
#pragma once

#include "saltus/mpcc/multipliers.hpp"

namespace saltus::solver {

using MpccMultipliers = mpcc::Multipliers;

}  // namespace saltus::solver
