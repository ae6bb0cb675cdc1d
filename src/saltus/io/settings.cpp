// --set of dotted keys.
#include <algorithm>
#include <array>
#include <utility>

#include <fmt/format.h>

#include "saltus/base/contains.hpp"
#include "saltus/base/other_words.hpp"
#include "saltus/expression/parser.hpp"
#include "saltus/io/optimize/toml_optimize_internal.hpp"
#include "saltus/io/option_text.hpp"
#include "saltus/io/setting_values_internal.hpp"
#include "saltus/io/toml/toml_model.hpp"
#include "saltus/io/toml/toml_sections_internal.hpp"
#include "saltus/pipeline/options/option_fields.hpp"

namespace saltus::io {
namespace {

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

void put_in_place(model::Description& description, expression::NodePtr& place, expression::NodePtr tree) {
  if (place) description.replaced.push_back(std::move(place));
  place = std::move(tree);
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
    if (name.size() < path.size() && contains(known, name)) {
      return refused_setting(key, ErrorCode::unknown_name,
                             fmt::format("'{}' is no part of '{}'", path.substr(name.size() + 1), name),
                             "states and controls have the parts initial, lower and upper; other names have none");
    }
    return refused_setting(
        key, ErrorCode::unknown_name, fmt::format("the model has no '{}' there", path),
        known.empty() ? "--set changes what the file states and adds nothing" : suggest(name, known));
  }
  auto tree = expression::parse(value, place_of_setting(key), names_of(description.tables));
  if (!tree) return tl::unexpected(tree.error());
  put_in_place(description, *place, std::move(*tree));
  return {};
}

/// parameters.k, and parameters.k.lower of a free one.
Expected<void> set_parameter(model::Description& description, std::string_view key, std::string_view value) {
  const auto path = path_in(key);
  const auto dot = std::min(path.find('.'), path.size());
  const auto part = path.substr(std::min(dot + 1, path.size()));
  for (auto& parameter : description.free_parameters) {
    if (parameter.name != path.substr(0, dot) || part.empty()) continue;
    if (part == "initial") break;
    if (part != "lower" && part != "upper") continue;
    auto tree = expression::parse(value, place_of_setting(key), names_of(description.tables));
    if (!tree) return tl::unexpected(tree.error());
    (part == "lower" ? parameter.lower : parameter.upper) = std::move(*tree);
    return {};
  }
  const bool initial = part == "initial";
  return set_expression<&model::Description::parameters>(description, initial ? key.substr(0, key.rfind('.')) : key,
                                                         value);
}

/// states.q, states.q.lower, and states.q.free=true.
Expected<void> set_state(model::Description& description, std::string_view key, std::string_view value) {
  const auto path = path_in(key);
  if (!path.ends_with(".free")) return set_expression<&model::Description::states>(description, key, value);
  const auto name = path.substr(0, path.rfind('.'));
  const auto found = std::find_if(description.states.begin(), description.states.end(),
                                  [&](const auto& state) { return state.name == name; });
  if (found == description.states.end()) {
    return refused_setting(key, ErrorCode::unknown_name, fmt::format("the model has no state '{}'", name),
                           suggest(std::string(name), names_of(description.states)));
  }
  if (value != "true" && value != "false") {
    return refused_setting(key, ErrorCode::invalid_option, fmt::format("expected true or false, found {}", value), "");
  }
  found->free = value == "true";
  if (!found->free || (found->lower && found->upper)) return {};
  return refused_setting(key, ErrorCode::invalid_option, fmt::format("'{}' has no two bounds", name),
                         "what is optimised needs `lower` and `upper` in [states]");
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
      inclusion.error().location = place_of_setting(full_key);
      return tl::unexpected(inclusion.error());
    }
    description.inclusion = *inclusion;
  } else {
    return refused_setting(full_key, ErrorCode::unknown_name, fmt::format("[model] has no key '{}'", key),
                           suggest_word(std::string(key), {"name", "description", "inclusion"}));
  }
  return {};
}

struct SettableTable {
  std::string_view name;
  Expected<void> (*set)(model::Description&, std::string_view key, std::string_view value);
};
constexpr std::array settable{
    SettableTable{"model", set_model_key},
    SettableTable{"parameters", set_parameter},
    SettableTable{"states", set_state},
    SettableTable{"controls", set_expression<&model::Description::controls>},
    SettableTable{"definitions", set_expression<&model::Description::definitions>},
    SettableTable{"switching", set_expression<&model::Description::switching>},
    SettableTable{"dynamics", set_expression<&model::Description::dynamics>},
    SettableTable{"outputs", set_expression<&model::Description::outputs>},
};

/// Tables of a model file whose entries have no name of their own, or that --set does not reach for another reason.
constexpr std::array fixed{"modes", "events", "jumps", "tables", "mechanics", "contacts", "sensitivity", "hysteresis"};

