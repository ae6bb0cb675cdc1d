#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "saltus/io/atomic_file.hpp"
#include "saltus/io/optimize/number_rows_internal.hpp"
#include "saltus/io/separated_line_internal.hpp"
#include "saltus/io/text_encoding_internal.hpp"

namespace saltus::io {
namespace {

/// The lines of a text, without the ends of lines, as on Windows.
std::string_view next_line(std::string_view& text) {
  const auto end = std::min(text.find('\n'), text.size());
  auto line = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  if (line.ends_with('\r')) line.remove_suffix(1);
  return line;
}

Error row_mistake(const std::string& file, int line, std::string message, std::string remedy) {
  return {ErrorCode::parse_failure, std::move(message), std::move(remedy), {file, line, line > 0 ? 1 : 0}, {}};
}

bool is_header(const std::vector<std::string_view>& fields) {
  return std::none_of(fields.begin(), fields.end(), [](auto field) { return separated_number(field).has_value(); });
}

}  // namespace

Expected<NumberRows> parse_rows(std::string_view text, const std::string& file, std::size_t columns,
                                const std::string& what) {
  constexpr std::size_t shown = 40;
  if (auto readable = check_is_text(text, file, data_remedy); !readable) return tl::unexpected(readable.error());
  NumberRows found;
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  bool begins = true;
  for (int line_number = 1; !text.empty(); ++line_number) {
    const auto line = next_line(text);
    if (line.find_first_not_of(" \t") == std::string_view::npos || line.starts_with('#')) continue;
    const auto fields = separated_fields(line);
    const bool skipped = begins && is_header(fields);
    begins = false;
    if (skipped) continue;
    if (fields.size() != columns) {
      return tl::unexpected(row_mistake(
          file, line_number,
          fmt::format("expected {} number{}, found {}", columns, columns == 1 ? "" : "s", fields.size()), what));
    }
    auto& row = found.rows.emplace_back();
    found.places.push_back({file, line_number, 1});
    for (const auto field : fields) {
      const auto number = separated_number(field);
      if (!number || !std::isfinite(*number)) {
        return tl::unexpected(row_mistake(file, line_number,
                                          fmt::format("expected a finite number, found '{}'", field.substr(0, shown)),
                                          "columns are separated by commas, decimals by a point"));
      }
      row.push_back(*number);
    }
  }
  if (found.rows.empty())
    return tl::unexpected(row_mistake(file, 0, "the file has no rows of numbers", "write one per line"));
  return found;
}

}  // namespace saltus::io
