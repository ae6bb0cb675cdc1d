#include <algorithm>
#include <cmath>
#include <cstddef>

#include "saltus/base/contains.hpp"
#include "saltus/io/json/json_shapes_internal.hpp"
#include "saltus/result/kept_columns.hpp"

namespace saltus::io {
namespace {

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

/// Rows at both sides of an event have one time.
void check_times(JsonReader& reader, const std::string& path, const std::vector<double>& times) {
  for (std::size_t i = 0; i < times.size(); ++i) {
    const bool ascends = std::isfinite(times[i]) && (i == 0 || times[i] >= times[i - 1]);
    if (ascends) continue;
    reader.fail(fmt::format("{}/{}", path, i),
                i == 0 ? fmt::format("expected a time, found {}", times[i])
                       : fmt::format("expected ascending times, found {} after {}", times[i], times[i - 1]));
    return;
  }
}

void check_surface(JsonReader& reader, const result::Surface& surface, const std::string& path,
                   const std::vector<std::string>& states) {
  for (const auto& name : surface.states) {
    if (contains(states, name)) continue;
    reader.fail(path + "/states", fmt::format("'{}' is no state", name));
  }
  if (surface.affine) check_length(reader, path + "/affine/gradient", surface.affine->gradient, surface.states.size());
  for (const auto& form : surface.within) {
    check_length(reader, path + "/within/gradient", form.gradient, surface.states.size());
  }
  for (std::size_t i = 0; i < surface.curves.size(); ++i) {
    const auto& coordinates = surface.curves[i].coordinates;
    const auto here = fmt::format("{}/curves/{}/coordinates", path, i);
    check_length(reader, here, coordinates, surface.states.size());
    for (const auto& column : coordinates) check_length(reader, here, column, coordinates.front().size());
  }
}

/// Of each group the active modes, each one of its own.
void check_active(JsonReader& reader, const std::string& path, const result::Regions& regions,
                  const std::vector<result::RegionGroup>& groups) {
  check_length(reader, path, regions, groups.size());
  for (std::size_t g = 0; g < std::min(regions.size(), groups.size()); ++g) {
    const auto& modes = groups[g].modes;
    for (const auto& mode : regions[g]) {
      if (contains(modes, mode)) continue;
      reader.fail(fmt::format("{}/{}", path, g), fmt::format("'{}' is no mode of this group", mode));
    }
  }
}

void check_contacts(JsonReader& reader, const std::string& path, const result::Result& result) {
  const std::size_t contacts = result.contacts.size();
  check_rows(reader, path + "/trajectory/contact_modes", result.trajectory.contact_modes,
             contacts == 0 ? 0 : result.trajectory.t.size(), contacts);
  check_length(reader, path + "/final/contact_modes", result.final.contact_modes, contacts);
  for (std::size_t i = 0; i < result.events.size(); ++i) {
    const auto& event = result.events[i];
    const auto here = fmt::format("{}/events/{}", path, i);
    // Nothing is before what happens at the start.
    if (event.mode_before || !event.contact_modes_before.empty() || !event.contact_modes_after.empty()) {
      check_length(reader, here + "/contact_modes_before", event.contact_modes_before, contacts);
      check_length(reader, here + "/contact_modes_after", event.contact_modes_after, contacts);
    }
    if (!event.impulse) continue;
    check_length(reader, here + "/impulse", *event.impulse, contacts);
    for (const auto& one : *event.impulse) {
      if (one.size() != 2 && one.size() != 3)
        reader.fail(here + "/impulse", fmt::format("expected 2 or 3 entries, found {}", one.size()));
    }
  }
}

void check_regions(JsonReader& reader, const std::string& path, const result::Result& result) {
  const auto& groups = result.region_groups;
  const auto& trajectory = result.trajectory;
  const std::size_t times = groups.empty() ? 0 : trajectory.t.size();
  const std::size_t weights = result::region_labels(groups).size();
  check_length(reader, path + "/trajectory/regions", trajectory.regions, times);
  for (std::size_t i = 0; i < trajectory.regions.size(); ++i) {
    check_active(reader, fmt::format("{}/trajectory/regions/{}", path, i), trajectory.regions[i], groups);
  }
  check_rows(reader, path + "/trajectory/theta", trajectory.theta, times, weights);
  check_active(reader, path + "/final/regions", result.final.regions, groups);
  check_length(reader, path + "/final/theta", result.final.theta, weights);
  for (std::size_t i = 0; i < result.events.size(); ++i) {
    const auto& event = result.events[i];
    const auto here = fmt::format("{}/events/{}", path, i);
    if (event.regions_before) check_active(reader, here + "/regions_before", *event.regions_before, groups);
    if (event.regions_after) check_active(reader, here + "/regions_after", *event.regions_after, groups);
    for (const auto& other : event.alternatives) {
      check_active(reader, here + "/alternatives", other.regions, groups);
    }
  }
}

void check_elements(JsonReader& reader, const std::string& path, const result::Elements& elements) {
  const std::size_t times = elements.t.size();
  if (elements.points < 2 || times % elements.points != 0) {
    reader.fail(path + "/points", fmt::format("expected the number of points of each element, and {} times are a "
                                              "multiple of it; found {}",
                                              times, elements.points));
  }
  check_rows(reader, path + "/lambda", elements.lambda, times, elements.selections.size());
  check_rows(reader, path + "/selection", elements.selection, times, elements.selections.size());
}

/// What pictures and tables index; a start checks what it needs of the start values itself.
void check_optimization(JsonReader& reader, const std::string& path, const result::Result& result) {
  const auto& optimization = *result.optimization;
  const std::size_t intervals = optimization.u.size();
  check_rows(reader, path + "/u", optimization.u, intervals, result.controls.size());
  check_length(reader, path + "/grid", optimization.grid, intervals == 0 ? 0 : intervals + 1);
  check_length(reader, path + "/h", optimization.h, intervals);
  if (!optimization.speed_of_time.empty()) {
    check_length(reader, path + "/speed_of_time", optimization.speed_of_time, intervals);
  }
  if (!optimization.verification) return;
  const auto& open_loop = optimization.verification->open_loop;
  check_rows(reader, path + "/verification/open_loop/x", open_loop.x, open_loop.t.size(), result.states.size());
  if (!optimization.verification->closed_loop) return;
  const auto& closed_loop = *optimization.verification->closed_loop;
  check_rows(reader, path + "/verification/closed_loop/x", closed_loop.x, closed_loop.t.size(), result.states.size());
  for (std::size_t k = 0; k < closed_loop.gains.size(); ++k) {
    const auto& gain = closed_loop.gains[k];
    check_rows(reader, fmt::format("{}/verification/closed_loop/gains/{}/K", path, k), gain.K, result.controls.size(),
               result.states.size());
  }
}

}  // namespace

void check_event_lengths(JsonReader& reader, const result::Event& event, const std::string& path,
                         const result::Result& result) {
  const std::size_t states = result.states.size(), columns = result.switching_functions.size();
  check_length(reader, path + "/x", event.x, states);
  check_length(reader, path + "/x_after", event.x_after, states);
  if (event.mode_before) check_length(reader, path + "/mode_before", *event.mode_before, columns);
  if (event.mode_after) check_length(reader, path + "/mode_after", *event.mode_after, columns);
  if (event.alpha_before) check_length(reader, path + "/alpha_before", *event.alpha_before, columns);
  if (event.alpha_after) check_length(reader, path + "/alpha_after", *event.alpha_after, columns);
}

void check_shapes(JsonReader& reader, const std::string& path, const result::Result& result) {
  const auto& trajectory = result.trajectory;
  const std::size_t times = trajectory.t.size();
  const std::size_t columns = result.switching_functions.size();
  const std::size_t functions = result::functions_in_rows(result).size();
  check_times(reader, path + "/trajectory/t", trajectory.t);
  check_rows(reader, path + "/trajectory/x", trajectory.x, times, result::states_in_rows(result).size());
  check_rows(reader, path + "/trajectory/u", trajectory.u, times, result.controls.size());
  check_rows(reader, path + "/trajectory/alpha", trajectory.alpha, times, functions);
  check_rows(reader, path + "/trajectory/mode", trajectory.mode, times, functions);
  check_regions(reader, path, result);
  check_contacts(reader, path, result);
  check_rows(reader, path + "/trajectory/outputs", trajectory.outputs, times, result.outputs.size());
  check_length(reader, path + "/final/x", result.final.x, result.states.size());
  check_length(reader, path + "/final/mode", result.final.mode, columns);
  check_length(reader, path + "/final/alpha", result.final.alpha, columns);
  check_length(reader, path + "/final/outputs", result.final.outputs, result.outputs.size());
  if (result.drawing) {
    check_rows(reader, path + "/drawing/rows", result.drawing->rows, times, result.drawing->width());
  }
  if (result.sensitivities) {
    const auto& [x0, p, parameters] = *result.sensitivities;
    check_rows(reader, path + "/sensitivities/x0", x0, result.states.size(), result.states.size());
    check_rows(reader, path + "/sensitivities/p", p, result.states.size(), parameters.size());
  }
  if (result.optimization) check_optimization(reader, path, result);
  if (result.elements) check_elements(reader, path + "/elements", *result.elements);
  for (std::size_t i = 0; i < result.families.size(); ++i) {
    const auto& family = result.families[i];
    const auto here = fmt::format("{}/families/{}", path, i);
    if (family.event >= result.events.size()) {
      reader.fail(here + "/event", fmt::format("there is no event {}", family.event));
    }
    check_length(reader, here + "/to/mode", family.to.mode, columns);
    check_length(reader, here + "/to/alpha", family.to.alpha, columns);
    check_active(reader, here + "/to", family.to.regions, result.region_groups);
  }
  for (std::size_t i = 0; i < result.surfaces.size(); ++i) {
    check_surface(reader, result.surfaces[i], fmt::format("{}/surfaces/{}", path, i), result.states);
  }
}

void check_branch(JsonReader& reader, const std::string& path, const result::Result& parent,
                  const result::Result& branch) {
  const bool same = branch.states == parent.states && branch.controls == parent.controls &&
                    branch.switching_functions == parent.switching_functions && branch.outputs == parent.outputs &&
                    branch.region_groups == parent.region_groups && branch.kept == parent.kept;
  if (!same)
    reader.fail(path,
                "expected the states, controls, switching functions, outputs and groups of regions of what it leaves, "
                "and the same columns");
  if (!branch.left_at) {
    reader.fail(path, "'left_at' is missing");
    return;
  }
  const auto& [event, alternative, member] = *branch.left_at;
  if (member) {
    if (member->family >= parent.families.size()) {
      reader.fail(path + "/left_at", fmt::format("what it leaves has no family {}", member->family));
    }
  } else if (event >= parent.events.size() || alternative >= parent.events[event].alternatives.size()) {
    reader.fail(path + "/left_at",
                fmt::format("what it leaves has no alternative {} of an event {}", alternative, event));
  }
  if (branch.events.empty()) reader.fail(path + "/events", "expected the event at which it leaves, found none");
}

}  // namespace saltus::io
