// Reader of [[hysteresis]].
#include <fmt/format.h>

#include "saltus/expression/parser.hpp"
#include "saltus/io/toml/toml_sections_internal.hpp"

namespace saltus::io {
namespace {

model::HysteresisDescription read_hysteresis_entry(TomlReader& reader, const TomlTable& table,
                                                   const SourceLocation& location) {
  model::HysteresisDescription hysteresis;
  hysteresis.location = location;
  for (const auto& entry : table) {
    if (entry.key == "name") {
      hysteresis.name = reader.string(entry.value, "a name in quotes");
      hysteresis.location = entry.value.location;
    } else if (entry.key == "input") {
      hysteresis.input = reader.expression(entry.value);
    } else if (entry.key == "on") {
      hysteresis.on = reader.expression(entry.value);
    } else if (entry.key == "off") {
      hysteresis.off = reader.expression(entry.value);
    } else if (entry.key == "initial") {
      hysteresis.initial = reader.expression(entry.value);
    } else {
      reader.unknown_key(entry, {"name", "input", "on", "off", "initial"});
    }
  }
  const auto missing = [&](const char* key, const char* remedy) {
    reader.missing(fmt::format("this hysteresis has no `{}`", key), remedy, hysteresis.location);
    return expression::unreadable(hysteresis.location);
  };
  if (hysteresis.name.empty()) missing("name", "write name = \"turbo\": what is 0 or 1");
  if (!hysteresis.input) {
    hysteresis.input = missing("input", "write input = \"v\": an expression of states and parameters");
  }
  if (!hysteresis.on) hysteresis.on = missing("on", "write on = 15: the threshold at which it becomes 1");
  if (!hysteresis.off) hysteresis.off = missing("off", "write off = 10: the threshold at which it becomes 0");
  return hysteresis;
}

}  // namespace

void read_hysteresis(TomlReader& reader, const TomlEntry& entry, ModelFile& model) {
  for (const auto& value : reader.tables(entry.value, "hysteresis")) {
    const auto* table = reader.table(value, "a table with `name`, `input`, `on` and `off`");
    if (table == nullptr) return;
    reader.begin_entry();
    auto hysteresis = read_hysteresis_entry(reader, *table, value.location);
    if (reader.is_understood()) {
      model.description.hysteresis.push_back(std::move(hysteresis));
    } else {
      model.is_whole = false;
    }
  }
}

}  // namespace saltus::io
