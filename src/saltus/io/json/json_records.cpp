#include "saltus/io/json/json_records_internal.hpp"

namespace saltus::io {

Json numbers_json(const Numbers& numbers) {
  Json json = Json::object();
  for (const auto& [name, value] : numbers) json[name] = value;
  return json;
}

void read_numbers(JsonReader& reader, const Json& json, const std::string& path, Numbers& numbers) {
  if (!json.is_object()) {
    reader.mismatch(path, "an object", json);
    return;
  }
  for (const auto& [name, value] : json.items()) {
    double number = 0.0;
    reader.read(value, path + "/" + name, number);
    numbers.emplace_back(name, number);
  }
}

}  // namespace saltus::io
