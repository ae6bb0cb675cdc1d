// Where the values of a function are while its arguments stay within bounds.
#pragma once

#include <vector>

#include <casadi/core/function.hpp>
#include <casadi/core/sx_elem.hpp>

#include "saltus/base/function_ref.hpp"

namespace saltus::model {

/// Holds what differs from its middle by its radius at most, up to rounding; a radius that is not finite says nothing.
struct Range {
  casadi::SXElem middle = 0.0;
  casadi::SXElem radius = 0.0;
};

/// Returns ranges of the entries of the first result, operation by operation: they are wide where operands depend on
/// each other.
/// @param input  range of entry `k` of argument `i`: input(i, k)
[[nodiscard]] std::vector<Range> ranges(const casadi::Function& function,
                                        FunctionRef<Range(casadi_int, casadi_int)> input);

}  // namespace saltus::model
