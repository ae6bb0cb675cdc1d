// Surfaces that influence each other: decision trees for two, the hidden dynamics for more and where no tree decides.
#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "saltus/event_integrator/decide/transition_internal.hpp"
#include "saltus/event_integrator/mode/resolution.hpp"
#include "saltus/switching/plane/spiral.hpp"
#include "saltus/switching/table/multi_affine.hpp"

namespace saltus::event_integrator {
namespace {

using switching::Arrival;
using switching::PlaneDecision;
using switching::PlaneMode;
using switching::PlaneTable;
using switching::SelectionPolicy;

/// Normal components of all corner fields of a group.
switching::MultiAffine corner_velocities(const ProjectedFields& fields, const ModeState& state,
                                         const std::vector<int>& group) {
  const int m = static_cast<int>(group.size());
  switching::MultiAffine g(m, m);
  for (std::size_t corner = 0; corner < g.corners(); ++corner) {
    const auto velocities = fields.velocities(fields.corner_alpha(state.alpha, group, corner), group);
    for (int row = 0; row < m; ++row) g.set_value(row, corner, velocities[at(row)]);
  }
  return g;
}

/// g := (ahead - g) / time.
void subtract(const switching::MultiAffine& ahead, double time, switching::MultiAffine& g) {
  for (int row = 0; row < g.rows(); ++row) {
    for (std::size_t corner = 0; corner < g.corners(); ++corner) {
      g.set_value(row, corner, (ahead.value(row, corner) - g.value(row, corner)) / time);
    }
  }
}

/// A kink that rests beside a surface decides nothing: no other solution is known.
std::optional<bool> unique_if_unstable(const model::Layout& layout, const std::vector<int>& group,
                                       std::optional<bool> unique) {
  const bool beside_kink =
      std::any_of(group.begin(), group.end(), [&](int j) { return layout.surfaces[at(j)].is_kink; });
  return beside_kink && unique == true ? std::nullopt : std::optional<bool>(false);
}

/// Which of the modes is the one that was chosen: of two roots of a mode the nearer one, as behind the end of sliding
/// the hidden dynamics has the fields of a little later; one past the last if none is.
std::size_t find_chosen(const switching::HiddenDecision& chosen, const auto& modes) {
  std::size_t found = modes.size();
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < modes.size(); ++i) {
    const auto& mode = modes[i];
    if (!std::equal(mode.mode.begin(), mode.mode.end(), chosen.mode.begin())) continue;
    double distance = 0.0;
    for (std::size_t k = 0; k < mode.alpha.size(); ++k) {
      distance = std::max(distance, std::abs(mode.alpha[k] - chosen.alpha[k]));
    }
    if (!(distance < nearest)) continue;
    nearest = distance;
    found = i;
  }
  return found;
}

double largest(const switching::MultiAffine& g) {
  double result = 0.0;
  for (int row = 0; row < g.rows(); ++row) {
    for (std::size_t corner = 0; corner < g.corners(); ++corner)
      result = std::max(result, std::abs(g.value(row, corner)));
  }
  return result;
}

}  // namespace

/// The tree for a situation of two surfaces; nullopt if there is none for it.
std::optional<PlaneDecision> Decider::ask_tree(const std::vector<int>& group,
                                               const switching::CornerTable& table) const {
  if (switching_point_.start || group.size() != 2 || !s_.affine_in_alpha) return std::nullopt;
  for (const int j : group) {
    const auto role = s_.layout.surfaces[at(j)].role;
    if (role != model::SwitchingRole::listed && role != model::SwitchingRole::region) return std::nullopt;
  }
  const PlaneTable plane = switching::plane_table(table);
  const PlaneMode incoming{before_.mode[at(group[0])], before_.mode[at(group[1])]};
  PlaneMode leaves{};
  for (std::size_t k = 0; k < 2; ++k) {
    if (contains(switching_point_.exit_above, group[k])) leaves[k] = 1;
    if (contains(switching_point_.exit_below, group[k])) leaves[k] = -1;
  }
  const bool exit = leaves != PlaneMode{};
  if (incoming == PlaneMode{0, 0}) {
    if (leaves[0] != 0 && leaves[1] != 0) return switching::decide_exit_corner(plane, leaves);
    if (exit)
      return switching::decide_exit_edge(
          plane, leaves[0] != 0 ? switching::SquareEdge{0, leaves[0]} : switching::SquareEdge{1, leaves[1]});
    if (contains(switching_point_.coalesced, group[0])) return switching::decide_exit_fold(plane);
    if (contains(switching_point_.destabilised, group[0])) return switching::decide_exit_unstable(plane);
    return std::nullopt;
  }
  if (exit) return std::nullopt;
  if (incoming[0] == 0 || incoming[1] == 0) return switching::decide_entering(plane, incoming, s_.policy);
  return switching::decide_corner_arrival(plane, incoming);
}

