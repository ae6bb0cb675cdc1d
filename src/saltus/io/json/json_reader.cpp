// JSON -> Result.
#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <limits>
#include <string_view>
#include <system_error>

#include <fmt/format.h>

#include "saltus/io/atomic_file.hpp"
#include "saltus/io/json/json_facts_internal.hpp"
#include "saltus/io/json/json_record_members_internal.hpp"
#include "saltus/io/json/json_result.hpp"
#include "saltus/io/json/json_shapes_internal.hpp"
#include "saltus/io/sha256.hpp"

namespace saltus::io {
namespace {

constexpr std::string_view format_name = "saltus-result/1";

/// Applies a reader of a part to the member `key`.
template <class Read, class Part>
void read_with(JsonReader& reader, const Json& json, const std::string& path, const char* key, Read read, Part& part) {
  if (const auto* found = reader.member(json, path, key)) read(reader, *found, path + "/" + key, part);
}

/// Refuses what was edited.
void check_text(JsonReader& reader, const std::string& path, const std::string& text, const std::string& fingerprint,
                const std::string& what) {
  if (text.empty() || sha256(text) == fingerprint) return;
  reader.fail(path + "/text",
              fmt::format("{} is not the one with which it was computed: its sha256 was {}", what, fingerprint));
}

void read_model(JsonReader& reader, const Json& json, const std::string& path, result::ModelRecord& model) {
  reader.read_member(json, path, "name", model.name);
  reader.read_member(json, path, "sha256", model.sha256);
  reader.read_if_there(json, path, "description", model.description);
  read_part(reader, json, path, "parameters", model.parameters);
  if (!json.is_object()) return;
  read_part_if_there(reader, json, path, "initial_state", model.initial_state);
  if (json.contains("captions") && json["captions"].is_object()) {
    for (const auto& [name, caption] : json["captions"].items()) {
      model.captions.emplace_back(name, result::Caption{});
      read_record(reader, caption, path + "/captions/" + name, model.captions.back().second);
    }
  }
  read_part_if_there(reader, json, path, "equations", model.equations);
  reader.read_if_there(json, path, "file", model.file);
  reader.read_if_there(json, path, "text", model.text);
  check_text(reader, path, model.text, model.sha256, "the model in this result");
  reader.read_if_there(json, path, "set", model.settings);
  read_part_if_there(reader, json, path, "files", model.files);
}

/// Events whose vectors have the lengths that the names of the result say.
void read_recorded_events(JsonReader& reader, const Json& json, const std::string& path, result::Result& result) {
  reader.for_each_entry(json, path, [&](const Json& entry, std::size_t i) {
    const auto here = fmt::format("{}/{}", path, i);
    result::Event event;
    read_record(reader, entry, here, event);
    check_event_lengths(reader, event, here, result);
    if (!reader.error()) result.events.push_back(std::move(event));
  });
}

bool begins_with_text(const Json& list) {
  bool begins = false;
  for_each_piece(list, [&](const Json& piece) {
    begins = !piece.empty() && piece.front().is_string();
    return false;
  });
  return begins;
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
    } else if (is_list(value) && begins_with_text(value)) {
      add(std::vector<std::string>{});
    } else if (is_list(value)) {
      add(std::vector<double>{});
    } else {
      add(double{});
    }
  }
}

/// Refuses a record that was edited; results of earlier versions have no fingerprint.
void check_record(JsonReader& reader, const Json& json, const std::string& path, const result::Result& result) {
  std::string fingerprint;
  reader.read_if_there(json, path, "record_sha256", fingerprint);
  if (reader.error() || fingerprint.empty() || fingerprint == record_sha256(result)) return;
  reader.fail(path,
              "this result was edited: its model, status, end state or options are not those that were "
              "written; saltus simulate RESULT.json --set NAME=VALUE changes a value and runs it again");
}

void read_format(JsonReader& reader, const Json& json) {
  std::string format;
  reader.read_member(json, "", "format", format);
  if (format == format_name) return;
  reader.fail("/format", fmt::format("expected \"{}\", found \"{}\": no result of this version", format_name, format));
}

void read_departure(JsonReader& reader, const Json& json, const std::string& path,
                    std::optional<result::Departure>& left_at) {
  read_part(reader, json, path, "event", left_at.emplace().event);
  if (!json.contains("family")) return read_part(reader, json, path, "alternative", left_at->alternative);
  read_part(reader, json, path, "family", left_at->member.emplace().family);
  reader.read_member(json, path, "parameter", left_at->member->parameter);
}

void read_vector_field(JsonReader& reader, const Json& json, const std::string& path,
                       std::optional<result::VectorField>& vectors) {
  read_record(reader, json, path, vectors.emplace());
  for (const auto& [name, arrows] : {std::pair("free", &vectors->free), std::pair("sides", &vectors->sides),
                                     std::pair("sliding", &vectors->sliding)}) {
    const auto size = arrows->x.size();
    if (arrows->y.size() != size || arrows->dx.size() != size || arrows->dy.size() != size) {
      reader.fail(path + "/" + name, "expected x, y, dx and dy of one length");
    }
  }
}

