// The one table of the keys of [optimize.mpcc], which `saltus mpcc` takes as --set mpcc.KEY=VALUE.
#pragma once

#include <span>
#include <string_view>

#include "saltus/base/error.hpp"
#include "saltus/pipeline/options/option_fields.hpp"
#include "saltus/result/result.hpp"
#include "saltus/solver/solve.hpp"

namespace saltus::pipeline {

using MpccField = FieldOf<solver::SolveOptions>;

/// Returns the keys of [optimize.mpcc], in the order of the documentation; `solver` is not among them, as it is no
/// option of the method.
[[nodiscard]] std::span<const MpccField> mpcc_fields();

/// Changes one option.
/// @param key    below [optimize.mpcc]
/// @param value  as written; integers are taken where numbers are expected
/// @return unknown_name (with the nearest keys) or invalid_option (what was expected and found), without a location.
[[nodiscard]] Expected<void> set_mpcc_option(solver::SolveOptions& options, std::string_view key,
                                             const result::OptionValue& value);

/// Finds what is wrong between options that are fine one by one: sigma_final above sigma_initial.
[[nodiscard]] Expected<void> check_mpcc_options(const solver::SolveOptions& options);

}  // namespace saltus::pipeline