tl::unexpected<Error> not_settable(std::string_view key, std::string_view table) {
  if (contains(fixed, table)) {
    return refused_setting(key, ErrorCode::invalid_option,
                           fmt::format("nothing in '{}' can be set on the command line", table),
                           "write a parameter there, and set that: --set NAME=VALUE");
  }
  const auto options = pipeline::simulate_keys();
  if (contains(options, key)) {
    return refused_setting(key, ErrorCode::unknown_name, fmt::format("'{}' is a table of [simulate]", table),
                           fmt::format("write simulate.{}", key));
  }
  std::vector<std::string> known{"simulate", "optimize", "time_freezing"};
  for (const auto& candidate : settable) known.emplace_back(candidate.name);
  return refused_setting(key, ErrorCode::unknown_name, fmt::format("'{}' is no table of a model file", table),
                         suggest_word(std::string(table), known));
}

Expected<void> set_input_expression(model::Description& description, std::string_view name, std::string_view value) {
  auto tree =
      expression::parse(value, place_of_setting(fmt::format("simulate.inputs.{}", name)), names_of(description.tables));
  if (!tree) return tl::unexpected(tree.error());
  std::erase_if(description.sampled_inputs, [&](const auto& input) { return input.name == name; });
  if (auto* place = place_in(description.inputs, name); place != nullptr) {
    put_in_place(description, *place, std::move(*tree));
  } else {
    description.inputs.push_back(
        {std::string(name), std::move(*tree), place_of_setting(fmt::format("simulate.inputs.{}", name))});
  }
  return {};
}

/// simulate.inputs.u.file=PATH and simulate.inputs.u.result=PATH, relative to the working folder.
Expected<void> set_samples(ModelFile& model, std::string_view name, std::string_view source, std::string_view file) {
  const auto place = place_of_setting(fmt::format("simulate.inputs.{}.{}", name, source));
  auto input = sampled_input(std::string(name), source, std::string(file), place, model.files);
  if (!input) return tl::unexpected(input.error());
  withdraw_input(model.description, name);
  model.description.sampled_inputs.push_back(std::move(*input));
  return {};
}

Expected<void> set_input(ModelFile& model, std::string_view path, std::string_view value) {
  const auto dot = path.find('.');
  if (dot == std::string_view::npos) return set_input_expression(model.description, path, value);
  const auto source = path.substr(dot + 1);
  if (source == "file" || source == "result") return set_samples(model, path.substr(0, dot), source, value);
  return refused_setting(fmt::format("simulate.inputs.{}", path), ErrorCode::unknown_name,
                         fmt::format("an input has no key '{}'", source),
                         suggest_word(std::string(source), {"file", "result"}));
}

/// A value may stand in quotes, as in a model file: no expression, option or file begins and ends with them.
std::string_view without_quotes(std::string_view value) {
  const bool quoted =
      value.size() > 1 && value.back() == value.front() && (value.front() == '"' || value.front() == '\'');
  return quoted ? value.substr(1, value.size() - 2) : value;
}

}  // namespace

Expected<pipeline::SimulateOptions> with_option(pipeline::SimulateOptions options, std::string_view key,
                                                std::string_view value) {
  constexpr std::string_view root = "simulate.";
  if (!key.starts_with(root)) {
    return refused_setting(key, ErrorCode::unknown_name, fmt::format("unknown option {}", key),
                           "options begin with simulate.");
  }
  auto changed = pipeline::with_value(std::move(options), key.substr(root.size()), option_value(value));
  if (!changed) changed.error().location = place_of_setting(key);
  return changed;
}

Expected<void> set_option(ModelFile& model, std::string_view key, std::string_view value,
                          const SourceLocation& location) {
  if (key.starts_with("optimize.")) return set_optimize_option(model, key, value, location);
  auto options = with_option(model.simulate, key, value);
  if (!options) {
    options.error().location = location;
    return tl::unexpected(options.error());
  }
  model.simulate = std::move(*options);
  model.option_locations.emplace_back(key.substr(key.find('.') + 1), location);
  return {};
}

Expected<ModelFile> with_setting(ModelFile model, std::string_view key, std::string_view given) {
  const std::string_view value = without_quotes(given);
  constexpr std::string_view inputs = "simulate.inputs.";
  const auto dot = std::min(key.find('.'), key.size());
  const auto table = key.substr(0, dot);
  Expected<void> done;
  if (table == "simulate" && dot < key.size() && is_table_text(value)) {
    done = set_table(model, key, value);
  } else if (key.starts_with(inputs)) {
    done = set_input(model, key.substr(inputs.size()), value);
  } else if (table == "simulate") {
    done = set_option(model, key, value, place_of_setting(key));
  } else if (table == "optimize") {
    done = set_optimize(model, key, value);
  } else if (table == "time_freezing" && dot < key.size()) {
    done = set_table(model, key, is_table_text(value) ? std::string(value) : fmt::format("\"{}\"", value));
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
