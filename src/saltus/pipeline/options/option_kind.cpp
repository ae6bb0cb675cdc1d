#include "saltus/pipeline/options/option_kind.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <variant>
#include <vector>

#include <fmt/format.h>

#include "saltus/base/contains.hpp"
#include "saltus/base/other_words.hpp"
#include "saltus/pipeline/options/option_values_internal.hpp"

namespace saltus::pipeline {
namespace {

/// Whole numbers up to this one are doubles without gaps.
constexpr double most_whole = 9e15;

bool are_among(const Numbers& numbers, double value) {
  const auto& [whole, above, from, below, up_to, above_option] = numbers;
  return std::isfinite(value) && (!whole || (value == std::floor(value) && std::abs(value) <= most_whole)) &&
         (!above || value > *above) && (!from || value >= *from) && (!below || value < *below) &&
         (!up_to || value <= *up_to);
}

/// "a finite number > 0", "a whole number from 2 to 64".
std::string text(const Numbers& numbers) {
  const auto& [whole, above, from, below, up_to, above_option] = numbers;
  if (whole && from && up_to) return fmt::format("a whole number from {} to {}", *from, *up_to);
  std::vector<std::string> bounds;
  if (above) bounds.push_back(fmt::format(" > {}", *above));
  if (from) bounds.push_back(fmt::format(" >= {}", *from));
  if (below) bounds.push_back(fmt::format(" < {}", *below));
  if (up_to) bounds.push_back(fmt::format(" <= {}", *up_to));
  const bool bounded = (above || from) && (below || up_to);
  return fmt::format("a {}number{}", whole ? "whole " : bounded ? "" : "finite ", fmt::join(bounds, " and"));
}

std::string text(ListOf list, std::string_view pattern) {
  switch (list) {
    case ListOf::nothing:
      return "";
    case ListOf::the_same:
      return "a list of them";
    case ListOf::increasing_numbers:
      return "a list of finite, increasing numbers";
    case ListOf::names:
      return fmt::format("a list of names, or of patterns like {}", pattern);
  }
  __builtin_unreachable();
}

/// Single values, and behind them what has no end.
struct Alternatives {
  std::vector<std::string> single, many;
};

Alternatives alternatives(const OptionKind& kind, std::string_view quote) {
  Alternatives all;
  for (const auto word : kind.words) all.single.push_back(fmt::format("{0}{1}{0}", quote, word));
  for (const int value : kind.values) all.single.push_back(fmt::format("{}", value));
  if (kind.truth) all.single.insert(all.single.end(), {"true", "false"});
  if (kind.number) all.many.push_back(text(*kind.number));
  if (kind.list != ListOf::nothing) all.many.push_back(text(kind.list, kind.pattern));
  return all;
}

/// "auto" or "off", as a person would write it.
std::string expected(const OptionKind& kind) {
  auto [all, many] = alternatives(kind, "\"");
  all.insert(all.end(), many.begin(), many.end());
  const auto last = all.back();
  all.pop_back();
  return all.empty() ? last : fmt::format("{} or {}", fmt::join(all, ", "), last);
}

/// The first place where numbers do not increase.
std::optional<std::size_t> first_decrease(const std::vector<double>& list) {
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (!std::isfinite(list[i]) || (i > 0 && !(list[i - 1] < list[i]))) return i;
  }
  return std::nullopt;
}

bool fits(const OptionKind& kind, const OptionValue& value) {
  const auto is_one = [&](double number) {
    return contains(kind.values, number) || (kind.number && are_among(*kind.number, number));
  };
  if (std::holds_alternative<bool>(value)) return kind.truth;
  if (const auto* word = std::get_if<std::string>(&value)) {
    return kind.list == ListOf::names || contains(kind.words, *word);
  }
  if (std::holds_alternative<std::vector<std::string>>(value)) return kind.list == ListOf::names;
  if (const auto* list = std::get_if<std::vector<double>>(&value)) {
    if (list->empty()) return kind.list == ListOf::names;  // nobody can see of what it is a list
    if (kind.list == ListOf::increasing_numbers) return !first_decrease(*list);
    return kind.list == ListOf::the_same && std::all_of(list->begin(), list->end(), is_one);
  }
  return is_one(number_in(value));
}

}  // namespace

double number_in(const OptionValue& value) {
  if (const auto* real = std::get_if<double>(&value)) return *real;
  if (const auto* integer = std::get_if<std::int64_t>(&value)) return static_cast<double>(*integer);
  return std::numeric_limits<double>::quiet_NaN();
}

std::string expects(const OptionKind& kind) {
  auto [single, many] = alternatives(kind, "");
  if (kind.number && !kind.number->above_option.empty())
    many.front() += fmt::format(" > `{}`", kind.number->above_option);
  if (!single.empty()) many.insert(many.begin(), fmt::format("{}", fmt::join(single, ", ")));
  return fmt::format("{}", fmt::join(many, ", or "));
}

Expected<void> check(const OptionKind& kind, const OptionValue& value) {
  if (fits(kind, value)) return {};
  Error error{
      ErrorCode::invalid_option, fmt::format("expected {}, found {}", expected(kind), to_text(value)), "", {}, {}};
  if (const auto* word = std::get_if<std::string>(&value)) {
    const std::vector<std::string> known(kind.words.begin(), kind.words.end());
    if (!nearest_words(*word, known).empty()) error.remedy = suggest_word(*word, known);
  }
  const auto* list = std::get_if<std::vector<double>>(&value);
  if (list != nullptr && !list->empty() && kind.list == ListOf::increasing_numbers) {
    const std::size_t i = *first_decrease(*list);
    error.message = fmt::format("expected {}, found {} at place {}{}", expected(kind), (*list)[i], i + 1,
                                i == 0 ? "" : fmt::format(", after {}", (*list)[i - 1]));
    error.remedy = "sort the times and write each once";
  }
  return tl::unexpected(std::move(error));
}

}  // namespace saltus::pipeline