/// What the picture of a decision about two surfaces shows.
void Decider::note_meeting(const std::vector<int>& group, const switching::CornerTable& table) {
  if (group.size() != 2 || transition_.meeting) return;
  Meeting meeting;
  std::array<double, 2> alpha{};
  for (std::size_t k = 0; k < 2; ++k) {
    meeting.surfaces[k] = group[k];
    alpha[k] = std::clamp(before_.alpha[at(group[k])], 0.0, 1.0);
    for (std::size_t corner = 0; corner < 4; ++corner) {
      meeting.velocities[k][corner] = table.side(static_cast<int>(k), corner).velocity;
    }
  }
  if (!switching_point_.start) meeting.alpha = alpha;
  transition_.meeting = meeting;
}

/// Notes a decision about a group as a whole.
void Decider::take(const std::vector<int>& group, const std::vector<int>& mode, const std::vector<double>& alpha) {
  for (std::size_t k = 0; k < group.size(); ++k) {
    decisions_.emplace_back(group[k],
                            switching::SurfaceDecision{switching::Verdict::decided, mode[k], alpha[k], {}, ""});
  }
}

/// Whether a mode differs from what was taken by sides of kinks at most: f is one and the same on both.
bool Decider::is_same_motion(const std::vector<int>& group, const auto& mode) const {
  const auto taken = decisions_.end() - static_cast<std::ptrdiff_t>(group.size());
  for (std::size_t k = 0; k < group.size(); ++k) {
    if (s_.layout.surfaces[at(group[k])].is_kink) continue;
    const auto& decision = taken[static_cast<std::ptrdiff_t>(k)].second;
    if (mode.mode[k] != decision.mode || std::abs(mode.alpha[k] - decision.alpha) > same_selection) return false;
  }
  return true;
}

/// Another admissible mode of a group, unless it is the same motion.
void Decider::note_other(const std::vector<int>& group, const auto& mode) {
  if (is_same_motion(group, mode)) return;
  transition_.unique = false;
  std::vector<GivenMode> choice;
  for (std::size_t k = 0; k < group.size(); ++k) choice.push_back({group[k], mode.mode[k], mode.alpha[k]});
  transition_.other_choices.push_back(std::move(choice));
}

/// Whether it is sliding on, at the double root that is the last of this sliding. As its time is known to 1e-12 the two
/// roots may be 1e-6 apart.
bool Decider::is_vanishing(const std::vector<int>& group, const auto& mode) const {
  constexpr double near = 1e-5;
  const auto on_its_root = [&](std::size_t k) {
    return mode.mode[k] == 0 && std::abs(mode.alpha[k] - before_.alpha[at(group[k])]) <= near;
  };
  bool vanishes =
      std::any_of(group.begin(), group.end(), [&](int j) { return contains(switching_point_.coalesced, j); });
  for (std::size_t k = 0; k < group.size(); ++k) vanishes = vanishes && on_its_root(k);
  return vanishes;
}

/// All admissible modes but the chosen one, and the sliding that ends here.
void Decider::note_others(const std::vector<int>& group, const switching::HiddenDecision& chosen, const auto& modes) {
  const std::size_t taken = find_chosen(chosen, modes);
  for (std::size_t i = 0; i < modes.size(); ++i) {
    if (i != taken && !is_vanishing(group, modes[i])) note_other(group, modes[i]);
  }
}

bool Decider::accept(const std::vector<int>& group, const PlaneDecision& decision) {
  const auto& chosen = decision.chosen;
  take(group, {chosen.mode[0], chosen.mode[1]}, {chosen.alpha[0], chosen.alpha[1]});
  for (const auto& other : decision.others) note_other(group, other);
  if (decision.ambiguous || decision.spirals_out) transition_.unique = false;
  group_reasons_.push_back(names(s_.layout, group));
  append_leaf(decision.leaf, decision.reason, group_reasons_.back());
  return true;
}

