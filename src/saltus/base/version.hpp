// The version of Saltus: the only place that states it (CMake and the package read this line).
#pragma once

#include <string_view>

namespace saltus {

inline constexpr std::string_view version = "0.1.0";

}  // namespace saltus
