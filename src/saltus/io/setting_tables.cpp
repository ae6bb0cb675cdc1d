// Tables of options behind --set, as they stand in a model file: KEY='{ points = 11 }'.
#include <algorithm>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "saltus/base/text.hpp"
#include "saltus/io/optimize/toml_optimize_internal.hpp"
#include "saltus/io/setting_values_internal.hpp"
#include "saltus/io/toml/toml_sections_internal.hpp"

namespace saltus::io {
namespace {

/// Inputs that a table names stand in place of earlier ones.
void withdraw_inputs(model::Description& description, const TomlTable& simulate) {
  for (const auto& entry : simulate) {
    const auto* inputs = std::get_if<TomlTable>(&entry.value.value);
    if (entry.key != "inputs" || inputs == nullptr) continue;
    for (const auto& input : *inputs) withdraw_input(description, input.key);
  }
}

/// What is typed has a name, and no line.
void place_at_setting(std::vector<std::pair<std::string, SourceLocation>>& locations, const SourceLocation& place) {
  for (auto& [key, location] : locations) {
    if (location.file == place.file) location = place;
  }
}

Error told_of_setting(Error error, const SourceLocation& place) {
  if (error.location.file == place.file) error.location = place;
  std::erase_if(error.context, [&](const std::string& frame) { return frame.ends_with(place.file); });
  return error;
}

}  // namespace

void withdraw_input(model::Description& description, std::string_view name) {
  const auto same = [&](const auto& input) { return input.name == name; };
  std::erase_if(description.sampled_inputs, same);
  for (auto& input : description.inputs) {
    if (same(input)) description.replaced.push_back(input.expression);
  }
  std::erase_if(description.inputs, same);
}

bool is_table_text(std::string_view value) {
  const auto text = trimmed(value);
  return text.starts_with('{') && text.ends_with('}');
}

Expected<void> set_table(ModelFile& model, std::string_view key, std::string_view value) {
  const auto place = place_of_setting(key);
  const auto dot = key.find('.');
  const auto document =
      parse_toml(fmt::format("[{}]\n{} = {}\n", key.substr(0, dot), key.substr(dot + 1), value), place.file);
  if (!document) {
    return refused_setting(key, ErrorCode::parse_failure, document.error().message,
                           "write the table as in a model file, words in quotes: { integrator = \"taylor\" }");
  }
  TomlReader reader(place.file, model.files);
  std::vector<std::string> functions;
  for (const auto& table : model.description.tables) functions.push_back(table.name);
  reader.set_functions(std::move(functions));
  const auto& section = document->front();
  const auto& entries = std::get<TomlTable>(section.value.value);
  if (section.key == "optimize") {
    read_optimize_key(reader, entries.front(), model);
  } else if (section.key == "time_freezing") {
    read_time_freezing(reader, section, model);
  } else {
    withdraw_inputs(model.description, entries);
    read_simulate(reader, section, model);
  }
  if (!reader.errors().empty()) return tl::unexpected(told_of_setting(reader.errors().front(), place));
  place_at_setting(model.option_locations, place);
  place_at_setting(model.optimize_locations, place);
  return {};
}

}  // namespace saltus::io
