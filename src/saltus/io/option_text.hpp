// Values of options as they are typed.
#pragma once

#include <string_view>

#include "saltus/result/result.hpp"

namespace saltus::io {

/// Returns what a text on the command line states: true and false, a whole number, a number or an expression of
/// constants, a list of numbers, or else a word.
[[nodiscard]] result::OptionValue option_value(std::string_view text);

}  // namespace saltus::io
