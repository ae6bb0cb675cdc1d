#include "saltus/event_integrator/decide/start.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include <fmt/format.h>

#include "saltus/base/contains.hpp"
#include "saltus/event_integrator/decide/continuations.hpp"
#include "saltus/event_integrator/decide/projected_fields.hpp"
#include "saltus/event_integrator/decide/tied_indicators.hpp"
#include "saltus/event_integrator/mode/regions.hpp"
#include "saltus/event_integrator/mode/resolution.hpp"
#include "saltus/event_integrator/mode/small_internal.hpp"

namespace saltus::event_integrator {
namespace {

/// psi_j, or where it holds signs that are not decided yet, and that it depends on, the value in one of their regions:
/// 0 at a selection of 1/2 means nothing.
double value_in_a_region(const SwitchingContext& s, double t, const double* x, const ModeState& state, int j,
                         double noise) {
  std::vector<double> values(at(s.kernel.event_functions()));
  s.kernel.functions(t, x, state.alpha.data(), values.data());
  if (std::abs(values[at(j)]) > noise) return values[at(j)];
  for (const double region : {0.0, 1.0}) {
    std::vector<double> alpha = state.alpha;
    for (const int inner : s.kernel.inner(j)) {
      if (state.mode[at(inner)] == 0) alpha[at(inner)] = region;
    }
    s.kernel.functions(t, x, alpha.data(), values.data());
    if (std::abs(values[at(j)]) > noise) break;
  }
  return values[at(j)];
}

/// A switching function of discrete states: its selection pointwise, as written where it is 0. It is in no mode, so
/// that nothing looks for a zero of it or slides on it.
void read_discrete(const SwitchingContext& s, double t, const double* x, int j, ModeState& state) {
  std::vector<double> values(at(s.kernel.event_functions()));
  s.kernel.functions(t, x, state.alpha.data(), values.data());
  const double psi = values[at(j)];
  state.mode[at(j)] = 0;
  state.alpha[at(j)] = psi > 0.0 ? 1.0 : psi < 0.0 ? 0.0 : s.layout.surfaces[at(j)].alpha_at_zero;
}

/// Whether psi_j, exactly 0 here, is 0 whatever moves: n x while the discrete state n is 0. Such a function is decided
/// as written until a jump changes that.
bool vanishes_until_a_jump(const SwitchingContext& s, double t, const double* x, int j, const ModeState& state) {
  const auto& discrete = s.layout.discrete_states;
  if (s.layout.surfaces[at(j)].alpha_at_zero == 0.5) return false;
  std::vector<double> row(discrete.size());
  double rate = 0.0;
  s.kernel.gradient(j, t, x, state.alpha.data(), row.data(), &rate);
  for (std::size_t i = 0; i < row.size(); ++i) {
    if (!discrete[i] && row[i] != 0.0) return false;
  }
  return rate == 0.0 && s.kernel.lie_derivative(j, 2, t, x, state.alpha.data()) == 0.0;
}

/// The surfaces that the solution has been on.
struct SurfacesMet {
  std::span<const int> held = {};  ///< at zero whatever is left of their psi
  std::span<const int> slid = {};  ///< at zero where no more than what projections leave is left of it

