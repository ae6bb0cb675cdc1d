#include <algorithm>
#include <limits>
#include <type_traits>

#include "saltus/base/contains.hpp"
#include "saltus/base/version.hpp"
#include "saltus/report/packed_rows_internal.hpp"
#include "saltus/report/page_columns_internal.hpp"
#include "saltus/report/page_comparison_internal.hpp"
#include "saltus/report/page_data_internal.hpp"
#include "saltus/report/page_optimization_internal.hpp"
#include "saltus/result/turned.hpp"

namespace saltus::report {
namespace {

using nlohmann::json;
using Rows = std::vector<std::vector<double>>;

/// The first `most` elements.
template <class T>
std::vector<T> head(const std::vector<T>& list, std::size_t most) {
  return {list.begin(), list.begin() + static_cast<std::ptrdiff_t>(std::min(most, list.size()))};
}

template <class T>
json head_or_null(const std::optional<std::vector<T>>& value, std::size_t most) {
  return value ? json(head(*value, most)) : json(nullptr);
}

/// Intervals of constant value of one band: edges t_0 < … < t_n and the n values between them.
/// @param mode_at  of a row: -1, 0, 1, or null
template <class ModeAt>
json mode_intervals(const result::Trajectory& trajectory, const ModeAt& mode_at) {
  json::array_t edges, values;
  for (std::size_t i = 1; i < trajectory.t.size(); ++i) {
    if (trajectory.t[i - 1] == trajectory.t[i]) continue;
    const json mode = mode_at(i - 1);
    if (edges.empty()) edges.emplace_back(trajectory.t[i - 1]);
    if (!values.empty() && values.back() == mode) {
      edges.back() = trajectory.t[i];
    } else {
      values.push_back(mode);
      edges.emplace_back(trajectory.t[i]);
    }
  }
  return {{"edges", edges}, {"values", values}};
}

/// Bands of the switching functions: their modes.
json::array_t mode_bands(const result::Trajectory& trajectory, std::size_t width) {
  json::array_t bands;
  for (std::size_t j = 0; j < width; ++j) {
    bands.push_back(mode_intervals(trajectory, [&](std::size_t i) -> json {
      const bool there = i < trajectory.mode.size() && j < trajectory.mode[i].size();
      return there ? json(trajectory.mode[i][j]) : json(nullptr);
    }));
  }
  return bands;
}

/// Bands of the contacts: their modes by name.
json::array_t contact_bands(const result::Result& result) {
  json::array_t bands;
  for (std::size_t k = 0; k < std::min(columns_in_page, result.contacts.size()); ++k) {
    bands.push_back(mode_intervals(
        result.trajectory, [&](std::size_t i) -> json { return result::name(result.trajectory.contact_modes[i][k]); }));
  }
  return bands;
}

/// What is drawn of the bodies.
json shapes_data(const std::optional<result::Drawing>& drawing) {
  json shapes = json::array();
  if (!drawing) return shapes;
  for (const auto& shape : drawing->shapes) {
    shapes.push_back({{"kind", shape.is_disc ? "disc" : "line"}, {"points", shape.points}});
  }
  return shapes;
}

/// Bands of the modes by `indicator`: 1 active alone, 0 active with others, null not active.
json::array_t region_bands(const result::Result& result) {
  json::array_t bands;
  const auto& rows = result.trajectory.regions;
  for (std::size_t g = 0; g < result.region_groups.size(); ++g) {
    for (const auto& mode : result.region_groups[g].modes) {
      if (bands.size() == columns_in_page) return bands;
      bands.push_back(mode_intervals(result.trajectory, [&](std::size_t i) -> json {
        const auto& active = rows[i][g];
        if (!contains(active, mode)) return nullptr;
        return active.size() == 1 ? 1 : 0;
      }));
    }
  }
  return bands;
}

json intersection_data(const std::optional<result::Intersection>& intersection) {
  if (!intersection) return nullptr;
  return {{"surfaces", intersection->surfaces},
          {"velocities", intersection->velocities},
          {"alpha_before", or_null(intersection->alpha_before)},
          {"alpha_after", intersection->alpha_after}};
}

json event_data(const result::Event& event, const result::Result& result, std::size_t most) {
  json alternatives = json::array();
  for (const auto& other : event.alternatives) {
    alternatives.push_back(
        {{"mode", head(other.mode, most)}, {"alpha", head(other.alpha, most)}, {"regions", other.regions}});
  }
  return {{"t", event.t},
          {"kind", result::name(event.kind)},
          {"name", or_null(event.name)},
          {"turned", or_null(turned(event, result))},
          {"surfaces", event.surfaces},
          {"mode_before", head_or_null(event.mode_before, most)},
          {"mode_after", head_or_null(event.mode_after, most)},
          {"alpha_before", head_or_null(event.alpha_before, most)},
          {"alpha_after", head_or_null(event.alpha_after, most)},
          {"regions_before", or_null(event.regions_before)},
          {"regions_after", or_null(event.regions_after)},
          {"x", head(event.x, most)},
          {"x_after", head(event.x_after, most)},
          {"unique", or_null(event.unique)},
          {"alternatives", std::move(alternatives)},
          {"reason", event.reason},
          {"intersection", intersection_data(event.intersection)}};
}

/// States as numbers of columns: names are for people.
json surface_data(const result::Surface& surface, const std::vector<std::string>& states) {
  json::array_t places, curves;
  for (const auto& name : surface.states) {
    places.emplace_back(std::find(states.begin(), states.end(), name) - states.begin());
  }
  for (const auto& curve : surface.curves) {
    curves.emplace_back(json{{"t", or_null(curve.t)}, {"coordinates", curve.coordinates}});
  }
  const auto form = [](const result::AffineSurface& affine) {
    return json{{"gradient", affine.gradient}, {"rate", affine.rate}, {"constant", affine.constant}};
  };
  json affine = nullptr, within = json::array();
  if (surface.affine) {
    affine = form(*surface.affine);
    for (const auto& end : surface.within) within.push_back(form(end));
  }
  return {{"name", surface.name},        {"role", result::name(surface.role)},
          {"states", std::move(places)}, {"depends_on_time", surface.depends_on_time},
          {"affine", std::move(affine)}, {"within", std::move(within)},
          {"curves", std::move(curves)}};
}

json option_value(const result::OptionValue& value) {
  return std::visit([](const auto& v) { return json(v); }, value);
}

/// Names with their values, in the order given (an object would be sorted).
template <class Pairs>
json pairs(const Pairs& list) {
  json result = json::array();
  for (const auto& [name, value] : list) {
    if constexpr (std::is_arithmetic_v<std::decay_t<decltype(value)>>) {
      result.push_back(json::array({name, value}));
    } else {
      result.push_back(json::array({name, option_value(value)}));
    }
  }
  return result;
}

json equations_data(const std::vector<result::StatedEquation>& equations) {
  json data = json::array();
  for (const auto& [left, right, where] : equations) data.push_back({left, right, where});
  return data;
}

/// With what it takes to run it again: who gets the page alone sees what was solved.
json model_data(const result::ModelRecord& model) {
  json files = json::array();
  for (const auto& file : model.files)
    files.push_back({{"name", file.name}, {"sha256", file.sha256}, {"text", or_null(file.text)}});
  return {{"name", model.name},
          {"description", model.description},
          {"sha256", model.sha256},
          {"parameters", pairs(model.parameters)},
          {"initial_state", pairs(head(model.initial_state, columns_in_page))},
          {"file", model.file},
          {"text", model.text},
          {"equations", equations_data(model.equations)},
          {"files", std::move(files)},
          {"settings", model.settings}};
}

/// Calls visit(name, table, width) for each table of columns of a trajectory.
template <class Visit>
void for_each_list_of_columns(const result::Result& result, Visit visit) {
  const auto width = [](const std::vector<std::string>& names) { return std::min(columns_in_page, names.size()); };
  const auto& trajectory = result.trajectory;
  visit("x", trajectory.x, width(result.states));
  visit("u", trajectory.u, width(result.controls));
  visit("alpha", trajectory.alpha, width(result.switching_functions));
  visit("outputs", trajectory.outputs, width(result.outputs));
  visit("theta", trajectory.theta, width(result::region_labels(result.region_groups)));
}

/// Chooses the rows of a trajectory of many columns, and a tolerance. With it the points of all of them are about as
/// many numbers as there is room for.
KeptRows rows_of_many(const result::Result& result, std::size_t limit) {
  constexpr std::size_t most_rows = 20000;
  constexpr double coarsest = 0.05;
  KeptRows kept{rows_to_draw(result.trajectory, most_rows, 4), {}, least_line_tolerance};
  for (const std::size_t i : kept.rows) kept.t.push_back(result.trajectory.t[i]);
  for (; kept.line_tolerance < coarsest; kept.line_tolerance *= 2.0) {
    std::size_t numbers = kept.t.size();
    for_each_list_of_columns(result, [&](const char*, const auto& table, std::size_t width) {
      for (std::size_t column = 0; column < width && numbers <= limit; ++column) {
        numbers += 2 * points_of(kept, values_of(table, kept.rows, column)).size();
      }
    });
    if (numbers <= limit) break;
  }
  return kept;
}

json trajectory_data(const result::Result& result, std::size_t limit) {
  const auto& trajectory = result.trajectory;
  const std::size_t of_bodies = result.drawing ? result.drawing->width() : 0;
  const std::size_t columns_drawn = 1 + number_of_columns(trajectory, columns_in_page) + of_bodies;
  const bool many = columns_drawn > many_columns && trajectory.t.size() * columns_drawn > limit / 8;
  KeptRows kept;
  if (many) {
    kept = rows_of_many(result, limit / 2);
  } else {
    kept.rows = rows_to_draw(trajectory, std::max<std::size_t>(1, limit / columns_drawn), columns_in_page);
    for (const std::size_t i : kept.rows) kept.t.push_back(trajectory.t[i]);
  }
  json data = {{"rows", trajectory.t.size()},
               {"t", kept.t},
               {"line_tolerance", kept.line_tolerance},
               {"contact_modes", contact_bands(result)},
               {"modes", mode_bands(trajectory, std::min(columns_in_page, result.switching_functions.size()))},
               {"regions", region_bands(result)}};
  for_each_list_of_columns(result, [&](const char* name, const auto& table, std::size_t width) {
    data[name] = kept_columns(table, kept, width);
  });
  data["drawing"] = result.drawing ? kept_columns(result.drawing->rows, {kept.rows, kept.t}, of_bodies) : json::array();
  return data;
}

/// Of the first columns; a page shows one selection after the other, but carries all of them.
json elements_data(const std::optional<result::Elements>& elements) {
  if (!elements) return nullptr;
  std::vector<std::size_t> rows(elements->t.size());
  for (std::size_t i = 0; i < rows.size(); ++i) rows[i] = i;
  json::array_t selections;
  for (const auto& [name, form] : head(elements->selections, columns_in_page)) {
    selections.emplace_back(json{{"name", name}, {"form", result::name(form)}});
  }
  const std::size_t width = selections.size();
  const KeptRows all{std::move(rows), {}};
  return {{"points", elements->points},
          {"t", elements->t},
          {"selections", std::move(selections)},
          {"lambda", kept_columns(elements->lambda, all, width)},
          {"selection", kept_columns(elements->selection, all, width)}};
}

json sensitivities_data(const std::optional<result::Sensitivities>& sensitivities) {
  if (!sensitivities) return nullptr;
  const auto shown = [](const Rows& matrix) {
    json::array_t rows;
    for (const auto& row : head(matrix, columns_in_page)) rows.emplace_back(head(row, columns_in_page));
    return rows;
  };
  return {{"x0", shown(sensitivities->x0)},
          {"p", shown(sensitivities->p)},
          {"parameters", head(sensitivities->parameters, columns_in_page)}};
}

json captions_data(const result::Captions& captions) {
  json data = json::object();
  for (const auto& [name, caption] : captions) data[name] = {{"unit", caption.unit}, {"label", caption.label}};
  return data;
}

json vector_field_data(const std::optional<result::VectorField>& field) {
  if (!field) return nullptr;
  const auto arrows = [](const result::Arrows& list) {
    return json{{"x", list.x}, {"y", list.y}, {"dx", list.dx}, {"dy", list.dy}};
  };
  return {{"t", field->t},
          {"free", arrows(field->free)},
          {"sides", arrows(field->sides)},
          {"sliding", arrows(field->sliding)}};
}

/// The branches of a tree, parents first; branch i of the list is entry i + 1 of the tree, entry 0 the root.
json branches_data(const std::vector<result::TreeEntry>& tree, std::size_t limit) {
  json branches = json::array();
  for (std::size_t i = 1; i < tree.size(); ++i) {
    const auto& [branch, label, parent] = tree[i];
    const result::Event left = branch->events.empty() ? result::Event{} : branch->events.front();
    branches.push_back({{"label", label},
                        {"parent", parent},
                        {"left_at",
                         {{"event", branch->left_at ? branch->left_at->event : 0},
                          {"later", branch->left_at && branch->left_at->member},
                          {"t", left.t},
                          {"mode", head_or_null(left.mode_after, columns_in_page)},
                          {"regions", or_null(left.regions_after)}}},
                        {"status", status_data(branch->status)},
                        {"events", branch->events.size()},
                        {"final", {{"t", branch->final.t}, {"x", head(branch->final.x, columns_in_page)}}},
                        {"trajectory", trajectory_data(*branch, limit)}});
  }
  return branches;
}

/// Continua of other solutions, of all trajectories of a tree; `of` is the number in the tree.
json families_data(const std::vector<result::TreeEntry>& tree) {
  json families = json::array();
  for (std::size_t i = 0; i < tree.size(); ++i) {
    for (const auto& family : tree[i].result->families) {
      families.push_back({{"of", i},
                          {"kind", name(family.kind)},
                          {"event", family.event},
                          {"from", family.from},
                          {"until", family.until},
                          {"mode", head(family.to.mode, columns_in_page)},
                          {"regions", family.to.regions},
                          {"lap_ratio", or_null(family.lap_ratio)}});
    }
  }
  return families;
}

/// Events with as many values each as fit the limit of the page; many of them in columns, as pack() would make them.
json events_data(const result::Result& result, std::size_t limit, const GoOn& go_on) {
  // x, mode and alpha on both sides: six lists for every event. Of many columns nobody reads the lists.
  const bool many = result.states.size() + result.switching_functions.size() > many_columns;
  const std::size_t share = (many ? limit / 8 : limit) / (6 * std::max<std::size_t>(1, result.events.size()));
  const std::size_t values_of_event = std::clamp(share, least_values_of_event, columns_in_page);
  constexpr std::size_t few = 1000;
  if (result.events.size() <= few) {
    json events = json::array();
    for (const auto& event : result.events) events.push_back(event_data(event, result, values_of_event));
    return events;
  }
  PackedRows events;
  for (const auto& event : result.events) {
    if (events.size() % 1024 == 0 && go_on && !go_on()) break;
    events.add(event_data(event, result, values_of_event));
  }
  return events.take();
}

/// Surfaces whose states are all shown.
json surfaces_data(const result::Result& result) {
  const auto states = head(result.states, columns_in_page);
  json surfaces = json::array();
  for (const auto& surface : result.surfaces) {
    const bool drawn = std::all_of(surface.states.begin(), surface.states.end(),
                                   [&](const std::string& name) { return contains(states, name); });
    if (drawn) surfaces.push_back(surface_data(surface, states));
  }
  return surfaces;
}

json final_data(const result::Final& final) {
  const auto shown = [](const auto& list) { return head(list, columns_in_page); };
  return {{"t", final.t},
          {"x", shown(final.x)},
          {"mode", shown(final.mode)},
          {"alpha", shown(final.alpha)},
          {"outputs", shown(final.outputs)},
          {"theta", shown(final.theta)}};
}

json counts_data(const result::Statistics& statistics) {
  return {{"steps", statistics.steps},
          {"rejected", statistics.rejected},
          {"rhs_evaluations", statistics.rhs_evaluations},
          {"wall_seconds", statistics.wall_seconds},
          {"thinned_from", or_null(statistics.thinned_from)}};
}

}  // namespace

json page_data(const result::Result& result, std::size_t limit, const GoOn& go_on) {
  const auto shown = [](const auto& list) { return head(list, columns_in_page); };
  const auto tree = result::tree(result);
  const std::size_t share_of_trajectory = limit / tree.size();
  std::size_t not_followed = 0;
  for (const auto& entry : tree) not_followed += result::not_followed(*entry.result);
  return {{"saltus", version},
          {"model", model_data(result.model)},
          {"command", result.command},
          {"command_line", result.command_line},
          {"date", result.date},
          {"method", result.method},
          {"status", status_data(result.status)},
          {"states", shown(result.states)},
          {"controls", shown(result.controls)},
          {"switching_functions", shown(result.switching_functions)},
          {"regions", shown(result::region_labels(result.region_groups))},
          {"output_names", shown(result.outputs)},
          {"contacts", shown(result.contacts)},
          {"shapes", shapes_data(result.drawing)},
          {"penetration", or_null(result.penetration)},
          {"sizes",
           {{"states", result.states.size()},
            {"controls", result.controls.size()},
            {"switching functions", result.switching_functions.size()},
            {"outputs", result.outputs.size()}}},
          {"sensitivity_parameters", result.sensitivities ? result.sensitivities->parameters.size() : 0},
          {"final", final_data(result.final)},
          {"events", events_data(result, limit, go_on)},
          {"trajectory", trajectory_data(result, share_of_trajectory)},
          {"branches", branches_data(tree, share_of_trajectory)},
          {"not_followed", not_followed},
          {"families", families_data(tree)},
          {"surfaces", surfaces_data(result)},
          {"captions", captions_data(result.model.captions)},
          {"vector_field", vector_field_data(result.vector_field)},
          {"elements", elements_data(result.elements)},
          {"sensitivities", sensitivities_data(result.sensitivities)},
          {"optimization", optimization_data(result, share_of_trajectory)},
          {"comparison", comparison_data(result.comparison)},
          {"order", order_data(result.order)},
          {"statistics", counts_data(result.statistics)},
          {"options", pairs(result.options)}};
}

std::string to_script_text(const json& data) {
  // Names come from files of others: bytes that are no UTF-8 are replaced instead of thrown at the user.
  const std::string text = data.dump(-1, ' ', false, json::error_handler_t::replace);
  std::string safe;
  safe.reserve(text.size() + 1024);
  for (const char c : text) {
    // '<' occurs in strings only; without it neither </script> nor <!-- can end the element early.
    if (c == '<') {
      safe += "\\u003c";
    } else {
      safe += c;
    }
  }
  return safe;
}

}  // namespace saltus::report
