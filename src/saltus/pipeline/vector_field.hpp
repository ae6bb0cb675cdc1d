// The field of a model with two states as a phase plane draws it.
#pragma once

#include <optional>

#include "saltus/result/result.hpp"

namespace saltus::model {
struct System;
}

namespace saltus::pipeline {

/// Arrows per side of the grid.
inline constexpr int field_cells = 20;

/// Evaluates f at the end of the run on a grid over what is drawn; beside the surfaces in `result` where f jumps, on
/// both sides; and on them where solutions slide: the selection with d psi/dt = 0. Depends on the trajectory, never the
/// other way round.
/// @return nullopt unless the model has two states, both continuous, and its switching functions say all: no contacts,
///         no modes by `indicator`, no piecewise functions of states. Cost: about 1000 evaluations of f.
[[nodiscard]] std::optional<result::VectorField> vector_field(const model::System& system,
                                                              const result::Result& result);

/// Adds bodies, surfaces and vector field to `result`.
void add_drawings(const model::System& system, result::Result& result);

}  // namespace saltus::pipeline
