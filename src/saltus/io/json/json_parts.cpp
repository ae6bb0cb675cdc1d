#include <algorithm>

#include <fmt/format.h>

#include "saltus/io/json/json_parts_internal.hpp"

namespace saltus::io {

std::size_t read_number(JsonReader& reader, const Json& json, const std::string& path, const char* key) {
  std::int64_t value = 0;
  reader.read_member(json, path, key, value);
  if (value < 0) reader.fail(path + "/" + key, fmt::format("expected a number from 0, found {}", value));
  return static_cast<std::size_t>(std::max<std::int64_t>(value, 0));
}

Json numbers_json(const std::vector<std::pair<std::string, double>>& numbers) {
  Json json = Json::object();
  for (const auto& [name, value] : numbers) json[name] = value;
  return json;
}

void read_numbers(JsonReader& reader, const Json& json, const std::string& path,
                  std::vector<std::pair<std::string, double>>& numbers) {
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

Json status_json(const result::Status& status) {
  return {
      {"termination", name(status.termination)}, {"message", status.message}, {"time_reached", status.time_reached}};
}

void read_status(JsonReader& reader, const Json& json, const std::string& path, result::Status& status) {
  reader.read_word(json, path, "termination", result::termination_named, "termination", status.termination);
  reader.read_member(json, path, "message", status.message);
  reader.read_member(json, path, "time_reached", status.time_reached);
}

Json statistics_json(const result::Statistics& statistics) {
  Json json = {{"steps", statistics.steps},
               {"rejected", statistics.rejected},
               {"rhs_evaluations", statistics.rhs_evaluations},
               {"wall_seconds", statistics.wall_seconds}};
  if (statistics.error_estimate) json["error_estimate"] = *statistics.error_estimate;
  return json;
}

void read_statistics(JsonReader& reader, const Json& json, const std::string& path, result::Statistics& statistics) {
  reader.read_member(json, path, "steps", statistics.steps);
  reader.read_member(json, path, "rejected", statistics.rejected);
  reader.read_member(json, path, "rhs_evaluations", statistics.rhs_evaluations);
  reader.read_member(json, path, "wall_seconds", statistics.wall_seconds);
  if (json.is_object() && json.contains("error_estimate")) {
    reader.read_member(json, path, "error_estimate", statistics.error_estimate.emplace());
  }
}

Json sensitivities_json(const result::Sensitivities& sensitivities) {
  return {{"x0", sensitivities.x0}, {"p", sensitivities.p}, {"parameters", sensitivities.parameters}};
}

void read_sensitivities(JsonReader& reader, const Json& json, const std::string& path,
                        std::optional<result::Sensitivities>& sensitivities) {
  sensitivities.emplace();
  reader.read_member(json, path, "x0", sensitivities->x0);
  reader.read_member(json, path, "p", sensitivities->p);
  reader.read_member(json, path, "parameters", sensitivities->parameters);
}

Json elements_json(const result::Elements& elements) {
  Json selections = Json::array();
  for (const auto& selection : elements.selections) {
    selections.push_back({{"name", selection.name}, {"form", name(selection.form)}});
  }
  return {{"points", elements.points},
          {"selections", std::move(selections)},
          {"t", elements.t},
          {"lambda", elements.lambda},
          {"selection", elements.selection}};
}

void read_elements(JsonReader& reader, const Json& json, const std::string& path,
                   std::optional<result::Elements>& elements) {
  elements.emplace();
  elements->points = read_number(reader, json, path, "points");
  if (const auto* selections = reader.member(json, path, "selections")) {
    read_list(reader, *selections, path + "/selections", elements->selections,
              [](JsonReader& inner, const Json& entry, const std::string& here) {
                result::ElementSelection selection;
                inner.read_member(entry, here, "name", selection.name);
                inner.read_word(entry, here, "form", result::selection_form_named, "form of a selection",
                                selection.form);
                return selection;
              });
  }
  reader.read_member(json, path, "t", elements->t);
  reader.read_member(json, path, "lambda", elements->lambda);
  reader.read_member(json, path, "selection", elements->selection);
}

}  // namespace saltus::io
