#include "saltus/event_integrator/decide/fast/single_surface.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "saltus/event_integrator/decide/projected_fields.hpp"
#include "saltus/event_integrator/mode/large_system.hpp"
#include "saltus/event_integrator/mode/regions.hpp"
#include "saltus/event_integrator/mode/resolution.hpp"
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

switching::Arrival arrival_from(int mode) {
  if (mode == 0) return switching::Arrival::along;
  return mode < 0 ? switching::Arrival::from_below : switching::Arrival::from_above;
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
  const auto& kernel = switching_context_.kernel;
  const auto slides = [&](int k) { return std::binary_search(before.sliding.begin(), before.sliding.end(), k); };
  const auto interferes = [&](int k) { return k != j && (is_inner_[at(k)] || same_group(kernel, j, k)); };
  if (std::any_of(kernel.neighbours(j).begin(), kernel.neighbours(j).end(), slides)) return false;
  if (!between_.empty() && std::any_of(before.sliding.begin(), before.sliding.end(), interferes)) return false;
  if (is_inner_[at(j)] || switching_context_.layout.surfaces[at(j)].role == model::SwitchingRole::discrete)
    return false;
  const auto exits = switching_point.exit_below.size() + switching_point.exit_above.size();
  if (arrives) return exits == 0;
  // Beyond its bounds a selection may have been lost in a two-fold point, where the full decision looks closer.
  return exits == 1 && is_within_bounds(before.alpha[at(j)]);
}

/// What the gradient row_, with rate_, says of a field; not finite where that is not.
double SingleSurface::along_row(const std::vector<double>& f) const {
  double velocity = rate_;
  for (std::size_t i = 0; i < f.size(); ++i) velocity += row_[i] * f[i];
  return velocity;
}

/// The rounding of psi, whose gradient is in row_ and rate_.
double SingleSurface::noise(const Place& place) const {
  double terms = std::abs(rate_ * place.t);
  for (std::size_t i = 0; i < row_.size(); ++i) terms += std::abs(row_[i] * place.x[i]);
  return rounding_of(terms);
}

/// Whether both velocities move psi by less than its rounding over the time scale: that decides nothing.
bool SingleSurface::moves_no_more_than_rounding(const Velocities& velocities, const Place& place) const {
  const double fastest = std::max(std::abs(velocities.below), std::abs(velocities.above));
  return !(fastest * place.time_scale > noise(place));
}

void SingleSurface::find_gradient(const std::vector<double>& alpha, const Place& place) {
  switching_context_.kernel.gradient(place.surface, place.t, place.x, alpha.data(), row_.data(), &rate_);
}

bool SingleSurface::has_rows(int surface) const {
  const auto& kernel = switching_context_.kernel;
  return between_.empty() && kernel.is_affine(surface) && kernel.inner(surface).empty() &&
         structure_of_large(kernel) != nullptr;
}

/// Whether rows of f are enough: all of it is known, and finite.
bool SingleSurface::by_rows(int surface, const Motion* known) const {
  return known != nullptr && has_rows(surface) && is_finite(known->slope);
}

/// grad psi . f + d psi/dt, not finite where a row that holds this selection is not.
double SingleSurface::velocity_by_rows(const Place& place, const std::vector<double>& alpha) const {
  const auto& kernel = switching_context_.kernel;
  for (const std::size_t row : kernel.field_structure()->rows_of_selection[at(place.surface)]) {
    if (!std::isfinite(kernel.field_row(row, place.t, place.x, alpha.data())))
      return std::numeric_limits<double>::quiet_NaN();
  }
  return kernel.rate(place.surface, place.t, place.x, alpha.data());
}

/// Velocities at the selections of alpha_, behind the gradient. Outside of surfaces the side that the solution comes
/// from is that of its own field.
SingleSurface::Velocities SingleSurface::find_velocities(const ModeState& before, const Place& place,
                                                         const Motion* known) {
  if (by_rows(place.surface, known)) return velocities_by_rows(alpha_, place);
  const auto j = at(place.surface);
  const int from = known != nullptr && before.sliding.empty() && between_.empty() ? before.mode[j] : 0;
  const auto velocity_of = [&](int side) {
    if (from == side) return along_row(known->slope);
    alpha_[j] = side > 0 ? 1.0 : 0.0;
    switching_context_.kernel.field(place.t, place.x, alpha_.data(), f_.data());
    return along_row(f_);
  };
  const double below = velocity_of(-1);
  return {below, velocity_of(+1)};
}

/// Where the field goes that ends the sliding; false where that is not clear. The point is located to rounding on its
/// tangency, so that the second derivative says it: of what ProjectedFields::motion() looks at the first, and clear of
/// what makes it look further.
bool SingleSurface::find_tangent_drift(std::vector<double>& alpha, const Place& place, std::optional<double> bend,
                                       switching::SurfaceSituation& situation) {
  const auto& kernel = switching_context_.kernel;
  // Explicit steps do not leave a root, and the field of one side may go along a nested function.
  if (kernel.has_root(place.surface) || !kernel.inner(place.surface).empty()) return false;
  find_gradient(alpha, place);
  if (moves_no_more_than_rounding({situation.below.velocity, situation.above.velocity}, place)) return false;
  if (!bend) {
    const double own = std::exchange(alpha[at(place.surface)], place.exit > 0 ? 1.0 : 0.0);
    bend = kernel.lie_derivative(place.surface, 2, place.t, place.x, alpha.data());
    alpha[at(place.surface)] = own;
  }
  const double moved = std::abs(*bend) * 0.5 * place.time_scale * place.time_scale;
  if (!(moved > 2.0 * noise(place)) || !std::isfinite(moved)) return false;
  (place.exit < 0 ? situation.below : situation.above) = {0.0, *bend > 0.0 ? Drift::up : Drift::down};
  return true;
}

