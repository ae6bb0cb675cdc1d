// Places and errors of --set.
#pragma once

#include <string>
#include <string_view>

#include "saltus/base/error.hpp"

namespace saltus::io {

/// "--set KEY" as the place of an error.
[[nodiscard]] SourceLocation place_of_setting(std::string_view key);

/// An error of --set KEY=VALUE.
[[nodiscard]] tl::unexpected<Error> refused_setting(std::string_view key, ErrorCode code, std::string message,
                                                    std::string remedy);

}  // namespace saltus::io
