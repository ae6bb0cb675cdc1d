// What `saltus check` says about a model, for people.
#pragma once

#include <string>

#include "saltus/io/check/model_overview.hpp"

namespace saltus::frontend {

/// Writes quantities, equations, surfaces, jumps, events, inclusion; each part with its heading.
[[nodiscard]] std::string overview_text(const io::ModelOverview& overview, const std::string& path);

[[nodiscard]] std::string warnings_text(const io::ModelOverview& overview);

}  // namespace saltus::frontend
