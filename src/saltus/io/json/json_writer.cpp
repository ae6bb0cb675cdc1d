// Result -> JSON.
#include <cmath>
#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <utility>

#include "saltus/base/version.hpp"
#include "saltus/io/json/json_optimization_internal.hpp"
#include "saltus/io/json/json_parts_internal.hpp"
#include "saltus/io/json/json_result.hpp"
#include "saltus/io/json/json_stream_internal.hpp"
#include "saltus/result/kept_columns.hpp"

namespace saltus::io {
namespace {

Json named_file_json(const result::NamedFile& file) {
  Json json = Json::object();
  json["name"] = file.name;
  json["sha256"] = file.sha256;
  json["text"] = or_null(file.text);
  return json;
}

Json model_json(const result::ModelRecord& model) {
  Json json = Json::object();
  json["name"] = model.name;
  json["sha256"] = model.sha256;
  json["parameters"] = numbers_json(model.parameters);
  json["initial_state"] = numbers_json(model.initial_state);
  json["description"] = model.description;
  for (const auto& [name, caption] : model.captions) {
    json["captions"][name] = {{"unit", caption.unit}, {"label", caption.label}};
  }
  for (const auto& [left, right, where] : model.equations) {
    json["equations"].push_back({{"left", left}, {"right", right}, {"where", where}});
  }
  if (model.text.empty()) return json;
  json["file"] = model.file;
  json["text"] = model.text;
  json["files"] = Json::array();
  for (const auto& file : model.files) json["files"].push_back(named_file_json(file));
  json["set"] = model.settings;
  return json;
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

Json contact_modes_json(const std::vector<result::ContactMode>& modes) {
  Json json = Json::array();
  for (const auto mode : modes) json.push_back(name(mode));
  return json;
}

void append_event(TextStream& stream, const result::Event& event, std::size_t indent) {
  ObjectStream object(stream, indent);
  const auto put = [&](const char* key, const auto& value) { append_json(object.key(key), value); };
  put("t", event.t);
  put("kind", std::string(name(event.kind)));
  put("name", event.name);
  put("surfaces", event.surfaces);
  put("mode_before", event.mode_before);
  put("mode_after", event.mode_after);
  put("alpha_before", event.alpha_before);
  put("alpha_after", event.alpha_after);
  if (event.regions_before) object.member("regions_before", *event.regions_before);
  if (event.regions_after) object.member("regions_after", *event.regions_after);
  if (!event.contact_modes_before.empty()) {
    object.member("contact_modes_before", contact_modes_json(event.contact_modes_before));
    object.member("contact_modes_after", contact_modes_json(event.contact_modes_after));
  }
  if (event.impulse) object.member("impulse", *event.impulse);
  put("x", event.x);
  put("x_after", event.x_after);
  object.key("unique") += !event.unique ? "null" : *event.unique ? "true" : "false";
  Json alternatives = Json::array();
  for (const auto& other : event.alternatives) alternatives.push_back(alternative_json(other));
  object.member("alternatives", alternatives);
  put("reason", event.reason);
  if (event.intersection) object.member("intersection", intersection_json(*event.intersection));
  object.end();
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
  if (!final.contact_modes.empty()) json["contact_modes"] = contact_modes_json(final.contact_modes);
  return json;
}

/// The lists of a trajectory but for its times: append_rows(name, table, append_row).
template <class Rows>
void for_each_list(const result::Trajectory& trajectory, Rows append_rows) {
  const auto numbers = [](std::string& text, const auto& row) { append_json(text, row); };
  append_rows("x", trajectory.x, numbers);
  append_rows("u", trajectory.u, numbers);
  append_rows("alpha", trajectory.alpha, numbers);
  append_rows("mode", trajectory.mode, numbers);
  append_rows("outputs", trajectory.outputs, numbers);
  if (!trajectory.regions.empty()) {
    append_rows("regions", trajectory.regions, numbers);
    append_rows("theta", trajectory.theta, numbers);
  }
  if (!trajectory.contact_modes.empty()) {
    append_rows("contact_modes", trajectory.contact_modes,
                [](std::string& text, const auto& row) { text += contact_modes_json(row).dump(); });
  }
}

void append_trajectory(TextStream& stream, const result::Trajectory& trajectory, std::size_t indent) {
  ObjectStream object(stream, indent);
  object.line("t", trajectory.t);
  for_each_list(trajectory, [&](const char* key, const auto& table, auto append_row) {
    object.list(key, table, [&](const auto& row, std::size_t) { append_row(stream.text(), row); });
  });
  object.end();
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

Json arrows_json(const result::Arrows& arrows) {
  return {{"x", arrows.x}, {"y", arrows.y}, {"dx", arrows.dx}, {"dy", arrows.dy}};
}

Json vector_field_json(const result::VectorField& field) {
  return {{"t", field.t},
          {"free", arrows_json(field.free)},
          {"sides", arrows_json(field.sides)},
          {"sliding", arrows_json(field.sliding)}};
}

Json options_json(const result::OptionRecord& options) {
  Json json = Json::object();
  for (const auto& [name, value] : options) {
    std::visit([&json, &key = name](const auto& content) { json[key] = content; }, value);
  }
  return json;
}

void append_drawing(TextStream& stream, const result::Drawing& drawing, std::size_t indent) {
  ObjectStream object(stream, indent);
  Json shapes = Json::array();
  for (const auto& shape : drawing.shapes) {
    shapes.push_back({{"kind", shape.is_disc ? "disc" : "line"}, {"points", shape.points}});
  }
  object.member("shapes", shapes);
  object.list("rows", drawing.rows, [&](const auto& row, std::size_t) { append_json(stream.text(), row); });
  object.end();
}

/// What an optimisation has found, as members of the result.
void append_optimum(ObjectStream& object, const result::Optimization& optimization) {
  Json found = Json::object();
  add_optimization(found, optimization);
  for (const auto& [key, value] : found.items()) object.member(key.c_str(), value);
}

void append_head(ObjectStream& object, const result::Result& result) {
  object.member("format", "saltus-result/1");
  object.member("saltus", version);
  object.member("model", model_json(result.model));
  object.member("command", result.command);
  if (!result.command_line.empty()) object.member("command_line", result.command_line);
  object.member("method", result.method);
  object.member("status", status_json(result.status));
  object.member("states", result.states);
  object.member("controls", result.controls);
  object.member("switching_functions", result.switching_functions);
  object.member("outputs", result.outputs);
  if (result.kept) {
    object.member("kept_columns",
                  {{"states", states_in_rows(result)}, {"switching_functions", functions_in_rows(result)}});
  }
  Json groups = Json::array();
  for (const auto& group : result.region_groups) groups.push_back({{"name", group.name}, {"modes", group.modes}});
  if (!groups.empty()) object.member("region_groups", groups);
  if (!result.contacts.empty()) object.member("contacts", result.contacts);
  object.member("final", final_json(result.final));
}

/// What grows with a run: events and trajectory, as members of the result.
using AppendLists = FunctionRef<void(ObjectStream& object)>;

void append_whole(TextStream& stream, const result::Result& result, std::size_t indent);

void append_with(AppendLists append_lists, TextStream& stream, const result::Result& result, std::size_t indent) {
  ObjectStream object(stream, indent);
  append_head(object, result);
  append_lists(object);
  if (result.drawing) {
    object.key("drawing");
    append_drawing(stream, *result.drawing, indent + 2);
  }
  if (result.penetration) object.member("penetration", *result.penetration);
  if (result.optimization) append_optimum(object, *result.optimization);
  Json surfaces = Json::array();
  for (const auto& surface : result.surfaces) surfaces.push_back(surface_json(surface));
  object.member("surfaces", surfaces);
  if (result.vector_field) object.member("vector_field", vector_field_json(*result.vector_field));
  object.member("statistics", result.optimization ? optimization_statistics_json(result.optimization->statistics)
                                                  : statistics_json(result.statistics));
  object.member("options", options_json(result.options));
  if (result.sensitivities) object.member("sensitivities", sensitivities_json(*result.sensitivities));
  if (result.optimization) object.member("start_values", start_values_json(*result.optimization));
  if (result.elements) object.member("elements", elements_json(*result.elements));
  if (result.comparison) object.member("comparison", comparison_json(*result.comparison));
  if (result.order) object.member("order", order_json(*result.order));
  Json families = Json::array();
  for (const auto& family : result.families) families.push_back(family_json(family));
  if (!families.empty()) object.member("families", families);
  if (result.left_at) object.member("left_at", departure_json(*result.left_at));
  if (!result.branches.empty()) {
    object.list("branches", result.branches,
                [&](const auto& branch, std::size_t at) { append_whole(stream, branch, at); });
  }
  object.end();
}

void append_whole(TextStream& stream, const result::Result& result, std::size_t indent) {
  const auto append_lists = [&](ObjectStream& object) {
    object.list("events", result.events, [&](const auto& event, std::size_t at) { append_event(stream, event, at); });
    object.key("trajectory");
    append_trajectory(stream, result.trajectory, indent + 2);
  };
  append_with(append_lists, stream, result, indent);
}

/// The elements of a list that were put aside.
class SpooledList {
 public:
  SpooledList(const std::filesystem::path& folder, std::string between)
      : file_(folder), between_(std::move(between)), stream_(write_) {}
  SpooledList(const SpooledList&) = delete;
  SpooledList& operator=(const SpooledList&) = delete;

  /// Where the next element is to be appended.
  std::string& next() {
    static_cast<void>(stream_.pass());
    return stream_.text().append(count_++ > 0 ? "," : "").append(between_);
  }
  [[nodiscard]] bool empty() const { return count_ == 0; }
  [[nodiscard]] Expected<void> flush() {
    static_cast<void>(stream_.flush());
    return file_.outcome();
  }
  [[nodiscard]] Expected<void> outcome() const { return file_.outcome(); }
  void append_to(TextStream& stream) {
    static_cast<void>(file_.copy_to([&](std::string_view piece) {
      stream.text() += piece;
      return stream.pass();
    }));
  }

 private:
  SpoolFile file_;
  std::function<bool(std::string_view)> write_ = [this](std::string_view piece) { return file_.write(piece); };
  std::string between_;  ///< before each element, behind the comma
  TextStream stream_;
  std::size_t count_ = 0;
};

class JsonParts : public ResultParts {
 public:
  JsonParts(std::filesystem::path folder, Sink sink) : folder_(std::move(folder)), sink_(sink) {}

  Expected<void> add(const result::Result& part) override {
    auto& events = list("events", "\n" + std::string(margin + 2, ' '));
    for (std::size_t i = 0; i < part.events.size(); ++i) {
      std::string text;
      const auto keep = [&](std::string_view piece) {
        text += piece;
        return true;
      };
      TextStream event(keep);
      append_event(event, part.events[i], margin + 2);
      static_cast<void>(event.flush());
      events.next() += text;
    }
    auto& times = list("t", "");
    for (const double t : part.trajectory.t) append_json(times.next(), t);
    for_each_list(part.trajectory, [&](const char* key, const auto& table, auto append_row) {
      auto& rows = list(key, "\n" + std::string(margin + 4, ' '));
      for (const auto& row : table) append_row(rows.next(), row);
    });
    for (auto& [name, spooled] : lists_) {
      if (auto flushed = spooled->flush(); !flushed) return flushed;
    }
    return {};
  }

  Expected<void> finish(const result::Result& rest) override {
    TextStream stream(sink_);
    const auto append_lists = [&](ObjectStream& object) {
      append(object, stream, "events");
      object.key("trajectory");
      ObjectStream trajectory(stream, margin);
      trajectory.key("t") += '[';
      if (auto* times = found("t")) times->append_to(stream);
      stream.text() += ']';
      for_each_list(rest.trajectory, [&](const char* key, const auto&, auto) { append(trajectory, stream, key); });
      for (const char* key : {"regions", "theta", "contact_modes"}) {
        if (found(key) != nullptr) append(trajectory, stream, key);
      }
      trajectory.end();
    };
    append_with(append_lists, stream, rest, 0);
    stream.text() += '\n';
    for (const auto& [name, spooled] : lists_) {
      if (auto read = spooled->outcome(); !read) return read;
    }
    return taken(stream.flush());
  }

 private:
  static constexpr std::size_t margin = 2;  ///< of the members of the result

  SpooledList& list(const std::string& name, const std::string& between) {
    auto& spooled = lists_[name];
    if (!spooled) spooled = std::make_unique<SpooledList>(folder_, between);
    return *spooled;
  }
  [[nodiscard]] SpooledList* found(const std::string& name) const {
    const auto place = lists_.find(name);
    return place == lists_.end() || place->second->empty() ? nullptr : place->second.get();
  }
  void append(ObjectStream& object, TextStream& stream, const char* key) const {
    object.key(key) += '[';
    auto* spooled = found(key);
    if (spooled != nullptr) spooled->append_to(stream);
    object.end_list(spooled == nullptr);
  }

  std::filesystem::path folder_;
  Sink sink_;
  std::map<std::string, std::unique_ptr<SpooledList>> lists_;
};

}  // namespace

std::unique_ptr<ResultParts> json_parts(const std::filesystem::path& folder, Sink sink) {
  return std::make_unique<JsonParts>(folder, sink);
}

bool write_json(const result::Result& result, Sink sink) {
  TextStream stream(sink);
  append_whole(stream, result, 0);
  stream.text() += '\n';
  return stream.flush();
}

std::string to_json(const result::Result& result) {
  return collected([&](Sink sink) { return write_json(result, sink); });
}

}  // namespace saltus::io
