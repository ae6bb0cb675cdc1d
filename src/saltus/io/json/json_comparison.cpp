// The records of `compare` and `order`.
#include "saltus/io/json/json_parts_internal.hpp"

namespace saltus::io {
namespace {

/// A row that was not run has its reason and nothing else.
Json run_json(const result::ComparedRun& run) {
  Json json = {{"method", run.method}, {"variant", run.variant}};
  if (!run.reason.empty()) {
    json["reason"] = run.reason;
    return json;
  }
  json["status"] = status_json(run.status);
  json["x"] = run.x;
  json["switches"] = or_null(run.switches);
  json["last_switch"] = or_null(run.last_switch);
  json["state_difference"] = or_null(run.state_difference);
  json["switch_time_difference"] = or_null(run.switch_time_difference);
  json["statistics"] = statistics_json(run.statistics);
  return json;
}

result::ComparedRun read_run(JsonReader& reader, const Json& json, const std::string& path) {
  result::ComparedRun run;
  reader.read_member(json, path, "method", run.method);
  reader.read_member(json, path, "variant", run.variant);
  reader.read_if_there(json, path, "reason", run.reason);
  if (!run.reason.empty()) return run;
  read_part(reader, json, path, "status", read_status, run.status);
  reader.read_member(json, path, "x", run.x);
  reader.read_member(json, path, "switches", run.switches);
  reader.read_member(json, path, "last_switch", run.last_switch);
  reader.read_member(json, path, "state_difference", run.state_difference);
  reader.read_member(json, path, "switch_time_difference", run.switch_time_difference);
  read_part(reader, json, path, "statistics", read_statistics, run.statistics);
  return run;
}

Json point_json(const result::OrderPoint& point) {
  Json json = {{"steps", point.steps},
               {"mean_step", point.mean_step},
               {"error", or_null(point.error)},
               {"switch_time_error", or_null(point.switch_time_error)}};
  if (!point.reason.empty()) json["reason"] = point.reason;
  json["wall_seconds"] = point.wall_seconds;
  return json;
}

result::OrderPoint read_point(JsonReader& reader, const Json& json, const std::string& path) {
  result::OrderPoint point;
  reader.read_member(json, path, "steps", point.steps);
  reader.read_member(json, path, "mean_step", point.mean_step);
  reader.read_member(json, path, "error", point.error);
  reader.read_member(json, path, "switch_time_error", point.switch_time_error);
  reader.read_if_there(json, path, "reason", point.reason);
  reader.read_member(json, path, "wall_seconds", point.wall_seconds);
  return point;
}

Json series_json(const result::OrderSeries& series) {
  Json points = Json::array();
  for (const auto& point : series.points) points.push_back(point_json(point));
  return {{"method", series.method},        {"scheme", series.scheme},
          {"stages", series.stages},        {"reformulation", series.reformulation},
          {"slope", or_null(series.slope)}, {"switch_time_slope", or_null(series.switch_time_slope)},
          {"points", std::move(points)}};
}

result::OrderSeries read_series(JsonReader& reader, const Json& json, const std::string& path) {
  result::OrderSeries series;
  reader.read_member(json, path, "method", series.method);
  reader.read_member(json, path, "scheme", series.scheme);
  reader.read_member(json, path, "stages", series.stages);
  reader.read_member(json, path, "reformulation", series.reformulation);
  reader.read_member(json, path, "slope", series.slope);
  reader.read_member(json, path, "switch_time_slope", series.switch_time_slope);
  if (const auto* points = reader.member(json, path, "points")) {
    read_list(reader, *points, path + "/points", series.points, read_point);
  }
  return series;
}

}  // namespace

Json comparison_json(const result::Comparison& comparison) {
  Json runs = Json::array();
  for (const auto& run : comparison.runs) runs.push_back(run_json(run));
  return {{"reference", comparison.reference}, {"time", or_null(comparison.time)}, {"runs", std::move(runs)}};
}

void read_comparison(JsonReader& reader, const Json& json, const std::string& path,
                     std::optional<result::Comparison>& comparison) {
  comparison.emplace();
  std::int64_t reference = 0;
  reader.read_member(json, path, "reference", reference);
  if (json.is_object() && json.contains("time")) reader.read_member(json, path, "time", comparison->time);
  if (const auto* runs = reader.member(json, path, "runs")) {
    read_list(reader, *runs, path + "/runs", comparison->runs, read_run);
  }
  const auto count = static_cast<std::int64_t>(comparison->runs.size());
  if (reference < 0 || reference >= count) {
    reader.fail(path + "/reference", fmt::format("expected a number of `runs`, found {} of {}", reference, count));
  } else {
    comparison->reference = static_cast<std::size_t>(reference);
  }
}

Json order_json(const result::OrderStudy& order) {
  Json series = Json::array();
  for (const auto& one : order.series) series.push_back(series_json(one));
  return {{"reference", order.reference},
          {"floor", order.floor},
          {"time_floor", order.time_floor},
          {"series", std::move(series)}};
}

void read_order(JsonReader& reader, const Json& json, const std::string& path,
                std::optional<result::OrderStudy>& order) {
  order.emplace();
  reader.read_member(json, path, "reference", order->reference);
  reader.read_member(json, path, "floor", order->floor);
  reader.read_member(json, path, "time_floor", order->time_floor);
  if (const auto* series = reader.member(json, path, "series")) {
    read_list(reader, *series, path + "/series", order->series, read_series);
  }
}

}  // namespace saltus::io
