// Drawings as files of other formats, and pages shown: what other programs of the system do.
#pragma once

#include <string>
#include <vector>

#include "saltus/base/error.hpp"

namespace saltus::cli {

/// Checks whether a drawing can be written as this file: .svg always, .pdf and .png where librsvg's program is
/// installed.
[[nodiscard]] Expected<void> check_figure(const std::string& file);

/// Writes an SVG document as the format of the file's suffix, whole or not at all.
[[nodiscard]] Expected<void> write_figure(const std::string& file, const std::string& svg);

/// Shows a page with $BROWSER, else xdg-open, and does not wait for it.
[[nodiscard]] Expected<void> open_page(const std::string& page);

}  // namespace saltus::cli
