// What the tool prints, and where.
#pragma once

#include <optional>
#include <string_view>

#include "saltus/base/error.hpp"
#include "saltus/cli/exit_code.hpp"

namespace saltus::cli {

/// Writes to standard output. A reader that went away (a closed pipe) is no error.
void print(std::string_view text);

/// Returns whether something of what was printed could not be written, a closed pipe aside.
[[nodiscard]] std::optional<Error> lost_output();

/// Writes one line to standard error.
void print_error(std::string_view line);

/// Reports bad input on standard error.
[[nodiscard]] ExitCode refuse(const Error& error);

}  // namespace saltus::cli
