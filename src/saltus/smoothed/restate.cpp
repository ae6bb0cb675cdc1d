#include "saltus/smoothed/restate.hpp"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "saltus/base/at.hpp"
#include "saltus/base/contains.hpp"
#include "saltus/smoothed/regularise.hpp"

namespace saltus::smoothed {
namespace {

using result::Event;
using result::EventKind;
using result::Mode;
using result::Termination;

/// -1, 0, 1: outside below, inside, outside above.
int mode_on(const Side& side, const Mode& edges) {
  if (edges[side.lower] < 0) return -1;
  return edges[side.upper] > 0 ? 1 : 0;
}

/// Whether the solution is, at least partly, on this side of the surfaces inside a function.
bool is_on(const Side& side, const Layer& layer, const Mode& layers) {
  for (std::size_t k = 0; k < layer.inner.size(); ++k) {
    const int inner = layers[layer.inner[k]];
    if (inner != 0 && (inner > 0) != (side.values[k] > 0)) return false;
  }
  return true;
}

/// Modes of the original columns from those of the edges; inside, where the sides differ.
Mode modes_of(const Regularisation& regularisation, const Mode& edges) {
  Mode layers;
  for (const Layer& layer : regularisation.layers) {
    std::optional<int> mode;
    for (const Side& side : layer.sides) {
      if (!is_on(side, layer, layers)) continue;
      const int here = mode_on(side, edges);
      mode = mode && *mode != here ? 0 : here;
    }
    layers.push_back(mode.value_or(0));
  }
  Mode modes;
  for (const auto& column : regularisation.columns) {
    modes.push_back(column.orientation * layers[at(column.function)]);
  }
  return modes;
}

/// Takes the selections from the end of a row's outputs; exactly 0 and 1 outside of the layers.
std::vector<double> selections_from(std::vector<double>& outputs, const Regularisation& regularisation,
                                    const Mode& modes) {
  const auto first = outputs.end() - static_cast<std::ptrdiff_t>(modes.size());
  std::vector<double> alpha(first, outputs.end());
  outputs.erase(first, outputs.end());
  for (std::size_t j = 0; j < alpha.size(); ++j) {
    if (regularisation.columns[j].orientation < 0) alpha[j] = 1.0 - alpha[j];
    alpha[j] = modes[j] == 0 ? std::clamp(alpha[j], 0.0, 1.0) : modes[j] > 0 ? 1.0 : 0.0;
  }
  return alpha;
}

/// The active modes of every group by `indicator`.
result::Regions regions_of(const Regularisation& regularisation, const Mode& edges) {
  result::Regions active;
  for (const auto& group : regularisation.regions) {
    active.emplace_back();
    for (std::size_t i = 0; i < group.names.size(); ++i) {
      if (edges[group.columns[i]] > 0) active.back().push_back(group.names[i]);
    }
  }
  return active;
}

/// Takes the weights of all regions from the end of a row's outputs; those of inactive ones are 0.
std::vector<double> weights_from(std::vector<double>& outputs, const Regularisation& regularisation,
                                 const Mode& edges) {
  std::size_t count = 0;
  for (const auto& group : regularisation.regions) count += group.names.size();
  const auto first = outputs.end() - static_cast<std::ptrdiff_t>(count);
  std::vector<double> theta(first, outputs.end());
  outputs.erase(first, outputs.end());
  std::size_t next = 0;
  for (const auto& group : regularisation.regions) {
    double sum = 0.0;
    const auto begin = next;
    for (const std::size_t column : group.columns) {
      if (edges[column] < 0) theta[next] = 0.0;
      sum += theta[next++];
    }
    for (std::size_t i = begin; i < next; ++i) theta[i] /= sum;
  }
  return theta;
}

/// Modes and selections of an event are those of the first and the last row at its time.
void take_from_rows(Event& event, const result::Trajectory& rows) {
  const auto [first, last] = std::equal_range(rows.t.begin(), rows.t.end(), event.t);
  if (first == last) return;
  event.alpha_before = rows.alpha[at(first - rows.t.begin())];
  event.alpha_after = rows.alpha[static_cast<std::size_t>(last - rows.t.begin()) - 1];
}

bool is_edge(EventKind kind) {
  return kind == EventKind::crossing || kind == EventKind::enter_sliding || kind == EventKind::leave_sliding ||
         kind == EventKind::change_sliding;
}

/// Notes the regions that have changed: alone 1, with others 0, inactive -1.
void describe_regions(Event& event, const Regularisation& regularisation, Mode& before, Mode& after) {
  if (!event.regions_before || !event.regions_after) return;
  for (std::size_t g = 0; g < regularisation.regions.size(); ++g) {
    for (const auto& name : regularisation.regions[g].names) {
      const auto mode = [&](const std::vector<std::string>& active) {
        const bool is_active = contains(active, name);
        return !is_active ? -1 : active.size() > 1 ? 0 : 1;
      };
      const int from = mode((*event.regions_before)[g]), to = mode((*event.regions_after)[g]);
      if (from == to) continue;
      before.push_back(from);
      after.push_back(to);
      if ((from < 0) == (to < 0)) continue;
      event.surfaces.push_back(name);
      event.reason += fmt::format("{}{} {} the others", event.reason.empty() ? "" : "; ", name,
                                  to < 0 ? "has no weight left beside" : "begins to have a weight beside");
    }
  }
}

/// Surfaces, kind and reason of a passed edge; false if no column has changed.
bool describe(Event& event, const Regularisation& regularisation) {
  if (!event.mode_before || !event.mode_after) return false;
  Mode before, after;
  event.surfaces.clear();
  event.reason.clear();
  describe_regions(event, regularisation, before, after);
  for (std::size_t j = 0; j < event.mode_before->size(); ++j) {
    const int from = (*event.mode_before)[j], to = (*event.mode_after)[j];
    if (from == to) continue;
    const auto& name = regularisation.columns[j].name;
    before.push_back(from);
    after.push_back(to);
    event.surfaces.push_back(name);
    event.reason += fmt::format("{}{} the layer |{}| <= {}", event.reason.empty() ? "" : "; ",
                                to == 0 ? "enters" : "leaves", name, regularisation.epsilon);
  }
  if (event.surfaces.empty()) return false;
  event.kind = result::kind_of_switch(before, after);
  return true;
}

}  // namespace

void restate(const Regularisation& regularisation, result::Events& events, result::Trajectory& trajectory,
             result::Status& status) {
  result::SteadyTable<signed char> modes;
  result::SteadyTable<double> alphas;
  std::size_t outputs_of_user = trajectory.outputs.width();
  for (std::size_t row = 0; row < trajectory.t.size(); ++row) {
    const Mode edges = trajectory.mode[row];
    std::vector<double> outputs = trajectory.outputs[row];
    if (!regularisation.regions.empty()) {
      trajectory.regions.push_back(regions_of(regularisation, edges));
      trajectory.theta.push_back(weights_from(outputs, regularisation, edges));
    }
    const Mode mode = modes_of(regularisation, edges);
    alphas.push_back(selections_from(outputs, regularisation, mode));
    modes.push_back(mode);
    outputs_of_user = outputs.size();
  }
  trajectory.outputs.narrow(outputs_of_user);
  trajectory.mode = std::move(modes);
  trajectory.alpha = std::move(alphas);
  result::Events restated;
  for (Event event : events) {
    if (event.kind == EventKind::start) continue;  // on an edge, where nothing is decided
    if (!regularisation.regions.empty()) {
      if (event.mode_before) event.regions_before = regions_of(regularisation, *event.mode_before);
      if (event.mode_after) event.regions_after = regions_of(regularisation, *event.mode_after);
    }
    for (auto* mode : {&event.mode_before, &event.mode_after}) {
      if (*mode) *mode = modes_of(regularisation, **mode);
    }
    const bool had_before = event.alpha_before.has_value(), had_after = event.alpha_after.has_value();
    take_from_rows(event, trajectory);
    if (!had_before) event.alpha_before.reset();
    if (!had_after) event.alpha_after.reset();
    if (is_edge(event.kind) && !describe(event, regularisation)) continue;
    // A system without jumps has one solution, whatever sides a corner was looked at from.
    event.unique = true;
    event.alternatives.clear();
    restated.push_back(std::move(event));
  }
  events = std::move(restated);
  // Corners have one continuation, unless rounding hides it; and the error that a layer allows may be below rounding.
  const bool lost = status.termination == Termination::outside_class ||
                    status.termination == Termination::no_admissible_mode ||
                    status.termination == Termination::step_size_too_small;
  if (lost) {
    status.message += fmt::format(
        "; with method \"smoothed\" the layer of width epsilon = {} may be too thin for doubles: choose a larger "
        "simulate.smoothed.epsilon",
        regularisation.epsilon);
  }
}

}  // namespace saltus::smoothed
