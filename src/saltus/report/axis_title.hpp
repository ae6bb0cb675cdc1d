// What an axis says.
#pragma once

#include <string>

#include <fmt/format.h>

namespace saltus::report {

/// Returns a name with its unit: "force [N]"; without one the name alone.
[[nodiscard]] inline std::string axis_title(const std::string& name, const std::string& unit) {
  return unit.empty() ? name : fmt::format("{} [{}]", name, unit);
}

}  // namespace saltus::report
