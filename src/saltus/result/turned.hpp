// What a jump of [[hysteresis]] did, in a word.
#pragma once

#include <optional>
#include <string_view>

#include "saltus/result/result.hpp"

namespace saltus::result {

/// Returns "on" or "off" of a jump that turns the state of its name from 0 to 1 or back, as those of [[hysteresis]] do.
///
/// Pictures and tables have that word behind the name, which is the same for both. A state that ends elsewhere counts.
[[nodiscard]] std::optional<std::string_view> turned(const Event& event, const Result& result);

}  // namespace saltus::result
