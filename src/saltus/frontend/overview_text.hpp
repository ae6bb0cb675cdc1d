// What `saltus check` says about a model, for people.
#pragma once

#include <string>

#include "saltus/io/check/model_overview.hpp"

namespace saltus::frontend {

/// Writes quantities, equations, surfaces, jumps, events, each part with its heading; the inclusion where another one
/// would differ.
[[nodiscard]] std::string overview_text(const io::ModelOverview& overview, const std::string& path);

/// Writes what specialists want to know of the inclusion.
[[nodiscard]] std::string inclusion_in_depth(const io::ModelOverview& overview);

[[nodiscard]] std::string warnings_text(const io::ModelOverview& overview);

}  // namespace saltus::frontend
