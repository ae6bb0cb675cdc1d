// JSON -> Result.
#include <algorithm>
#include <cstddef>

#include "saltus/io/atomic_file.hpp"
#include "saltus/io/json_reader_internal.hpp"
#include "saltus/io/json_result.hpp"

namespace saltus::io {
namespace {

constexpr std::string_view format_name = "saltus-result/1";

void read_model(JsonReader& reader, const Json& json, const std::string& path, result::ModelRecord& model) {
  reader.read_member(json, path, "name", model.name);
  reader.read_member(json, path, "sha256", model.sha256);
  if (json.is_object() && json.contains("description"))
    reader.read_member(json, path, "description", model.description);
  const auto* parameters = reader.member(json, path, "parameters");
  if (parameters == nullptr) return;
  if (!parameters->is_object()) {
    reader.mismatch(path + "/parameters", "an object", *parameters);
    return;
  }
  for (const auto& [name, value] : parameters->items()) {
    double number = 0.0;
    reader.read(value, path + "/parameters/" + name, number);
    model.parameters.emplace_back(name, number);
  }
}

void read_status(JsonReader& reader, const Json& json, const std::string& path, result::Status& status) {
  std::string word;
  reader.read_member(json, path, "termination", word);
  const auto termination = result::termination_named(word);
  if (!termination) reader.fail(path + "/termination", fmt::format("'{}' is no termination", word));
  status.termination = termination.value_or(result::Termination::completed);
  reader.read_member(json, path, "message", status.message);
  reader.read_member(json, path, "time_reached", status.time_reached);
}

void read_alternatives(JsonReader& reader, const Json& json, const std::string& path, result::Event& event) {
  if (!json.is_array()) {
    reader.mismatch(path, "a list", json);
    return;
  }
  for (std::size_t i = 0; i < json.size(); ++i) {
    result::Alternative alternative;
    const auto here = fmt::format("{}/{}", path, i);
    reader.read_member(json[i], here, "mode", alternative.mode);
    reader.read_member(json[i], here, "alpha", alternative.alpha);
    event.alternatives.push_back(std::move(alternative));
  }
}

result::Event read_event(JsonReader& reader, const Json& json, const std::string& path) {
  result::Event event;
  std::string word;
  reader.read_member(json, path, "t", event.t);
  reader.read_member(json, path, "kind", word);
  const auto kind = result::event_kind_named(word);
  if (!kind) reader.fail(path + "/kind", fmt::format("'{}' is no kind of event", word));
  event.kind = kind.value_or(result::EventKind::crossing);
  reader.read_member(json, path, "name", event.name);
  reader.read_member(json, path, "surfaces", event.surfaces);
  reader.read_member(json, path, "mode_before", event.mode_before);
  reader.read_member(json, path, "mode_after", event.mode_after);
  reader.read_member(json, path, "alpha_before", event.alpha_before);
  reader.read_member(json, path, "alpha_after", event.alpha_after);
  reader.read_member(json, path, "x", event.x);
  reader.read_member(json, path, "x_after", event.x_after);
  reader.read_member(json, path, "unique", event.unique);
  if (const auto* others = reader.member(json, path, "alternatives")) {
    read_alternatives(reader, *others, path + "/alternatives", event);
  }
  reader.read_member(json, path, "reason", event.reason);
  return event;
}

void read_events(JsonReader& reader, const Json& json, const std::string& path, std::vector<result::Event>& events) {
  if (!json.is_array()) {
    reader.mismatch(path, "a list", json);
    return;
  }
  for (std::size_t i = 0; i < json.size(); ++i)
    events.push_back(read_event(reader, json[i], fmt::format("{}/{}", path, i)));
}

void read_trajectory(JsonReader& reader, const Json& json, const std::string& path, result::Trajectory& trajectory) {
  reader.read_member(json, path, "t", trajectory.t);
  reader.read_member(json, path, "x", trajectory.x);
  reader.read_member(json, path, "u", trajectory.u);
  reader.read_member(json, path, "alpha", trajectory.alpha);
  reader.read_member(json, path, "mode", trajectory.mode);
  reader.read_member(json, path, "outputs", trajectory.outputs);
}

void read_affine(JsonReader& reader, const Json& json, const std::string& path, result::Surface& surface) {
  if (json.is_null()) return;
  surface.affine.emplace();
  reader.read_member(json, path, "gradient", surface.affine->gradient);
  reader.read_member(json, path, "rate", surface.affine->rate);
  reader.read_member(json, path, "constant", surface.affine->constant);
}

void read_curves(JsonReader& reader, const Json& json, const std::string& path, result::Surface& surface) {
  if (!json.is_array()) {
    reader.mismatch(path, "a list", json);
    return;
  }
  for (std::size_t i = 0; i < json.size(); ++i) {
    result::SurfaceCurve curve;
    const auto here = fmt::format("{}/{}", path, i);
    reader.read_member(json[i], here, "t", curve.t);
    reader.read_member(json[i], here, "coordinates", curve.coordinates);
    surface.curves.push_back(std::move(curve));
  }
}

result::Surface read_surface(JsonReader& reader, const Json& json, const std::string& path) {
  result::Surface surface;
  std::string word;
  reader.read_member(json, path, "name", surface.name);
  reader.read_member(json, path, "role", word);
  const auto role = result::surface_role_named(word);
  if (!role) reader.fail(path + "/role", fmt::format("'{}' is no role of a surface", word));
  surface.role = role.value_or(result::SurfaceRole::switching);
  reader.read_member(json, path, "states", surface.states);
  reader.read_member(json, path, "depends_on_time", surface.depends_on_time);
  if (const auto* affine = reader.member(json, path, "affine")) {
    read_affine(reader, *affine, path + "/affine", surface);
  }
  if (const auto* curves = reader.member(json, path, "curves")) read_curves(reader, *curves, path + "/curves", surface);
  return surface;
}

void read_surfaces(JsonReader& reader, const Json& json, const std::string& path,
                   std::vector<result::Surface>& surfaces) {
  if (!json.is_array()) {
    reader.mismatch(path, "a list", json);
    return;
  }
  for (std::size_t i = 0; i < json.size(); ++i)
    surfaces.push_back(read_surface(reader, json[i], fmt::format("{}/{}", path, i)));
}

void read_final(JsonReader& reader, const Json& json, const std::string& path, result::Final& final) {
  reader.read_member(json, path, "t", final.t);
  reader.read_member(json, path, "x", final.x);
  reader.read_member(json, path, "mode", final.mode);
  reader.read_member(json, path, "alpha", final.alpha);
  reader.read_member(json, path, "outputs", final.outputs);
}

void read_statistics(JsonReader& reader, const Json& json, const std::string& path, result::Statistics& statistics) {
  reader.read_member(json, path, "steps", statistics.steps);
  reader.read_member(json, path, "rejected", statistics.rejected);
  reader.read_member(json, path, "rhs_evaluations", statistics.rhs_evaluations);
  reader.read_member(json, path, "wall_seconds", statistics.wall_seconds);
}

void read_options(JsonReader& reader, const Json& json, const std::string& path, result::OptionRecord& options) {
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
    } else if (value.is_array()) {
      add(std::vector<double>{});
    } else {
      add(double{});
    }
  }
}

