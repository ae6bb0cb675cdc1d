// Directions and surfaces of what slides, by their entries.
#pragma once

#include "saltus/discretization/stage_kernel.hpp"
#include "saltus/fesd_integrator/element/active_set.hpp"
#include "saltus/linalg/sparse.hpp"

namespace saltus::fesd_integrator {

using SparseColumns = linalg::SparseColumns;
using SparseRows = linalg::SparseRows;

/// Returns f_alpha of the selections that slide in a set: n_x by n_sliding. Entries that can be other than 0 only, as
/// in the others.
[[nodiscard]] SparseColumns sliding_directions(const ActiveSet& set, const discretization::StageValues& at);
/// Returns the gradients of what is zero while they slide: n_sliding by n_x.
[[nodiscard]] SparseRows sliding_surfaces(const ActiveSet& set, const discretization::StageValues& at);
/// Returns f_x as it is; the values have to stay where they are.
[[nodiscard]] linalg::SparseView<linalg::Major::columns> field_by_state(const discretization::StageValues& at);

}  // namespace saltus::fesd_integrator
