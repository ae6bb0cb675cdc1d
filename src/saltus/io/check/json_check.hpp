// What `saltus check` says, as JSON (format saltus-check/1).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "saltus/base/error.hpp"
#include "saltus/io/check/model_overview.hpp"
#include "saltus/pipeline/optimal_control/describe_ocp.hpp"

namespace saltus::io {

/// Writes one object on one or more lines: file, valid, errors, and of a valid model what it says. Infinite bounds are
/// null.
/// @param overview      null for a model with errors
/// @param optimization  sizes of [optimize]; null without it
[[nodiscard]] std::string check_json(const std::string& file, const std::vector<Error>& errors,
                                     const ModelOverview* overview, const pipeline::OcpOverview* optimization);

}  // namespace saltus::io
