// Switches that accumulate: spirals into the intersection of surfaces, and what follows behind their limit.
#include <algorithm>
#include <cmath>
#include <utility>

#include "saltus/event_integrator/decide/continuations.hpp"
#include "saltus/event_integrator/decide/tied_indicators.hpp"
#include "saltus/event_integrator/field/held_functions.hpp"
#include "saltus/event_integrator/mode/at_surface.hpp"
#include "saltus/event_integrator/mode/mode_differences_internal.hpp"
#include "saltus/event_integrator/mode/regions.hpp"
#include "saltus/event_integrator/run/run_internal.hpp"

namespace saltus::event_integrator {
namespace {

/// A surface with the mode that it changes to, as one number: what has to repeat from lap to lap.
int label_of(int surface, int mode) { return 3 * surface + mode + 1; }
int surface_of(int label) { return label / 3; }

/// All surfaces of the laps at zero, and all of their regions active; but for functions that jump over zero on surfaces
/// inside them.
/// @param limit  of the laps
/// @param time_scale  a step of the integrator
void put_on(const evaluation::ModelKernel& kernel, const SeriesLimit& limit, double time_scale, ModeState& state) {
  const auto& labels = limit.events;
  const auto is_nested = [&](int j) { return !kernel.inner(j).empty(); };
  std::vector<std::vector<ActiveRegion>> active(kernel.region_groups().size());
  for (const int label : labels) {
    const int surface = surface_of(label);
    bool is_region = false;
    for (std::size_t g = 0; g < active.size(); ++g) {
      if (!kernel.region_groups()[g].holds(surface)) continue;
      is_region = true;
      const auto known = [&](const ActiveRegion& region) { return region.region == surface; };
      if (std::none_of(active[g].begin(), active[g].end(), known)) active[g].push_back({surface, 0.0});
    }
    if (!is_region && !is_nested(surface)) set_surface(state, surface, 0, 0.5);
  }
  for (const int label : labels) {  // inner functions have smaller numbers
    const int surface = surface_of(label);
    if (!is_nested(surface) || state.mode[at(surface)] == 0) continue;
    const auto corners = corners_at(state, sliding_inside(kernel, state, surface));
    const bool jumps = !continuous_across(kernel, corners, surface, limit.t, limit.x, time_scale);
    if (!jumps) set_surface(state, surface, 0, 0.5);
  }
  for (std::size_t g = 0; g < active.size(); ++g) {
    for (auto& region : active[g]) region.weight = 1.0 / static_cast<double>(active[g].size());
    if (!active[g].empty()) set_active(state, kernel.region_groups()[g], active[g]);
  }
  set_corner_alpha(state);
}

/// Functions inside those that are put on, which the laps shrink with them: they vanish there, too. Returns whether
/// there are any.
/// @param lap_change  of each function: what a lap changes it by
bool put_on_inner(const evaluation::ModelKernel& kernel, const SeriesLimit& limit,
                  const std::vector<double>& lap_change, ModeState& state) {
  std::vector<double> values(at(kernel.event_functions()));
  kernel.functions(limit.t, limit.x.data(), state.alpha.data(), values.data());
  const std::vector<int> around = state.sliding;
  bool any = false;
  for (const int j : around) {
    for (const int i : kernel.inner(j)) {
      constexpr double part = 0.1;  // the limit is far nearer than the last lap
      if (state.mode[at(i)] == 0 || !(std::abs(values[at(i)]) <= part * lap_change[at(i)])) continue;
      set_surface(state, i, 0, 0.5);
      any = true;
    }
  }
  return any;
}

/// x onto surfaces some of which hold the signs of others.
void put_onto_nested(const evaluation::ModelKernel& kernel, const ModeState& state, double t, std::vector<double>& x) {
  std::vector<HeldFunction> functions;
  std::vector<double> alpha = state.alpha;
  for (const int j : state.sliding) {
    functions.push_back({j, 0});
    alpha[at(j)] = 0.5;
  }
  HeldFunctions held(kernel);
  held.set(std::move(functions), std::move(alpha));
  static_cast<void>(held.project(t, x.data()));
}

}  // namespace

/// Notes the switch in hand as part of a sequence that tightens; empty if there is none.
void Run::note_tightening_switch() {
  if (before_.mode == here_.state.mode) return;
  if (jumped_ || !series_.tightens()) return switch_laps_.clear();
  bool holds = true;  // kinks do not hold a solution, and times pass
  switch_labels_.clear();
  for_each_difference(before_.mode, here_.state.mode, [&](std::size_t j) {
    const auto role = surroundings_.system.switching[j].role;
    holds = holds && (role == model::SwitchingRole::listed || role == model::SwitchingRole::region);
    switch_labels_.push_back(label_of(static_cast<int>(j), here_.state.mode[j]));
  });
  if (!holds) return switch_laps_.clear();
  switch_laps_.add(here_.t, switch_labels_, here_.x);
  // A limit asks for the rates of those switches only behind which laps have shrunk twice.
  if (switch_laps_.shrinks()) note_switch_rates();
}

/// How short laps of the switch in hand may get.
void Run::note_switch_rates() {
  kernel_.field(here_.t, here_.x.data(), before_.alpha.data(), free_slope_.data());
  for (const int label : switch_labels_) {
    // Where sliding begins or ends psi moves on the other side only.
    const Rate arriving = rates_.along(surface_of(label), free_slope_);
    const Rate leaving = rates_.here(surface_of(label));
    const double rate = std::max(std::abs(arriving.value), std::abs(leaving.value));
    // As for guards of jumps: between two zeros psi gets about as far as its rate times a quarter of the lap. Shallower
    // laps are lost in the rounding of psi, or in ten times the atol that follows the laps. Not in rtol times the terms
    // of psi: every switch puts psi back to 0, and over laps far shorter than the steps that rtol allows the error of a
    // step is far smaller than that.
    const double unresolved =
        std::max(200.0 * 8.0 * rounding_unit * leaving.magnitude, 10.0 * tolerances_.step().atol * leaving.slope);
    double& shortest = shortest_switch_lap_[at(label)];
    shortest = rate > 0.0 ? 4.0 * unresolved / rate : 0.0;
    // Where sliding ends psi leaves tangentially: its rate is rounding, and what bends it is what resolves the lap.
    constexpr double tangent = 1e-12;
    if (rate > tangent * std::max(arriving.terms, leaving.terms)) continue;
    const double bend =
        std::abs(kernel_.lie_derivative(surface_of(label), 2, here_.t, here_.x.data(), here_.state.alpha.data()));
    if (bend > 0.0) shortest = std::min(shortest, std::sqrt(8.0 * unresolved / bend));
  }
}

/// Laps that shrink by q have psi shrink by q or, where psi is tangent to its surface at the limit, q^2: an absolute
/// tolerance that did not follow would end them in noise long before their limit.
void Run::follow_shrinking() {
  if (switch_laps_.empty()) {
    first_lap_ = 0.0;
    if (tolerances_.part(StepTolerances::Reason::cycles).atol != 1.0 || !ending_roots_.empty()) {
      tolerances_.lift(StepTolerances::Reason::cycles);
      tolerances_.lift(StepTolerances::Reason::zeros);
    }
    return;
  }
  const auto lap = switch_laps_.closed_lap();
  if (!lap) return;
  if (first_lap_ == 0.0) first_lap_ = *lap;
  closed_lap_ = *lap;
  const double share = std::clamp(*lap / first_lap_, 1e-6, 1.0);
  tolerances_.limit(StepTolerances::Reason::cycles, {.rtol = 1.0, .atol = share * share});
}

/// Without a switch for many laps their sequence has ended before it had a limit, as spirals do in the layers of a
/// regularisation: what comes has the tolerances of the run.
void Run::end_shrinking() {
  constexpr double many = 16.0;
  if (here_.t - series_.last() <= many * closed_lap_) return;
  switch_laps_.clear();
  follow_shrinking();
}

/// The same for one surface, listed, with no jump; `before` is its mode and selection before.
void Run::note_tightening_switch(const SurfaceSwitch& change) {
  if (!series_.tightens()) return switch_laps_.clear();
  switch_labels_.assign(1, label_of(change.surface, change.after));
  switch_laps_.add(here_.t, switch_labels_, here_.x);
  if (!switch_laps_.shrinks()) return;
  before_ = here_.state;
  set_surface(before_, change.surface, change.before, change.alpha_before);
  if (change.slid != nullptr) before_.alpha[at(change.slid->surface)] = change.slid->alpha_before;
  note_switch_rates();
}

/// Behind a switch that was noted: if those up to here have a limit that nothing else precedes, the run goes on from
/// there.
void Run::accumulate_switches() {
  follow_shrinking();
  if (switch_laps_.empty()) return;
  const auto limit = switch_laps_.limit(shortest_switch_lap_);
  if (const auto nearly = limit ? std::nullopt : switch_laps_.nearly(); nearly && nearly->t < options_.until) {
    if (follow_spiral(*nearly, Behind::higher_order)) return switch_laps_.clear();
  }
  if (!limit || limit->rattling || limit->t > std::min(options_.until, jumps_.next_time())) return;
  const bool repeats = limits_repeat(limit->t);
  switch_laps_.clear();
  if (repeats || !follow_spiral(*limit, Behind::any)) accumulates();
}

/// The switch in hand cannot be decided, in a lap beside a root that drowns in the rounding of psi, as do the rates of
/// the fields there: laps have their limit where they are. nullopt where it is none of such laps.
std::optional<SeriesLimit> Run::drowned_here() const {
  if (switch_laps_.empty() || occasion_.touched.size() != 1) return std::nullopt;
  const int surface = occasion_.touched.front();
  if (!contains(ending_roots_, surface)) return std::nullopt;
  const double lap = here_.t - last_event_time_;
  const double shortest =
      std::max(shortest_switch_lap_[at(label_of(surface, -1))], shortest_switch_lap_[at(label_of(surface, 1))]);
  if (!(lap <= shortest)) return std::nullopt;
  return SeriesLimit{here_.t, here_.x, {label_of(surface, before_.mode[at(surface)])}, lap, false};
}

/// Goes on from the limit that an undecided switch has turned out to be.
void Run::go_on_from_drowned() {
  const SeriesLimit limit = *std::exchange(drowned_, std::nullopt);
  switch_laps_.clear();
  follow_shrinking();
  if (!follow_spiral(limit, Behind::any)) fail(transition_.termination, std::move(transition_.message));
}

/// Events cannot be told apart here: surfaces that are zero together, as far as the tolerances tell, may be held so,
/// with their derivatives (controllers with roots of several states, which reach their origin faster than laps shrink).
/// Returns whether the run has gone on.
bool Run::hold_what_drowns() {
  find_functions(here_.t, here_.x.data(), values_here_);
  SeriesLimit limit{here_.t, here_.x, {}, here_.smallest_step(), false, true};
  for (std::size_t i = 0; i < values_here_.size(); ++i) {
    const auto& function = search_.functions()[i];
    if (function.kind != FunctionKind::surface || !(std::abs(values_here_[i]) <= search_.accuracy(i))) continue;
    limit.events.push_back(label_of(function.index, function.sign));
  }
  return limit.events.size() > 1 && follow_spiral(limit, Behind::higher_order);
}

/// Laps that hardly shrink are too many for their time before as little of it remains as a limit is asked for usually.
/// Returns whether they have one all the same, and the run has gone on from there.
bool Run::follow_dense_laps() {
  const auto lap = switch_laps_.last_lap();
  if (!lap) return false;
  // Laps that are not longer than this are extrapolated whatever remains.
  const std::vector<double> shortest(shortest_switch_lap_.size(), 2.0 * *lap);
  const auto limit = switch_laps_.limit(shortest);
  if (!limit || limit->rattling || limit->t > std::min(options_.until, jumps_.next_time())) return false;
  switch_laps_.clear();
  return follow_spiral(*limit, Behind::any);
}

/// Whether limits follow each other at once, laps of rounding between them: the solution stays where the switches have
/// come together (sliding of second order on some surfaces), and no mode found there is that.
bool Run::limits_repeat(double t) {
  constexpr int many = 8;
  constexpr double at_once = 1e-3;
  auto& row = limits_in_a_row_;
  const bool follows = row.count > 0 && t - row.last <= at_once * row.first_lap;
  row = {follows ? row.count + 1 : 1, t, follows ? row.first_lap : first_lap_};
  return row.count >= many;
}

/// Returns whether the run has gone on, or has ended for another reason.
bool Run::follow_spiral(const SeriesLimit& limit, Behind wanted) {
  ModeState on = here_.state;
  on.higher.reset();
  put_on(kernel_, limit, here_.time_scale, on);
  std::vector<double> x = limit.x;
  Occasion occasion;
  std::vector<double> lap_change(at(kernel_.event_functions()));
  for (const int j : on.sliding) {
    for (const int i : kernel_.inner(j)) {
      lap_change[at(i)] = limit.lap * std::abs(rates_.here(i).value);
    }
  }
  if (put_on_inner(kernel_, limit, lap_change, on)) {
    put_onto_nested(kernel_, on, limit.t, x);
  } else {
    const ReferenceScope references(kernel_, on);
    ModeField field(kernel_, surroundings_.affine_in_alpha);
    field.enter(on);
    field.project(limit.t, x.data());
  }
  occasion.t = limit.t;
  occasion.x = x.data();
  occasion.at_zero = occasion.touched = on.sliding;
  occasion.start = occasion.limit = true;  // no side is the one it comes from
  // What the last lap changes is at rest behind it, and what t does not resolve.
  occasion.time_scale = std::max({here_.time_scale, limit.lap, 1e3 * rounding_unit * std::abs(limit.t)});
  note_ties(kernel_, on, occasion);
  Transition transition = decide_mode(surroundings_, on, occasion);
  if (transition.termination != result::Termination::completed) return false;
  if (wanted == Behind::higher_order && !transition.state.higher) return false;
  other_continuations(surroundings_, on, occasion, transition);

  field_(here_.t, here_.x.data(), here_.slope.data());
  if (!here_.state.sliding.empty()) here_.state.alpha = field_.alpha();
  const ModeState before = here_.state;
  const std::vector<double> x_last = here_.x;
  pass_to(limit.t, std::move(x));
  if (!enter(transition)) return true;
  const auto why = limit.drowned ? "these are zero together, as far as they can be told apart"
                                 : "the intervals of these switches shrink geometrically: the state is their limit";
  // What has been slid on through all laps may be left at their limit, too.
  std::vector<int> surfaces = on.sliding;
  for (const int label : limit.events) surfaces.push_back(surface_of(label));
  recorder_.spiralled(here_.t, surfaces, {x_last, here_.x, before, here_.state}, transition, why);
  row(here_.t, here_.x);
  last_event_time_ = here_.t;
  restart_control();
  static_cast<void>(steps_.memory().change(here_.state.mode, here_.t, here_.h));
  go_on_from_limit();
  here_.time_scale = here_.h;
  return true;
}

}  // namespace saltus::event_integrator
