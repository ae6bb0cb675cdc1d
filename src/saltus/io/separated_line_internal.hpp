// A line of a file of numbers: fields between commas, semicolons, tabs or spaces.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

namespace saltus::io {

/// Returns the fields of a line. It is separated by semicolons if there are some, else by commas, else by tabs, between
/// which a field may be empty; else by spaces. Quotes around a field are taken away.
[[nodiscard]] std::vector<std::string_view> separated_fields(std::string_view line);

/// Returns the number a field states, may begin with +; nullopt if it is none.
[[nodiscard]] std::optional<double> separated_number(std::string_view field);

}  // namespace saltus::io