/// Every row of a table must have as many entries as there are names, and every table as many rows as times.
template <class Rows>
void check_rows(JsonReader& reader, const std::string& path, const Rows& rows, std::size_t times, std::size_t names) {
  if (rows.size() != times) {
    reader.fail(path, fmt::format("expected as many rows as times, {}, found {}", times, rows.size()));
  }
  const auto wrong = std::find_if(rows.begin(), rows.end(), [&](const auto& row) { return row.size() != names; });
  if (wrong == rows.end()) return;
  reader.fail(fmt::format("{}/{}", path, wrong - rows.begin()),
              fmt::format("expected {} entries, found {}", names, wrong->size()));
}

template <class Vector>
void check_length(JsonReader& reader, const std::string& path, const Vector& vector, std::size_t expected) {
  if (vector.size() == expected) return;
  reader.fail(path, fmt::format("expected {} entries, found {}", expected, vector.size()));
}

void check_event_lengths(JsonReader& reader, const result::Event& event, const std::string& path, std::size_t states,
                         std::size_t columns) {
  check_length(reader, path + "/x", event.x, states);
  check_length(reader, path + "/x_after", event.x_after, states);
  if (event.mode_before) check_length(reader, path + "/mode_before", *event.mode_before, columns);
  if (event.mode_after) check_length(reader, path + "/mode_after", *event.mode_after, columns);
  if (event.alpha_before) check_length(reader, path + "/alpha_before", *event.alpha_before, columns);
  if (event.alpha_after) check_length(reader, path + "/alpha_after", *event.alpha_after, columns);
}

