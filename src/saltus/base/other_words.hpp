// What options, keys and words are called in other programs.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace saltus {

/// Returns those of the known names that a word of other programs stands for, in the order of `known`; dashes before a
/// name and tables before its last part are left out of account.
[[nodiscard]] std::vector<std::string> names_meant(std::string_view word, const std::vector<std::string>& known);

/// Does as nearest_names for options, keys and words of ours: one that is the same but for capitals is nearest, then
/// those that a word of other programs stands for.
[[nodiscard]] std::vector<std::string> nearest_words(const std::string& word, const std::vector<std::string>& known);
/// Does as suggest for options, keys and words of ours.
[[nodiscard]] std::string suggest_word(const std::string& word, const std::vector<std::string>& known);

}  // namespace saltus
