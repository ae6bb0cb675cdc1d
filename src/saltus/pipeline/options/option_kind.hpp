// Which values an option takes: what is said about it, its check and its schema follow from that.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "saltus/base/error.hpp"
#include "saltus/result/result.hpp"

namespace saltus::pipeline {

/// Holds finite numbers within bounds.
struct Numbers {
  bool whole = false;
  std::optional<double> above{}, from{}, below{}, up_to{};  ///< >, >=, <, <=
  /// An option that they are above, too; checked where options are checked against each other.
  std::string_view above_option{};
};

enum class ListOf {
  nothing,             ///< no list
  the_same,            ///< what the option may be by itself: its numbers
  increasing_numbers,  ///< at least one
  names,               ///< or patterns; a word by itself is a list of one
};

/// Says which values an option takes: any of what it has.
struct OptionKind {
  std::span<const std::string_view> words{};
  std::span<const int> values{};
  bool truth = false;
  std::optional<Numbers> number{};
  ListOf list = ListOf::nothing;
  std::string_view pattern{};  ///< an example of ListOf::names: "v*"
};

/// Returns what an option takes for a table of options: "none, or a finite number > 0", "auto, on, off".
[[nodiscard]] std::string expects(const OptionKind& kind);

/// Checks a value.
/// @return invalid_option with what was expected and found, and the word that may be meant; without a location.
[[nodiscard]] Expected<void> check(const OptionKind& kind, const result::OptionValue& value);

}  // namespace saltus::pipeline
