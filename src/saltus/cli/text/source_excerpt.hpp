// The line of a mistake, with a mark below its place.
#pragma once

#include <string>

#include "saltus/base/error.hpp"
#include "saltus/cli/exit_code.hpp"
#include "saltus/frontend/model_input.hpp"

namespace saltus::cli {

/// Returns to_text(error), with the source line and a caret behind its first line; without them for a place outside the
/// text.
[[nodiscard]] std::string with_source(const Error& error, const frontend::ModelText& source);

/// Prints it, and returns ExitCode::bad_input.
[[nodiscard]] ExitCode refuse_with_source(const Error& error, const frontend::ModelText& source);

}  // namespace saltus::cli
