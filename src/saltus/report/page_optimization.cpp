#include <algorithm>
#include <limits>

#include "saltus/report/optimization_table_internal.hpp"
#include "saltus/report/optimization_words_internal.hpp"
#include "saltus/report/page_data_internal.hpp"
#include "saltus/report/page_optimization_internal.hpp"
#include "saltus/report/thinning_internal.hpp"

namespace saltus::report {
namespace {

using nlohmann::json;
using Rows = std::vector<std::vector<double>>;

json findings_data(const std::vector<Finding>& findings) {
  constexpr const char* tones[] = {"good", "neutral", "bad"};
  json list = json::array();
  for (const auto& [tone, text] : findings) list.push_back({{"tone", tones[static_cast<int>(tone)]}, {"text", text}});
  return list;
}

/// Pairs of bounds, null where there is none.
json bounds_data(const std::vector<double>& lower, const std::vector<double>& upper, std::size_t count) {
  const auto at = [](const std::vector<double>& list, std::size_t i) {
    return i < list.size() ? list[i] : std::numeric_limits<double>::quiet_NaN();
  };
  json list = json::array();
  for (std::size_t i = 0; i < count; ++i) list.push_back({at(lower, i), at(upper, i)});
  return list;
}

json control_columns(const Rows& rows, std::size_t count) {
  json columns = json::array();
  for (std::size_t i = 0; i < count; ++i) {
    json::array_t values;
    for (const auto& row : rows)
      values.emplace_back(i < row.size() ? row[i] : std::numeric_limits<double>::quiet_NaN());
    columns.push_back(std::move(values));
  }
  return columns;
}

/// The simulation of the controls over the whole horizon; null if there are no rows.
json open_loop_data(const result::Optimization& optimization, std::size_t states, std::size_t limit) {
  if (!optimization.verification || optimization.verification->open_loop.t.empty()) return nullptr;
  const auto& open_loop = optimization.verification->open_loop;
  result::Trajectory trajectory;
  trajectory.t = open_loop.t;
  trajectory.x = result::Table<double>(open_loop.x);
  const auto chosen = rows_to_draw(trajectory, std::max<std::size_t>(1, limit / (1 + states)), states);
  json::array_t t, x;
  for (const std::size_t i : chosen) t.emplace_back(open_loop.t[i]);
  for (std::size_t column = 0; column < states; ++column) {
    json::array_t values;
    for (const std::size_t i : chosen) values.emplace_back(open_loop.x[i][column]);
    x.emplace_back(std::move(values));
  }
  return {{"t", std::move(t)}, {"x", std::move(x)}};
}

json multipliers_data(const std::vector<result::ConstraintMultiplier>& multipliers) {
  json list = json::array();
  for (const auto& [name, time, value, range] : multipliers) {
    if (list.size() == multipliers_in_page) break;
    list.push_back({{"name", name}, {"time", time}, {"value", value}});
    if (!range.empty()) list.back()["range"] = range;
  }
  return list;
}

json homotopy_data(const std::vector<result::HomotopyStep>& steps) {
  json list = json::array();
  for (const auto& step : steps) {
    list.push_back({{"phase", result::name(step.phase)},
                    {"solver", step.solver},
                    {"sigma", step.sigma},
                    {"iterations", step.iterations},
                    {"objective", step.objective},
                    {"primal_infeasibility", step.primal_infeasibility},
                    {"complementarity_residual", step.complementarity_residual},
                    {"termination", result::name(step.termination)},
                    {"seconds", step.seconds},
                    {"message", step.message}});
  }
  return list;
}

json statistics_data(const result::OptimizationStatistics& statistics) {
  return {{"iterations", statistics.iterations},
          {"variables", statistics.variables},
          {"equations", statistics.equations},
          {"pairs", statistics.pairs},
          {"build_seconds", statistics.build_seconds},
          {"evaluation_seconds", statistics.evaluation_seconds},
          {"linear_algebra_seconds", statistics.linear_algebra_seconds},
          {"wall_seconds", statistics.wall_seconds}};
}

}  // namespace

json optimization_data(const result::Result& result, std::size_t limit) {
  if (!result.optimization) return nullptr;
  const auto& optimization = *result.optimization;
  const std::size_t states = std::min(columns_in_page, result.states.size());
  const std::size_t controls = std::min(columns_in_page, result.controls.size());
  return {{"method", optimization_method(result)},
          {"objective", optimization.objective},
          {"terms", objective_terms(optimization.terms)},
          {"horizon", optimization.horizon},
          {"parameters", optimization.parameters},
          {"grid", optimization.grid},
          {"u", control_columns(optimization.u, controls)},
          {"h", optimization.h},
          {"speed_of_time", optimization.speed_of_time},
          {"bounds",
           {{"x", bounds_data(optimization.state_lower, optimization.state_upper, states)},
            {"u", bounds_data(optimization.control_lower, optimization.control_upper, controls)}}},
          {"multipliers", multipliers_data(optimization.multipliers)},
          {"multiplier_count", optimization.multipliers.size()},
          {"homotopy", homotopy_data(optimization.homotopy)},
          {"open_loop", open_loop_data(optimization, states, limit)},
          {"certificate", findings_data(certificate_findings(result))},
          {"verification", findings_data(verification_findings(optimization))},
          {"statistics", statistics_data(optimization.statistics)}};
}

}  // namespace saltus::report
