#include "saltus/io/check/json_check.hpp"

#include <cmath>

#include "saltus/io/json/json_reader_internal.hpp"

namespace saltus::io {
namespace {

Json error_json(const Error& error) {
  return {{"file", error.location.file}, {"line", error.location.line}, {"column", error.location.column},
          {"message", error.message},    {"context", error.context},    {"remedy", error.remedy}};
}

Json finite_or_null(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

void caption_json(Json& json, const result::Caption& caption) {
  if (!caption.unit.empty()) json["unit"] = caption.unit;
  if (!caption.label.empty()) json["label"] = caption.label;
}

Json quantities_json(const std::vector<OverviewQuantity>& quantities) {
  Json list = Json::array();
  for (const auto& quantity : quantities) {
    Json json = {{"name", quantity.name}, {"value", quantity.value}};
    if (std::isfinite(quantity.lower) || std::isfinite(quantity.upper)) {
      json["lower"] = finite_or_null(quantity.lower);
      json["upper"] = finite_or_null(quantity.upper);
    }
    caption_json(json, quantity.caption);
    if (!quantity.remark.empty()) json["remark"] = quantity.remark;
    list.push_back(std::move(json));
  }
  return list;
}

Json equations_json(const std::vector<OverviewEquation>& equations) {
  Json list = Json::array();
  for (const auto& equation : equations) {
    Json json = {{"name", equation.name}, {"expression", equation.text}};
    caption_json(json, equation.caption);
    list.push_back(std::move(json));
  }
  return list;
}

Json modes_json(const std::vector<OverviewMode>& modes) {
  Json list = Json::array();
  for (const auto& mode : modes) {
    Json json = {{"when", mode.when}, {"equations", equations_json(mode.rates)}};
    if (!mode.group.empty()) json["group"] = mode.group;
    if (!mode.name.empty()) json["name"] = mode.name;
    list.push_back(std::move(json));
  }
  return list;
}

Json surfaces_json(const std::vector<OverviewSurface>& surfaces) {
  Json list = Json::array();
  for (const auto& surface : surfaces) {
    Json json = {
        {"name", surface.name}, {"expression", surface.expression}, {"role", surface.role}, {"rates", surface.rates}};
    if (!surface.inner.empty()) json["inner"] = surface.inner;
    if (!surface.alias_of.empty()) {
      json["alias_of"] = surface.alias_of;
      json["swapped"] = surface.swapped;
    }
    list.push_back(std::move(json));
  }
  return list;
}

Json events_json(const ModelOverview& overview) {
  Json list = Json::array();
  for (const auto& event : overview.events) {
    list.push_back({{"name", event.name}, {"when", event.when}, {"stop", event.stops}});
  }
  return list;
}

Json jumps_json(const ModelOverview& overview) {
  Json list = Json::array();
  for (const auto& jump : overview.jumps) {
    list.push_back({{"name", jump.name}, {"when", jump.when}, {"set", equations_json(jump.set)}});
  }
  return list;
}

Json forms_json(const std::vector<OverviewForm>& forms) {
  Json list = Json::array();
  for (const auto& form : forms) {
    list.push_back({{"form", form.name}});
    if (!form.reason.empty()) {
      list.back()["reason"] = form.reason;
      continue;
    }
    list.back().update({{"n_alpha", form.alpha},
                        {"n_theta", form.theta},
                        {"n_beta", form.beta},
                        {"n_alg", form.algebraic},
                        {"n_comp", form.complementarities},
                        {"n_eq", form.equations}});
  }
  return list;
}

void add_overview(Json& json, const ModelOverview& overview) {
  json["name"] = overview.name;
  json["description"] = overview.description;
  json["states"] = quantities_json(overview.states);
  json["parameters"] = quantities_json(overview.parameters);
  json["controls"] = quantities_json(overview.controls);
  json["equations"] = equations_json(overview.equations);
  if (!overview.contacts.empty()) json["contacts"] = equations_json(overview.contacts);
  json["modes"] = modes_json(overview.modes);
  json["definitions"] = equations_json(overview.definitions);
  json["outputs"] = equations_json(overview.outputs);
  json["surfaces"] = surfaces_json(overview.surfaces);
  json["piecewise_functions"] = equations_json(overview.cells);
  json["events"] = events_json(overview);
  json["jumps"] = jumps_json(overview);
  json["inclusion"] = {{"kind", overview.inclusion},
                       {"multi_affine", overview.multi_affine},
                       {"differs_in", overview.inclusion_differences}};
  json["complementarity_systems"] = forms_json(overview.forms);
  json["warnings"] = overview.warnings;
}

Json counts_json(const pipeline::OcpCounts& counts) {
  return {{"variables", counts.variables},
          {"equations", counts.equations},
          {"pairs", counts.pairs},
          {"nonzeros", counts.nonzeros}};
}

Json optimization_json(const pipeline::OcpOverview& optimization) {
  Json intervals = Json::array();
  for (const auto& interval : optimization.intervals) intervals.push_back(counts_json(interval));
  return {{"problem", counts_json(optimization.problem)},
          {"intervals", std::move(intervals)},
          {"warnings", optimization.warnings}};
}

}  // namespace

std::string check_json(const std::string& file, const std::vector<Error>& errors, const ModelOverview* overview,
                       const pipeline::OcpOverview* optimization) {
  Json json = {{"format", "saltus-check/1"}, {"file", file}, {"valid", errors.empty()}, {"errors", Json::array()}};
  for (const auto& error : errors) json["errors"].push_back(error_json(error));
  if (overview != nullptr) add_overview(json, *overview);
  if (optimization != nullptr) json["optimization"] = optimization_json(*optimization);
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace saltus::io