void check_surface(JsonReader& reader, const result::Surface& surface, const std::string& path,
                   const std::vector<std::string>& states) {
  for (const auto& name : surface.states) {
    if (std::find(states.begin(), states.end(), name) != states.end()) continue;
    reader.fail(path + "/states", fmt::format("'{}' is no state", name));
  }
  if (surface.affine) check_length(reader, path + "/affine/gradient", surface.affine->gradient, surface.states.size());
  for (std::size_t i = 0; i < surface.curves.size(); ++i) {
    const auto& coordinates = surface.curves[i].coordinates;
    const auto here = fmt::format("{}/curves/{}/coordinates", path, i);
    check_length(reader, here, coordinates, surface.states.size());
    for (const auto& column : coordinates) check_length(reader, here, column, coordinates.front().size());
  }
}

/// What tables and reports rely on when they index.
void check_shapes(JsonReader& reader, const std::string& path, const result::Result& result) {
  const auto& trajectory = result.trajectory;
  const std::size_t times = trajectory.t.size();
  const std::size_t columns = result.switching_functions.size();
  check_rows(reader, path + "/trajectory/x", trajectory.x, times, result.states.size());
  check_rows(reader, path + "/trajectory/u", trajectory.u, times, result.controls.size());
  check_rows(reader, path + "/trajectory/alpha", trajectory.alpha, times, columns);
  check_rows(reader, path + "/trajectory/mode", trajectory.mode, times, columns);
  check_rows(reader, path + "/trajectory/outputs", trajectory.outputs, times, result.outputs.size());
  check_length(reader, path + "/final/x", result.final.x, result.states.size());
  check_length(reader, path + "/final/mode", result.final.mode, columns);
  check_length(reader, path + "/final/alpha", result.final.alpha, columns);
  check_length(reader, path + "/final/outputs", result.final.outputs, result.outputs.size());
  for (std::size_t i = 0; i < result.events.size(); ++i) {
    check_event_lengths(reader, result.events[i], fmt::format("{}/events/{}", path, i), result.states.size(), columns);
  }
  for (std::size_t i = 0; i < result.surfaces.size(); ++i) {
    check_surface(reader, result.surfaces[i], fmt::format("{}/surfaces/{}", path, i), result.states);
  }
}

/// A branch has the columns of its parent, and leaves it at an alternative of an event that it lists.
void check_branch(JsonReader& reader, const std::string& path, const result::Result& parent,
                  const result::Result& branch) {
  const bool same = branch.states == parent.states && branch.controls == parent.controls &&
                    branch.switching_functions == parent.switching_functions && branch.outputs == parent.outputs;
  if (!same) reader.fail(path, "expected the states, controls, switching functions and outputs of what it leaves");
  if (!branch.left_at) {
    reader.fail(path, "'left_at' is missing");
    return;
  }
  const auto& [event, alternative] = *branch.left_at;
  if (event >= parent.events.size() || alternative >= parent.events[event].alternatives.size()) {
    reader.fail(path + "/left_at",
                fmt::format("what it leaves has no alternative {} of an event {}", alternative, event));
  }
  if (branch.events.empty()) reader.fail(path + "/events", "expected the event at which it leaves, found none");
}

