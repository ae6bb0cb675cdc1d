#include "saltus/event_integrator/instant/switch_stage.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "saltus/base/at.hpp"
#include "saltus/event_integrator/decide/continuations.hpp"
#include "saltus/event_integrator/decide/projected_fields.hpp"
#include "saltus/event_integrator/decide/tied_indicators.hpp"
#include "saltus/event_integrator/instant/rest_stage.hpp"
#include "saltus/event_integrator/mode/at_surface.hpp"
#include "saltus/event_integrator/mode/kept_by_sliding.hpp"

namespace saltus::event_integrator {
namespace {

/// Whether a nested function reaches 0 on one side only of a surface that is slid on; that ends the run.
bool jumps_while_sliding(RunState& run, int surface) {
  const Position& here = run.here;
  const auto corners = corners_inside(run.kernel, here.state, surface);
  if (continuous_across(run.kernel, corners, surface, here.t, here.x, here.time_scale)) return false;
  const auto name = [&](int j) { return run.switching.layout.surfaces[at(j)].name; };
  run.end(
      result::Termination::outside_class,
      fmt::format("'{}' jumps across the surface of '{}', on which the solution slides, and reaches 0 on one side of "
                  "it at t = {:.17g}: rewrite the nested term with named switching functions",
                  name(surface), name(sliding_inside(run.kernel, here.state, surface).front()), here.t));
  return true;
}

void insert_ascending(std::vector<int>& list, int surface) {
  const auto behind = std::lower_bound(list.begin(), list.end(), surface);
  if (behind == list.end() || *behind != surface) list.insert(behind, surface);
}

/// Kinks that are zero all along what is slid on: they are there, too, where that ends or another one is met.
void add_kinks_kept(const RunState& run, SwitchingPoint& point) {
  const auto& state = run.here.state;
  if (state.sliding.empty()) return;
  std::vector<double> values;
  std::optional<ProjectedFields> fields;
  for (int j = 0; j < run.kernel.switching_functions(); ++j) {
    if (run.switching.layout.surfaces[at(j)].role != model::SwitchingRole::kink || contains(point.at_zero, j)) continue;
    if (!fields) {
      fields.emplace(run.kernel, point);
      values.resize(at(run.kernel.event_functions()));
      run.kernel.functions(point.t, point.x, state.alpha.data(), values.data());
    }
    const bool is_zero = std::abs(values[at(j)]) <= fields->noise(j);
    if (is_zero && is_kept_by_sliding(run.kernel, state, j, point.t, point.x)) insert_ascending(point.at_zero, j);
  }
}

}  // namespace

bool collect_surfaces(const InstantContext& c, const Located& located, double longest_step) {
  auto& [run, cascade, out] = c;
  const Position& here = run.here;
  SwitchingPoint& point = out.switching_point;
  point.begin(here.t, here.x.data(), here.time_scale);
  point.at_zero = here.state.sliding;
  for (const std::size_t place : located.functions) {
    const auto& function = run.search.functions()[place];
    const bool is_surface = function.kind != FunctionKind::user && function.kind != FunctionKind::release;
    if (!is_surface || is_cell_end(function.kind)) continue;
    if (function.kind == FunctionKind::exit_below) point.exit_below.push_back(function.index);
    if (function.kind == FunctionKind::exit_above) point.exit_above.push_back(function.index);
    if (function.kind == FunctionKind::loss) {
      point.coalesced.push_back(function.index);
      point.time_scale = std::max(point.time_scale, longest_step);
    }
    if (function.kind == FunctionKind::instability) point.destabilised.push_back(function.index);
    if (function.kind == FunctionKind::nested && jumps_while_sliding(c.run, function.index)) return false;
    insert_ascending(point.at_zero, function.index);
    point.touched.push_back(function.index);
  }
  if (!point.touched.empty()) add_kinks_kept(run, point);
  return true;
}

const ModeState& touch_others(const InstantContext& c) {
  auto& [run, cascade, out] = c;
  const ModeState& from = out.freed.empty() ? out.before : slid_on_freed(c);
  for (const int j : run.here.state.sliding) {
    // Sliding goes on with the new gradient, or ends, behind a kink of its own psi.
    if (out.cell_change != CellChange::none && run.cells.moved_in(j)) out.switching_point.touched.push_back(j);
  }
  return from;
}

void decide_touched(const InstantContext& c, const ModeState& from, SingleSurface& single, SurfacePair& pair) {
  auto& [run, cascade, out] = c;
  SwitchingPoint& point = out.switching_point;
  if (!run.kernel.region_groups().empty()) complete_ties(run.kernel, run.here.state, point);
  note_ties(run.kernel, run.here.state, point);
  const bool slope_holds = run.cells.empty() && run.jumps.none();  // no cell was left, and no guard released, here
  const SingleSurface::Motion known{run.here.slope, run.field.solve()};
  out.by_one_surface = single.decide(from, point, out.transition, slope_holds ? &known : nullptr);
  if (!out.by_one_surface && !pair.decide(from, point, out.transition)) {
    out.transition = decide_mode(run.switching, from, point);
  }
  if (out.transition.termination == result::Termination::completed) {
    other_continuations(run.switching, from, point, out.transition);
  }
}

}  // namespace saltus::event_integrator
