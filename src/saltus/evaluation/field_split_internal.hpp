// The right-hand side in two parts: what depends on parameters and selections only, and the rest.
#pragma once

#include <casadi/core/sx.hpp>

#include "saltus/evaluation/affine_functions_internal.hpp"

namespace saltus::evaluation {

/// Holds f(t, x, p, alpha) = varying(t, x, constants(p, alpha)), operation by operation the same as f.
struct FieldSplit {
  casadi::SX constants;  ///< over p and alpha
  casadi::SX symbols;    ///< that stand for them
  casadi::SX varying;    ///< over t, x and the symbols
};

/// Splits f by what changes in a mode, where the selections do not: the constants are computed once per mode, however
/// many switching functions they sum up.
[[nodiscard]] FieldSplit split_field(const casadi::SX& f, const ModelSymbols& symbols);

}  // namespace saltus::evaluation
