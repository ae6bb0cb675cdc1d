// Result -> JSON.
#include <cmath>
#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <utility>

#include "saltus/base/version.hpp"
#include "saltus/io/json/json_facts_internal.hpp"
#include "saltus/io/json/json_record_members_internal.hpp"
#include "saltus/io/json/json_result.hpp"
#include "saltus/io/json/json_stream_internal.hpp"
#include "saltus/result/kept_columns.hpp"

namespace saltus::io {
namespace {

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
    object.member("contact_modes_before", value_json(event.contact_modes_before));
    object.member("contact_modes_after", value_json(event.contact_modes_after));
  }
  if (event.impulse) object.member("impulse", *event.impulse);
  put("x", event.x);
  put("x_after", event.x_after);
  object.key("unique") += !event.unique ? "null" : *event.unique ? "true" : "false";
  object.member("alternatives", value_json(event.alternatives));
  put("reason", event.reason);
  if (event.intersection) object.member("intersection", record_json(*event.intersection));
  object.end();
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
    append_rows("contact_modes", trajectory.contact_modes, [](std::string& text, const auto& row) {
      text += value_json(std::vector<result::ContactMode>(row)).dump();
    });
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
  const Json found = record_json(optimization);
  for (const auto& [key, value] : found.items()) object.member(key.c_str(), value);
}

void append_head(ObjectStream& object, const result::Result& result) {
  object.member("format", "saltus-result/1");
  object.member("saltus", version);
  object.member("record_sha256", record_sha256(result));
  object.member("model", model_json(result.model));
  object.member("command", result.command);
  if (!result.command_line.empty()) object.member("command_line", result.command_line);
  if (!result.date.empty()) object.member("date", result.date);
  object.member("method", result.method);
  object.member("status", record_json(result.status));
  object.member("states", result.states);
  object.member("controls", result.controls);
  object.member("switching_functions", result.switching_functions);
  object.member("outputs", result.outputs);
  if (result.kept) {
    object.member("kept_columns",
                  {{"states", states_in_rows(result)}, {"switching_functions", functions_in_rows(result)}});
  }
  if (!result.region_groups.empty()) object.member("region_groups", value_json(result.region_groups));
  if (!result.contacts.empty()) object.member("contacts", result.contacts);
  object.member("final", record_json(result.final));
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
  object.member("surfaces", value_json(result.surfaces));
  if (result.vector_field) object.member("vector_field", record_json(*result.vector_field));
  object.member("statistics",
                result.optimization ? record_json(result.optimization->statistics) : record_json(result.statistics));
  object.member("options", options_json(result.options));
  if (result.sensitivities) object.member("sensitivities", record_json(*result.sensitivities));
  if (result.optimization) object.member("start_values", members_json(*result.optimization, StartValues::list));
  if (result.error_estimate) object.member("error_estimate", record_json(*result.error_estimate));
  if (result.elements) object.member("elements", record_json(*result.elements));
  if (result.comparison) object.member("comparison", comparison_json(*result.comparison));
  if (result.order) object.member("order", record_json(*result.order));
  if (!result.families.empty()) object.member("families", value_json(result.families));
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
  [[nodiscard]] std::size_t bytes() const { return file_.size(); }
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

  [[nodiscard]] std::size_t bytes_aside() const override {
    std::size_t bytes = 0;
    for (const auto& [name, spooled] : lists_) bytes += spooled->bytes();
    return bytes;
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

bool write_as(std::string_view name, const result::Result& result, Sink sink) {
  if (name.ends_with("events.csv")) return write_events_csv(result, sink);
  if (name.ends_with("csv")) return write_csv(result, sink);
  return name.ends_with("npz") ? write_npz(result, sink) : write_json(result, sink);
}

std::string to_json(const result::Result& result) {
  return collected([&](Sink sink) { return write_json(result, sink); });
}

}  // namespace saltus::io
