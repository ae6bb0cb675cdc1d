// [tables.name], and inputs that are samples.
#include <array>
#include <filesystem>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "saltus/base/contains.hpp"
#include "saltus/io/named_files_internal.hpp"
#include "saltus/io/sample_files.hpp"
#include "saltus/io/toml/toml_sections_internal.hpp"
#include "saltus/io/toml/toml_words_internal.hpp"

namespace saltus::io {
namespace {

/// A list of numbers with their places.
struct NumberList {
  std::vector<double> values;
  std::vector<SourceLocation> places;
  SourceLocation location;
};

std::optional<NumberList> number_list(TomlReader& reader, const TomlValue& value) {
  const auto* array = std::get_if<TomlArray>(&value.value);
  if (array == nullptr) {
    reader.wrong_type("a list of numbers", value);
    return std::nullopt;
  }
  NumberList list;
  list.location = value.location;
  for (const auto& element : *array) {
    const auto number = reader.number(element);
    if (!number) return std::nullopt;
    list.values.push_back(*number);
    list.places.push_back(element.location);
  }
  return list;
}

/// What a table states, before it is read together.
struct StatedTable {
  std::optional<NumberList> x, y;
  std::optional<std::string> file;
  SourceLocation file_location;
  model::TableKind kind = model::TableKind::linear;
};

const std::vector<std::pair<std::string, model::TableKind>> table_kinds{{"linear", model::TableKind::linear},
                                                                        {"cubic", model::TableKind::cubic}};

void missing_points(TomlReader& reader, const TomlEntry& entry, const StatedTable& stated) {
  const bool one = stated.x.has_value() != stated.y.has_value();
  reader.fail({ErrorCode::parse_failure,
               stated.file ? fmt::format("table '{}' has a file and points of its own", entry.key)
               : one       ? fmt::format("table '{}' has no {}", entry.key, stated.x ? "y" : "x")
                           : fmt::format("table '{}' has no points", entry.key),
               "write x = [0, 1, 2] and y = [0, 0.5, 0], or file = \"points.csv\"",
               entry.location,
               {}});
}

/// The error of points that stand in the model file.
Error located(const model::PointMistake& mistake, const StatedTable& stated, const SourceLocation& table) {
  const auto& list = mistake.in_values ? *stated.y : *stated.x;
  const auto place = mistake.point && *mistake.point < list.places.size() ? list.places[*mistake.point] : table;
  return {ErrorCode::invalid_model, mistake.message, mistake.remedy, place, {}};
}

void read_points(TomlReader& reader, const TomlEntry& entry, const StatedTable& stated, ModelFile& model) {
  model::TableDescription table;
  table.name = entry.key;
  table.kind = stated.kind;
  table.location = entry.location;
  const bool lists = stated.x && stated.y;
  if (lists == stated.file.has_value() || (stated.file && (stated.x || stated.y))) {
    missing_points(reader, entry, stated);
    return;
  }
  const auto frame = fmt::format("in [tables.{}]", entry.key);
  if (lists) {
    table.x = stated.x->values;
    table.y = stated.y->values;
    if (const auto mistake = model::find_mistake(table.x, table.y, table.kind)) {
      reader.fail(with_context(located(*mistake, stated, entry.location), frame));
      return;
    }
  } else {
    const auto file = beside(reader.file(), *stated.file);
    auto columns = read_named(reader.files(), file).and_then([&](const std::string& text) {
      return parse_columns(text, file.string(), entry.key, ColumnsOf::table);
    });
    if (!columns) {
      reader.fail(with_context(columns.error(), fmt::format("{}, line {}", frame, stated.file_location.line)));
      return;
    }
    if (const auto mistake = model::find_mistake(columns->first, columns->second, table.kind)) {
      reader.fail(
          with_context(io::located(*mistake, *columns), fmt::format("{}, line {}", frame, stated.file_location.line)));
      return;
    }
    table.x = std::move(columns->first);
    table.y = std::move(columns->second);
  }
  model.description.tables.push_back(std::move(table));
}

void read_one_table(TomlReader& reader, const TomlEntry& entry, ModelFile& model) {
  const auto* fields = reader.table(entry.value, fmt::format("the table [tables.{}] with x and y, or file", entry.key));
  if (fields == nullptr) return;
  reader.begin_entry();
  StatedTable stated;
  for (const auto& field : *fields) {
    if (field.key == "x") {
      stated.x = number_list(reader, field.value);
    } else if (field.key == "y") {
      stated.y = number_list(reader, field.value);
    } else if (field.key == "file") {
      stated.file = reader.string(field.value, "a file name in quotes");
      stated.file_location = field.value.location;
    } else if (field.key == "kind") {
      stated.kind = read_enum(reader, field.value, table_kinds, stated.kind);
    } else {
      reader.unknown_key(field, {"x", "y", "file", "kind"});
    }
  }
  if (!reader.failed()) read_points(reader, entry, stated, model);
}

}  // namespace

std::filesystem::path beside(const std::string& model, const std::string& file) {
  const std::filesystem::path path(file);
  return path.is_absolute() ? path : std::filesystem::path(model).parent_path() / path;
}

void read_tables(TomlReader& reader, const TomlEntry& entry, ModelFile& model) {
  const auto* tables = reader.table(entry.value, "tables like [tables.road]");
  if (tables == nullptr) return;
  for (const auto& table : *tables) read_one_table(reader, table, model);
}

std::vector<std::string> value_names(const TomlTable& document) {
  constexpr std::array places{"parameters", "states", "controls", "definitions", "switching", "outputs"};
  std::vector<std::string> names;
  for (const auto& entry : document) {
    const auto* table = std::get_if<TomlTable>(&entry.value.value);
    if (table == nullptr || !contains(places, entry.key)) continue;
    for (const auto& field : *table) names.push_back(field.key);
  }
  return names;
}

std::vector<std::string> table_names(const TomlTable& document) {
  const auto taken = value_names(document);  // a second meaning is refused later; until then the first one holds
  std::vector<std::string> names;
  for (const auto& entry : document) {
    const auto* tables = std::get_if<TomlTable>(&entry.value.value);
    if (entry.key != "tables" || tables == nullptr) continue;
    for (const auto& table : *tables) {
      const bool is_table = std::holds_alternative<TomlTable>(table.value.value);
      if (is_table && !contains(taken, table.key)) names.push_back(table.key);
    }
  }
  return names;
}

void read_listed_samples(TomlReader& reader, const TomlEntry& field, const TomlTable& source, ModelFile& model) {
  StatedTable stated;
  for (const auto& entry : source) {
    if (entry.key == "times") {
      stated.x = number_list(reader, entry.value);
    } else if (entry.key == "values") {
      stated.y = number_list(reader, entry.value);
    } else {
      reader.unknown_key(entry, {"times", "values"});
    }
  }
  if (reader.failed()) return;
  if (!stated.x || !stated.y) {
    reader.fail({ErrorCode::parse_failure,
                 fmt::format("the input '{}' has no {}", field.key, stated.x ? "values" : "times"),
                 "write e.g. u = { times = [0, 1], values = [2, 3] }",
                 field.value.location,
                 {}});
    return;
  }
  if (const auto mistake = model::find_mistake(stated.x->values, stated.y->values)) {
    reader.fail(
        with_context(located(*mistake, stated, field.value.location), fmt::format("in the input of {}", field.key)));
    return;
  }
  model.description.sampled_inputs.push_back(
      {field.key, std::move(stated.x->values), std::move(stated.y->values), field.location});
}

Expected<model::SampledInput> sampled_input(const std::string& control, std::string_view source,
                                            const std::filesystem::path& file, const SourceLocation& location,
                                            std::vector<result::NamedFile>& files) {
  const auto frame = fmt::format("in the input of {}", control);
  const auto text = read_named(files, file);
  if (!text) return tl::unexpected(with_context(text.error(), frame));
  auto columns = source == "file" ? parse_columns(*text, file.string(), control, ColumnsOf::input)
                                  : parse_control(*text, file.string(), control);
  if (!columns) return tl::unexpected(with_context(columns.error(), frame));
  if (const auto mistake = model::find_mistake(columns->first, columns->second)) {
    return tl::unexpected(with_context(located(*mistake, *columns), frame));
  }
  return model::SampledInput{control, std::move(columns->first), std::move(columns->second), location};
}

}  // namespace saltus::io
