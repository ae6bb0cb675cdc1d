// A foreign problem with complementarities, and its options, for whoever solves it.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "saltus/base/error.hpp"
#include "saltus/foreign/problem.hpp"
#include "saltus/solver/solve.hpp"

namespace saltus::cli {

struct MpccInput {
  std::unique_ptr<foreign::Problem> problem;
  std::string sha256;  ///< of the file's bytes
};

/// Reads a file of another program, with what AMPL may have written beside an .nl file.
/// @return the problem; or what is wrong where, what was expected, and what to do
[[nodiscard]] Expected<MpccInput> read_mpcc(const std::string& file);

/// Changes an option of a solution: a key of [optimize.mpcc] without its table, or time_limit.
/// @param written  what a person wrote, for messages
[[nodiscard]] Expected<void> set_mpcc_option(solver::SolveOptions& options, std::string_view key,
                                             std::string_view value, const std::string& written);

}  // namespace saltus::cli