void read_format(JsonReader& reader, const Json& json) {
  std::string format;
  reader.read_member(json, "", "format", format);
  if (format == format_name) return;
  reader.fail("/format", fmt::format("expected \"{}\", found \"{}\": no result of this version", format_name, format));
}

/// Applies a reader of a part to the member `key`.
template <class Read, class Part>
void read_part(JsonReader& reader, const Json& json, const std::string& path, const char* key, Read read, Part& part) {
  if (const auto* member = reader.member(json, path, key)) read(reader, *member, path + "/" + key, part);
}

void read_departure(JsonReader& reader, const Json& json, const std::string& path,
                    std::optional<result::Departure>& left_at) {
  const auto number = [&](const char* key) {
    std::int64_t value = 0;
    reader.read_member(json, path, key, value);
    if (value < 0) reader.fail(path + "/" + key, fmt::format("expected a number from 0, found {}", value));
    return static_cast<std::size_t>(std::max<std::int64_t>(value, 0));
  };
  left_at = result::Departure{number("event"), number("alternative")};
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

result::Result read_whole(JsonReader& reader, const Json& json, const std::string& path, int depth) {
  result::Result result;
  read_part(reader, json, path, "model", read_model, result.model);
  reader.read_member(json, path, "command", result.command);
  reader.read_member(json, path, "method", result.method);
  read_part(reader, json, path, "status", read_status, result.status);
  reader.read_member(json, path, "states", result.states);
  reader.read_member(json, path, "controls", result.controls);
  reader.read_member(json, path, "switching_functions", result.switching_functions);
  reader.read_member(json, path, "outputs", result.outputs);
  read_part(reader, json, path, "final", read_final, result.final);
  read_part(reader, json, path, "events", read_events, result.events);
  read_part(reader, json, path, "trajectory", read_trajectory, result.trajectory);
  // Results of versions before surfaces were recorded have none.
  if (json.is_object() && json.contains("surfaces")) {
    read_part(reader, json, path, "surfaces", read_surfaces, result.surfaces);
  }
  read_part(reader, json, path, "statistics", read_statistics, result.statistics);
  read_part(reader, json, path, "options", read_options, result.options);
  if (json.is_object() && json.contains("left_at")) {
    read_part(reader, json, path, "left_at", read_departure, result.left_at);
  }
  if (!reader.error()) check_shapes(reader, path, result);
  if (json.is_object() && json.contains("branches")) {
    read_branches(reader, json["branches"], path + "/branches", depth + 1, result);
  }
  return result;
}

Error syntax_error(const std::string& text, const std::string& file, std::size_t byte) {
  const auto before = std::string_view(text).substr(0, byte > 0 ? byte - 1 : 0);
  const auto line = 1 + std::count(before.begin(), before.end(), '\n');
  const auto line_start = before.rfind('\n') + 1;  // npos + 1 is 0: the first line
  return {ErrorCode::parse_failure,
          text.empty() ? "the file is empty" : "not valid JSON",
          "expected a result file written by saltus simulate --out FILE.json",
          {file, static_cast<int>(line), static_cast<int>(before.size() - line_start + 1)},
          {}};
}

}  // namespace

Expected<result::Result> parse_result(const std::string& text, const std::string& file) {
  Json json;
  try {
    json = Json::parse(text);
  } catch (const Json::parse_error& failure) {
    return tl::unexpected(syntax_error(text, file, failure.byte));
  } catch (const Json::exception&) {  // a number beyond the range of a double
    return tl::unexpected(syntax_error(text, file, 1));
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