/// The only state in psi, if sliding on it keeps that constant.
evaluation::FixedState SingleSurface::kept_state(const double* x) const {
  const auto is_there = [](double entry) { return entry != 0.0; };
  const auto first = std::find_if(row_.begin(), row_.end(), is_there);
  if (rate_ != 0.0 || first == row_.end() || std::any_of(first + 1, row_.end(), is_there)) return {};
  const auto component = first - row_.begin();
  return {static_cast<int>(component), x[component]};
}

/// The second derivative of psi along the field that ends the sliding, where L psi is affine and that is clear. Behind
/// the gradient.
std::optional<double> SingleSurface::bend_by_rows(const Place& place) {
  const auto& kernel = switching_context_.kernel;
  alpha_[at(place.surface)] = place.exit > 0 ? 1.0 : 0.0;
  if (!kernel.lie_row(place.surface, kept_state(place.x), alpha_.data(), lie_row_)) return std::nullopt;
  double bend = lie_row_.rate, sizes = std::abs(lie_row_.rate);
  for (std::size_t k = 0; k < lie_row_.column.size(); ++k) {
    if (lie_row_.coefficient[k] == 0.0) continue;
    const double term = lie_row_.coefficient[k] * kernel.field_row(lie_row_.column[k], place.t, place.x, alpha_.data());
    bend += term;
    sizes += std::abs(term);
  }
  constexpr double clear = 1e3 * std::numeric_limits<double>::epsilon();
  return std::abs(bend) > clear * sizes ? std::optional(bend) : std::nullopt;
}

bool SingleSurface::decide(const ModeState& before, const SwitchingPoint& switching_point, Transition& transition,
                           const Motion* known) {
  if (!applies(before, switching_point)) return false;
  const int j = switching_point.touched.front();
  const int mode = before.mode[at(j)];
  const Place place{j,
                    mode != 0                            ? 0
                    : switching_point.exit_above.empty() ? -1
                                                         : 1,
                    switching_point.t, switching_point.x, switching_point.time_scale};
  alpha_ = before.alpha;
  for (const int i : between_) {
    if (before.mode[at(i)] != 0) alpha_[at(i)] = before.mode[at(i)] > 0 ? 1.0 : 0.0;
  }
  find_gradient(alpha_, place);
  const Velocities velocities = find_velocities(before, place, known);
  if (moves_no_more_than_rounding(velocities, place)) return false;
  const auto bend = place.exit != 0 && by_rows(j, known) ? bend_by_rows(place) : std::nullopt;
  const auto decision = decide(alpha_, mode, place, velocities, bend);
  if (!decision) return false;
  fill(before, switching_point, *decision, transition);
  const bool alone = before.sliding.size() == (place.exit != 0 ? 1U : 0U);
  return alone || complete(switching_point, known, transition.state);
}

/// The selections of the other surfaces, which are those before where they have a closed form.
bool SingleSurface::complete(const SwitchingPoint& switching_point, const Motion* known, ModeState& state) {
  const bool same = by_rows(switching_point.touched.front(), known) && known->solve == SlidingSolve::decoupled;
  return same ? are_within_bounds(state) : select_others(switching_point, state);
}

SingleSurface::Velocities SingleSurface::velocities_of(const std::vector<double>& below,
                                                       const std::vector<double>& above, const ModeState& before,
                                                       const Place& place) {
  find_gradient(before.alpha, place);
  return {along_row(below), along_row(above)};
}

SingleSurface::Velocities SingleSurface::velocities_by_rows(std::vector<double>& alpha, const Place& place) const {
  double& selection = alpha[at(place.surface)];
  const double own = std::exchange(selection, 0.0);
  const double below = velocity_by_rows(place, alpha);
  selection = 1.0;
  const double above = velocity_by_rows(place, alpha);
  selection = own;
  return {below, above};
}

std::optional<switching::SurfaceDecision> SingleSurface::decide(std::vector<double>& alpha, int mode,
                                                                const Place& place, const Velocities& velocities,
                                                                std::optional<double> bend) {
  switching::SurfaceSituation situation;
  situation.below.velocity = velocities.below;
  situation.above.velocity = velocities.above;
  if (!find_drifts(situation)) return std::nullopt;
  if (place.exit != 0 && !find_tangent_drift(alpha, place, bend, situation)) return std::nullopt;
  if (situation.below.drift == Drift::stays || situation.above.drift == Drift::stays) return std::nullopt;
  situation.arrival = arrival_from(mode);
  auto decision = switching::decide_surface(situation);
  if (!is_plain(decision, mode) || (place.exit != 0 && decision.mode != place.exit)) return std::nullopt;
  // Nothing slides on a kink: velocities that say so are rounding.
  if (decision.mode == 0 && switching_context_.layout.surfaces[at(place.surface)].is_kink) return std::nullopt;
  return decision;
}

/// The selections of several surfaces, or of others than this one, from the new mode's own field.
bool SingleSurface::select_others(const SwitchingPoint& switching_point, ModeState& state) {
  field_.enter(state);
  field_(switching_point.t, switching_point.x, f_.data());
  if (!is_finite(f_)) return false;
  for (const int k : state.sliding) state.alpha[at(k)] = field_.alpha()[at(k)];
  return are_within_bounds(state);
}

bool SingleSurface::are_within_bounds(const ModeState& state) {
  return std::all_of(state.sliding.begin(), state.sliding.end(),
                     [&](int k) { return state.alpha[at(k)] >= 0.0 && state.alpha[at(k)] <= 1.0; });
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
  append_reason(switching_context_.layout, j, decision, before, switching_point, transition.reason);
}

}  // namespace saltus::event_integrator
