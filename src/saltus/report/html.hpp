// A result as one self-contained HTML page that works offline.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "saltus/report/overlay.hpp"
#include "saltus/result/result.hpp"

namespace saltus::report {

/// Asked now and then while a page is made; false ends it.
using GoOn = std::function<bool()>;

/// Writes a page, in which numbers and plotly are deflated; the page inflates them.
/// @param plotly_source  the text of plotly.min.js, embedded into the page
/// @param overlays       other results of the model (check_overlay), drawn over it; their differences are shown
/// @return a complete HTML document, which depends on the results only; an empty one if it was ended.
[[nodiscard]] std::string to_html(const result::Result& result, std::string_view plotly_source,
                                  const std::vector<Overlay>& overlays = {}, const GoOn& go_on = {});

}  // namespace saltus::report
