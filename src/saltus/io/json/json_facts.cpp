#include "saltus/io/json/json_facts_internal.hpp"
#include "saltus/io/json/json_layout_internal.hpp"
#include "saltus/io/json/json_record_members_internal.hpp"
#include "saltus/io/sha256.hpp"

namespace saltus::io {

Json model_json(const result::ModelRecord& model) {
  Json json = Json::object();
  json["name"] = model.name;
  json["sha256"] = model.sha256;
  json["parameters"] = numbers_json(model.parameters);
  json["initial_state"] = numbers_json(model.initial_state);
  json["description"] = model.description;
  for (const auto& [name, caption] : model.captions) json["captions"][name] = record_json(caption);
  if (!model.equations.empty()) json["equations"] = value_json(model.equations);
  if (model.text.empty()) return json;
  json["file"] = model.file;
  json["text"] = model.text;
  json["files"] = value_json(model.files);
  json["set"] = model.settings;
  return json;
}

Json options_json(const result::OptionRecord& options) {
  Json json = Json::object();
  for (const auto& [name, value] : options) {
    std::visit([&json, &key = name](const auto& content) { json[key] = content; }, value);
  }
  return json;
}

std::string record_sha256(const result::Result& result) {
  Json json = Json::object();
  json["model"] = model_json(result.model);
  json["command"] = result.command;
  json["method"] = result.method;
  json["status"] = record_json(result.status);
  json["final"] = record_json(result.final);
  json["options"] = options_json(result.options);
  // Whoever writes the file anew may put keys in another order.
  return sha256(nlohmann::json::parse(compact(json)).dump());
}

}  // namespace saltus::io
