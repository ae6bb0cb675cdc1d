// Reader of [mechanics].
#include <fmt/format.h>

#include "saltus/expression/parser.hpp"
#include "saltus/io/toml/toml_sections_internal.hpp"
#include "saltus/io/toml/toml_words_internal.hpp"

namespace saltus::io {
namespace {

const std::vector<std::string> mechanics_keys{"positions", "velocities", "mass", "potential",
                                              "coriolis",  "force",      "draw"};
const std::vector<std::pair<std::string, model::Coriolis>> coriolis_words{{"none", model::Coriolis::in_force},
                                                                          {"auto", model::Coriolis::from_mass}};

class MechanicsReader {
 public:
  MechanicsReader(TomlReader& reader, const SourceLocation& location) : reader_(reader) {
    mechanics_.location = mechanics_.mass_location = location;
  }

  model::MechanicsDescription read(const TomlTable& table) {
    for (const auto& entry : table) read_key(entry);
    if (mechanics_.positions.empty()) missing("positions", "write positions = [\"x\", \"z\"]: names of states");
    if (mechanics_.velocities.empty()) missing("velocities", "write velocities = [\"vx\", \"vz\"], in the same order");
    return std::move(mechanics_);
  }

 private:
  void read_key(const TomlEntry& entry) {
    const auto& [key, location, value] = entry;
    if (key == "positions") {
      mechanics_.positions = names(value);
    } else if (key == "velocities") {
      mechanics_.velocities = names(value);
    } else if (key == "mass") {
      mechanics_.mass_location = location;
      mechanics_.mass = matrix(value);
    } else if (key == "potential") {
      mechanics_.potential = reader_.expression(value);
    } else if (key == "coriolis") {
      mechanics_.coriolis = read_enum(reader_, value, coriolis_words, model::Coriolis::in_force);
    } else if (key == "force") {
      const auto* table = reader_.table(value, "a table of velocities and forces, e.g. { vx = \"u\" }");
      if (table == nullptr) return;
      for (const auto& force : *table) {
        mechanics_.force.push_back({force.key, reader_.expression(force.value), force.location});
      }
    } else if (key == "draw") {
      read_draw(value);
    } else {
      reader_.unknown_key(entry, mechanics_keys);
    }
  }

  const TomlArray* array(const TomlValue& value, std::string_view expected) {
    const auto* list = std::get_if<TomlArray>(&value.value);
    if (list == nullptr) reader_.wrong_type(expected, value);
    return list;
  }

  std::vector<model::StateName> names(const TomlValue& value) {
    std::vector<model::StateName> result;
    const auto* list = array(value, "a list of names of states");
    if (list == nullptr) return result;
    for (const auto& name : *list) result.push_back({reader_.string(name, "a name in quotes"), name.location});
    return result;
  }

  std::vector<expression::NodePtr> expressions(const TomlValue& value, std::string_view expected) {
    std::vector<expression::NodePtr> result;
    const auto* list = array(value, expected);
    if (list == nullptr) return result;
    for (const auto& entry : *list) {
      if (auto node = reader_.expression(entry)) result.push_back(std::move(node));
    }
    return result;
  }

  std::vector<std::vector<expression::NodePtr>> matrix(const TomlValue& value) {
    std::vector<std::vector<expression::NodePtr>> rows;
    const auto* list = array(value, "a list of rows, e.g. [[\"m\", 0], [0, \"m\"]]");
    if (list == nullptr) return rows;
    for (const auto& row : *list) rows.push_back(expressions(row, "a row of the mass matrix, a list of expressions"));
    return rows;
  }

  void read_draw(const TomlValue& value) {
    const auto* list = array(value, "a list of { line = […] } and { point = […], radius = … }");
    if (list == nullptr) return;
    for (const auto& shape : *list) {
      const auto* table =
          reader_.table(shape, "{ line = [[\"x\", \"z\"], …] } or { point = [\"x\", \"z\"], radius = 0.1 }");
      if (table == nullptr) return;
      mechanics_.draw.push_back(drawn(*table, shape.location));
    }
  }

  model::DrawnDescription drawn(const TomlTable& table, const SourceLocation& location) {
    model::DrawnDescription shape;
    shape.location = location;
    bool is_read = true;
    for (const auto& entry : table) {
      if (entry.key == "line") {
        const auto* points = array(entry.value, "a list of points");
        is_read = points != nullptr;
        if (!is_read) continue;
        for (const auto& point : *points) shape.points.push_back(planar(point));
      } else if (entry.key == "point") {
        shape.points.push_back(planar(entry.value));
      } else if (entry.key == "radius") {
        shape.radius = reader_.expression(entry.value);
      } else {
        reader_.unknown_key(entry, {"line", "point", "radius"});
      }
    }
    // Coordinates that could not be read have their own mistake.
    const bool is_both = table.size() == 2 && shape.radius == nullptr && shape.points.size() > 1;
    const bool is_point = shape.points.size() == 1;
    if (is_read && (shape.points.empty() || is_both || is_point != (shape.radius != nullptr))) {
      fail("what is drawn is a line or a disc",
           "write { line = [[\"x\", 0], [\"x\", 1]] } or { point = [\"x\", \"z\"], radius = 0.1 }", location);
    }
    return shape;
  }

  std::array<expression::NodePtr, 2> planar(const TomlValue& value) {
    auto coordinates = expressions(value, "a point of the plane, two expressions");
    if (coordinates.size() == 2) return {coordinates[0], coordinates[1]};
    if (std::holds_alternative<TomlArray>(value.value)) {
      fail("a point of the plane has two coordinates", "write [\"x\", \"z\"]", value.location);
    }
    return {expression::unreadable(value.location), expression::unreadable(value.location)};
  }

  void missing(const char* key, const char* remedy) {
    reader_.missing(fmt::format("[mechanics] has no `{}`", key), remedy, mechanics_.location);
  }
  void fail(std::string message, std::string remedy, const SourceLocation& location) {
    reader_.fail({ErrorCode::parse_failure, std::move(message), std::move(remedy), location, {}});
  }

  TomlReader& reader_;
  model::MechanicsDescription mechanics_;
};

}  // namespace

void read_mechanics(TomlReader& reader, const TomlEntry& entry, ModelFile& model) {
  const auto* table = reader.table(entry.value, "the table [mechanics]");
  if (table == nullptr) return;
  auto mechanics = MechanicsReader(reader, entry.location).read(*table);
  if (reader.is_understood()) {
    model.description.mechanics = std::move(mechanics);
  } else {
    model.is_whole = false;
  }
}

}  // namespace saltus::io
