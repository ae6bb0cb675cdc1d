// Result -> JSON.
#include <cmath>
#include <cstddef>

#include "saltus/base/version.hpp"
#include "saltus/io/json_layout_internal.hpp"
#include "saltus/io/json_optimization_internal.hpp"
#include "saltus/io/json_parts_internal.hpp"
#include "saltus/io/json_result.hpp"

namespace saltus::io {
namespace {

Json model_json(const result::ModelRecord& model) {
  return {{"name", model.name},
          {"sha256", model.sha256},
          {"parameters", numbers_json(model.parameters)},
          {"description", model.description}};
}

Json intersection_json(const result::Intersection& intersection) {
  Json json = Json::object();
  json["surfaces"] = intersection.surfaces;
  json["velocities"] = intersection.velocities;
  json["alpha_before"] = or_null(intersection.alpha_before);
  json["alpha_after"] = intersection.alpha_after;
  return json;
}

Json alternative_json(const result::Alternative& other) {
  Json json = Json::object();
  json["mode"] = other.mode;
  json["alpha"] = other.alpha;
  if (!other.regions.empty()) json["regions"] = other.regions;
  return json;
}

Json family_json(const result::Family& family) {
  Json json = Json::object();
  json["kind"] = name(family.kind);
  json["event"] = family.event;
  json["from"] = family.from;
  json["until"] = family.until;
  json["to"] = alternative_json(family.to);
  if (family.lap_ratio) json["lap_ratio"] = *family.lap_ratio;
  return json;
}

Json departure_json(const result::Departure& departure) {
  Json json = Json::object();
  json["event"] = departure.event;
  if (!departure.member) {
    json["alternative"] = departure.alternative;
    return json;
  }
  json["family"] = departure.member->family;
  json["parameter"] = departure.member->parameter;
  return json;
}

Json event_json(const result::Event& event) {
  Json alternatives = Json::array();
  for (const auto& other : event.alternatives) alternatives.push_back(alternative_json(other));
  Json json = Json::object();
  json["t"] = event.t;
  json["kind"] = name(event.kind);
  json["name"] = or_null(event.name);
  json["surfaces"] = event.surfaces;
  json["mode_before"] = or_null(event.mode_before);
  json["mode_after"] = or_null(event.mode_after);
  json["alpha_before"] = or_null(event.alpha_before);
  json["alpha_after"] = or_null(event.alpha_after);
  if (event.regions_before) json["regions_before"] = *event.regions_before;
  if (event.regions_after) json["regions_after"] = *event.regions_after;
  json["x"] = event.x;
  json["x_after"] = event.x_after;
  json["unique"] = or_null(event.unique);
  json["alternatives"] = std::move(alternatives);
  json["reason"] = event.reason;
  if (event.intersection) json["intersection"] = intersection_json(*event.intersection);
  return json;
}

Json final_json(const result::Final& final) {
  Json json = Json::object();
  json["t"] = final.t;
  json["x"] = final.x;
  json["mode"] = final.mode;
  json["alpha"] = final.alpha;
  json["outputs"] = final.outputs;
  if (!final.regions.empty()) {
    json["regions"] = final.regions;
    json["theta"] = final.theta;
  }
  return json;
}

Json trajectory_json(const result::Trajectory& trajectory) {
  Json json = Json::object();
  json["t"] = trajectory.t;
  json["x"] = trajectory.x;
  json["u"] = trajectory.u;
  json["alpha"] = trajectory.alpha;
  json["mode"] = trajectory.mode;
  json["outputs"] = trajectory.outputs;
  if (!trajectory.regions.empty()) {
    json["regions"] = trajectory.regions;
    json["theta"] = trajectory.theta;
  }
  return json;
}

Json affine_json(const result::AffineSurface& affine) {
  Json json = Json::object();
  json["gradient"] = affine.gradient;
  json["rate"] = affine.rate;
  json["constant"] = affine.constant;
  return json;
}

Json surface_json(const result::Surface& surface) {
  Json curves = Json::array();
  for (const auto& curve : surface.curves) {
    Json piece = Json::object();
    piece["t"] = or_null(curve.t);
    piece["coordinates"] = curve.coordinates;
    curves.push_back(std::move(piece));
  }
  Json json = Json::object();
  json["name"] = surface.name;
  json["role"] = name(surface.role);
  json["states"] = surface.states;
  json["depends_on_time"] = surface.depends_on_time;
  json["affine"] = surface.affine ? affine_json(*surface.affine) : Json();
  for (const auto& form : surface.within) json["within"].push_back(affine_json(form));
  json["curves"] = std::move(curves);
  return json;
}

Json options_json(const result::OptionRecord& options) {
  Json json = Json::object();
  for (const auto& [name, value] : options) {
    std::visit([&json, &key = name](const auto& content) { json[key] = content; }, value);
  }
  return json;
}

Json whole_json(const result::Result& result) {
  Json events = Json::array();
  for (const auto& event : result.events) events.push_back(event_json(event));
  Json surfaces = Json::array();
  for (const auto& surface : result.surfaces) surfaces.push_back(surface_json(surface));
  Json json = Json::object();
  json["format"] = "saltus-result/1";
  json["saltus"] = version;
  json["model"] = model_json(result.model);
  json["command"] = result.command;
  json["method"] = result.method;
  json["status"] = status_json(result.status);
  json["states"] = result.states;
  json["controls"] = result.controls;
  json["switching_functions"] = result.switching_functions;
  json["outputs"] = result.outputs;
  for (const auto& group : result.region_groups) {
    json["region_groups"].push_back({{"name", group.name}, {"modes", group.modes}});
  }
  json["final"] = final_json(result.final);
  json["events"] = std::move(events);
  json["trajectory"] = trajectory_json(result.trajectory);
  if (result.optimization) add_optimization(json, *result.optimization);
  json["surfaces"] = std::move(surfaces);
  json["statistics"] = result.optimization ? optimization_statistics_json(result.optimization->statistics)
                                           : statistics_json(result.statistics);
  json["options"] = options_json(result.options);
  if (result.sensitivities) json["sensitivities"] = sensitivities_json(*result.sensitivities);
  if (result.optimization) json["start_values"] = start_values_json(*result.optimization);
  if (result.elements) json["elements"] = elements_json(*result.elements);
  if (result.comparison) json["comparison"] = comparison_json(*result.comparison);
  if (result.order) json["order"] = order_json(*result.order);
  for (const auto& family : result.families) json["families"].push_back(family_json(family));
  if (result.left_at) json["left_at"] = departure_json(*result.left_at);
  if (!result.branches.empty()) {
    json["branches"] = Json::array();
    for (const auto& branch : result.branches) json["branches"].push_back(whole_json(branch));
  }
  return json;
}

}  // namespace

std::string to_json(const result::Result& result) { return laid_out(whole_json(result)); }

}  // namespace saltus::io
