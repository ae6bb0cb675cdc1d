// Text as it stands in a page: what its HTML and its scripts cannot take is escaped.
#pragma once

#include <string>
#include <string_view>

#include "saltus/result/result.hpp"

namespace saltus::report {

/// The style sheet of all pages: colours of both themes, cards, banners, buttons, paper.
[[nodiscard]] std::string_view page_style();

/// Writes text between tags, or in an attribute.
[[nodiscard]] std::string escape_html(std::string_view text);

/// Writes a value as JSON that can stand inside a <script> element whatever its strings contain; non-finite numbers are
/// null.
[[nodiscard]] std::string script_json(const result::OptionValue& value);
/// Writes an object of such values, in their order.
[[nodiscard]] std::string script_json(const result::OptionRecord& members);

}  // namespace saltus::report
