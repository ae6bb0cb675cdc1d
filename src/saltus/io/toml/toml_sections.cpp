#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "saltus/base/contains.hpp"
#include "saltus/expression/parser.hpp"
#include "saltus/io/optimize/toml_optimize_internal.hpp"
#include "saltus/io/toml/toml_sections_internal.hpp"
#include "saltus/io/toml/toml_words_internal.hpp"

namespace saltus::io {
namespace {

/// { initial, lower, upper, free } of a state, a parameter or a control.
struct Quantity {
  expression::NodePtr initial, lower, upper;
  bool free = false;
  result::Caption caption;
};

void read_caption(TomlReader& reader, const TomlEntry& field, result::Caption& caption) {
  (field.key == "unit" ? caption.unit : caption.label) = reader.string(field.value, "a text in quotes");
}

/// Reads `name = value` or `name = { initial = value }`, with more keys in the table.
Quantity read_quantity(TomlReader& reader, const TomlEntry& entry, const std::vector<std::string>& known) {
  Quantity quantity;
  reader.begin_entry();
  const auto* table = std::get_if<TomlTable>(&entry.value.value);
  if (std::holds_alternative<TomlArray>(entry.value.value)) {
    reader.fail({ErrorCode::parse_failure,
                 "expected a number or an expression in quotes, found a list",
                 fmt::format("a file has no arrays: name the entries {0}1, {0}2, …; saltus.Builder of the Python "
                             "package has them, b.states and b.parameters",
                             entry.key),
                 entry.value.location,
                 {}});
    quantity.initial = expression::unreadable(entry.value.location);
    return quantity;
  }
  if (table == nullptr) {
    quantity.initial = reader.expression(entry.value);
    return quantity;
  }
  for (const auto& [key, location, value] : *table) {
    if (!contains(known, key)) {
      reader.unknown_key({key, location, value}, known);
      // Perhaps it was to be the initial value: that this is missing, and what follows from it, is the same mistake.
      if (quantity.initial == nullptr) quantity.initial = expression::unreadable(location);
    } else if (key == "initial") {
      quantity.initial = reader.expression(value);
    } else if (key == "lower") {
      quantity.lower = reader.bound(value);
    } else if (key == "upper") {
      quantity.upper = reader.bound(value);
    } else if (key == "free") {
      quantity.free = reader.boolean(value);
    } else {
      read_caption(reader, {key, location, value}, quantity.caption);
    }
  }
  if (quantity.free && quantity.initial) {
    check_free(reader, fmt::format("'{}'", entry.key), quantity.initial, quantity.lower, quantity.upper,
               entry.location);
  }
  return quantity;
}

void add_caption(ModelFile& model, const std::string& name, result::Caption caption) {
  if (caption.unit.empty() && caption.label.empty()) return;
  model.captions.emplace_back(name, std::move(caption));
}

void require_initial(TomlReader& reader, const TomlEntry& entry, const Quantity& quantity) {
  if (quantity.initial != nullptr) return;
  reader.missing(fmt::format("'{}' has no initial value", entry.key),
                 fmt::format("write {} = {{ initial = 0, … }}", entry.key), entry.location);
}

/// `name = "value"` or `name = { value = "value", unit = "unit", label = "label" }`.
model::NamedExpression read_output(TomlReader& reader, const TomlEntry& entry, ModelFile& model) {
  reader.begin_entry();
  result::Caption caption;
  model::NamedExpression output{entry.key, nullptr, entry.location};
  const auto* table = std::get_if<TomlTable>(&entry.value.value);
  if (table == nullptr) output.expression = reader.expression(entry.value);
  for (const auto& field : table == nullptr ? TomlTable{} : *table) {
    if (field.key == "value") {
      output.expression = reader.expression(field.value);
    } else if (field.key == "unit" || field.key == "label") {
      read_caption(reader, field, caption);
    } else {
      reader.unknown_key(field, {"value", "unit", "label"});
    }
  }
  if (output.expression == nullptr) {
    reader.missing(fmt::format("the output '{}' has no value", entry.key),
                   fmt::format("write {} = {{ value = \"…\", unit = \"…\" }}", entry.key), entry.location);
    output.expression = expression::unreadable(entry.location);
  }
  add_caption(model, entry.key, std::move(caption));
  return output;
}

/// `record = ["s", "u"]`: each is an output of that name.
void read_record(TomlReader& reader, const TomlValue& value, ModelFile& model) {
  for (const auto& element : std::get<TomlArray>(value.value)) {
    auto name = reader.string(element, "the name of a definition in quotes");
    if (!std::holds_alternative<TomlString>(element.value)) continue;
    const auto& outputs = model.description.outputs;
    if (std::any_of(outputs.begin(), outputs.end(), [&](const auto& output) { return output.name == name; })) {
      reader.fail({ErrorCode::parse_failure,
                   fmt::format("'{}' is recorded twice", name),
                   "write it once",
                   element.location,
                   {}});
      continue;
    }
    model.description.outputs.push_back({std::move(name), reader.expression(element), element.location});
  }
}

const std::vector<std::string> quantity_keys{"initial", "lower", "upper", "free", "unit", "label"};
const std::vector<std::string> control_keys{"initial", "lower", "upper", "unit", "label"};

const std::vector<std::pair<std::string, model::Inclusion>> inclusions{
    {"filippov", model::Inclusion::filippov}, {"aizerman_pyatnitskii", model::Inclusion::aizerman_pyatnitskii}};
const std::vector<std::pair<std::string, model::Direction>> directions{
    {"up", model::Direction::up}, {"down", model::Direction::down}, {"both", model::Direction::both}};

void read_event(TomlReader& reader, const TomlValue& value, ModelFile& model) {
  const auto* table = reader.table(value, "a table with `when`");
  if (table == nullptr) return;
  reader.begin_entry();
  model::UserEventDescription event;
  event.location = value.location;
  for (const auto& entry : *table) {
    if (entry.key == "name") {
      event.name = reader.string(entry.value, "a name in quotes");
    } else if (entry.key == "when") {
      event.when = reader.expression(entry.value);
    } else if (entry.key == "direction") {
      event.direction = read_enum(reader, entry.value, directions, model::Direction::both);
    } else if (entry.key == "stop") {
      event.action = reader.boolean(entry.value) ? model::AtEvent::stop : model::AtEvent::record;
    } else if (entry.key == "set") {
      reader.fail({ErrorCode::unknown_name,
                   "unknown key 'set': an event records, it changes nothing",
                   "write it under [[jumps]], which takes `when`, `direction`, `name` and `set`",
                   entry.location,
                   {}});
    } else {
      reader.unknown_key(entry, {"name", "when", "direction", "stop"});
    }
  }
  if (!reader.is_understood()) return;
  if (event.when == nullptr) {
    reader.missing("this event has no `when`", "write when = \"expression\" (its zeros) or a condition (its edges)",
                   value.location);
    event.when = expression::unreadable(value.location);
  }
  model.description.events.push_back(std::move(event));
}

void read_mode(TomlReader& reader, const TomlValue& value, ModelFile& model) {
  const auto* table = reader.table(value, "a table with `when` and `dynamics`");
  if (table == nullptr) return;
  reader.begin_entry();
  model::ModeDescription mode;
  mode.location = value.location;
  bool has_dynamics = false;
  for (const auto& entry : *table) {
    if (entry.key == "when") {
      mode.when = reader.expression(entry.value);
    } else if (entry.key == "indicator") {
      mode.indicator = reader.expression(entry.value);
    } else if (entry.key == "group") {
      mode.group = reader.string(entry.value, "a name in quotes");
    } else if (entry.key == "name") {
      mode.name = reader.string(entry.value, "a name in quotes");
    } else if (entry.key == "dynamics") {
      has_dynamics = true;
      read_expressions(reader, entry.value, "a table of states and their right-hand sides", mode.dynamics);
    } else {
      reader.unknown_key(entry, {"when", "dynamics", "group", "indicator", "name"});
    }
  }
  if (!has_dynamics) {
    reader.missing("this mode has no `dynamics`", "write dynamics = { x = \"…\" }; states that are absent get 0",
                   value.location);
  }
  if (reader.is_understood()) {
    model.description.modes.push_back(std::move(mode));
  } else {
    model.is_whole = false;
  }
}

}  // namespace

Expected<model::Inclusion> inclusion_named(const std::string& word) { return enum_named(word, inclusions); }

void read_model_table(TomlReader& reader, const TomlEntry& entry, ModelFile& model) {
  const auto* table = reader.table(entry.value, "the table [model]");
  if (table == nullptr) return;
  for (const auto& field : *table) {
    if (field.key == "name") {
      model.description.name = reader.string(field.value, "a name in quotes");
      if (model.description.name.empty()) {
        reader.fail({ErrorCode::parse_failure,
                     "the model's name is empty",
                     "write name = \"my-model\"",
                     field.value.location,
                     {}});
      }
    } else if (field.key == "description") {
      model.description.description = reader.string(field.value, "a text in quotes");
    } else if (field.key == "inclusion") {
      model.description.inclusion = read_enum(reader, field.value, inclusions, model::Inclusion::filippov);
    } else {
      reader.unknown_key(field, {"name", "description", "inclusion"});
    }
  }
  if (model.description.name.empty() && !reader.failed()) {
    reader.missing("the model has no name", "write name = \"my-model\" in [model]", entry.location);
  }
}

void read_expressions(TomlReader& reader, const TomlValue& value, std::string_view expected,
                      std::vector<model::NamedExpression>& expressions) {
  const auto* table = reader.table(value, expected);
  if (table == nullptr) return;
  for (const auto& field : *table) {
    expressions.push_back({field.key, reader.expression(field.value), field.location});
  }
}

void read_outputs(TomlReader& reader, const TomlEntry& entry, ModelFile& model) {
  const auto* table = reader.table(entry.value, "the table [outputs] of names and expressions");
  if (table == nullptr) return;
  for (const auto& field : *table) {
    if (field.key == "record" && std::holds_alternative<TomlArray>(field.value.value)) {
      read_record(reader, field.value, model);
    } else {
      model.description.outputs.push_back(read_output(reader, field, model));
    }
  }
}

void read_parameters(TomlReader& reader, const TomlEntry& entry, ModelFile& model) {
  const auto* table = reader.table(entry.value, "the table [parameters]");
  if (table == nullptr) return;
  for (const auto& field : *table) {
    auto quantity = read_quantity(reader, field, quantity_keys);
    require_initial(reader, field, quantity);
    model.description.parameters.push_back({field.key, std::move(quantity.initial), field.location});
    add_caption(model, field.key, std::move(quantity.caption));
    if (!quantity.free) continue;
    model.description.free_parameters.push_back(
        {field.key, std::move(quantity.lower), std::move(quantity.upper), field.location});
  }
}

void read_states(TomlReader& reader, const TomlEntry& entry, ModelFile& model) {
  const auto* table = reader.table(entry.value, "the table [states]");
  if (table == nullptr) return;
  for (const auto& field : *table) {
    auto quantity = read_quantity(reader, field, quantity_keys);
    require_initial(reader, field, quantity);
    model.description.states.push_back({field.key, std::move(quantity.initial), std::move(quantity.lower),
                                        std::move(quantity.upper), field.location, quantity.free});
    add_caption(model, field.key, std::move(quantity.caption));
  }
}

void read_controls(TomlReader& reader, const TomlEntry& entry, ModelFile& model) {
  const auto* table = reader.table(entry.value, "the table [controls]");
  if (table == nullptr) return;
  for (const auto& field : *table) {
    if (std::holds_alternative<TomlArray>(field.value.value)) {
      reader.fail({ErrorCode::parse_failure,
                   fmt::format("expected a value of '{}' or its bounds, found a list", field.key),
                   fmt::format("bounds are {} = {{ lower = -2, upper = 2 }}", field.key),
                   field.value.location,
                   {}});
    }
    auto quantity = read_quantity(reader, field, control_keys);
    model.description.controls.push_back(
        {field.key, std::move(quantity.initial), std::move(quantity.lower), std::move(quantity.upper), field.location});
    add_caption(model, field.key, std::move(quantity.caption));
  }
}

void read_events(TomlReader& reader, const TomlEntry& entry, ModelFile& model) {
  for (const auto& value : reader.tables(entry.value, "events")) read_event(reader, value, model);
}

void read_modes(TomlReader& reader, const TomlEntry& entry, ModelFile& model) {
  for (const auto& value : reader.tables(entry.value, "modes")) read_mode(reader, value, model);
}

}  // namespace saltus::io
