#include "saltus/event_integrator/decide/fast/single_surface.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "saltus/event_integrator/decide/projected_fields.hpp"
#include "saltus/event_integrator/mode/regions.hpp"
#include "saltus/event_integrator/mode/small_internal.hpp"

namespace saltus::event_integrator {

using switching::Drift;

namespace {

/// Where each side goes by its velocity, if that is clear of zero; false where one is not finite.
bool find_drifts(switching::SurfaceSituation& situation) {
  auto& [below, above, arrival] = situation;
  if (!std::isfinite(below.velocity) || !std::isfinite(above.velocity)) return false;
  const double scale = std::max(std::abs(below.velocity), std::abs(above.velocity));
  for (auto* side : {&below, &above}) {
    if (std::abs(side->velocity) > sign_tolerance * scale) side->drift = side->velocity > 0.0 ? Drift::up : Drift::down;
  }
  return true;
}

bool is_plain(const switching::SurfaceDecision& decision, int mode_before) {
  return decision.verdict == switching::Verdict::decided && decision.other_modes.empty() &&
         decision.mode != mode_before;
}

switching::Arrival arrival_from(int side) {
  return side < 0 ? switching::Arrival::from_below : switching::Arrival::from_above;
}

}  // namespace

SingleSurface::SingleSurface(const SwitchingContext& switching_context)
    : switching_context_(switching_context),
      is_inner_(at(switching_context.kernel.switching_functions()), false),
      f_(at(switching_context.kernel.states())),
      row_(f_.size()),
      field_(switching_context.kernel, switching_context.affine_in_alpha) {
  for (int j = 0; j < switching_context.kernel.switching_functions(); ++j) {
    for (const int inner : switching_context.kernel.inner(j)) is_inner_[at(inner)] = true;
    if (!switching_context.kernel.inner(j).empty()) between_.push_back(j);
  }
  for (const auto& group : switching_context.kernel.region_groups()) {
    for (int j = group.first; j < group.first + group.count; ++j) between_.push_back(j);
  }
}

bool SingleSurface::applies(const ModeState& before, const SwitchingPoint& switching_point) const {
  if (!switching_context_.affine_in_alpha || switching_point.start || before.higher) return false;
  if (switching_point.touched.size() != 1) return false;
  const int j = switching_point.touched.front();
  const bool arrives = before.mode[at(j)] != 0;
  if (switching_point.at_zero.size() != before.sliding.size() + (arrives ? 1 : 0)) return false;
  for (const int k : before.sliding) {
    const auto& kernel = switching_context_.kernel;
    if (k != j && (is_inner_[at(k)] || kernel.depends(j, k) || kernel.depends(k, j) || same_group(kernel, j, k)))
      return false;
  }
  if (is_inner_[at(j)] || switching_context_.system.switching[at(j)].role == model::SwitchingRole::discrete)
    return false;
  const auto exits = switching_point.exit_below.size() + switching_point.exit_above.size();
  if (arrives) return exits == 0;
  return exits == 1 && is_within_bounds(before.alpha[at(j)]);
}

/// Normal component of the field of one side; not finite if the field is not.
double SingleSurface::velocity(const SwitchingPoint& switching_point, int surface, double selection) {
  const auto& kernel = switching_context_.kernel;
  alpha_[at(surface)] = selection;
  kernel.field(switching_point.t, switching_point.x, alpha_.data(), f_.data());
  return velocity(switching_point.t, switching_point.x, surface, alpha_, f_);
}

/// The same with the field that belongs to `alpha`.
double SingleSurface::velocity(double t, const double* x, int surface, const std::vector<double>& alpha,
                               const std::vector<double>& f) {
  if (!is_finite(f)) return std::numeric_limits<double>::quiet_NaN();
  double rate = 0.0;
  switching_context_.kernel.gradient(surface, t, x, alpha.data(), row_.data(), &rate);
  return along_row(f, rate);
}

/// row_ . f + rate, f finite.
double SingleSurface::along_row(const std::vector<double>& f, double rate) const {
  double velocity = rate;
  for (std::size_t i = 0; i < f.size(); ++i) velocity += row_[i] * f[i];
  return velocity;
}

/// Whether both velocities, whose gradient is in row_, move psi by less than its rounding over the time scale: that
/// decides nothing.
bool SingleSurface::moves_no_more_than_rounding(const switching::SurfaceSituation& situation,
                                                const SwitchingPoint& switching_point) const {
  double terms = 0.0;
  for (std::size_t i = 0; i < row_.size(); ++i) terms += std::abs(row_[i] * switching_point.x[i]);
  const double fastest = std::max(std::abs(situation.below.velocity), std::abs(situation.above.velocity));
  return fastest * switching_point.time_scale <= 8.0 * rounding_unit * terms;
}

/// Normal components of both fields at the touched surface. Outside of surfaces the side that the solution comes from
/// is that of its own field.
void SingleSurface::find_velocities(const ModeState& before, const SwitchingPoint& switching_point,
                                    const std::vector<double>* slope, switching::SurfaceSituation& situation) {
  const int j = switching_point.touched.front();
  alpha_ = before.alpha;
  for (const int i : between_) {
    if (before.mode[at(i)] != 0) alpha_[at(i)] = before.mode[at(i)] > 0 ? 1.0 : 0.0;
  }
  const int known = slope != nullptr && before.sliding.empty() && between_.empty() ? before.mode[at(j)] : 0;
  const auto velocity_of = [&](int side, double selection) {
    return known == side ? velocity(switching_point.t, switching_point.x, j, alpha_, *slope)
                         : velocity(switching_point, j, selection);
  };
  situation.below.velocity = velocity_of(-1, 0.0);
  situation.above.velocity = velocity_of(+1, 1.0);
}

/// Where the field goes that ends the sliding. The point is located to rounding on its tangency, so that a later
/// derivative says it.
void SingleSurface::find_tangent_drift(const SwitchingPoint& switching_point, int exit,
                                       switching::SurfaceSituation& situation) {
  const int j = switching_point.touched.front();
  alpha_[at(j)] = exit > 0 ? 1.0 : 0.0;
  auto& tangent = exit > 0 ? situation.above : situation.below;
  const auto& other = exit > 0 ? situation.below : situation.above;
  tangent =
      ProjectedFields(switching_context_.kernel, switching_point).motion(alpha_, j, 0.0, std::abs(other.velocity)).side;
}

bool SingleSurface::decide(const ModeState& before, const SwitchingPoint& switching_point, Transition& transition,
                           const std::vector<double>* slope) {
  if (!applies(before, switching_point)) return false;
  const int j = switching_point.touched.front();
  const bool slides = before.mode[at(j)] == 0;
  if (slides && switching_context_.kernel.has_root(j)) return false;  // explicit steps do not leave it
  switching::SurfaceSituation situation;
  find_velocities(before, switching_point, slope, situation);
  if (!find_drifts(situation) || moves_no_more_than_rounding(situation, switching_point)) return false;
  situation.arrival = slides ? switching::Arrival::along : arrival_from(before.mode[at(j)]);
  const int exit = !slides ? 0 : switching_point.exit_above.empty() ? -1 : 1;  // to the side that ends the sliding
  if (slides) find_tangent_drift(switching_point, exit, situation);
  if (situation.below.drift == Drift::stays || situation.above.drift == Drift::stays) return false;
  const auto decision = switching::decide_surface(situation);
  if (!is_plain(decision, before.mode[at(j)]) || (exit != 0 && decision.mode != exit)) return false;
  // Nothing slides on a kink: velocities that say so are rounding.
  if (decision.mode == 0 && switching_context_.system.switching[at(j)].is_kink()) return false;
  fill(before, switching_point, decision, transition);
  const bool alone = before.sliding.size() == (exit != 0 ? 1U : 0U);
  return alone || select_others(switching_point, transition.state);
}

std::optional<switching::SurfaceDecision> SingleSurface::decide(const ModeState& before, int surface, double t,
                                                                const double* x, const std::vector<double>& below,
                                                                const std::vector<double>& above) {
  switching::SurfaceSituation situation;
  if (!is_finite(below) || !is_finite(above)) return std::nullopt;
  double rate = 0.0;
  switching_context_.kernel.gradient(surface, t, x, before.alpha.data(), row_.data(), &rate);
  situation.below.velocity = along_row(below, rate);
  situation.above.velocity = along_row(above, rate);
  if (!find_drifts(situation)) return std::nullopt;
  if (situation.below.drift == Drift::stays || situation.above.drift == Drift::stays) return std::nullopt;
  situation.arrival = arrival_from(before.mode[at(surface)]);
  auto decision = switching::decide_surface(situation);
  if (!is_plain(decision, before.mode[at(surface)])) return std::nullopt;
  if (decision.mode == 0 && switching_context_.system.switching[at(surface)].is_kink()) return std::nullopt;
  return decision;
}

std::optional<switching::SurfaceDecision> SingleSurface::decide_exit(const ModeState& before, int surface,
                                                                     const Place& place, const Motions& motions,
                                                                     Region side) {
  const auto& kernel = switching_context_.kernel;
  if (kernel.has_root(surface)) return std::nullopt;  // explicit steps do not leave it
  const double* x = place.x;
  switching::SurfaceSituation situation;
  situation.below.velocity = motions.velocities.below;
  situation.above.velocity = motions.velocities.above;
  if (!find_drifts(situation)) return std::nullopt;
  double rate = 0.0;
  kernel.gradient(surface, place.t, x, before.alpha.data(), row_.data(), &rate);
  double terms = std::abs(rate * place.t);
  for (std::size_t i = 0; i < row_.size(); ++i) terms += std::abs(row_[i] * x[i]);
  const double noise = 8.0 * rounding_unit * terms;
  const double fastest = std::max(std::abs(situation.below.velocity), std::abs(situation.above.velocity));
  if (!(fastest * place.time_scale > noise)) return std::nullopt;
  // What ProjectedFields::motion looks at first, and clear of what makes it look further.
  const double bend = motions.bend ? *motions.bend : kernel.lie_derivative(surface, 2, place.t, x, before.alpha.data());
  const double moved = std::abs(bend) * 0.5 * place.time_scale * place.time_scale;
  if (!(moved > 2.0 * noise) || !std::isfinite(moved)) return std::nullopt;
  const bool is_below = side == Region::below;
  (is_below ? situation.below : situation.above) = {0.0, bend > 0.0 ? Drift::up : Drift::down};
  if ((is_below ? situation.above : situation.below).drift == Drift::stays) return std::nullopt;
  situation.arrival = switching::Arrival::along;
  auto decision = switching::decide_surface(situation);
  if (!is_plain(decision, 0) || decision.mode != (is_below ? -1 : 1)) return std::nullopt;
  return decision;
}

/// The selections of several surfaces, or of others than this one, from the new mode's own field.
bool SingleSurface::select_others(const SwitchingPoint& switching_point, ModeState& state) {
  field_.enter(state);
  field_(switching_point.t, switching_point.x, f_.data());
  if (!is_finite(f_)) return false;
  for (const int k : state.sliding) {
    const double selection = field_.alpha()[at(k)];
    if (!(selection >= 0.0 && selection <= 1.0)) return false;
    state.alpha[at(k)] = selection;
  }
  return true;
}

void SingleSurface::fill(const ModeState& before, const SwitchingPoint& switching_point,
                         const switching::SurfaceDecision& decision, Transition& transition) const {
  const int j = switching_point.touched.front();
  begin_transition(before, switching_point, f_.size(), transition);
  auto& state = transition.state;
  state.alpha = alpha_;
  set_surface(state, j, decision.mode, decision.alpha);
  set_corner_alpha(state);
  if (decision.mode != 0) transition.zero_order[at(j)] = before.mode[at(j)] == 0 ? 2 : 1;
  rebase(switching_context_.kernel, state, transition.zero_order);
  complete_weights(switching_context_.kernel, state);
  append_reason(switching_context_.system, j, decision, before, switching_point, transition.reason);
}

}  // namespace saltus::event_integrator
