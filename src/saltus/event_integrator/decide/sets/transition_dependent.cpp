// Surfaces at zero whose gradients depend on each other: which of them are slid on, and which are left, as the solution
// of a complementarity problem.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "saltus/event_integrator/decide/transition_internal.hpp"
#include "saltus/event_integrator/field/higher_order.hpp"
#include "saltus/event_integrator/mode/resolution.hpp"
#include "saltus/switching/selections/selection_complementarity.hpp"
#include "saltus/switching/table/additive_map.hpp"

namespace saltus::event_integrator {
namespace {

/// y = w + W lambda for the surfaces at zero; nullopt where selections multiply each other, or velocities are not
/// finite.
std::optional<switching::AdditiveMap> additive_velocities(const SwitchingContext& s, const ModeState& state,
                                                          const SwitchingPoint& switching_point) {
  const auto& meeting = switching_point.at_zero;
  const ProjectedFields fields(s.kernel, switching_point);
  std::vector<double> alpha = state.alpha;
  const auto velocities = [&](const std::vector<double>& selections, linalg::Vector& value) {
    for (std::size_t i = 0; i < meeting.size(); ++i) alpha[at(meeting[i])] = selections[i];
    const auto values = fields.velocities(alpha, meeting);
    value = linalg::ConstView(values.data(), static_cast<linalg::Index>(values.size()));
  };
  auto map = switching::additive_map(meeting.size(), velocities);
  if (!map || !map->effects.all_finite() || !map->constant.all_finite()) return std::nullopt;
  return map;
}

/// Where all of them are slid on and some are about to be left, selections are at their bounds: what they would be
/// beyond these a little later along what is held decides.
std::optional<switching::AdditiveMap> velocities_that_decide(const SwitchingContext& s, const ModeState& before,
                                                             const ModeState& state, const SwitchingPoint& met) {
  if (!before.higher || met.at_zero != before.sliding) return additive_velocities(s, state, met);
  HigherOrderField field(s.kernel);
  field.enter(*before.higher, before.sliding, before.alpha);
  field.evaluate(met.t, met.x);
  const double h = look_ahead(met.time_scale);
  std::vector<double> x(met.x, met.x + s.kernel.states());
  for (std::size_t i = 0; i < x.size(); ++i) x[i] += h * field.motion()[i];
  SwitchingPoint later = met;
  later.t += h;
  static_cast<void>(field.project(later.t, x.data()));
  later.x = x.data();
  return additive_velocities(s, state, later);
}

/// Whether selections in [0, 1] are determined on all sliding surfaces, as usual.
bool slides_as_usual(const SwitchingContext& s, const ModeState& state, const SwitchingPoint& switching_point,
                     const std::vector<double>& x, std::vector<double>& alpha) {
  ModeField field(s.kernel, s.affine_in_alpha);
  field.enter(state);
  std::vector<double> xdot(x.size());
  field(switching_point.t, x.data(), xdot.data());
  alpha = field.alpha();
  // As in the check of other modes.
  constexpr double room = 1e-9;
  return is_finite(xdot) && std::all_of(state.sliding.begin(), state.sliding.end(),
                                        [&](int j) { return alpha[at(j)] >= -room && alpha[at(j)] <= 1.0 + room; });
}

/// Sets the sides of functions at zero that are not in `meeting` to where the motion of `moving` leaves them; each with
/// the order of its zero.
std::vector<std::pair<int, int>> set_followers(const SwitchingContext& s, const SwitchingPoint& switching_point,
                                               const std::vector<int>& meeting, const ModeState& moving,
                                               ModeState& state) {
  std::vector<std::pair<int, int>> followers;
  ModeField field(s.kernel, s.affine_in_alpha);
  field.enter(moving);
  std::vector<double> xdot(at(s.kernel.states())), row(xdot.size());
  field(switching_point.t, switching_point.x, xdot.data());
  for (const int j : switching_point.at_zero) {
    if (contains(meeting, j)) continue;
    double velocity = 0.0;
    s.kernel.gradient(j, switching_point.t, switching_point.x, moving.alpha.data(), row.data(), &velocity);
    double terms = std::abs(velocity);
    for (std::size_t i = 0; i < row.size(); ++i) {
      if (row[i] == 0.0) continue;
      velocity += row[i] * xdot[i];
      terms += std::abs(row[i] * xdot[i]);
    }
    const bool moves = std::abs(velocity) > 1e-9 * terms;
    if (moves) set_surface(state, j, velocity > 0.0 ? 1 : -1, velocity > 0.0 ? 1.0 : 0.0);
    followers.emplace_back(j, moves ? 1 : 2);
  }
  return followers;
}

}  // namespace

std::optional<Transition> hold_dependent(const SwitchingContext& s, ModeState state,
                                         const SwitchingPoint& switching_point, std::vector<double>& x,
                                         std::string& problem) {
  if (auto held = hold(s, state, switching_point, x, problem)) return held;
  if (ProjectedFields(s.kernel, switching_point).gradients_depend(state.alpha, state.sliding)) return std::nullopt;
  set_corner_alpha(state);
  std::vector<double> alpha;
  if (!slides_as_usual(s, state, switching_point, x, alpha)) return std::nullopt;
  for (const int j : state.sliding) state.alpha[at(j)] = std::clamp(alpha[at(j)], 0.0, 1.0);
  return transition_to(std::move(state));
}

bool slides_on_dependent(const SwitchingContext& s, const ModeState& state, const SwitchingPoint& switching_point) {
  return state.sliding.size() > 1 &&
         ProjectedFields(s.kernel, switching_point).gradients_depend(state.alpha, state.sliding);
}

std::optional<Transition> check_dependent(const SwitchingContext& s, ModeState state,
                                          const SwitchingPoint& switching_point, std::string& problem) {
  std::vector<int> leaving;
  for (const int j : switching_point.at_zero) {
    if (state.mode[at(j)] != 0) leaving.push_back(j);
  }
  std::vector<double> x(switching_point.x, switching_point.x + s.kernel.states());
  problem = "the fields do not lead on";
  std::optional<Transition> next;
  if (state.sliding.empty()) {
    next = transition_to(std::move(state));
  } else {
    next = hold_dependent(s, std::move(state), switching_point, x, problem);
  }
  if (!next || !leads_into_its_region(s, next->state, switching_point, x, leaving)) return std::nullopt;
  for (const int j : leaving) next->zero_order[at(j)] = 1;
  return next;
}

std::vector<int> acting_surfaces(const SwitchingContext& s, const ModeState& state,
                                 const SwitchingPoint& switching_point) {
  std::vector<int> acting;
  std::vector<double> alpha = state.alpha, below(at(s.kernel.states())), above(below.size());
  for (const int j : switching_point.at_zero) {
    if (s.layout.surfaces[at(j)].role == model::SwitchingRole::kink) continue;
    double& own = alpha[at(j)];
    const double before = std::exchange(own, 0.0);
    s.kernel.field(switching_point.t, switching_point.x, alpha.data(), below.data());
    own = 1.0;
    s.kernel.field(switching_point.t, switching_point.x, alpha.data(), above.data());
    own = before;
    if (below != above) acting.push_back(j);
  }
  return acting;
}

std::optional<Transition> decide_dependent(const SwitchingContext& s, const ModeState& before,
                                           const SwitchingPoint& switching_point, std::string& problem) {
  SwitchingPoint met = switching_point;
  met.at_zero = acting_surfaces(s, before, switching_point);
  const auto& meeting = met.at_zero;
  problem.clear();
  if (!are_plain_surfaces(s, meeting)) return std::nullopt;
  problem = "their selections multiply each other";
  ModeState state = before;
  state.higher.reset();
  // Functions that move nothing have a side, which follows from the motion.
  for (const int j : switching_point.at_zero) {
    if (state.mode[at(j)] == 0 && !contains(meeting, j)) set_surface(state, j, 1, 1.0);
  }
  const auto velocities = velocities_that_decide(s, before, state, met);
  if (!velocities) return std::nullopt;
  const auto solution = switching::solve_complementarity(velocities->effects, velocities->constant, 1e-9);
  for (std::size_t i = 0; i < meeting.size(); ++i) {
    const int mode = solution.mode[i];
    set_surface(state, meeting[i], mode, mode == 0 ? 0.5 : mode > 0 ? 1.0 : 0.0);
  }
  auto next = check_dependent(s, state, met, problem);
  if (!next) return std::nullopt;
  const auto followers = set_followers(s, switching_point, meeting, next->state, state);
  if (!followers.empty()) {
    next = check_dependent(s, std::move(state), met, problem);
    if (!next) return std::nullopt;
    for (const auto& [follower, order] : followers) next->zero_order[at(follower)] = order;
  }
  for (const int j : meeting) {
    if (next->zero_order[at(j)] != 0 && contains(before.sliding, j)) next->zero_order[at(j)] = 2;
  }
  if (next->reason.empty()) {
    next->reason = fmt::format("{}: their gradients depend on each other; slides on {}", names(s.layout, meeting),
                               next->state.sliding.empty() ? "none" : names(s.layout, next->state.sliding));
  }
  // Else there may be others: not decided.
  next->unique = solution.unique_velocity ? std::optional<bool>(true) : std::nullopt;
  return next;
}

}  // namespace saltus::event_integrator
