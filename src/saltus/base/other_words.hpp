// What options, keys and words are called in other programs.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace saltus {

/// Returns those of the known names that a word of other programs stands for, in the order of `known`; dashes before a
/// name and tables before its last part are left out of account.
[[nodiscard]] std::vector<std::string> names_meant(std::string_view word, const std::vector<std::string>& known);

}  // namespace saltus