  [[nodiscard]] bool is_at_zero(int j, double psi, double noise) const {
    // The projection leaves a few roundings of psi; a jump leaves something of its size.
    return std::abs(psi) <= noise || contains(held, j) || (std::abs(psi) <= 8.0 * noise && contains(slid, j));
  }
};

/// The regions of a group by `indicator` at its minimum: the first of them is the reference, the others are at zero.
/// Where some have been met, the reference they are measured against and they are at the minimum.
void read_regions(const SwitchingContext& s, double t, const double* x, const ProjectedFields& fields,
                  std::size_t group, const SurfacesMet& met, ModeState& state, std::vector<int>& at_zero) {
  const auto& range = s.kernel.region_groups()[group];
  std::vector<double> values(at(s.kernel.event_functions()));
  s.kernel.functions(t, x, state.alpha.data(), values.data());
  const auto is_met = [&](int j) { return range.holds(j) && met.is_at_zero(j, values[at(j)], fields.noise(j)); };
  if (std::none_of(met.held.begin(), met.held.end(), is_met) &&
      std::none_of(met.slid.begin(), met.slid.end(), is_met)) {
    if (s.kernel.reference(group) < 0) s.kernel.set_reference(group, range.first);
    s.kernel.functions(t, x, state.alpha.data(), values.data());
    const auto first = values.begin() + range.first;
    const auto smallest = std::max_element(first, first + range.count);  // of psi_i = g_r - g_i
    s.kernel.set_reference(group, range.first + static_cast<int>(smallest - first));
  }
  s.kernel.functions(t, x, state.alpha.data(), values.data());
  const int reference = s.kernel.reference(group);
  std::vector<ActiveRegion> active{{reference, 1.0}};
  for (int j = range.first; j < range.first + range.count; ++j) {
    if (j == reference) continue;
    if (met.is_at_zero(j, values[at(j)], fields.noise(j))) active.push_back({j, 0.0});
  }
  for (auto& region : active) region.weight = 1.0 / static_cast<double>(active.size());
  set_active(state, range, active);
  for (std::size_t k = 1; k < active.size(); ++k) at_zero.push_back(active[k].region);
}

/// Signs of all switching functions, inner ones first; those at zero get 0.
void read_signs(const SwitchingContext& s, double t, const double* x, const ProjectedFields& fields,
                const SurfacesMet& met, ModeState& state, std::vector<int>& at_zero) {
  std::vector<double> values(at(s.kernel.event_functions()));
  s.kernel.functions(t, x, state.alpha.data(), values.data());
  for (int j = 0; j < s.kernel.switching_functions(); ++j) {
    if (s.layout.surfaces[at(j)].role == model::SwitchingRole::region) continue;
    if (std::binary_search(state.resting.begin(), state.resting.end(), j)) continue;
    if (s.layout.surfaces[at(j)].role == model::SwitchingRole::discrete) {
      read_discrete(s, t, x, j, state);
      continue;
    }
    const double psi =
        s.kernel.inner(j).empty() ? values[at(j)] : value_in_a_region(s, t, x, state, j, fields.noise(j));
    if (psi == 0.0 && vanishes_until_a_jump(s, t, x, j, state)) {
      const double alpha = s.layout.surfaces[at(j)].alpha_at_zero;
      set_surface(state, j, alpha > 0.5 ? 1 : -1, alpha);
      continue;
    }
    if (met.is_at_zero(j, psi, fields.noise(j))) {
      at_zero.push_back(j);
      set_surface(state, j, 0, 0.5);
    } else {
      set_surface(state, j, psi > 0.0 ? 1 : -1, psi > 0.0 ? 1.0 : 0.0);
    }
  }
  for (std::size_t g = 0; g < s.kernel.region_groups().size(); ++g) {
    read_regions(s, t, x, fields, g, met, state, at_zero);
  }
}

/// A selection that is not finite marks a switching function that is undefined at the start.
bool finite_at_start(const SwitchingContext& s, double t, const double* x, const ModeState& state,
                     Transition& transition) {
  std::vector<double> values(at(s.kernel.event_functions()));
  s.kernel.functions(t, x, state.alpha.data(), values.data());
  for (int j = 0; j < s.kernel.switching_functions(); ++j) {
    if (std::isfinite(values[at(j)])) continue;
    transition.termination = result::Termination::evaluation_failed;
    transition.message = fmt::format(
        "the switching function '{}' is not finite at the start t = {}; change the initial "
        "values or its expression",
        s.layout.surfaces[at(j)].name, t);
    return false;
  }
  return true;
}

/// Whether a mode is as given: of a region 1 says that it is active alone, 0 with others, -1 that it is not active.
bool has_given_modes(const evaluation::ModelKernel& kernel, const ModeState& state,
                     const std::vector<std::pair<int, int>>& given) {
  return std::all_of(given.begin(), given.end(), [&](const auto& entry) {
    const auto& [function, mode] = entry;
    for (const auto& range : kernel.region_groups()) {
      if (!range.holds(function)) continue;
      const auto first = state.mode.begin() + range.first;
      const bool alone = std::count(first, first + range.count, 0) == 1;
      return mode == (state.mode[at(function)] != 0 ? -1 : alone ? 1 : 0);
    }
    return state.mode[at(function)] == mode;
  });
}

/// The first one that is as given: of what was decided with the given surfaces, if any are, what was decided without,
/// and its alternatives.
std::optional<Transition> with_given_modes(const evaluation::ModelKernel& kernel,
                                           const std::vector<std::pair<int, int>>& given,
                                           const std::optional<Transition>& chosen, const Transition& decided) {
  const auto fits = [&](const Transition& t) {
    return t.termination == result::Termination::completed && has_given_modes(kernel, t.state, given);
  };
  if (chosen && fits(*chosen)) return chosen;
  std::optional<Transition> found;
  if (fits(decided)) {
    found = decided;
  } else {
    const auto& others = decided.alternatives;
    const auto other = std::find_if(others.begin(), others.end(), fits);
    if (other != others.end()) found = *other;
  }
  if (found) found->alternatives.clear();
  return found;
}

struct Point {
  SwitchingPoint switching_point;
  ModeState state;
};

/// A point as one at which the solution starts: the surfaces through it, and the sides of the others that it is on.
/// Those of `resting` stay there.
Point read_point(const SwitchingContext& s, double t, const double* x, double time_scale, const SurfacesMet& met,
                 const RestingSurfaces& resting = {}) {
  Point point;
  auto& [switching_point, state] = point;
  switching_point.t = t;
  switching_point.x = x;
  switching_point.start = true;
  switching_point.time_scale = time_scale;
  const ProjectedFields fields(s.kernel, switching_point);
  const auto n_psi = at(s.kernel.switching_functions());
  state.mode.assign(n_psi, 1);
  state.alpha.assign(n_psi, 1.0);
  state.resting = resting.surfaces;
  for (std::size_t i = 0; i < resting.surfaces.size(); ++i) {
    state.mode[at(resting.surfaces[i])] = 0;
    state.alpha[at(resting.surfaces[i])] = resting.alpha[i];
  }
  read_signs(s, t, x, fields, met, state, switching_point.at_zero);
  note_ties(s.kernel, state, switching_point);
  return point;
}

/// Whether nothing is at zero that would have to be decided, nor read anew behind a decision.
bool signs_say_it_all(const SwitchingContext& s, const SwitchingPoint& switching_point) {
  if (!switching_point.at_zero.empty() || !s.kernel.region_groups().empty()) return false;
  for (int j = 0; j < s.kernel.switching_functions(); ++j) {
    if (!s.kernel.inner(j).empty()) return false;
  }
  return true;
}

using GivenModes = std::vector<std::pair<int, int>>;

bool is_of_region(const SwitchingContext& s, int j) {
  return s.layout.surfaces[at(j)].role == model::SwitchingRole::region;
}

/// Why modes that are given contradict the signs at the start; nothing where they do not.
std::optional<std::string> contradiction(const SwitchingContext& s, const ModeState& state,
                                         const std::vector<int>& at_zero, const GivenModes& forced) {
  for (const auto& [surface, mode] : forced) {
    if (is_of_region(s, surface)) continue;
    const bool is_zero = contains(at_zero, surface);
    if (is_zero || mode == state.mode[at(surface)]) continue;
    return fmt::format("initial_mode {} = {} contradicts the sign of the switching function at the start",
                       s.layout.surfaces[at(surface)].name, mode);
  }
  return std::nullopt;
}

/// Whether a transition has the given modes of surfaces, and modes of regions are not given.
bool is_as_given(const Transition& transition, const std::vector<GivenMode>& given, const GivenModes& forced) {
  return transition.termination == result::Termination::completed && !transition.beyond_spiral &&
         given.size() == forced.size() && std::all_of(given.begin(), given.end(), [&](const GivenMode& surface) {
           return transition.state.mode[at(surface.surface)] == surface.mode;
         });
}

/// A continuation with the given modes, other than the one that was decided without them; nullopt if there is none.
std::optional<Transition> continue_as_given(const SwitchingContext& s, const Point& point,
                                            const std::vector<GivenMode>& given, const GivenModes& forced,
                                            const Transition& decided) {
  auto chosen = given.empty() ? std::nullopt : decide_with(s, point.state, point.switching_point, given);
  if (!chosen) {
    // Selections of three and more surfaces are looked for from the middle, where there may be no way to a root.
    const auto fits = [&](const Transition& transition) { return is_as_given(transition, given, forced); };
    const auto found = std::find_if(decided.alternatives.begin(), decided.alternatives.end(), fits);
    if (found != decided.alternatives.end()) chosen = *found;
  }
  return given.size() < forced.size() ? with_given_modes(s.kernel, forced, chosen, decided) : chosen;
}

/// What was decided without the given modes becomes an alternative to what they lead to.
void note_what_was_decided(const Transition& decided, Transition& chosen) {
  if (decided.termination != result::Termination::completed) return;
  const bool differs = decided.state.mode != chosen.state.mode;
  chosen.unique = differs ? std::optional<bool>(false) : decided.unique;
  if (differs) {
    chosen.alternatives.push_back(decided);
    chosen.alternatives.back().alternatives.clear();
  }
  for (const auto& other : decided.alternatives) {
    if (other.state.mode != chosen.state.mode) chosen.alternatives.push_back(other);
  }
}

void note_given(Transition& transition) {
  transition.reason = "initial_mode" + (transition.reason.empty() ? "" : "; " + transition.reason);
}

}  // namespace

Start decide_start(const SwitchingContext& s, double t, const double* x, double time_scale,
                   const std::vector<std::pair<int, int>>& forced, const RestingSurfaces& resting) {
  Start start;
  const Point point = read_point(s, t, x, time_scale, {}, resting);
  const auto& [switching_point, state] = point;
  start.at_zero = switching_point.at_zero;
  for (const int j : switching_point.tied) {
    if (!contains(start.at_zero, j)) start.at_zero.push_back(j);
  }
  if (!finite_at_start(s, t, x, state, start.transition)) return start;
  start.transition = decide_mode(s, state, switching_point);
  other_continuations(s, state, switching_point, start.transition);
  if (forced.empty()) return start;

  const auto refuse = [&start](std::string message) {
    start.transition.termination = result::Termination::no_admissible_mode;
    start.transition.message = std::move(message);
    return start;
  };
  if (auto problem = contradiction(s, state, start.at_zero, forced)) return refuse(std::move(*problem));
  std::vector<GivenMode> given;
  for (const auto& [surface, mode] : forced) {
    if (!is_of_region(s, surface)) given.push_back({surface, mode});
  }
  if (is_as_given(start.transition, given, forced)) {
    note_given(start.transition);
    return start;
  }
  auto chosen = continue_as_given(s, point, given, forced, start.transition);
  if (!chosen) return refuse("initial_mode does not continue the solution: its field does not move to where it says");
  note_given(*chosen);
  note_what_was_decided(start.transition, *chosen);
  start.transition = std::move(*chosen);
  return start;
}

Transition decide_behind_jump(const SwitchingContext& s, const ModeState& before, double t, const double* x,
                              double time_scale, const std::vector<int>& held, const RestingSurfaces& resting,
                              const std::vector<int>& slid) {
  Transition transition;
  if (s.kernel.switching_functions() == 0) {  // nothing to decide
    transition.beside.assign(x, x + s.kernel.states());
    return transition;
  }
  auto [switching_point, state] = read_point(s, t, x, time_scale, {held, slid}, resting);
  // Selections of the sliding motion before are where a search for the new ones starts.
  for (const auto* list : {&held, &slid}) {
    for (const int j : *list) {
      const bool rests = std::binary_search(state.resting.begin(), state.resting.end(), j);
      if (!rests && state.mode[at(j)] == 0) state.alpha[at(j)] = before.alpha[at(j)];
    }
  }
  if (!finite_at_start(s, t, x, state, transition)) return transition;
  if (signs_say_it_all(s, switching_point)) {
    transition.zero_order.assign(state.mode.size(), 0);
    transition.beside.assign(x, x + s.kernel.states());
    transition.state = std::move(state);
    return transition;
  }
  transition = decide_mode(s, state, switching_point);
  other_continuations(s, state, switching_point, transition);
  return transition;
}

}  // namespace saltus::event_integrator
