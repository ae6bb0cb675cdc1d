// Reader of [[contacts]].
#include <fmt/format.h>

#include "saltus/expression/parser.hpp"
#include "saltus/io/toml/toml_sections_internal.hpp"

namespace saltus::io {
namespace {

const std::vector<std::string> contact_keys{"name", "gap", "tangent", "tangents", "friction", "restitution"};

class ContactReader {
 public:
  ContactReader(TomlReader& reader, const SourceLocation& location) : reader_(reader) { contact_.location = location; }

  model::ContactDescription read(const TomlTable& table) {
    for (const auto& entry : table) read_key(entry);
    if (contact_.name.empty()) missing("name", "write name = \"ground\"");
    if (!contact_.gap) {
      missing("gap", "write gap = \"z\": what must not be negative, over positions, parameters and t");
      contact_.gap = expression::unreadable(contact_.location);
    }
    return std::move(contact_);
  }

 private:
  void read_key(const TomlEntry& entry) {
    const auto& [key, location, value] = entry;
    if (key == "name") {
      contact_.name = reader_.string(value, "a name in quotes");
      contact_.location = value.location;
    } else if (key == "gap") {
      contact_.gap = reader_.expression(value);
    } else if (key == "tangent") {
      if (!contact_.tangents.empty()) return both(location);
      contact_.tangents.push_back(tangent(value));
    } else if (key == "tangents") {
      if (!contact_.tangents.empty()) return both(location);
      const auto* list = std::get_if<TomlArray>(&value.value);
      if (list == nullptr) return reader_.wrong_type("a list of two tangents, [{ x = 1 }, { y = 1 }]", value);
      for (const auto& one : *list) contact_.tangents.push_back(tangent(one));
    } else if (key == "friction") {
      contact_.friction = reader_.expression(value);
    } else if (key == "restitution") {
      contact_.restitution = reader_.expression(value);
    } else {
      reader_.unknown_key(entry, contact_keys);
    }
  }

  std::vector<model::TangentEntry> tangent(const TomlValue& value) {
    std::vector<model::TangentEntry> row;
    const auto* table = reader_.table(value, "a row over the positions, e.g. { x = 1 }");
    if (table == nullptr) return row;
    for (const auto& entry : *table) row.push_back({entry.key, reader_.expression(entry.value), entry.location});
    if (row.empty()) fail("the tangent is empty", "write tangent = { x = 1 }, or leave it out", value.location);
    return row;
  }

  void both(const SourceLocation& location) {
    fail("`tangent` and `tangents` beside each other", "write one tangent, or a list of two in `tangents`", location);
  }
  void missing(const char* key, const char* remedy) {
    reader_.missing(fmt::format("this contact has no `{}`", key), remedy, contact_.location);
  }
  void fail(std::string message, std::string remedy, const SourceLocation& location) {
    reader_.fail({ErrorCode::parse_failure, std::move(message), std::move(remedy), location, {}});
  }

  TomlReader& reader_;
  model::ContactDescription contact_;
};

}  // namespace

void read_contacts(TomlReader& reader, const TomlEntry& entry, ModelFile& model) {
  for (const auto& value : reader.tables(entry.value, "contacts")) {
    const auto* table = reader.table(value, "a table with `name` and `gap`");
    if (table == nullptr) return;
    reader.begin_entry();
    auto contact = ContactReader(reader, value.location).read(*table);
    if (reader.is_understood()) model.description.contacts.push_back(std::move(contact));
  }
}

}  // namespace saltus::io
