#include "saltus/event_integrator/decide/transition.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "saltus/event_integrator/decide/tied_indicators.hpp"
#include "saltus/event_integrator/decide/transition_internal.hpp"

namespace saltus::event_integrator {

void append_reason(const model::Layout& layout, int surface, const switching::SurfaceDecision& decision,
                   const ModeState& before, const SwitchingPoint& switching_point, std::string& reason) {
  const auto& function = layout.surfaces[at(surface)];
  if (function.role != model::SwitchingRole::listed && function.role != model::SwitchingRole::region) return;
  if (decision.mode == before.mode[at(surface)] && !switching_point.start) return;
  if (!reason.empty()) reason += "; ";
  reason += function.name;
  reason += ": ";
  reason += decision.reason;
}

void append_leaf(switching::Leaf leaf, std::string_view why, std::string& reason) {
  reason += ": ";
  reason += why;
  reason += " (";
  reason += switching::name(leaf);
  reason += ")";
}

void append_meeting(const model::Layout& layout, const std::array<int, 2>& surfaces, switching::Leaf leaf,
                    std::string_view why, std::string& reason) {
  reason += layout.surfaces[at(surfaces[0])].name;
  reason += ", ";
  reason += layout.surfaces[at(surfaces[1])].name;
  append_leaf(leaf, why, reason);
}

void begin_transition(const ModeState& before, const SwitchingPoint& switching_point, std::size_t states,
                      Transition& transition) {
  auto& state = transition.state;
  state.mode = before.mode;
  state.alpha = before.alpha;
  state.sliding = before.sliding;
  state.higher.reset();
  state.resting = before.resting;
  transition.termination = result::Termination::completed;
  transition.message.clear();
  // Both fields are finite here; where they are not behind the projection onto the surface, this point is as good.
  transition.beside.assign(switching_point.x, switching_point.x + states);
  transition.zero_order.assign(state.mode.size(), 0);
  transition.unique = true;
  transition.other_choices.clear();
  transition.beyond_spiral.reset();
  transition.alternatives.clear();
  transition.decision = -1;
  transition.reason.clear();
  transition.meeting.reset();
}

bool Decider::fail(result::Termination termination, std::string message) {
  transition_.termination = termination;
  transition_.message = std::move(message);
  return false;
}

Transition Decider::run() {
  base_ = before_;
  std::vector<int> deciding = switching_point_.at_zero;
  std::erase_if(deciding, [&](int j) { return contains(followers_, j); });
  const auto groups = groups_of(s_.kernel, switching_point_, deciding);
  for (const int j : followers_) {
    if (before_.mode[at(j)] == 0) set_surface(transition_.state, j, 1, 1.0);
  }
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
          std::any_of(group.begin(), group.end(), [&](int j) { return contains(switching_point_.touched, j); });
      if ((touched || pass > 0 || switching_point_.start) && !decide(group)) return transition_;
    }
    for (const auto& [surface, decision] : decisions_) {
      set_surface(transition_.state, surface, decision.mode, decision.alpha);
    }
    apply_regions();
    if (!read_nested_anew()) break;
    base_ = transition_.state;
    for (const int j : switching_point_.at_zero) set_surface(base_, j, before_.mode[at(j)], before_.alpha[at(j)]);
  }
  for (const auto& [surface, decision] : decisions_) {
    if (contains(standing_, surface)) continue;
    if (!decision.reason.empty()) {
      append_reason(s_.layout, surface, decision, before_, switching_point_, transition_.reason);
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

namespace {

/// While it slides on an inner surface a nested function is recorded between its selections in both regions; the mode
/// decides what it is.
ModeState with_exact_selections(ModeState state) {
  for (std::size_t j = 0; j < state.mode.size(); ++j) {
    if (state.mode[j] != 0) state.alpha[j] = state.mode[j] > 0 ? 1.0 : 0.0;
  }
  return state;
}

Transition undecided(const SwitchingContext& s, const ModeState& before, const SwitchingPoint& switching_point,
                     const std::string& problem) {
  Transition transition;
  transition.state = before;
  transition.termination = result::Termination::outside_class;
  transition.message = fmt::format("at t = {} the surfaces {} meet, whose gradients depend on each other: {}",
                                   switching_point.t, names(s.layout, switching_point.at_zero), problem);
  return transition;
}

/// Whether surfaces that were not all slid on before are at zero here, and their gradients depend on each other.
bool dependent_are_met(const SwitchingContext& s, const ModeState& state, const SwitchingPoint& switching_point) {
  // Two are dependent only where they touch, and those that were slid on before are not.
  if (switching_point.at_zero.size() < 3) return false;
  const auto surfaces = acting_surfaces(s, state, switching_point);
  return surfaces.size() > 2 && (switching_point.start || surfaces != state.sliding) &&
         ProjectedFields(s.kernel, switching_point).gradients_depend(state.alpha, surfaces);
}

using Termination = result::Termination;

/// A point at which the mode is decided, and what rules have said of it so far.
struct Question {
  const SwitchingContext& s;
  const ModeState& before;
  ModeState exact;  ///< `before` with exact selections
  const SwitchingPoint& point;
  std::string problem = {};    ///< why surfaces that depend on each other are not decided
  Transition by_corners = {};  ///< by the tables of corners

  [[nodiscard]] bool is_outside_class() const { return by_corners.termination == Termination::outside_class; }
  [[nodiscard]] bool has_no_mode() const { return by_corners.termination == Termination::no_admissible_mode; }
};

using Answer = std::optional<Transition>;

Answer rest_where_they_meet(Question& q) { return rest_where_nested_meet(q.s, q.exact, q.point); }

Answer cross_and_jump(Question& q) { return cross_with_jump(q.s, q.exact, q.point); }

/// Rounding of a limit of switches decides what the fields do there one by one.
Answer hold_at_limit(Question& q) {
  return q.point.limit ? hold_with_higher_order(q.s, q.exact, q.point) : std::nullopt;
}

Answer decide_dependent_surfaces(Question& q) {
  if (!dependent_are_met(q.s, q.exact, q.point)) return std::nullopt;
  if (auto decided = decide_dependent(q.s, q.exact, q.point, q.problem)) return decided;
  // The corners of more are not enumerated.
  constexpr std::size_t most_enumerated = 10;
  if (q.problem.empty() || q.point.at_zero.size() <= most_enumerated) return std::nullopt;
  return undecided(q.s, q.exact, q.point, q.problem);
}

/// Never the answer at once: later rules look at what the tables say.
Answer ask_corners(Question& q) {
  q.by_corners = Decider(q.s, q.exact, q.point).run();
  return std::nullopt;
}

/// The codimension of a kink and a surface is 2, but the kink itself does not hold the solution.
Answer cross_a_kink(Question& q) {
  if (!q.is_outside_class()) return std::nullopt;
  set_references(q.s.kernel, q.before);
  return cross_kinks(q.s, q.exact, q.point);
}

Answer hold_what_meets(Question& q) {
  if (!q.is_outside_class() && !q.has_no_mode()) return std::nullopt;
  return hold_with_higher_order(q.s, q.exact, q.point);
}

Answer leave_what_meets(Question& q) {
  if (!q.is_outside_class() && !q.has_no_mode()) return std::nullopt;
  return leave_where_nested_meet(q.s, q.exact, q.point);
}

Answer take_borderline(Question& q) {
  return q.has_no_mode() ? borderline_mode(q.s, q.exact, q.point, q.by_corners.state) : std::nullopt;
}

/// In the order in which they are asked; the first answer counts. SingleSurface and SurfacePair come before them.
constexpr std::array rules_in_order{rest_where_they_meet,      cross_and_jump,   hold_at_limit,
                                    decide_dependent_surfaces, ask_corners,      cross_a_kink,
                                    hold_what_meets,           leave_what_meets, take_borderline};

/// Two active regions with the same indicator are one. Also where weights that soft minima leave open have been found
/// for them: what keeps their difference at 0, a gradient of roundings, does not last.
void refuse_same_indicators(const Question& q, Transition& transition) {
  const auto same = same_indicators(q.s.kernel, q.exact, q.point);
  if (!same) return;
  const auto is_active = [&](int region) { return transition.state.mode[at(region)] == 0; };
  const bool decided = transition.termination == Termination::completed;
  if (decided && !(is_active(same->first) && is_active(same->second))) return;
  transition.termination = Termination::outside_class;
  transition.message = fmt::format(
      "the regions '{}' and '{}' have the same indicator, and both are active at t = {}: nothing says which "
      "of them the solution is in; make one region of them",
      q.s.layout.surfaces[at(same->first)].name, q.s.layout.surfaces[at(same->second)].name, q.point.t);
}

}  // namespace

Transition decide_mode(const SwitchingContext& switching_context, const ModeState& before,
                       const SwitchingPoint& switching_point) {
  if (before.higher && !switching_point.start)
    return decide_from_higher_order(switching_context, before, switching_point);
  const ReferenceScope references(switching_context.kernel, before);
  Question question{switching_context, before, with_exact_selections(before), switching_point};
  for (const auto rule : rules_in_order) {
    if (auto answer = rule(question)) return std::move(*answer);
  }
  Transition transition = std::move(question.by_corners);
  refuse_same_indicators(question, transition);
  if (transition.termination != Termination::completed && !question.problem.empty()) {
    return undecided(switching_context, question.exact, switching_point, question.problem);
  }
  return transition;
}

Transition check_forced_mode(const SwitchingContext& switching_context, const ModeState& forced,
                             const SwitchingPoint& switching_point) {
  const ReferenceScope references(switching_context.kernel, forced);
  std::string problem;
  if (slides_on_dependent(switching_context, forced, switching_point)) {
    if (auto held = check_dependent(switching_context, forced, switching_point, problem)) return std::move(*held);
  }
  return Decider(switching_context, forced, switching_point).run_forced();
}

}  // namespace saltus::event_integrator
