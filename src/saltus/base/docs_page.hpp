// Where messages find pages of the documentation: the only place that says it.
#pragma once

#include <string>
#include <string_view>

namespace saltus {

/// Is empty in a build from source; scripts/name_urls.py writes the address of a release, with its last slash.
inline constexpr std::string_view docs_address = "";

/// Returns the address of a page, as docs/limits.md; in a release that of its page limits.html.
/// @param anchor  a heading of the page in the form of links, or nothing
[[nodiscard]] std::string docs_page(std::string_view page, std::string_view anchor = {});

}  // namespace saltus
