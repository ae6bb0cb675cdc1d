#include <algorithm>

#include "saltus/report/page_comparison_internal.hpp"
#include "saltus/report/page_data_internal.hpp"

namespace saltus::report {
namespace {

using nlohmann::json;

json run_data(const result::ComparedRun& run) {
  const auto shown = static_cast<std::ptrdiff_t>(std::min(columns_in_page, run.x.size()));
  return {{"method", run.method},
          {"variant", run.variant},
          {"reason", run.reason},
          {"status", status_data(run.status)},
          {"x", std::vector<double>(run.x.begin(), run.x.begin() + shown)},
          {"switches", or_null(run.switches)},
          {"last_switch", or_null(run.last_switch)},
          {"state_difference", or_null(run.state_difference)},
          {"switch_time_difference", or_null(run.switch_time_difference)},
          {"statistics", {{"wall_seconds", run.statistics.wall_seconds}}}};
}

json series_data(const result::OrderSeries& series) {
  json points = json::array();
  for (const auto& point : series.points) {
    points.push_back({{"mean_step", point.mean_step},
                      {"error", or_null(point.error)},
                      {"switch_time_error", or_null(point.switch_time_error)}});
  }
  return {{"method", series.method},        {"scheme", series.scheme},
          {"stages", series.stages},        {"reformulation", series.reformulation},
          {"slope", or_null(series.slope)}, {"switch_time_slope", or_null(series.switch_time_slope)},
          {"points", std::move(points)}};
}

}  // namespace

json status_data(const result::Status& status) {
  return {{"termination", result::name(status.termination)},
          {"done", result::is_done(status.termination)},
          {"message", status.message},
          {"time_reached", status.time_reached}};
}

json comparison_data(const std::optional<result::Comparison>& comparison) {
  if (!comparison) return nullptr;
  json runs = json::array();
  for (const auto& run : comparison->runs) runs.push_back(run_data(run));
  return {{"reference", comparison->reference}, {"runs", std::move(runs)}};
}

json order_data(const std::optional<result::OrderStudy>& order) {
  if (!order) return nullptr;
  json series = json::array();
  for (const auto& one : order->series) series.push_back(series_data(one));
  return {{"reference", order->reference},
          {"floor", order->floor},
          {"time_floor", order->time_floor},
          {"series", std::move(series)}};
}

}  // namespace saltus::report
