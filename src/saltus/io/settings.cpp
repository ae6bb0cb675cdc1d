// --set of dotted keys.
#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <utility>

#include <fmt/format.h>

#include "saltus/expression/parser.hpp"
#include "saltus/io/constant_value_internal.hpp"
#include "saltus/io/toml_model.hpp"
#include "saltus/io/toml_sections_internal.hpp"
#include "saltus/pipeline/option_fields.hpp"

namespace saltus::io {
namespace {

using result::OptionValue;

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  return text;
}

template <class Number>
std::optional<Number> whole_text_as(std::string_view text) {
  Number number{};
  const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (failure != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return number;
}

std::optional<double> constant_in(std::string_view text) {
  if (const auto number = whole_text_as<double>(text)) return number;
  const auto tree = expression::parse(text, {});
  return tree ? constant_value(**tree) : std::nullopt;
}

std::optional<std::vector<double>> list_in(std::string_view text) {
  if (!text.starts_with('[') || !text.ends_with(']')) return std::nullopt;
  text = text.substr(1, text.size() - 2);
  std::vector<double> list;
  while (!text.empty()) {
    const auto comma = std::min(text.find(','), text.size());
    const auto number = constant_in(trimmed(text.substr(0, comma)));
    if (!number) return std::nullopt;
    list.push_back(*number);
    text.remove_prefix(std::min(comma + 1, text.size()));
  }
  return list;
}

/// What a text on the command line states: true and false, a whole number, a number or an expression of constants, a
/// list of numbers, or else a word.
OptionValue option_value(std::string_view text) {
  text = trimmed(text);
  if (text == "true" || text == "false") return text == "true";
  if (const auto integer = whole_text_as<std::int64_t>(text)) return *integer;
  if (const auto number = constant_in(text)) return *number;
  if (auto list = list_in(text)) return std::move(*list);
  return std::string(text);
}

SourceLocation place_of(std::string_view key) { return {fmt::format("--set {}", key), 0, 0}; }

tl::unexpected<Error> refused(std::string_view key, ErrorCode code, std::string message, std::string remedy) {
  return tl::unexpected(Error{code, std::move(message), std::move(remedy), place_of(key), {}});
}

/// The expression that `path` ("q", "q.lower") names within a table, or null.
expression::NodePtr* place_in(std::vector<model::NamedExpression>& list, std::string_view path) {
  const auto found = std::find_if(list.begin(), list.end(), [&](const auto& item) { return item.name == path; });
  return found == list.end() ? nullptr : &found->expression;
}

template <class Quantity>
expression::NodePtr* place_in(std::vector<Quantity>& list, std::string_view path) {
  const auto dot = std::min(path.find('.'), path.size());
  const auto part = path.substr(std::min(dot + 1, path.size()));
  for (auto& item : list) {
    if (item.name != path.substr(0, dot)) continue;
    if (part.empty() || part == "initial") return &item.initial;
    if (part == "lower") return &item.lower;
    if (part == "upper") return &item.upper;
  }
  return nullptr;
}

template <class Item>
std::vector<std::string> names_of(const std::vector<Item>& list) {
  std::vector<std::string> names;
  for (const auto& item : list) names.push_back(item.name);
  return names;
}

/// What stands behind the table's name: "q.lower" of "states.q.lower".
std::string_view path_in(std::string_view key) { return key.substr(std::min(key.find('.'), key.size() - 1) + 1); }

template <auto member>
Expected<void> set_expression(model::Description& description, std::string_view key, std::string_view value) {
  auto& list = description.*member;
  const auto path = path_in(key);
  auto* place = place_in(list, path);
  if (place == nullptr) {
    const auto known = names_of(list);
    const auto name = std::string(path.substr(0, path.find('.')));
    if (name.size() < path.size() && std::find(known.begin(), known.end(), name) != known.end()) {
      return refused(key, ErrorCode::unknown_name,
                     fmt::format("'{}' is no part of '{}'", path.substr(name.size() + 1), name),
                     "states and controls have the parts initial, lower and upper; other names have none");
    }
    return refused(key, ErrorCode::unknown_name, fmt::format("the model has no '{}' there", path),
                   known.empty() ? "--set changes what the file states and adds nothing" : suggest(name, known));
  }
  auto tree = expression::parse(value, place_of(key), names_of(description.tables));
  if (!tree) return tl::unexpected(tree.error());
  *place = std::move(*tree);
  return {};
}

Expected<void> set_model_key(model::Description& description, std::string_view full_key, std::string_view value) {
  const auto key = path_in(full_key);
  if (key == "name") {
    description.name = value;
  } else if (key == "description") {
    description.description = value;
  } else if (key == "inclusion") {
    auto inclusion = inclusion_named(std::string(value));
    if (!inclusion) {
      inclusion.error().location = place_of(full_key);
      return tl::unexpected(inclusion.error());
    }
    description.inclusion = *inclusion;
  } else {
    return refused(full_key, ErrorCode::unknown_name, fmt::format("[model] has no key '{}'", key),
                   suggest(std::string(key), {"name", "description", "inclusion"}));
  }
  return {};
}

struct SettableTable {
  std::string_view name;
  Expected<void> (*set)(model::Description&, std::string_view key, std::string_view value);
};
constexpr std::array settable{
    SettableTable{"model", set_model_key},
    SettableTable{"parameters", set_expression<&model::Description::parameters>},
    SettableTable{"states", set_expression<&model::Description::states>},
    SettableTable{"controls", set_expression<&model::Description::controls>},
    SettableTable{"definitions", set_expression<&model::Description::definitions>},
    SettableTable{"switching", set_expression<&model::Description::switching>},
    SettableTable{"dynamics", set_expression<&model::Description::dynamics>},
    SettableTable{"outputs", set_expression<&model::Description::outputs>},
};

/// Tables of a model file whose entries have no name of their own, or that --set does not reach for another reason.
constexpr std::array fixed{"modes", "events", "jumps", "tables", "mechanics", "contacts", "optimize", "sensitivity"};

tl::unexpected<Error> not_settable(std::string_view key, std::string_view table) {
  if (std::find(fixed.begin(), fixed.end(), table) != fixed.end()) {
    return refused(key, ErrorCode::invalid_option, fmt::format("nothing in '{}' can be set on the command line", table),
                   "write a parameter there, and set that: --set NAME=VALUE");
  }
  std::vector<std::string> known{"simulate"};
  for (const auto& candidate : settable) known.emplace_back(candidate.name);
  return refused(key, ErrorCode::unknown_name, fmt::format("'{}' is no table of a model file", table),
                 suggest(std::string(table), known));
}

Expected<void> set_input_expression(model::Description& description, std::string_view name, std::string_view value) {
  auto tree = expression::parse(value, place_of(fmt::format("simulate.inputs.{}", name)), names_of(description.tables));
  if (!tree) return tl::unexpected(tree.error());
  std::erase_if(description.sampled_inputs, [&](const auto& input) { return input.name == name; });
  if (auto* place = place_in(description.inputs, name); place != nullptr) {
    *place = std::move(*tree);
  } else {
    description.inputs.push_back(
        {std::string(name), std::move(*tree), place_of(fmt::format("simulate.inputs.{}", name))});
  }
  return {};
}

/// simulate.inputs.u.file=… and simulate.inputs.u.result=…, relative to the working folder.
Expected<void> set_samples(model::Description& description, std::string_view name, std::string_view source,
                           std::string_view file) {
  const auto place = place_of(fmt::format("simulate.inputs.{}.{}", name, source));
  auto input = sampled_input(std::string(name), source, std::string(file), place);
  if (!input) return tl::unexpected(input.error());
  const auto same = [&](const auto& other) { return other.name == name; };
  std::erase_if(description.sampled_inputs, same);
  std::erase_if(description.inputs, same);
  description.sampled_inputs.push_back(std::move(*input));
  return {};
}

Expected<void> set_input(model::Description& description, std::string_view path, std::string_view value) {
  const auto dot = path.find('.');
  if (dot == std::string_view::npos) return set_input_expression(description, path, value);
  const auto source = path.substr(dot + 1);
  if (source == "file" || source == "result") return set_samples(description, path.substr(0, dot), source, value);
  return refused(fmt::format("simulate.inputs.{}", path), ErrorCode::unknown_name,
                 fmt::format("an input has no key '{}'", source), suggest(std::string(source), {"file", "result"}));
}

}  // namespace

Expected<pipeline::SimulateOptions> with_option(pipeline::SimulateOptions options, std::string_view key,
                                                std::string_view value) {
  constexpr std::string_view root = "simulate.";
  if (!key.starts_with(root)) {
    return refused(key, ErrorCode::unknown_name, fmt::format("unknown option {}", key), "options begin with simulate.");
  }
  auto changed = pipeline::with_value(std::move(options), key.substr(root.size()), option_value(value));
  if (!changed) changed.error().location = place_of(key);
  return changed;
}

Expected<void> set_option(ModelFile& model, std::string_view key, std::string_view value,
                          const SourceLocation& location) {
  auto options = with_option(model.simulate, key, value);
  if (!options) {
    options.error().location = location;
    return tl::unexpected(options.error());
  }
  model.simulate = std::move(*options);
  model.option_locations.emplace_back(key.substr(key.find('.') + 1), location);
  return {};
}

Expected<ModelFile> with_setting(ModelFile model, std::string_view key, std::string_view value) {
  constexpr std::string_view inputs = "simulate.inputs.";
  const auto dot = std::min(key.find('.'), key.size());
  const auto table = key.substr(0, dot);
  Expected<void> done;
  if (key.starts_with(inputs)) {
    done = set_input(model.description, key.substr(inputs.size()), value);
  } else if (table == "simulate") {
    done = set_option(model, key, value, place_of(key));
  } else {
    const auto same = [&](const auto& candidate) { return candidate.name == table; };
    const auto* found = std::find_if(settable.begin(), settable.end(), same);
    if (found == settable.end()) return not_settable(key, table);
    done = found->set(model.description, key, value);
  }
  if (!done) return tl::unexpected(done.error());
  return model;
}

}  // namespace saltus::io
