// Files of other programs that are taken for models: what they are, and where to read how to restate them.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "saltus/base/error.hpp"

namespace saltus::io {

/// Returns what to say of a file that is no model by its ending or its first bytes: SBML and other XML, an FMU,
/// Modelica, programs, tables, pictures; nullopt for others.
/// @param file  its name, for the place and for what its ending says
[[nodiscard]] std::optional<Error> other_format(std::string_view text, const std::string& file);

}  // namespace saltus::io
