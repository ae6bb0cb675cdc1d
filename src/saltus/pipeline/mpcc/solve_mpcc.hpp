// From a foreign MPCC to a certified point.
#pragma once

#include <optional>
#include <vector>

#include "saltus/base/error.hpp"
#include "saltus/foreign/problem.hpp"
#include "saltus/result/mpcc_result.hpp"
#include "saltus/solver/solve.hpp"

namespace saltus::pipeline {

/// Solves the problem from its own start, or from `x`: relaxed problems with Ipopt, branch problems, certificate.
/// @param options  with interrupt and observer
/// @param x        values of the file's variables, in its order
/// @return the result whatever the numerics did (see its status), without file and fingerprint; an Error for options
///         outside their ranges, an x of another length, and functions that are not finite at the start.
[[nodiscard]] Expected<result::MpccResult> solve_mpcc(foreign::Problem& problem, const solver::SolveOptions& options,
                                                      const std::optional<std::vector<double>>& x = std::nullopt);

}  // namespace saltus::pipeline
