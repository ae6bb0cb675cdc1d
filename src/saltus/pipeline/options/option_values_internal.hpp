// How values of options are read, checked and recorded: what the tables of options are made of.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "saltus/base/at.hpp"
#include "saltus/pipeline/options/option_fields.hpp"

namespace saltus::pipeline {

using result::OptionRecord;
using result::OptionValue;

inline Error out_of_range(std::string_view expected, const OptionValue& found) {
  return {ErrorCode::invalid_option, fmt::format("expected {}, found {}", expected, to_text(found)), "", {}, {}};
}

/// Returns the number a value states, whether it was written 1 or 1.0; NaN if it is none.
inline double number_in(const OptionValue& value) {
  if (const auto* real = std::get_if<double>(&value)) return *real;
  if (const auto* integer = std::get_if<std::int64_t>(&value)) return static_cast<double>(*integer);
  return std::numeric_limits<double>::quiet_NaN();
}

/// Returns the values in force of a table of options, under the name of their section.
template <class Options, class Fields>
OptionRecord record_of(const Options& options, std::string_view section, const Fields& fields) {
  OptionRecord record;
  record.reserve(fields.size());
  std::string key;
  for (const auto& field : fields) {
    key.assign(section).append(".").append(field.key);
    field.record(options, key, record);
  }
  return record;
}

enum class Range { finite, positive, not_negative };

constexpr std::string_view text(Range range) {
  switch (range) {
    case Range::finite:
      return "a finite number";
    case Range::positive:
      return "a finite number > 0";
    case Range::not_negative:
      return "a finite number >= 0";
  }
  __builtin_unreachable();
}

inline Expected<double> number_within(Range range, const OptionValue& value) {
  const double number = number_in(value);
  const bool fits = std::isfinite(number) && (range != Range::positive || number > 0.0) &&
                    (range != Range::not_negative || number >= 0.0);
  if (!fits) return tl::unexpected(out_of_range(text(range), value));
  return number;
}

template <auto access, Range range, class Options = SimulateOptions>
Expected<void> set_number(Options& options, std::string_view, const OptionValue& value) {
  return number_within(range, value).map([&](double number) { access(options) = number; });
}

template <auto access, class Options = SimulateOptions>
void record_number(const Options& options, std::string_view key, OptionRecord& record) {
  record.emplace_back(key, access(options));
}

template <auto access, class Options = SimulateOptions>
Expected<void> set_count(Options& options, std::string_view, const OptionValue& value) {
  // Written 1e6 it is a real number, and still a count.
  const double number = number_in(value);
  if (!(number >= 1.0 && number <= 9e15 && number == std::floor(number))) {
    return tl::unexpected(out_of_range("a whole number >= 1", value));
  }
  access(options) = static_cast<long>(number);
  return {};
}

template <auto access, class Options = SimulateOptions>
void record_count(const Options& options, std::string_view key, OptionRecord& record) {
  record.emplace_back(key, std::int64_t{access(options)});
}

template <auto access, class Options = SimulateOptions>
Expected<void> set_truth(Options& options, std::string_view, const OptionValue& value) {
  const auto* word = std::get_if<std::string>(&value);  // on the command line
  const auto* truth = std::get_if<bool>(&value);
  const bool yes = truth != nullptr ? *truth : word != nullptr && *word == "true";
  if (!yes && truth == nullptr && (word == nullptr || *word != "false")) {
    return tl::unexpected(out_of_range("true or false", value));
  }
  access(options) = yes;
  return {};
}

template <auto access, class Options = SimulateOptions>
void record_truth(const Options& options, std::string_view key, OptionRecord& record) {
  record.emplace_back(key, bool{access(options)});
}

/// Holds the spellings of an enum, and what they stand for.
template <class Enum, std::size_t n>
struct Choices {
  std::array<std::string_view, n> names;
  std::array<Enum, n> values;
};

template <auto access, const auto& choices, class Options = SimulateOptions>
Expected<void> set_choice(Options& options, std::string_view, const OptionValue& value) {
  const std::vector<std::string> known(choices.names.begin(), choices.names.end());
  const auto* word = std::get_if<std::string>(&value);
  if (word == nullptr) return tl::unexpected(out_of_range(fmt::format("\"{}\"", fmt::join(known, "\" or \"")), value));
  const auto found = std::find(known.begin(), known.end(), *word);
  if (found == known.end()) {
    auto error = out_of_range(fmt::format("\"{}\"", fmt::join(known, "\" or \"")), value);
    if (!nearest_names(*word, known).empty()) error.remedy = suggest(*word, known);
    return tl::unexpected(std::move(error));
  }
  access(options) = choices.values[at(found - known.begin())];
  return {};
}

template <auto access, const auto& choices, class Options = SimulateOptions>
void record_choice(const Options& options, std::string_view key, OptionRecord& record) {
  const auto* position = std::find(choices.values.begin(), choices.values.end(), access(options));
  record.emplace_back(key, std::string(choices.names[at(position - choices.values.begin())]));
}

/// Makes the rows of options of a simulation that are numbers, counts, truths or words.
template <auto access, Range range>
constexpr OptionField number_field(std::string_view key, std::string_view expects, std::string_view doc) {
  return {key, expects, doc, set_number<access, range>, record_number<access>};
}
template <auto access>
constexpr OptionField count_field(std::string_view key, std::string_view expects, std::string_view doc) {
  return {key, expects, doc, set_count<access>, record_count<access>};
}
template <auto access>
constexpr OptionField truth_field(std::string_view key, std::string_view expects, std::string_view doc) {
  return {key, expects, doc, set_truth<access>, record_truth<access>};
}
template <auto access, const auto& choices>
constexpr OptionField choice_field(std::string_view key, std::string_view expects, std::string_view doc) {
  return {key, expects, doc, set_choice<access, choices>, record_choice<access, choices>};
}

/// Returns the fields of [simulate.fesd] and [simulate.timestepping].
[[nodiscard]] std::span<const OptionField> element_fields();

}  // namespace saltus::pipeline
