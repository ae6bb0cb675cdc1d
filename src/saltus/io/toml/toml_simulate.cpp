// [simulate]: flattened into dotted keys, which the option table of the pipeline knows.
#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "saltus/base/contains.hpp"
#include "saltus/io/toml/toml_sections_internal.hpp"
#include "saltus/pipeline/options/option_fields.hpp"

namespace saltus::io {
namespace {

using result::OptionValue;

/// A list of numbers; nullopt and an error if there is anything else in it.
std::optional<std::vector<double>> numbers(TomlReader& reader, const TomlArray& array) {
  std::vector<double> list;
  for (const auto& element : array) {
    if (const auto* real = std::get_if<double>(&element.value)) {
      list.push_back(*real);
    } else if (const auto* integer = std::get_if<std::int64_t>(&element.value)) {
      list.push_back(static_cast<double>(*integer));
    } else {
      reader.wrong_type("a number", element);
      return std::nullopt;
    }
  }
  return list;
}

/// A list of words; nullopt unless all are.
std::optional<std::vector<std::string>> words(const TomlArray& array) {
  std::vector<std::string> list;
  for (const auto& element : array) {
    const auto* word = std::get_if<TomlString>(&element.value);
    if (word == nullptr) return std::nullopt;
    list.push_back(word->text);
  }
  return list;
}

/// Whether some option's key begins with this one and a dot: then it is a table.
bool is_table_of_options(std::string_view key) {
  const auto prefix = fmt::format("{}.", key);
  const auto fields = pipeline::simulate_fields();
  return std::any_of(fields.begin(), fields.end(), [&](const auto& field) { return field.key.starts_with(prefix); });
}

bool is_option(std::string_view key) {
  const auto keys = pipeline::simulate_keys();
  return contains(keys, key);
}

void read_option(TomlReader& reader, const std::string& key, const TomlEntry& entry, ModelFile& model) {
  if (is_table_of_options(key) && !is_option(key)) {
    reader.wrong_type(fmt::format("the table [simulate.{}]", key), entry.value);
    return;
  }
  // No option is a table or a date; whether there is one of that name is for the option table to say.
  const bool is_value =
      !std::holds_alternative<TomlTable>(entry.value.value) && !std::holds_alternative<TomlDate>(entry.value.value);
  const auto known = pipeline::with_value(pipeline::SimulateOptions{}, key, false);
  const bool unknown = !known && known.error().code == ErrorCode::unknown_name;
  const auto value =
      is_value || !unknown ? read_option_value(reader, entry.value) : std::optional<OptionValue>(std::in_place, false);
  if (!value) return;
  auto options = pipeline::with_value(model.simulate, key, *value);
  if (options) {
    model.simulate = std::move(*options);
    model.option_locations.emplace_back(key, entry.value.location);
    return;
  }
  auto error = options.error();
  const bool about_key = error.code == ErrorCode::unknown_name;
  error.location = about_key ? entry.location : entry.value.location;
  if (!about_key && error.code != ErrorCode::not_available)
    error.message = fmt::format("{}: {}", entry.key, error.message);
  reader.fail(std::move(error));
}

void check_output_table(TomlReader& reader, const TomlEntry& entry, const TomlTable& table) {
  if (table.empty()) {
    reader.fail({ErrorCode::invalid_option,
                 "the table output is empty",
                 "write e.g. output = { every = 0.01 }",
                 entry.value.location,
                 {}});
  }
  // What the rows have stands beside one of the grids, or alone.
  const TomlEntry* grid = nullptr;
  for (const auto& key : table) {
    if (key.key != "every" && key.key != "points" && key.key != "times") continue;
    if (grid != nullptr) {
      reader.fail({ErrorCode::invalid_option,
                   fmt::format("`{}` and `{}` of output say twice when there are rows", grid->key, key.key),
                   "leave one of them out",
                   key.location,
                   {}});
      return;
    }
    grid = &key;
  }
}

void read_options(TomlReader& reader, const std::string& prefix, const TomlTable& table, ModelFile& model) {
  for (const auto& entry : table) {
    const auto key = prefix + entry.key;
    const auto* inner = std::get_if<TomlTable>(&entry.value.value);
    if (inner == nullptr || !is_table_of_options(key)) {
      read_option(reader, key, entry, model);
      continue;
    }
    if (key == "output") check_output_table(reader, entry, *inner);
    read_options(reader, key + ".", *inner, model);
  }
}

/// { file = "u.csv" }, { result = "r.json" } or { times = [0, 1], values = [2, 3] }.
void read_samples(TomlReader& reader, const TomlEntry& field, const TomlTable& source, ModelFile& model) {
  const auto is_list = [](const TomlEntry& entry) { return entry.key == "times" || entry.key == "values"; };
  if (std::any_of(source.begin(), source.end(), is_list)) {
    read_listed_samples(reader, field, source, model);
    return;
  }
  const bool one = source.size() == 1;
  if (one && source.front().key != "file" && source.front().key != "result") {
    reader.unknown_key(source.front(), {"file", "result", "times", "values"});
    return;
  }
  if (!one) {
    reader.fail({ErrorCode::parse_failure,
                 fmt::format("expected one of file and result for the input '{}', found {}", field.key,
                             source.empty() ? "none" : "several"),
                 "write e.g. u = { file = \"u.csv\" }",
                 field.value.location,
                 {}});
    return;
  }
  const auto name = reader.string(source.front().value, "a file name in quotes");
  if (reader.failed()) return;
  auto input =
      sampled_input(field.key, source.front().key, beside(reader.file(), name), field.location, reader.files());
  if (!input) {
    reader.fail(with_context(input.error(), fmt::format("line {} of {}", field.location.line, reader.file())));
    return;
  }
  model.description.sampled_inputs.push_back(std::move(*input));
}

void read_inputs(TomlReader& reader, const TomlEntry& entry, ModelFile& model) {
  const auto* table = reader.table(entry.value, "a table like { u = \"sin(t)\" }");
  if (table == nullptr) return;
  for (const auto& field : *table) {
    if (const auto* source = std::get_if<TomlTable>(&field.value.value)) {
      read_samples(reader, field, *source, model);
      continue;
    }
    model.description.inputs.push_back({field.key, reader.expression(field.value), field.location});
  }
}

}  // namespace

std::optional<OptionValue> read_option_value(TomlReader& reader, const TomlValue& value) {
  // Built in place: moving a variant into the optional makes g++ 12 with sanitizers warn of what it never reads.
  std::optional<OptionValue> result;
  if (const auto* truth = std::get_if<bool>(&value.value)) {
    result.emplace(*truth);
  } else if (const auto* integer = std::get_if<std::int64_t>(&value.value)) {
    result.emplace(*integer);
  } else if (const auto* real = std::get_if<double>(&value.value)) {
    result.emplace(*real);
  } else if (const auto* text = std::get_if<TomlString>(&value.value)) {
    result.emplace(text->text);
  } else if (const auto* array = std::get_if<TomlArray>(&value.value)) {
    if (auto names = words(*array); names && !names->empty()) {
      result.emplace(std::move(*names));
    } else if (auto list = numbers(reader, *array)) {
      result.emplace(std::move(*list));
    }
  } else {
    reader.wrong_type("a number, a word in quotes or a list of numbers or words", value);
  }
  return result;
}

void read_simulate(TomlReader& reader, const TomlEntry& entry, ModelFile& model) {
  const auto* table = reader.table(entry.value, "the table [simulate]");
  if (table == nullptr) return;
  for (const auto& field : *table) {
    if (field.key == "inputs") {
      read_inputs(reader, field, model);
    } else {
      read_options(reader, "", {field}, model);
    }
  }
}

}  // namespace saltus::io