std::optional<bool> is_disc_named(std::string_view name) {
  return name == "disc" ? std::optional(true) : name == "line" ? std::optional(false) : std::nullopt;
}
constexpr EnumWords<bool> shape_words{is_disc_named, "kind of what is drawn"};

result::DrawnShape read_shape(JsonReader& reader, const Json& json, const std::string& path) {
  result::DrawnShape shape;
  if (const auto* kind = reader.member(json, path, "kind")) {
    reader.read_word(*kind, path + "/kind", shape_words, shape.is_disc);
  }
  read_part(reader, json, path, "points", shape.points);
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
  reader.for_each_entry(json, path, [&](const Json& entry, std::size_t i) {
    const auto here = fmt::format("{}/{}", path, i);
    result.branches.push_back(read_whole(reader, entry, here, depth));
    if (!reader.error()) check_branch(reader, here, result, result.branches.back());
  });
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
  const auto has = [&](const char* key) { return json.is_object() && json.contains(key); };
  read_with(reader, json, path, "model", read_model, result.model);
  reader.read_member(json, path, "command", result.command);
  reader.read_if_there(json, path, "command_line", result.command_line);
  reader.read_if_there(json, path, "date", result.date);
  reader.read_member(json, path, "method", result.method);
  read_part(reader, json, path, "status", result.status);
  reader.read_member(json, path, "states", result.states);
  reader.read_member(json, path, "controls", result.controls);
  reader.read_member(json, path, "switching_functions", result.switching_functions);
  reader.read_member(json, path, "outputs", result.outputs);
  if (has("kept_columns")) read_with(reader, json, path, "kept_columns", read_kept_columns, result);
  read_part_if_there(reader, json, path, "region_groups", result.region_groups);
  reader.read_if_there(json, path, "contacts", result.contacts);
  read_part(reader, json, path, "final", result.final);
  read_with(reader, json, path, "events", read_recorded_events, result);
  read_part(reader, json, path, "trajectory", result.trajectory);
  if (has("drawing")) read_with(reader, json, path, "drawing", read_drawing, result.drawing);
  reader.read_if_there(json, path, "penetration", result.penetration);
  if (result.command == "optimize") {
    auto& optimization = result.optimization.emplace();
    read_record(reader, json, path, optimization);
    read_part(reader, json, path, "statistics", optimization.statistics);
    if (const auto* start = reader.member(json, path, "start_values")) {
      read_members(reader, *start, path + "/start_values", StartValues::list, optimization);
    }
  }
  // Results of versions before surfaces were recorded have none.
  read_part_if_there(reader, json, path, "surfaces", result.surfaces);
  if (has("vector_field")) read_with(reader, json, path, "vector_field", read_vector_field, result.vector_field);
  if (!result.optimization) read_part(reader, json, path, "statistics", result.statistics);
  read_with(reader, json, path, "options", read_option_record, result.options);
  read_part_if_there(reader, json, path, "sensitivities", result.sensitivities);
  read_part_if_there(reader, json, path, "error_estimate", result.error_estimate);
  read_part_if_there(reader, json, path, "elements", result.elements);
  if (has("comparison")) read_with(reader, json, path, "comparison", read_comparison, result.comparison);
  read_part_if_there(reader, json, path, "order", result.order);
  read_part_if_there(reader, json, path, "families", result.families);
  if (has("left_at")) read_with(reader, json, path, "left_at", read_departure, result.left_at);
  if (!reader.error()) check_shapes(reader, path, result);
  check_record(reader, json, path, result);
  if (has("branches")) {
    read_branches(reader, json["branches"], path + "/branches", depth + 1, result);
  }
  return result;
}

}  // namespace

Expected<result::Result> parse_result(const std::string& text, const std::string& file) {
  const auto json = parse_document(text, file);
  if (!json) return tl::unexpected(json.error());
  JsonReader reader(file);
  result::Result result;
  read_format(reader, *json);
  if (!reader.error()) result = read_whole(reader, *json, "", 0);
  if (reader.error()) return tl::unexpected(*reader.error());
  return result;
}

Expected<result::Result> read_result(const std::filesystem::path& file) {
  std::error_code ignored;
  for (const std::string_view table : {".csv", ".npz"}) {
    if (file.extension() != table || !std::filesystem::exists(file, ignored)) continue;
    return tl::unexpected(Error{
        ErrorCode::parse_failure,
        fmt::format("a {} file is a table, not the whole result", table),
        "a result is what saltus simulate or saltus optimize writes with --out FILE.json; a sweep draws its table "
        "with --report FILE.html, where every picture can be saved",
        {file.string(), 0, 0},
        {}});
  }
  // Devices have no end; what a run has written may be as large as it is.
  const bool has_end = std::filesystem::is_regular_file(file, ignored);
  const auto text = has_end ? read_file(file, std::numeric_limits<std::size_t>::max()) : read_file(file);
  if (!text) return tl::unexpected(text.error());
  return parse_result(*text, file.string());
}

}  // namespace saltus::io
