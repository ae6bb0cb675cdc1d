// JSON -> Result.
#include <algorithm>
#include <cstddef>

#include <fmt/format.h>

#include "saltus/io/atomic_file.hpp"
#include "saltus/io/json/json_optimization_internal.hpp"
#include "saltus/io/json/json_parts_internal.hpp"
#include "saltus/io/json/json_result.hpp"
#include "saltus/io/json/json_shapes_internal.hpp"
#include "saltus/io/sha256.hpp"

namespace saltus::io {
namespace {

constexpr std::string_view format_name = "saltus-result/1";

/// Refuses what was edited.
void check_text(JsonReader& reader, const std::string& path, const std::string& text, const std::string& fingerprint,
                const std::string& what) {
  if (text.empty() || sha256(text) == fingerprint) return;
  reader.fail(path + "/text",
              fmt::format("{} is not the one with which it was computed: its sha256 was {}", what, fingerprint));
}

result::NamedFile read_named_file(JsonReader& reader, const Json& json, const std::string& path) {
  result::NamedFile file;
  reader.read_member(json, path, "name", file.name);
  reader.read_member(json, path, "sha256", file.sha256);
  reader.read_member(json, path, "text", file.text);
  return file;
}

result::StatedEquation read_equation(JsonReader& reader, const Json& json, const std::string& path) {
  result::StatedEquation equation;
  reader.read_member(json, path, "left", equation.left);
  reader.read_member(json, path, "right", equation.right);
  reader.read_if_there(json, path, "where", equation.where);
  return equation;
}

void read_model(JsonReader& reader, const Json& json, const std::string& path, result::ModelRecord& model) {
  reader.read_member(json, path, "name", model.name);
  reader.read_member(json, path, "sha256", model.sha256);
  if (json.is_object() && json.contains("description"))
    reader.read_member(json, path, "description", model.description);
  read_part(reader, json, path, "parameters", read_numbers, model.parameters);
  if (!json.is_object()) return;
  if (json.contains("initial_state")) {
    read_part(reader, json, path, "initial_state", read_numbers, model.initial_state);
  }
  if (json.contains("captions") && json["captions"].is_object()) {
    for (const auto& [name, caption] : json["captions"].items()) {
      const auto place = path + "/captions/" + name;
      result::Caption read;
      reader.read_if_there(caption, place, "unit", read.unit);
      reader.read_if_there(caption, place, "label", read.label);
      model.captions.emplace_back(name, read);
    }
  }
  if (json.contains("equations")) {
    read_list(reader, json["equations"], path + "/equations", model.equations, read_equation);
  }
  reader.read_if_there(json, path, "file", model.file);
  reader.read_if_there(json, path, "text", model.text);
  check_text(reader, path, model.text, model.sha256, "the model in this result");
  reader.read_if_there(json, path, "set", model.settings);
  if (json.contains("files")) read_list(reader, json["files"], path + "/files", model.files, read_named_file);
}

result::Alternative read_alternative(JsonReader& reader, const Json& json, const std::string& path) {
  result::Alternative alternative;
  reader.read_member(json, path, "mode", alternative.mode);
  reader.read_member(json, path, "alpha", alternative.alpha);
  reader.read_if_there(json, path, "regions", alternative.regions);
  return alternative;
}

void read_intersection(JsonReader& reader, const Json& json, const std::string& path, result::Event& event) {
  auto& intersection = event.intersection.emplace();
  reader.read_member(json, path, "surfaces", intersection.surfaces);
  reader.read_member(json, path, "velocities", intersection.velocities);
  reader.read_member(json, path, "alpha_before", intersection.alpha_before);
  reader.read_member(json, path, "alpha_after", intersection.alpha_after);
}

result::Event read_recorded_event(JsonReader& reader, const Json& json, const std::string& path) {
  result::Event event;
  reader.read_member(json, path, "t", event.t);
  reader.read_word(json, path, "kind", result::event_kind_named, "kind of event", event.kind);
  reader.read_member(json, path, "name", event.name);
  reader.read_member(json, path, "surfaces", event.surfaces);
  reader.read_member(json, path, "mode_before", event.mode_before);
  reader.read_member(json, path, "mode_after", event.mode_after);
  reader.read_member(json, path, "alpha_before", event.alpha_before);
  reader.read_member(json, path, "alpha_after", event.alpha_after);
  reader.read_if_there(json, path, "regions_before", event.regions_before);
  reader.read_if_there(json, path, "regions_after", event.regions_after);
  reader.read_if_there(json, path, "contact_modes_before", event.contact_modes_before);
  reader.read_if_there(json, path, "contact_modes_after", event.contact_modes_after);
  reader.read_if_there(json, path, "impulse", event.impulse);
  reader.read_member(json, path, "x", event.x);
  reader.read_member(json, path, "x_after", event.x_after);
  reader.read_member(json, path, "unique", event.unique);
  if (const auto* others = reader.member(json, path, "alternatives")) {
    read_list(reader, *others, path + "/alternatives", event.alternatives, read_alternative);
  }
  reader.read_member(json, path, "reason", event.reason);
  if (json.is_object() && json.contains("intersection")) {
    read_intersection(reader, json["intersection"], path + "/intersection", event);
  }
  return event;
}

/// Events whose vectors have the lengths that the names of the result say.
void read_recorded_events(JsonReader& reader, const Json& json, const std::string& path, result::Result& result) {
  std::vector<result::Event> events;
  read_list(reader, json, path, events, read_recorded_event);
  for (std::size_t i = 0; i < events.size() && !reader.error(); ++i) {
    check_event_lengths(reader, events[i], fmt::format("{}/{}", path, i), result);
  }
  if (!reader.error()) result.events = events;
}

void read_trajectory(JsonReader& reader, const Json& json, const std::string& path, result::Trajectory& trajectory) {
  reader.read_member(json, path, "t", trajectory.t);
  reader.read_member(json, path, "x", trajectory.x);
  reader.read_member(json, path, "u", trajectory.u);
  reader.read_member(json, path, "alpha", trajectory.alpha);
  reader.read_member(json, path, "mode", trajectory.mode);
  reader.read_member(json, path, "outputs", trajectory.outputs);
  reader.read_if_there(json, path, "regions", trajectory.regions);
  reader.read_if_there(json, path, "theta", trajectory.theta);
  reader.read_if_there(json, path, "contact_modes", trajectory.contact_modes);
}

result::AffineSurface read_affine(JsonReader& reader, const Json& json, const std::string& path) {
  result::AffineSurface affine;
  reader.read_member(json, path, "gradient", affine.gradient);
  reader.read_member(json, path, "rate", affine.rate);
  reader.read_member(json, path, "constant", affine.constant);
  return affine;
}

result::SurfaceCurve read_curve(JsonReader& reader, const Json& json, const std::string& path) {
  result::SurfaceCurve curve;
  reader.read_member(json, path, "t", curve.t);
  reader.read_member(json, path, "coordinates", curve.coordinates);
  return curve;
}

result::Surface read_surface(JsonReader& reader, const Json& json, const std::string& path) {
  result::Surface surface;
  reader.read_member(json, path, "name", surface.name);
  reader.read_word(json, path, "role", result::surface_role_named, "role of a surface", surface.role);
  reader.read_member(json, path, "states", surface.states);
  reader.read_member(json, path, "depends_on_time", surface.depends_on_time);
  if (const auto* affine = reader.member(json, path, "affine"); affine && !affine->is_null()) {
    surface.affine = read_affine(reader, *affine, path + "/affine");
  }
  if (json.contains("within")) {
    read_list(reader, *reader.member(json, path, "within"), path + "/within", surface.within, read_affine);
  }
  if (const auto* curves = reader.member(json, path, "curves")) {
    read_list(reader, *curves, path + "/curves", surface.curves, read_curve);
  }
  return surface;
}

void read_surfaces(JsonReader& reader, const Json& json, const std::string& path,
                   std::vector<result::Surface>& surfaces) {
  read_list(reader, json, path, surfaces, read_surface);
}

void read_final(JsonReader& reader, const Json& json, const std::string& path, result::Final& final) {
  reader.read_member(json, path, "t", final.t);
  reader.read_member(json, path, "x", final.x);
  reader.read_member(json, path, "mode", final.mode);
  reader.read_member(json, path, "alpha", final.alpha);
  reader.read_member(json, path, "outputs", final.outputs);
  reader.read_if_there(json, path, "regions", final.regions);
  reader.read_if_there(json, path, "theta", final.theta);
  reader.read_if_there(json, path, "contact_modes", final.contact_modes);
}

void read_option_record(JsonReader& reader, const Json& json, const std::string& path, result::OptionRecord& options) {
  if (!json.is_object()) {
    reader.mismatch(path, "an object", json);
    return;
  }
  for (const auto& [name, value] : json.items()) {
    const auto here = path + "/" + name;
    const auto add = [&, &key = name, &content = value](auto target) {
      reader.read(content, here, target);
      options.emplace_back(key, std::move(target));
    };
    if (value.is_boolean()) {
      add(bool{});
    } else if (value.is_number_integer()) {
      add(std::int64_t{});
    } else if (value.is_string()) {
      add(std::string{});
    } else if (value.is_array() && !value.empty() && value.front().is_string()) {
      add(std::vector<std::string>{});
    } else if (value.is_array()) {
      add(std::vector<double>{});
    } else {
      add(double{});
    }
  }
}

void read_format(JsonReader& reader, const Json& json) {
  std::string format;
  reader.read_member(json, "", "format", format);
  if (format == format_name) return;
  reader.fail("/format", fmt::format("expected \"{}\", found \"{}\": no result of this version", format_name, format));
}

result::Family read_family(JsonReader& reader, const Json& json, const std::string& path) {
  result::Family family;
  reader.read_word(json, path, "kind", result::family_kind_named, "kind of a family", family.kind);
  family.event = read_number(reader, json, path, "event");
  reader.read_member(json, path, "from", family.from);
  reader.read_member(json, path, "until", family.until);
  if (const auto* to = reader.member(json, path, "to")) family.to = read_alternative(reader, *to, path + "/to");
  reader.read_if_there(json, path, "lap_ratio", family.lap_ratio);
  return family;
}

void read_departure(JsonReader& reader, const Json& json, const std::string& path,
                    std::optional<result::Departure>& left_at) {
  left_at = result::Departure{read_number(reader, json, path, "event")};
  if (!json.contains("family")) {
    left_at->alternative = read_number(reader, json, path, "alternative");
    return;
  }
  left_at->member.emplace();
  left_at->member->family = read_number(reader, json, path, "family");
  reader.read_member(json, path, "parameter", left_at->member->parameter);
}

void read_arrows(JsonReader& reader, const Json& json, const std::string& path, result::Arrows& arrows) {
  reader.read_member(json, path, "x", arrows.x);
  reader.read_member(json, path, "y", arrows.y);
  reader.read_member(json, path, "dx", arrows.dx);
  reader.read_member(json, path, "dy", arrows.dy);
  const auto size = arrows.x.size();
  if (arrows.y.size() != size || arrows.dx.size() != size || arrows.dy.size() != size) {
    reader.fail(path, "expected x, y, dx and dy of one length");
  }
}

void read_vector_field(JsonReader& reader, const Json& json, const std::string& path,
                       std::optional<result::VectorField>& field) {
  field.emplace();
  reader.read_member(json, path, "t", field->t);
  read_part(reader, json, path, "free", read_arrows, field->free);
  read_part(reader, json, path, "sides", read_arrows, field->sides);
  read_part(reader, json, path, "sliding", read_arrows, field->sliding);
}

std::optional<bool> is_disc_named(std::string_view name) {
  return name == "disc" ? std::optional(true) : name == "line" ? std::optional(false) : std::nullopt;
}

result::DrawnShape read_shape(JsonReader& reader, const Json& json, const std::string& path) {
  result::DrawnShape shape;
  reader.read_word(json, path, "kind", is_disc_named, "kind of what is drawn", shape.is_disc);
  shape.points = read_number(reader, json, path, "points");
  if (!reader.error() && shape.is_disc != (shape.points == 1)) {
    reader.fail(path + "/points", fmt::format("expected 1 of a disc and more of a line, found {}", shape.points));
  }
  return shape;
}

void read_drawing(JsonReader& reader, const Json& json, const std::string& path,
                  std::optional<result::Drawing>& drawing) {
  drawing.emplace();
  if (const auto* shapes = reader.member(json, path, "shapes")) {
    read_list(reader, *shapes, path + "/shapes", drawing->shapes, read_shape);
  }
  reader.read_member(json, path, "rows", drawing->rows);
}

result::Result read_whole(JsonReader& reader, const Json& json, const std::string& path, int depth);

void read_branches(JsonReader& reader, const Json& json, const std::string& path, int depth, result::Result& result) {
  constexpr int deepest = 500;  // one level for every decision on the way to a branch
  if (depth > deepest) reader.fail(path, fmt::format("branches of branches, more than {} deep", deepest));
  if (!json.is_array()) reader.mismatch(path, "a list", json);
  for (std::size_t i = 0; i < json.size() && !reader.error(); ++i) {
    const auto here = fmt::format("{}/{}", path, i);
    result.branches.push_back(read_whole(reader, json[i], here, depth));
    if (!reader.error()) check_branch(reader, here, result, result.branches.back());
  }
}

result::RegionGroup read_region_group(JsonReader& reader, const Json& json, const std::string& path) {
  result::RegionGroup group;
  reader.read_member(json, path, "name", group.name);
  reader.read_member(json, path, "modes", group.modes);
  return group;
}

/// The places of names in a list, ascending.
std::vector<std::size_t> read_places(JsonReader& reader, const Json& json, const std::string& path, const char* key,
                                     const std::vector<std::string>& all) {
  std::vector<std::string> names;
  reader.read_member(json, path, key, names);
  std::vector<std::size_t> places;
  for (const auto& name : names) {
    const auto from = all.begin() + static_cast<std::ptrdiff_t>(places.empty() ? 0 : places.back() + 1);
    const auto found = std::find(from, all.end(), name);
    if (found == all.end()) {
      reader.fail(fmt::format("{}/{}", path, key),
                  fmt::format("expected names of {}, in its order; found '{}'", key, name));
      return {};
    }
    places.push_back(static_cast<std::size_t>(found - all.begin()));
  }
  return places;
}

void read_kept_columns(JsonReader& reader, const Json& json, const std::string& path, result::Result& result) {
  auto states = read_places(reader, json, path, "states", result.states);
  result.kept = {std::move(states), read_places(reader, json, path, "switching_functions", result.switching_functions)};
}

result::Result read_whole(JsonReader& reader, const Json& json, const std::string& path, int depth) {
  result::Result result;
  read_part(reader, json, path, "model", read_model, result.model);
  reader.read_member(json, path, "command", result.command);
  reader.read_if_there(json, path, "command_line", result.command_line);
  reader.read_member(json, path, "method", result.method);
  read_part(reader, json, path, "status", read_status, result.status);
  reader.read_member(json, path, "states", result.states);
  reader.read_member(json, path, "controls", result.controls);
  reader.read_member(json, path, "switching_functions", result.switching_functions);
  reader.read_member(json, path, "outputs", result.outputs);
  if (json.is_object() && json.contains("kept_columns")) {
    read_part(reader, json, path, "kept_columns", read_kept_columns, result);
  }
  if (json.is_object() && json.contains("region_groups")) {
    read_list(reader, json["region_groups"], path + "/region_groups", result.region_groups, read_region_group);
  }
  reader.read_if_there(json, path, "contacts", result.contacts);
  read_part(reader, json, path, "final", read_final, result.final);
  read_part(reader, json, path, "events", read_recorded_events, result);
  read_part(reader, json, path, "trajectory", read_trajectory, result.trajectory);
  if (json.is_object() && json.contains("drawing")) {
    read_part(reader, json, path, "drawing", read_drawing, result.drawing);
  }
  reader.read_if_there(json, path, "penetration", result.penetration);
  if (result.command == "optimize") read_optimization(reader, json, path, result.optimization.emplace());
  // Results of versions before surfaces were recorded have none.
  if (json.is_object() && json.contains("surfaces")) {
    read_part(reader, json, path, "surfaces", read_surfaces, result.surfaces);
  }
  if (json.is_object() && json.contains("vector_field")) {
    read_part(reader, json, path, "vector_field", read_vector_field, result.vector_field);
  }
  if (!result.optimization) read_part(reader, json, path, "statistics", read_statistics, result.statistics);
  read_part(reader, json, path, "options", read_option_record, result.options);
  if (json.is_object() && json.contains("sensitivities")) {
    read_part(reader, json, path, "sensitivities", read_sensitivities, result.sensitivities);
  }
  if (json.is_object() && json.contains("elements")) {
    read_part(reader, json, path, "elements", read_elements, result.elements);
  }
  if (json.is_object() && json.contains("comparison")) {
    read_part(reader, json, path, "comparison", read_comparison, result.comparison);
  }
  if (json.is_object() && json.contains("order")) read_part(reader, json, path, "order", read_order, result.order);
  if (json.is_object() && json.contains("families")) {
    read_list(reader, json["families"], path + "/families", result.families, read_family);
  }
  if (json.is_object() && json.contains("left_at")) {
    read_part(reader, json, path, "left_at", read_departure, result.left_at);
  }
  if (!reader.error()) check_shapes(reader, path, result);
  if (json.is_object() && json.contains("branches")) {
    read_branches(reader, json["branches"], path + "/branches", depth + 1, result);
  }
  return result;
}

Error json_syntax_error(const std::string& text, const std::string& file, std::size_t byte) {
  const auto before = std::string_view(text).substr(0, byte > 0 ? byte - 1 : 0);
  const auto line = 1 + std::count(before.begin(), before.end(), '\n');
  const auto line_start = before.rfind('\n') + 1;  // npos + 1 is 0: the first line
  return {ErrorCode::parse_failure,
          text.empty() ? "the file is empty" : "not valid JSON",
          "expected a result file written by saltus simulate or saltus optimize with --out FILE.json",
          {file, static_cast<int>(line), static_cast<int>(before.size() - line_start + 1)},
          {}};
}

}  // namespace

Expected<result::Result> parse_result(const std::string& text, const std::string& file) {
  Json json;
  try {
    json = Json::parse(text);
  } catch (const Json::parse_error& failure) {
    return tl::unexpected(json_syntax_error(text, file, failure.byte));
  } catch (const Json::exception&) {  // a number beyond the range of a double
    return tl::unexpected(json_syntax_error(text, file, 1));
  }
  JsonReader reader(file);
  result::Result result;
  read_format(reader, json);
  if (!reader.error()) result = read_whole(reader, json, "", 0);
  if (reader.error()) return tl::unexpected(*reader.error());
  return result;
}

Expected<result::Result> read_result(const std::filesystem::path& file) {
  const auto text = read_file(file);
  if (!text) return tl::unexpected(text.error());
  return parse_result(*text, file.string());
}

}  // namespace saltus::io
