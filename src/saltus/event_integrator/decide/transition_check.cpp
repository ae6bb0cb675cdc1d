// The mode behind an event must move to where it says.
#include <array>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "saltus/event_integrator/decide/transition_internal.hpp"
#include "saltus/event_integrator/field/rooted_exit.hpp"
#include "saltus/event_integrator/mode/resolution.hpp"

namespace saltus::event_integrator {

std::string names(const model::Layout& layout, const std::vector<int>& surfaces) {
  std::string text;
  for (const int j : surfaces) text += (text.empty() ? "" : ", ") + layout.surfaces[at(j)].name;
  return text;
}

std::string two_fold_at(const std::string& surface, double t) {
  return fmt::format(
      "both fields are tangent to '{}' at t = {} (two-fold point): the sliding motion is not determined there", surface,
      t);
}

/// Why the motion on a surface is not determined.
std::string undetermined_at(const ProjectedFields& fields, const model::Layout& layout,
                            const std::vector<double>& alpha, int surface, double t) {
  const auto& name = layout.surfaces[at(surface)].name;
  if (!fields.gradient_vanishes(alpha, surface)) return two_fold_at(name, t);
  return fmt::format(
      "the gradient of '{}' vanishes where '{}' is 0, at t = {} (a square or another power?): the motion on that "
      "surface "
      "is not determined; use a function with the same sign and a gradient there, such as the root",
      name, name, t);
}

/// Selections of the regions that meet at the one sliding surface.
bool Decider::set_corners() {
  auto& state = transition_.state;
  rebase(s_.kernel, state, transition_.zero_order);
  set_references(s_.kernel, state);
  if (state.sliding.empty()) {
    complete_weights(s_.kernel, state);
    return true;
  }
  for (std::size_t corner = 0; corner < 2; ++corner) {
    state.corner_alpha[corner] = fields_.corner_alpha(state.alpha, state.sliding, corner);
  }
  complete_weights(s_.kernel, state);
  const auto is_nested = [&](int j) { return !s_.kernel.inner(j).empty(); };
  std::vector<int> nested(state.mode.size());
  std::iota(nested.begin(), nested.end(), 0);
  if (state.sliding.size() == 1 || std::none_of(nested.begin(), nested.end(), is_nested)) return true;
  // Several sliding surfaces: a function nested around one of them must have one sign in all regions.
  for (std::size_t corner = 1; corner < (std::size_t{1} << std::min<std::size_t>(state.sliding.size(), 10)); ++corner) {
    const auto alpha = fields_.corner_alpha(state.alpha, state.sliding, corner);
    for (int j = 0; j < s_.kernel.switching_functions(); ++j) {
      if (!contains(state.sliding, j) && alpha[at(j)] != state.alpha[at(j)]) {
        return fail(result::Termination::outside_class,
                    fmt::format("at t = {} the sign of '{}' depends on the selections of several sliding surfaces ({})",
                                switching_point_.t, s_.layout.surfaces[at(j)].name, names(s_.layout, state.sliding)));
      }
    }
  }
  return true;
}

/// The field of the new mode here, in xdot, and the point beside it.
bool Decider::check_field(ModeField& field, std::vector<double>& xdot) {
  const auto& state = transition_.state;
  field(switching_point_.t, switching_point_.x, xdot.data());
  // Regions whose indicators depend on each other follow those that do not.
  const auto held = field.independent();
  if (held.size() > 1 && fields_.gradients_depend(state.alpha, held)) return fail_where_surfaces_touch(held);
  transition_.beside = fields_.point_beside(state.alpha);
  const auto is_number = [](double value) { return std::isfinite(value); };
  if (!std::all_of(xdot.begin(), xdot.end(), is_number))
    field(switching_point_.t, transition_.beside.data(), xdot.data());
  if (!std::all_of(xdot.begin(), xdot.end(), is_number)) {
    // A field may be undefined on the far side of its own surface; the step loop finds out on its own side.
    for (const int j : state.sliding) {
      if (!fields_.gradient_vanishes(state.alpha, j) && !fields_.nearly_two_fold(state.alpha, j)) continue;
      return fail(result::Termination::outside_class,
                  undetermined_at(fields_, s_.layout, state.alpha, j, switching_point_.t));
    }
    if (!state.sliding.empty()) {
      return fail(result::Termination::evaluation_failed,
                  fmt::format("the sliding field on {} is not finite at t = {}", names(s_.layout, state.sliding),
                              switching_point_.t));
    }
  }
  return true;
}

/// Selections of the new mode are those of its field, inside [0, 1].
bool Decider::take_selections(const ModeField& field) {
  auto& state = transition_.state;
  for (const int j : state.sliding) {
    const double selection = field.alpha()[at(j)];
    if (!is_within_bounds(selection)) {
      const auto& name = s_.layout.surfaces[at(j)].name;
      // Behind an exit located on one field the selection is at its bound, unless the other field vanishes with it.
      const bool at_exit = contains(switching_point_.exit_below, j) || contains(switching_point_.exit_above, j);
      if (at_exit || fields_.nearly_two_fold(state.alpha, j)) {
        return fail(result::Termination::outside_class,
                    undetermined_at(fields_, s_.layout, state.alpha, j, switching_point_.t));
      }
      return fail(
          result::Termination::no_admissible_mode,
          fmt::format("sliding on '{}' at t = {} would need the selection {}", name, switching_point_.t, selection));
    }
    state.alpha[at(j)] = std::clamp(selection, 0.0, 1.0);
  }
  // Functions nested around a sliding surface are between their own selections in the regions beside it.
  for (int j = 0; j < s_.kernel.switching_functions(); ++j) {
    const auto& inner = s_.kernel.inner(j);
    if (std::any_of(inner.begin(), inner.end(), [&](int i) { return contains(state.sliding, i); })) {
      state.alpha[at(j)] = std::clamp(field.alpha()[at(j)], 0.0, 1.0);
    }
  }
  complete_weights(s_.kernel, state);
  return true;
}

/// Where the new field moves psi_j from zero.
Motion Decider::motion_from(int j, ModeField& field, const std::vector<double>& xdot) {
  const auto& state = transition_.state;
  const bool leaves = fields_.is_exit(j, state.mode[at(j)]) && keeps_selections();
  const double velocity = fields_.velocities(state.alpha, {j}).front();
  // The fields of all regions that meet: those on both sides of this surface may be tangent to it together.
  const double scale =
      std::max({scale_[at(j)], std::abs(fields_.velocities(fields_.corner_alpha(state.alpha, {j}, 0), {j}).front()),
                std::abs(fields_.velocities(fields_.corner_alpha(state.alpha, {j}, 1), {j}).front())});
  Motion motion = leaves ? fields_.motion_seen(state.alpha, j, state.mode[at(j)], velocity, scale)
                         : fields_.motion(state.alpha, j, velocity, scale);
  const bool follows_selections =
      std::any_of(state.sliding.begin(), state.sliding.end(), [&](int i) { return s_.kernel.depends(j, i); });
  if (follows_selections && (leaves || std::abs(velocity) <= sign_tolerance * scale)) {
    // A tangency along sliding whose selections change: no derivative with selections held speaks for it.
    const double ahead = velocity_ahead(field, xdot, j);
    motion = {};
    if (std::abs(ahead) > velocity_rounding * scale) {
      motion = {{ahead, ahead > 0.0 ? switching::Drift::up : switching::Drift::down}, 2};
    }
  }
  return motion;
}

/// A kink at zero is on the side to which the others take it; on either one while they keep it there.
void Decider::follow(int kink, const Motion& motion) {
  auto& state = transition_.state;
  const int side = static_cast<int>(motion.side.drift);
  transition_.zero_order[at(kink)] = side == 0 ? 2 : std::min(motion.order, 2);
  if (side == 0) return;
  set_surface(state, kink, side, side > 0 ? 1.0 : 0.0);
  if (state.sliding.empty()) return;
  for (auto& corner : state.corner_alpha) corner[at(kink)] = state.alpha[at(kink)];
}

/// A function at zero moves to the side that the new mode says.
bool Decider::check_side(int j, ModeField& field, const std::vector<double>& xdot) {
  const int mode = transition_.state.mode[at(j)];
  if (mode == 0) return true;
  if (contains(standing_, j)) {
    transition_.zero_order[at(j)] = 2;
    return true;
  }
  const Motion motion = motion_from(j, field, xdot);
  if (contains(followers_, j)) {
    follow(j, motion);
    return true;
  }
  const bool is_kink = s_.layout.surfaces[at(j)].role == model::SwitchingRole::kink;
  if (is_kink && motion.side.drift == switching::Drift::stays) {
    // A state at rest there: both sides are the same.
    transition_.zero_order[at(j)] = 2;
    return true;
  }
  // Along a root psi goes where its regular derivatives say, if these say anything, but like another power of t.
  const bool stays = motion.side.drift == switching::Drift::stays;
  const bool tangent_root = s_.kernel.has_root(j) && motion.order != 1 && static_cast<int>(motion.side.drift) == mode;
  if ((stays || tangent_root) && leaves_by_root(j)) {
    transition_.zero_order[at(j)] = 2;
    return true;
  }
  if (static_cast<int>(motion.side.drift) != mode) return fail_at_tangency(j, mode, motion);
  transition_.zero_order[at(j)] = std::min(motion.order, 2);
  return true;
}

/// The new mode must move to where it says: signs along its own field, selections inside [0, 1].
bool Decider::check() {
  if (transition_.beyond_spiral) {  // no field leads away from the intersection by itself
    transition_.beside = transition_.beyond_spiral->x;
    return true;
  }
  ModeField field(s_.kernel, s_.affine_in_alpha);
  field.enter(transition_.state);
  std::vector<double> xdot(at(s_.kernel.states()));
  if (!check_field(field, xdot) || !take_selections(field)) return false;
  // Regions are measured against the reference of the new mode: the one before may be at zero, too.
  std::vector<int> at_zero = switching_point_.at_zero;
  for (const int j : switching_point_.tied) {
    if (!contains(at_zero, j)) at_zero.push_back(j);
  }
  return std::all_of(at_zero.begin(), at_zero.end(), [&](int j) { return check_side(j, field, xdot); });
}

bool Decider::fail_where_surfaces_touch(const std::vector<int>& surfaces) {
  return fail(
      result::Termination::outside_class,
      fmt::format("the surfaces {} touch at t = {}: their gradients depend on each other there, so that sliding "
                  "on all of them does not determine the selections; state surfaces that coincide by one "
                  "switching function",
                  names(s_.layout, surfaces), switching_point_.t));
}

/// Whether the new field has an infinite derivative on a surface, which it leaves all the same: no derivative says so.
bool Decider::leaves_by_root(int j) {
  if (transition_.rooted >= 0 || s_.layout.surfaces[at(j)].role != model::SwitchingRole::listed) return false;
  const std::vector<double> x(switching_point_.x, switching_point_.x + s_.kernel.states());
  RootedExit exit(s_.kernel, s_.affine_in_alpha, transition_.state, j);
  if (!exit.has_root(switching_point_.t, x) ||
      !exit.leads_away(switching_point_.t, x, look_ahead(switching_point_.time_scale)))
    return false;
  transition_.rooted = j;
  return true;
}

/// The field of the new mode does not move psi_j to where the mode says: why not.
bool Decider::fail_at_tangency(int j, int mode, const Motion& motion) {
  const auto& state = transition_.state;
  const auto& function = s_.layout.surfaces[at(j)];
  const auto& name = function.name;
  if (motion.side.drift == switching::Drift::stays && function.role == model::SwitchingRole::region &&
      state.sliding.size() > 1) {
    return fail(
        result::Termination::outside_class,
        fmt::format("at t = {} more regions meet than their indicators tell apart, for an instant or with too many "
                    "sides: that of '{}' follows from those of the others, and their weights are not determined; "
                    "state these regions by conditions (when) of switching functions, or perturb a parameter",
                    switching_point_.t, name));
  }
  if (motion.side.drift == switching::Drift::stays) {
    return fail(result::Termination::outside_class,
                fmt::format("behind t = {} the field of the new mode does not leave '{}', to any order (boundary "
                            "equilibrium or higher-order contact); start beside the surface or perturb a parameter",
                            switching_point_.t, name));
  }
  std::array<switching::Side, 2> sides;
  for (const std::size_t corner : {std::size_t{0}, std::size_t{1}}) {
    const auto alpha = fields_.corner_alpha(state.alpha, {j}, corner);
    sides[corner] = fields_.motion(alpha, j, fields_.velocities(alpha, {j}).front(), scale_[at(j)]).side;
  }
  const bool tangent =
      std::max(std::abs(sides[0].velocity), std::abs(sides[1].velocity)) <= sign_tolerance * scale_[at(j)];
  if (tangent && sides[0].drift == switching::Drift::up && sides[1].drift == switching::Drift::down) {
    return fail(result::Termination::outside_class,
                fmt::format("from t = {} on the fields on both sides of '{}' are tangent to it and turn towards it: "
                            "sliding on which the derivative of '{}' is 0 for every selection (of second order)",
                            switching_point_.t, name, name));
  }
  if (tangent) return fail(result::Termination::outside_class, two_fold_at(name, switching_point_.t));
  if (fields_.gradients_depend(state.alpha, switching_point_.at_zero))
    return fail_where_surfaces_touch(switching_point_.at_zero);
  return fail(result::Termination::no_admissible_mode,
              fmt::format("behind t = {} the solution should move to {} of '{}', but its field does not",
                          switching_point_.t, mode > 0 ? "the positive side" : "the negative side", name));
}

/// Whether the new field is the sliding one of before at this point: selections were lost at their bounds only. Then
/// the surfaces that are left through a bound are tangent to it. Coupled surfaces may be left with any selection.
bool Decider::keeps_selections() const {
  for (std::size_t j = 0; j < before_.mode.size(); ++j) {
    if (before_.mode[j] != 0 || transition_.state.mode[j] == 0) continue;
    const int surface = static_cast<int>(j);
    if (!contains(switching_point_.exit_below, surface) && !contains(switching_point_.exit_above, surface))
      return false;
  }
  return true;
}

/// Normal component of the mode's own field on a surface, a little later along it.
double Decider::velocity_ahead(ModeField& field, const std::vector<double>& xdot, int surface) {
  const double time = look_ahead(switching_point_.time_scale);
  std::vector<double> x(switching_point_.x, switching_point_.x + xdot.size());
  std::vector<double> later(xdot.size()), row(xdot.size());
  for (std::size_t i = 0; i < x.size(); ++i) x[i] += time * xdot[i];
  field(switching_point_.t + time, x.data(), later.data());
  for (std::size_t i = 0; i < x.size(); ++i) x[i] = switching_point_.x[i] + 0.5 * time * (xdot[i] + later[i]);
  field(switching_point_.t + time, x.data(), later.data());
  double velocity = 0.0;
  s_.kernel.gradient(surface, switching_point_.t + time, x.data(), field.alpha().data(), row.data(), &velocity);
  for (std::size_t i = 0; i < x.size(); ++i) velocity += row[i] == 0.0 ? 0.0 : row[i] * later[i];
  return velocity;
}

std::optional<std::string> lost_selections(const SwitchingContext& switching_context, const ModeState& state, double t,
                                           const double* x) {
  if (state.sliding.size() < 2 || state.higher) return std::nullopt;
  ModeField field(switching_context.kernel, switching_context.affine_in_alpha);
  field.enter(state);
  // Selections are known to 1e-16 over this.
  constexpr double parallel = 1e-8;
  if (!(field.root_distance(t, x) < parallel)) return std::nullopt;
  return fmt::format(
      "the selections of sliding on {} have no limit at t = {:.17g}: det G, of the derivatives of the velocities of "
      "these functions with respect to them, vanishes there (the fields that hold the solution are parallel, or two "
      "roots meet), so that they do not determine what follows; end the simulation before, or perturb a parameter",
      names(switching_context.layout, state.sliding), t);
}

std::optional<std::string> two_fold_message(const SwitchingContext& switching_context, const ModeState& state, double t,
                                            const double* x) {
  if (auto lost = lost_selections(switching_context, state, t, x)) return lost;
  SwitchingPoint switching_point;
  switching_point.t = t;
  switching_point.x = x;
  switching_point.at_zero = state.sliding;
  const ProjectedFields fields(switching_context.kernel, switching_point);
  for (const int j : state.sliding) {
    if (fields.nearly_two_fold(state.alpha, j) || fields.gradient_vanishes(state.alpha, j)) {
      return undetermined_at(fields, switching_context.layout, state.alpha, j, t);
    }
  }
  return std::nullopt;
}

}  // namespace saltus::event_integrator