/// One of the spirals that leave the intersection, (6.5) of [guglielmi2022]: the first cycle in closed form.
bool Decider::spiral_out(const std::vector<int>& group, const PlaneTable& table, PlaneDecision decision) {
  const auto cycle = switching::spiral_cycle(table, 0);
  if (!cycle || !(cycle->cycle_ratio > 1.0)) return false;
  // Any size is as good as another; the fields are constant to a millionth of it over this one, and the surface on
  // which the cycle ends is far above its rounding.
  constexpr double small = 1e-6, above_rounding = 1e5;
  double delta = small * switching_point_.time_scale / cycle->duration();
  for (const int j : group) delta = std::max(delta, above_rounding * fields_.noise(j) / (cycle->cycle_ratio - 1.0));
  const std::size_t crossed = (cycle->corners[3] ^ cycle->corners[0]) >> 1U;
  transition_.beyond_spiral = SpiralStart{delta * cycle->duration(),
                                          {switching_point_.x, switching_point_.x + s_.kernel.states()},
                                          group[crossed],
                                          cycle->cycle_ratio};
  std::vector<double> f(at(s_.kernel.states()));
  for (std::size_t k = 0; k < cycle->corners.size(); ++k) {
    s_.kernel.field(switching_point_.t, switching_point_.x,
                    fields_.corner_alpha(base_.alpha, group, cycle->corners[k]).data(), f.data());
    for (std::size_t i = 0; i < f.size(); ++i) transition_.beyond_spiral->x[i] += delta * cycle->durations[k] * f[i];
  }
  const std::size_t first = cycle->corners[0];
  for (std::size_t k = 0; k < 2; ++k) {
    decision.chosen.mode[k] = (first >> k & 1U) != 0 ? 1 : -1;
    decision.chosen.alpha[k] = (first >> k & 1U) != 0 ? 1.0 : 0.0;
  }
  decision.spirals_out = true;
  return accept(group, decision);
}

/// A start on the intersection of two surfaces, or the limit of a spiral there.
bool Decider::accept_start(const std::vector<int>& group, const switching::CornerTable& table) {
  const PlaneTable plane = switching::plane_table(table);
  if (switching_point_.limit) {
    const PlaneDecision limit = switching::decide_spiral_in(plane);
    if (limit.undecided.empty()) return accept(group, limit);
  }
  const PlaneDecision decision = switching::decide_intersection_start(plane);
  if (!decision.undecided.empty()) return false;
  return decision.spirals_out ? spiral_out(group, plane, decision) : accept(group, decision);
}

/// The hidden dynamics of the group, started where the solution comes from.
switching::HiddenDecision Decider::follow_hidden(const std::vector<int>& group, const switching::CornerTable& table) {
  switching::HiddenSituation situation;
  situation.arrival = table.arrival;
  bool leaves = false;
  for (const int j : group) {
    situation.alpha.push_back(std::clamp(before_.alpha[at(j)], 0.0, 1.0));
    for (const auto* surfaces : {&switching_point_.exit_below, &switching_point_.exit_above,
                                 &switching_point_.coalesced, &switching_point_.destabilised}) {
      leaves = leaves || (!switching_point_.start && contains(*surfaces, j));
    }
  }
  switching::HiddenOptions options;
  if (s_.policy == SelectionPolicy::scaled) {
    for (const int j : group) options.scaling.push_back(s_.scaling.empty() ? 1.0 : s_.scaling[at(j)]);
  }
  if (!leaves) return switching::decide_by_hidden_dynamics(table, situation, options);
  // At the event itself the hidden dynamics rests at the root: it needs to know where the fields go.
  ModeField field(s_.kernel, s_.affine_in_alpha);
  field.enter(before_);
  std::vector<double> ahead(at(s_.kernel.states()));
  field(switching_point_.t, switching_point_.x, ahead.data());
  constexpr double soon = 1e-4;
  const double time = soon * switching_point_.time_scale;
  for (std::size_t i = 0; i < ahead.size(); ++i) ahead[i] = switching_point_.x[i] + time * ahead[i];
  SwitchingPoint later = switching_point_;
  later.t += time;
  later.x = ahead.data();
  const auto here = corner_velocities(fields_, base_, group);
  auto rate = here;
  subtract(corner_velocities(ProjectedFields(s_.kernel, later), base_, group), time, rate);
  const double change = largest(rate);
  constexpr double small_change = 1e-5;
  const double eta = change > 0.0 ? small_change * largest(here) / change : time;
  if (!std::isfinite(eta)) return {};
  const int m = static_cast<int>(group.size());
  return switching::decide_leaving(
      m, [&](const double* alpha, double* g) { here.evaluate(alpha, g); },
      [&](const double* alpha, double* g) { rate.evaluate(alpha, g); }, situation, eta, options);
}

