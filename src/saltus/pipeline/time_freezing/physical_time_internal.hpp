// Rows and events of a run in numerical time become those of physical time.
#pragma once

#include <string>
#include <vector>

#include "saltus/result/result.hpp"

namespace saltus::model {
struct Layout;
struct TimeFreezing;
}  // namespace saltus::model

namespace saltus::pipeline {

/// Leaves out what lies between two rows of one physical time; what the state did there is one event: a jump, an
/// impact, or a change of what touches. Columns that freezing has added are left out, too.
/// @param layout, freezing  of a frozen system
/// @param standing  a clock that gains less stands; at least its rounding
/// @param run  trajectory, events and end of the run; they are replaced
/// @return names of the switching functions that are left
[[nodiscard]] std::vector<std::string> to_physical_time(const model::Layout& layout,
                                                        const model::TimeFreezing& freezing, double standing,
                                                        result::Result& run);

/// Returns the states of a frozen system that are columns of a result, from all.
[[nodiscard]] std::vector<double> shown_states(const model::TimeFreezing& freezing, const std::vector<double>& x);

}  // namespace saltus::pipeline
