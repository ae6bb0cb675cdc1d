#include "saltus/event_integrator/transition.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "saltus/event_integrator/at_surface.hpp"
#include "saltus/event_integrator/transition_internal.hpp"
#include "saltus/switching/selection_root.hpp"

namespace saltus::event_integrator {

void append_reason(const model::System& system, int surface, const switching::SurfaceDecision& decision,
                   const ModeState& before, const Occasion& occasion, std::string& reason) {
  const auto& function = system.switching[at(surface)];
  if (function.role != model::SwitchingRole::listed && function.role != model::SwitchingRole::region) return;
  if (decision.mode == before.mode[at(surface)] && !occasion.start) return;
  if (!reason.empty()) reason += "; ";
  reason += function.name;
  reason += ": ";
  reason += decision.reason;
}

void append_leaf(const switching::PlaneDecision& decision, std::string& reason) {
  reason += ": ";
  reason += decision.reason;
  reason += " (";
  reason += switching::name(decision.leaf);
  reason += ")";
}

void begin_transition(const ModeState& before, const Occasion& occasion, std::size_t states, Transition& transition) {
  auto& state = transition.state;
  state.mode = before.mode;
  state.alpha = before.alpha;
  state.sliding = before.sliding;
  state.higher.reset();
  state.resting = before.resting;
  transition.termination = result::Termination::completed;
  transition.message.clear();
  // Both fields are finite here; where they are not behind the projection onto the surface, this point is as good.
  transition.beside.assign(occasion.x, occasion.x + states);
  transition.zero_order.assign(state.mode.size(), 0);
  transition.unique = true;
  transition.other_choices.clear();
  transition.beyond_spiral.reset();
  transition.alternatives.clear();
  transition.decision = -1;
  transition.reason.clear();
  transition.meeting.reset();
}

using switching::SurfaceDecision;
using switching::Verdict;

namespace {

/// Largest group whose 2^m corners are looked at.
constexpr std::size_t largest_group = 12;

}  // namespace

bool feels(const evaluation::ModelKernel& kernel, const Occasion& occasion, int i, int j) {
  if (kernel.depends(i, j) || same_group(kernel, i, j)) return true;
  for (int nested = 0; nested < kernel.switching_functions(); ++nested) {
    if (!contains(occasion.at_zero, nested) && contains(kernel.inner(nested), j) && kernel.depends(i, nested))
      return true;
  }
  return false;
}

std::vector<std::vector<int>> groups_of(const evaluation::ModelKernel& kernel, const Occasion& occasion,
                                        std::vector<int> open) {
  std::vector<std::vector<int>> groups;
  while (!open.empty()) {
    std::vector<int> group{open.front()};
    open.erase(open.begin());
    for (std::size_t k = 0; k < group.size(); ++k) {
      for (std::size_t other = 0; other < open.size();) {
        if (feels(kernel, occasion, group[k], open[other]) || feels(kernel, occasion, open[other], group[k])) {
          group.push_back(open[other]);
          open.erase(open.begin() + static_cast<std::ptrdiff_t>(other));
        } else {
          ++other;
        }
      }
    }
    std::sort(group.begin(), group.end());
    groups.push_back(std::move(group));
  }
  return groups;
}

bool Decider::fail(result::Termination termination, std::string message) {
  transition_.termination = termination;
  transition_.message = std::move(message);
  return false;
}

SurfaceDecision Decider::ask_selection(const switching::CornerTable& table, int surface) {
  std::vector<double> alpha = base_.alpha;
  const auto g = [&](double selection) {
    alpha[at(surface)] = selection;
    return fields_.velocities(alpha, {surface}).front();
  };
  const double last = before_.mode[at(surface)] == 0 ? before_.alpha[at(surface)] : 0.0;
  return switching::decide_selection({table.side(0, 0), table.side(0, 1), table.arrival[0]}, g, last);
}

switching::GroupDecision Decider::ask(const std::vector<int>& group, const switching::CornerTable& table) {
  if (s_.affine_in_alpha || group.size() > 1) return switching::decide_group(table);
  SurfaceDecision decision = ask_selection(table, group.front());
  return {decision.verdict, 0, {decision}};
}

/// Sizes of the normal components in the regions around a point.
void Decider::note_scales(const std::vector<int>& group, const switching::CornerTable& table) {
  for (std::size_t k = 0; k < group.size(); ++k) {
    double& scale = scale_[at(group[k])];
    scale = 0.0;
    for (std::size_t corner = 0; corner < table.corners(); ++corner) {
      scale = std::max(scale, std::abs(table.side(static_cast<int>(k), corner).velocity));
    }
  }
}

/// Nothing slides on a kink, and none is left to both sides: f is one and the same there. Velocities that say so, or
/// nothing, are rounding, as at the edge of a thin layer that a solution drifts through; the kink was seen to be
/// passed.
bool Decider::passes_kink(const std::vector<int>& group, const switching::GroupDecision& decision) {
  const int j = group.front();
  const int arrived = before_.mode[at(j)];
  if (group.size() > 1 || arrived == 0 || occasion_.start) return false;
  if (!s_.system.switching[at(j)].is_kink()) return false;
  const auto& surface = decision.surfaces.front();
  if (decision.verdict == Verdict::decided && surface.mode != 0 && surface.other_modes.empty()) return false;
  decisions_.emplace_back(j,
                          SurfaceDecision{Verdict::decided, -arrived, arrived < 0 ? 1.0 : 0.0, {}, "a kink is passed"});
  standing_.push_back(j);
  return true;
}

bool Decider::decide(const std::vector<int>& group) {
  if (group.size() > 1) {
    for (const int j : group) {
      const auto is_other = [&](int i) { return i != j && same_group(s_.kernel, i, j); };
      if (std::any_of(group.begin(), group.end(), is_other)) return decide_regions(group);
    }
  }
  for (const int j : group) {
    const bool at_exit = contains(occasion_.exit_below, j) || contains(occasion_.exit_above, j);
    // An exit is located where one field is tangent: its selection is at its bound to rounding over the other field,
    // unless that vanishes, too. Ten times less or more makes no difference: it is 1e-9 or of the order of one. Between
    // these it depends on what is left of the other field.
    constexpr double lost = 1e-6;
    constexpr double doubtful = 1e-9;
    const double beyond = at_exit ? std::max(-before_.alpha[at(j)], before_.alpha[at(j)] - 1.0) : 0.0;
    if (!(beyond <= lost) || (beyond > doubtful && fields_.nearly_two_fold(before_.alpha, j))) {
      return fail(result::Termination::outside_class, two_fold_at(s_.system.switching[at(j)].name, occasion_.t));
    }
  }
  if (group.size() > largest_group || (!s_.affine_in_alpha && group.size() > 1)) {
    return fail(result::Termination::outside_class,
                fmt::format("{} surfaces that influence each other meet at t = {}: {}; covered are up to {} with every "
                            "selection entering affinely",
                            group.size(), occasion_.t, names(s_.system, group), largest_group));
  }
  const auto table = fields_.table(base_, group);
  note_scales(group, table);
  note_meeting(group, table);
  const auto tree = ask_tree(group, table);
  if (tree && tree->undecided.empty()) {
    const bool by_scaling = tree->by_scaling && s_.policy == switching::SelectionPolicy::scaled;
    if (by_scaling) return resolve(group, table);
    if (!tree->spirals_out) return accept(group, *tree);
    if (spiral_out(group, switching::plane_table(table), *tree)) return true;
  }
  const auto decision = ask(group, table);
  if (passes_kink(group, decision)) return true;
  const auto culprit = [&] { return s_.system.switching[at(group[at(std::max(decision.culprit, 0))])].name; };
  switch (decision.verdict) {
    case Verdict::decided:
      break;
    case Verdict::stands:
      // Nothing depends on the selection: any side continues the same solution.
      if (!fields_.fields_agree(base_, group)) {
        return fail(result::Termination::outside_class,
                    fmt::format("'{}' does not leave 0 at t = {} under either field, which differ there (boundary "
                                "equilibrium or higher-order contact); start beside the surface or perturb a parameter",
                                culprit(), occasion_.t));
      }
      break;
    case Verdict::two_fold:
      return fail(
          result::Termination::outside_class,
          undetermined_at(fields_, s_.system, base_.alpha, group[at(std::max(decision.culprit, 0))], occasion_.t));
    case Verdict::coupled:
      return decide_coupled(group, table);
  }
  for (std::size_t k = 0; k < group.size(); ++k) {
    SurfaceDecision surface = decision.surfaces[k];
    // One field has turned away from the surface, the other one moves along it: the solution can go on there and leave
    // at any later time.
    const bool turned = contains(occasion_.exit_below, group[k]) || contains(occasion_.exit_above, group[k]);
    if (turned && surface.verdict == Verdict::decided && surface.mode == 0 && group.size() == 1) {
      return fail(result::Termination::outside_class, two_fold_at(s_.system.switching[at(group[k])].name, occasion_.t));
    }
    if (surface.verdict == Verdict::stands) {
      const int kept = before_.mode[at(group[k])] != 0 && !occasion_.start ? before_.mode[at(group[k])] : 1;
      surface = {Verdict::decided, kept, kept > 0 ? 1.0 : 0.0, {}, "psi stays 0 and the fields agree"};
      standing_.push_back(group[k]);
    }
    decisions_.emplace_back(group[k], surface);
  }
  return true;
}

/// Reads the sign of functions nested around a changed surface (or around a stepped input); true if one flipped.
bool Decider::read_nested_anew() {
  auto& state = transition_.state;
  bool flipped = false;
  std::vector<double> values(at(s_.kernel.event_functions()));
  for (int j = 0; j < s_.kernel.switching_functions(); ++j) {
    const auto& inner = s_.kernel.inner(j);
    if (inner.empty() || contains(occasion_.at_zero, j) || state.mode[at(j)] == 0) continue;
    s_.kernel.functions(occasion_.t, occasion_.x, state.alpha.data(), values.data());
    const double psi = values[at(j)];
    if (!(std::abs(psi) > fields_.noise(j)) || (psi > 0.0) == (state.mode[at(j)] > 0)) continue;
    set_surface(state, j, psi > 0.0 ? 1 : -1, psi > 0.0 ? 1.0 : 0.0);
    flipped = true;
  }
  return flipped;
}

Transition Decider::run() {
  base_ = before_;
  const auto groups = groups_of(s_.kernel, occasion_, occasion_.at_zero);
  // Nested functions that flip change the fields for everything else: decide again until nothing flips.
  for (int pass = 0; pass < 8; ++pass) {
    decisions_.clear();
    group_reasons_.clear();
    region_choices_.clear();
    standing_.clear();
    transition_.unique = true;
    transition_.other_choices.clear();
    transition_.beyond_spiral.reset();
    transition_.meeting.reset();
    for (const auto& group : groups) {
      // Sliding that nothing has touched goes on, also where it was forced on a repelling surface.
      const bool touched =
          std::any_of(group.begin(), group.end(), [&](int j) { return contains(occasion_.touched, j); });
      if ((touched || pass > 0 || occasion_.start) && !decide(group)) return transition_;
    }
    for (const auto& [surface, decision] : decisions_) {
      set_surface(transition_.state, surface, decision.mode, decision.alpha);
    }
    apply_regions();
    if (!read_nested_anew()) break;
    base_ = transition_.state;
    for (const int j : occasion_.at_zero) set_surface(base_, j, before_.mode[at(j)], before_.alpha[at(j)]);
  }
  for (const auto& [surface, decision] : decisions_) {
    if (contains(standing_, surface)) continue;
    if (!decision.reason.empty()) {
      append_reason(s_.system, surface, decision, before_, occasion_, transition_.reason);
    }
    for (const int other : decision.other_modes) {
      transition_.unique = false;
      transition_.other_choices.push_back({{surface, other}});
    }
  }
  for (const auto& reason : group_reasons_) transition_.reason += (transition_.reason.empty() ? "" : "; ") + reason;
  if (set_corners() && check()) follow_other_regions();
  return std::move(transition_);
}

Transition Decider::run_forced() {
  if (set_corners()) check();
  return std::move(transition_);
}

/// The mode behind a crossing where function `jumping` gets away from zero: given, only its consequences are looked at.
Transition Decider::run_crossing(int jumping) {
  const std::string& name = s_.system.switching[at(jumping)].name;
  read_nested_anew();
  if (set_corners()) check();
  if (transition_.termination == result::Termination::no_admissible_mode) {
    fail(result::Termination::outside_class,
         fmt::format("'{}' jumps away from 0 at t = {} on a surface inside it, and the field behind does not lead on: "
                     "the continuation needs the hidden dynamics of functions that jump",
                     name, occasion_.t));
  }
  transition_.reason = fmt::format("'{}' jumps away from 0 on a surface inside it, which is crossed", name);
  return transition_;
}

namespace {

/// While it slides on an inner surface a nested function is recorded between its selections in both regions; the mode
/// decides what it is.
ModeState with_exact_selections(ModeState state) {
  for (std::size_t j = 0; j < state.mode.size(); ++j) {
    if (state.mode[j] != 0) state.alpha[j] = state.mode[j] > 0 ? 1.0 : 0.0;
  }
  return state;
}

/// Crosses the touched surfaces inside function j, which is at zero: whether j is not, behind them, but jumps away.
bool jumps_away(const Surroundings& s, const Occasion& occasion, int j, ModeState& state) {
  const auto& inner = s.kernel.inner(j);
  ModeState behind = state;
  bool crosses = false;
  for (const int i : occasion.touched) {
    if (i == j || !contains(inner, i) || state.mode[at(i)] == 0) continue;
    set_surface(behind, i, -state.mode[at(i)], state.mode[at(i)] > 0 ? 0.0 : 1.0);
    crosses = true;
  }
  if (!crosses) return false;
  std::vector<double> values(at(s.kernel.event_functions()));
  s.kernel.functions(occasion.t, occasion.x, behind.alpha.data(), values.data());
  const double psi = values[at(j)];
  const double size = size_of(s.kernel, j, occasion.t, occasion.x, behind.alpha.data(), occasion.time_scale);
  // Four digits above rounding, as for jumps on sliding surfaces: a kink leaves rounding, a jump something of size.
  if (!(std::abs(psi) > 1e5 * rounding_unit * size)) return false;
  set_surface(behind, j, psi > 0.0 ? 1 : -1, psi > 0.0 ? 1.0 : 0.0);
  state = std::move(behind);
  return true;
}

/// The mode where functions jump away from zero on surfaces inside them that are crossed; nullopt if none does.
std::optional<Transition> cross_with_jump(const Surroundings& s, const ModeState& before, const Occasion& occasion) {
  std::optional<ModeState> behind;
  Occasion rest;
  int jumping = -1;
  for (const int j : occasion.at_zero) {
    if (s.kernel.inner(j).empty()) continue;
    ModeState own = before;
    if (!jumps_away(s, occasion, j, own)) continue;
    jumping = j;
    if (!behind) {
      behind = before;
      rest = occasion;
    }
    for (auto* surfaces : {&rest.at_zero, &rest.touched, &rest.exit_below, &rest.exit_above}) std::erase(*surfaces, j);
    for (std::size_t k = 0; k < own.mode.size(); ++k) {
      if (own.mode[k] != before.mode[k]) set_surface(*behind, static_cast<int>(k), own.mode[k], own.alpha[k]);
    }
  }
  if (!behind) return std::nullopt;
  return Decider(s, *behind, rest).run_crossing(jumping);
}

/// Sliding on functions that have a kink on the touched surfaces: goes on, or ends, with their new gradients behind the
/// kinks. nullopt if other surfaces are touched, or if the new motion does not lead away from the kinks.
std::optional<Transition> cross_kinks(const Surroundings& s, const ModeState& before, const Occasion& occasion) {
  if (occasion.start) return std::nullopt;
  ModeState behind = before;
  Occasion rest = occasion;
  rest.touched.clear();
  for (const int i : occasion.touched) {
    if (s.system.switching[at(i)].role != model::SwitchingRole::kink || before.mode[at(i)] == 0) return std::nullopt;
    set_surface(behind, i, -before.mode[at(i)], before.mode[at(i)] > 0 ? 0.0 : 1.0);
    std::erase(rest.at_zero, i);
    for (const int j : before.sliding) {
      if (contains(s.kernel.inner(j), i) && !contains(rest.touched, j)) rest.touched.push_back(j);
    }
  }
  Transition transition = Decider(s, behind, rest).run();
  if (transition.termination != result::Termination::completed) return std::nullopt;
  const ProjectedFields fields(s.kernel, occasion);
  for (const int i : occasion.touched) {
    if (!(fields.velocities(transition.state.alpha, {i}).front() * transition.state.mode[at(i)] > 0.0)) {
      return std::nullopt;
    }
    transition.zero_order[at(i)] = 1;
  }
  return transition;
}

Transition undecided(const Surroundings& s, const ModeState& before, const Occasion& occasion,
                     const std::string& problem) {
  Transition transition;
  transition.state = before;
  transition.termination = result::Termination::outside_class;
  transition.message = fmt::format("at t = {} the surfaces {} meet, whose gradients depend on each other: {}",
                                   occasion.t, names(s.system, occasion.at_zero), problem);
  return transition;
}

/// Whether surfaces that were not all slid on before are at zero here, and their gradients depend on each other.
bool meet_dependent(const Surroundings& s, const ModeState& state, const Occasion& occasion) {
  // Two are dependent only where they touch, and those that were slid on before are not.
  if (occasion.at_zero.size() < 3) return false;
  const auto surfaces = acting_surfaces(s, state, occasion);
  return surfaces.size() > 2 && (occasion.start || surfaces != state.sliding) &&
         ProjectedFields(s.kernel, occasion).gradients_depend(state.alpha, surfaces);
}

}  // namespace

Transition decide_mode(const Surroundings& surroundings, const ModeState& before, const Occasion& occasion) {
  if (before.higher && !occasion.start) return decide_from_higher_order(surroundings, before, occasion);
  const ReferenceScope references(surroundings.kernel, before);
  const ModeState exact = with_exact_selections(before);
  if (auto crossed = cross_with_jump(surroundings, exact, occasion)) return std::move(*crossed);
  if (occasion.limit) {
    // Rounding of the limit decides what the fields do there one by one.
    if (auto held = hold_with_higher_order(surroundings, exact, occasion)) return std::move(*held);
  }
  std::string problem;
  if (meet_dependent(surroundings, exact, occasion)) {
    if (auto decided = decide_dependent(surroundings, exact, occasion, problem)) return std::move(*decided);
    // The corners of more are not enumerated.
    constexpr std::size_t most_enumerated = 10;
    if (!problem.empty() && occasion.at_zero.size() > most_enumerated) {
      return undecided(surroundings, exact, occasion, problem);
    }
  }
  Transition transition = Decider(surroundings, exact, occasion).run();
  if (transition.termination == result::Termination::outside_class) {
    set_references(surroundings.kernel, before);
    // The codimension of a kink and a surface is 2, but the kink itself does not hold the solution.
    if (auto crossed = cross_kinks(surroundings, exact, occasion)) return std::move(*crossed);
  }
  if (transition.termination == result::Termination::outside_class ||
      transition.termination == result::Termination::no_admissible_mode) {
    if (auto held = hold_with_higher_order(surroundings, exact, occasion)) return std::move(*held);
  }
  if (transition.termination == result::Termination::no_admissible_mode) {
    if (auto other = borderline_mode(surroundings, exact, occasion, transition.state)) return std::move(*other);
  }
  if (transition.termination != result::Termination::completed) {
    if (const auto same = same_indicators(surroundings.kernel, exact, occasion)) {
      transition.termination = result::Termination::outside_class;
      transition.message = fmt::format(
          "the regions '{}' and '{}' have the same indicator, and both are active at t = {}: nothing says which of "
          "them "
          "the solution is in; make one region of them",
          surroundings.system.switching[at(same->first)].name, surroundings.system.switching[at(same->second)].name,
          occasion.t);
    }
  }
  if (transition.termination != result::Termination::completed && !problem.empty()) {
    return undecided(surroundings, exact, occasion, problem);
  }
  return transition;
}

Transition check_forced_mode(const Surroundings& surroundings, const ModeState& forced, const Occasion& occasion) {
  const ReferenceScope references(surroundings.kernel, forced);
  std::string problem;
  if (slides_on_dependent(surroundings, forced, occasion)) {
    if (auto held = check_dependent(surroundings, forced, occasion, problem)) return std::move(*held);
  }
  return Decider(surroundings, forced, occasion).run_forced();
}

}  // namespace saltus::event_integrator
