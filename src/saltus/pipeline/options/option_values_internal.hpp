// How values of options are read, checked and recorded: what the tables of options are made of.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "saltus/base/at.hpp"
#include "saltus/pipeline/options/option_fields.hpp"

namespace saltus::pipeline {

using result::OptionRecord;
using result::OptionValue;

/// Returns the number a value states, whether it was written 1 or 1.0; NaN if it is none.
[[nodiscard]] double number_in(const OptionValue& value);

/// Checks a value and writes it into the options.
template <class Field, class Options>
Expected<void> set_option(const Field& field, Options& options, std::string_view name, const OptionValue& value) {
  auto fits = check(field.kind, value);
  if (fits) {
    field.set(options, name, value);
  } else if (field.explain != nullptr) {
    field.explain(fits.error(), value);
  }
  return fits;
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

/// What `access` returns of the options, by value.
template <auto access, class Options>
using MemberOf = std::remove_cvref_t<decltype(access(std::declval<Options&>()))>;

template <class Member>
OptionValue recorded(const Member& value) {
  if constexpr (std::is_same_v<Member, bool> || std::is_same_v<Member, double> || std::is_same_v<Member, std::string>) {
    return value;
  } else {
    return std::int64_t{value};
  }
}

template <auto access, class Options>
void record_member(const Options& options, std::string_view key, OptionRecord& record) {
  record.emplace_back(key, recorded(access(options)));
}

template <auto access, class Options>
void set_number(Options& options, std::string_view, const OptionValue& value) {
  access(options) = static_cast<MemberOf<access, Options>>(number_in(value));
}

template <auto access, class Options>
void set_truth(Options& options, std::string_view, const OptionValue& value) {
  access(options) = std::get<bool>(value);
}

/// Sets a number or a truth, or none where the value is a word.
template <auto access, class Options>
void set_or_none(Options& options, std::string_view, const OptionValue& value) {
  using Stated = typename MemberOf<access, Options>::value_type;
  auto& member = access(options);
  if (std::holds_alternative<std::string>(value)) {
    member.reset();
  } else if constexpr (std::is_same_v<Stated, bool>) {
    member = std::get<bool>(value);
  } else {
    member = static_cast<Stated>(number_in(value));
  }
}

template <auto access, const auto& none, class Options>
void record_or_none(const Options& options, std::string_view key, OptionRecord& record) {
  const auto& member = access(options);
  record.emplace_back(key, member ? recorded(*member) : OptionValue(std::string(none.front())));
}

/// Holds the spellings of an enum, and what they stand for.
template <class Enum, std::size_t n>
struct Choices {
  std::array<std::string_view, n> names;
  std::array<Enum, n> values;
};

template <auto access, const auto& choices, class Options>
void set_choice(Options& options, std::string_view, const OptionValue& value) {
  const auto* found = std::find(choices.names.begin(), choices.names.end(), std::get<std::string>(value));
  access(options) = choices.values[at(found - choices.names.begin())];
}

template <auto access, const auto& choices, class Options>
void record_choice(const Options& options, std::string_view key, OptionRecord& record) {
  const auto* position = std::find(choices.values.begin(), choices.values.end(), access(options));
  record.emplace_back(key, std::string(choices.names[at(position - choices.values.begin())]));
}

/// Makes the rows of options that are numbers, numbers or a word for none, truths or words.
template <auto access, class Options = SimulateOptions>
constexpr FieldOf<Options> number_field(std::string_view key, const Numbers& numbers, std::string_view doc) {
  return {key, {.number = numbers}, doc, set_number<access, Options>, record_member<access, Options>};
}
template <auto access, const auto& none, class Options = SimulateOptions>
constexpr FieldOf<Options> number_or_none_field(std::string_view key, const Numbers& numbers, std::string_view doc) {
  return {key,
          {.words = none, .number = numbers},
          doc,
          set_or_none<access, Options>,
          record_or_none<access, none, Options>};
}
template <auto access, const auto& none, class Options = SimulateOptions>
constexpr FieldOf<Options> truth_or_none_field(std::string_view key, std::string_view doc) {
  return {
      key, {.words = none, .truth = true}, doc, set_or_none<access, Options>, record_or_none<access, none, Options>};
}
template <auto access, class Options = SimulateOptions>
constexpr FieldOf<Options> truth_field(std::string_view key, std::string_view doc) {
  return {key, {.truth = true}, doc, set_truth<access, Options>, record_member<access, Options>};
}
template <auto access, const auto& choices, class Options = SimulateOptions>
constexpr FieldOf<Options> choice_field(std::string_view key, std::string_view doc,
                                        void (*explain)(Error&, const OptionValue&) = nullptr) {
  return {key,
          {.words = choices.names},
          doc,
          set_choice<access, choices, Options>,
          record_choice<access, choices, Options>,
          explain};
}

inline constexpr Numbers any_number{}, positive_number{.above = 0.0}, not_negative_number{.from = 0.0},
    counting_number{.whole = true, .from = 1.0};
/// The words of numbers that there may be none of.
inline constexpr std::array<std::string_view, 1> none_word{"none"}, off_word{"off"}, auto_word{"auto"};

/// Returns the fields of [simulate.fesd] and [simulate.timestepping].
[[nodiscard]] std::span<const OptionField> element_fields();

}  // namespace saltus::pipeline
