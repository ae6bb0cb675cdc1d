#include <algorithm>
#include <limits>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "saltus/report/page_comparison_internal.hpp"
#include "saltus/report/page_data_internal.hpp"
#include "saltus/report/page_overlays_internal.hpp"
#include "saltus/report/thinning_internal.hpp"
#include "saltus/result/difference.hpp"
#include "saltus/result/drawn.hpp"

namespace saltus::report {
namespace {

using nlohmann::json;

/// The columns `names` of a table whose columns are called `own`.
template <class Table>
json by_name(const std::vector<std::string>& names, const std::vector<std::string>& own, const Table& rows,
             const std::vector<std::size_t>& chosen) {
  json::array_t columns;
  for (const auto& name : names) {
    if (columns.size() == columns_in_page) break;
    const auto found = static_cast<std::size_t>(std::find(own.begin(), own.end(), name) - own.begin());
    json::array_t values;
    for (const std::size_t i : chosen) {
      if (found == own.size()) break;
      const bool there = i < rows.size() && found < rows[i].size();
      values.emplace_back(there ? rows[i][found] : std::numeric_limits<double>::quiet_NaN());
    }
    columns.emplace_back(std::move(values));
  }
  return columns;
}

/// Parameters and initial values that differ from those of the first, with their values.
json changed_values(const result::ModelRecord& first, const result::ModelRecord& other) {
  json changed = json::array();
  const auto add = [&](const auto& own, const auto& values) {
    for (const auto& [name, value] : values) {
      const auto found = std::find_if(own.begin(), own.end(), [&](const auto& pair) { return pair.first == name; });
      if (found == own.end() || found->second != value) changed.push_back(json::array({name, value}));
    }
  };
  add(first.parameters, other.parameters);
  add(first.initial_state, other.initial_state);
  return changed;
}

}  // namespace

Expected<void> check_overlay(const result::Result& first, const Overlay& other) {
  const auto refuse = [&](std::string message) -> Expected<void> {
    return tl::unexpected(Error{ErrorCode::invalid_option,
                                std::move(message),
                                "lay results of one model over each other; parameters and methods may differ",
                                {},
                                {}});
  };
  if (first.model.name != other.result.model.name) {
    return refuse(fmt::format("{} is a result of the model '{}', the first one is of '{}'", other.label,
                              other.result.model.name, first.model.name));
  }
  if (first.states != other.result.states) {
    return refuse(fmt::format("{} has the states {}, the first one has {}", other.label,
                              fmt::join(other.result.states, ", "), fmt::join(first.states, ", ")));
  }
  if (const auto equations = result::differing_equation(other.result, first); !equations.empty()) {
    return refuse(fmt::format("{} has another equation than the first one: {}", other.label, equations));
  }
  return {};
}

json overlays_data(const result::Result& first, const std::vector<Overlay>& overlays, std::size_t limit) {
  json list = json::array();
  for (const auto& [label, stored] : overlays) {
    const auto drawn = as_drawn(stored);
    const auto& other = drawn ? *drawn : stored;
    const auto& rows = other.trajectory;
    const std::size_t width = 1 + number_of_columns(rows, columns_in_page);
    const auto chosen = rows_to_draw(rows, std::max<std::size_t>(1, limit / width), columns_in_page);
    json::array_t t;
    for (const std::size_t i : chosen) t.emplace_back(rows.t[i]);
    list.push_back({{"label", label},
                    {"method", other.method},
                    {"status", status_data(other.status)},
                    {"events", other.events.size()},
                    {"parameters", changed_values(first.model, other.model)},
                    {"trajectory",
                     {{"t", std::move(t)},
                      {"x", by_name(first.states, other.states, rows.x, chosen)},
                      {"u", by_name(first.controls, other.controls, rows.u, chosen)},
                      {"alpha", by_name(first.switching_functions, other.switching_functions, rows.alpha, chosen)},
                      {"outputs", by_name(first.outputs, other.outputs, rows.outputs, chosen)},
                      {"theta", by_name(result::region_labels(first.region_groups),
                                        result::region_labels(other.region_groups), rows.theta, chosen)}}}});
  }
  return list;
}

}  // namespace saltus::report