bool Decider::resolve(const std::vector<int>& group, const switching::CornerTable& table) {
  const auto hidden = follow_hidden(group, table);
  const bool plane = group.size() == 2 && s_.affine_in_alpha;
  if (hidden.limit == switching::HiddenLimit::spirals_out && plane) {
    PlaneDecision decision;
    decision.leaf = switching::Leaf::spiral_out;
    decision.reason = hidden.reason;
    const PlaneTable fields = switching::plane_table(table);
    decision.others = switching::admissible_modes(fields);
    if (spiral_out(group, fields, decision)) return true;
  }
  const bool decided =
      hidden.limit == switching::HiddenLimit::settled || hidden.limit == switching::HiddenLimit::oscillating;
  if (!decided) {
    if (decide_parts(group, table)) return true;
    return fail(result::Termination::outside_class,
                fmt::format("the surfaces {} meet at t = {} and influence each other: no mode could be found that "
                            "continues the solution ({}); start beside them or perturb a parameter",
                            names(s_.layout, group), switching_point_.t,
                            hidden.reason.empty() ? "the fields are not finite" : hidden.reason));
  }
  take(group, hidden.mode, hidden.alpha);
  if (plane) {
    note_others(group, hidden, switching::admissible_modes(switching::plane_table(table)));
  } else if (s_.affine_in_alpha && group.size() <= at(switching::largest_enumerated)) {
    note_others(group, hidden, switching::admissible_modes(table));
  } else if (transition_.unique == true) {
    transition_.unique = std::nullopt;
  }
  if (hidden.structurally_unstable) transition_.unique = unique_if_unstable(s_.layout, group, transition_.unique);
  for (const auto& mode : hidden.other_modes) {
    std::vector<GivenMode> choice;
    for (std::size_t k = 0; k < group.size(); ++k) choice.push_back({group[k], mode[k], not_a_number});
    if (!plane) transition_.other_choices.push_back(std::move(choice));
  }
  group_reasons_.push_back(fmt::format("{}: {}", names(s_.layout, group), hidden.reason));
  return true;
}

/// Groups one after the other, each with what was decided for those before it; none may depend on a later one.
bool Decider::decide_parts(const std::vector<std::vector<int>>& parts) {
  const ModeState kept = base_;
  bool decided = true;
  for (const auto& part : parts) {
    const std::size_t surfaces = decisions_.size(), choices = region_choices_.size();
    decided = decide(part);
    if (!decided) break;
    for (std::size_t k = surfaces; k < decisions_.size(); ++k) {
      set_surface(base_, decisions_[k].first, decisions_[k].second.mode, decisions_[k].second.alpha);
    }
    for (std::size_t k = choices; k < region_choices_.size(); ++k) {
      set_active(base_, region_choices_[k].group, region_choices_[k].sets.front());
    }
  }
  base_ = kept;
  return decided;
}

/// A group of which some surfaces do not depend on others: the table of all corners knows first derivatives only, while
/// those who depend on nobody decide how the others move.
bool Decider::decide_parts(const std::vector<int>& group, const switching::CornerTable& table) {
  auto parts = switching::parts_by_influence(table);
  if (parts.size() < 2) return false;
  for (auto& part : parts) {
    for (int& surface : part) surface = group[at(surface)];
  }
  return decide_parts(parts);
}

bool Decider::decide_coupled(const std::vector<int>& group, const switching::CornerTable& table) {
  if (switching_point_.start && group.size() == 2 && accept_start(group, table)) return true;
  return resolve(group, table);
}

}  // namespace saltus::event_integrator
