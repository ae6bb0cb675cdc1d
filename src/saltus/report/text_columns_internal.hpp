// Text in columns for a terminal.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace saltus::report {

/// Returns the number of characters, not bytes: continuation bytes of UTF-8 take no place.
[[nodiscard]] std::size_t width(std::string_view text);

/// Returns at most `to` characters, the last one an ellipsis if something is left out.
[[nodiscard]] std::string shortened(const std::string& text, std::size_t to);

/// Writes pieces one after the other, broken into lines of the page, behind a label.
[[nodiscard]] std::string wrapped(std::string_view label, const std::vector<std::string>& pieces);

/// Writes words broken into lines of the page, behind a label.
[[nodiscard]] std::string paragraph(std::string_view label, std::string_view words);

using Row = std::vector<std::string>;

/// Writes rows with their entries below each other; columns that are empty everywhere are left out. At least one row.
[[nodiscard]] std::string aligned(const std::vector<Row>& rows);

}  // namespace saltus::report
