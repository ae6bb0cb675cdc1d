// What the models of a sweep are warned of.
#pragma once

#include <string>
#include <vector>

#include "saltus/pipeline/sweep.hpp"

namespace saltus::frontend {

/// Returns every warning once, in the order of their first runs, with the numbers of its runs behind it. Equal texts,
/// of several shares, are one warning; one that names no run holds for all, and comes first.
[[nodiscard]] std::vector<std::string> told_with_runs(const std::vector<pipeline::SweepWarning>& warnings);

}  // namespace saltus::frontend
