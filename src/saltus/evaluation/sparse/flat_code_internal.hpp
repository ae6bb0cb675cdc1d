// C source of a large function in short parts without branches, which compilers translate in linear time.
#pragma once

#include <string>

#include <casadi/core/function.hpp>

namespace saltus::evaluation {

/// Returns a function of CasADi's signature under the name of `function` (of SX, dense), which does the same operations
/// in the same order; empty if one of them is not known here.
[[nodiscard]] std::string flat_code(const casadi::Function& function);

}  // namespace saltus::evaluation
