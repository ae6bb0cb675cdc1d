#include "saltus/event_integrator/decide/fast/single_surface.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "saltus/event_integrator/decide/projected_fields.hpp"
#include "saltus/event_integrator/mode/large_system.hpp"
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
  const double fastest = std::max(std::abs(situation.below.velocity), std::abs(situation.above.velocity));
  return fastest * switching_point.time_scale <= 8.0 * rounding_unit * terms_of(switching_point);
}

/// The size of the terms of psi, whose gradient is in row_.
double SingleSurface::terms_of(const SwitchingPoint& switching_point) const {
  double terms = 0.0;
  for (std::size_t i = 0; i < row_.size(); ++i) terms += std::abs(row_[i] * switching_point.x[i]);
  return terms;
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
double SingleSurface::velocity_by_rows(int surface, double t, const double* x, const std::vector<double>& alpha) const {
  const auto& kernel = switching_context_.kernel;
  for (const std::size_t row : kernel.field_structure()->rows_of_selection[at(surface)]) {
    if (!std::isfinite(kernel.field_row(row, t, x, alpha.data()))) return std::numeric_limits<double>::quiet_NaN();
  }
  return kernel.rate(surface, t, x, alpha.data());
}

/// Normal components of both fields at the touched surface. Outside of surfaces the side that the solution comes from
/// is that of its own field.
void SingleSurface::find_velocities(const ModeState& before, const SwitchingPoint& switching_point, const Motion* known,
                                    switching::SurfaceSituation& situation) {
  const int j = switching_point.touched.front();
  alpha_ = before.alpha;
  for (const int i : between_) {
    if (before.mode[at(i)] != 0) alpha_[at(i)] = before.mode[at(i)] > 0 ? 1.0 : 0.0;
  }
  if (by_rows(j, known)) {
    const auto& [t, x] = std::tie(switching_point.t, switching_point.x);
    switching_context_.kernel.gradient(j, t, x, alpha_.data(), row_.data(), &rate_);
    alpha_[at(j)] = 0.0;
    situation.below.velocity = velocity_by_rows(j, t, x, alpha_);
    alpha_[at(j)] = 1.0;
    situation.above.velocity = velocity_by_rows(j, t, x, alpha_);
    return;
  }
  const int from = known != nullptr && before.sliding.empty() && between_.empty() ? before.mode[at(j)] : 0;
  const auto velocity_of = [&](int side, double selection) {
    return from == side ? velocity(switching_point.t, switching_point.x, j, alpha_, known->slope)
                        : velocity(switching_point, j, selection);
  };
  situation.below.velocity = velocity_of(-1, 0.0);
  situation.above.velocity = velocity_of(+1, 1.0);
}

/// Where the field goes that ends the sliding. The point is located to rounding on its tangency, so that a later
/// derivative says it.
void SingleSurface::find_tangent_drift(const SwitchingPoint& switching_point, int exit, const Motion* known,
                                       switching::SurfaceSituation& situation) {
  const int j = switching_point.touched.front();
  alpha_[at(j)] = exit > 0 ? 1.0 : 0.0;
  auto& tangent = exit > 0 ? situation.above : situation.below;
  const auto& other = exit > 0 ? situation.below : situation.above;
  if (by_rows(j, known)) {
    if (const auto drift = drift_by_rows(switching_point, j)) {
      tangent = {0.0, *drift};
      return;
    }
  }
  tangent =
      ProjectedFields(switching_context_.kernel, switching_point).motion(alpha_, j, 0.0, std::abs(other.velocity)).side;
}

/// The only state in psi, if sliding on it keeps that constant.
evaluation::FixedState SingleSurface::kept_state(const double* x) const {
  const auto is_there = [](double entry) { return entry != 0.0; };
  const auto first = std::find_if(row_.begin(), row_.end(), is_there);
  if (rate_ != 0.0 || first == row_.end() || std::any_of(first + 1, row_.end(), is_there)) return {};
  const auto component = first - row_.begin();
  return {static_cast<int>(component), x[component]};
}

/// The sign of the second derivative of psi along the field of alpha_, where L psi is affine and that is clear: of what
/// makes ProjectedFields::motion look further.
std::optional<Drift> SingleSurface::drift_by_rows(const SwitchingPoint& switching_point, int surface) {
  const auto& kernel = switching_context_.kernel;
  const auto& [t, x] = std::tie(switching_point.t, switching_point.x);
  if (!kernel.lie_row(surface, kept_state(x), alpha_.data(), lie_row_)) return std::nullopt;
  double bend = lie_row_.rate, sizes = std::abs(lie_row_.rate);
  for (std::size_t k = 0; k < lie_row_.column.size(); ++k) {
    if (lie_row_.coefficient[k] == 0.0) continue;
    const double term = lie_row_.coefficient[k] * kernel.field_row(lie_row_.column[k], t, x, alpha_.data());
    bend += term;
    sizes += std::abs(term);
  }
  constexpr double clear = 1e3 * std::numeric_limits<double>::epsilon();
  const double moved = 0.5 * std::abs(bend) * switching_point.time_scale * switching_point.time_scale;
  const double noise = 8.0 * rounding_unit * terms_of(switching_point);
  if (!(std::abs(bend) > clear * sizes) || !(moved > 2.0 * noise) || !std::isfinite(moved)) return std::nullopt;
  return bend > 0.0 ? Drift::up : Drift::down;
}

bool SingleSurface::decide(const ModeState& before, const SwitchingPoint& switching_point, Transition& transition,
                           const Motion* known) {
  if (!applies(before, switching_point)) return false;
  const int j = switching_point.touched.front();
  const bool slides = before.mode[at(j)] == 0;
  if (slides && switching_context_.kernel.has_root(j)) return false;  // explicit steps do not leave it
  switching::SurfaceSituation situation;
  find_velocities(before, switching_point, known, situation);
  if (!find_drifts(situation) || moves_no_more_than_rounding(situation, switching_point)) return false;
  const int exit = !slides ? 0 : switching_point.exit_above.empty() ? -1 : 1;  // to the side that ends the sliding
  if (slides) find_tangent_drift(switching_point, exit, known, situation);
  const auto decision = conclude(situation, j, before.mode[at(j)], exit);
  if (!decision) return false;
  fill(before, switching_point, *decision, transition);
  const bool alone = before.sliding.size() == (exit != 0 ? 1U : 0U);
  return alone || complete(switching_point, known, transition.state);
}

/// The selections of the other surfaces, which are those before where they have a closed form.
bool SingleSurface::complete(const SwitchingPoint& switching_point, const Motion* known, ModeState& state) {
  const bool same = by_rows(switching_point.touched.front(), known) && known->solve == SlidingSolve::decoupled;
  return same ? are_within_bounds(state) : select_others(switching_point, state);
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
  return conclude(situation, surface, before.mode[at(surface)], 0);
}

std::optional<switching::SurfaceDecision> SingleSurface::decide_by_rows(ModeState& before, int surface, double t,
                                                                        const double* x) {
  switching::SurfaceSituation situation;
  double& alpha = before.alpha[at(surface)];
  const double own = alpha;
  alpha = 0.0;
  situation.below.velocity = velocity_by_rows(surface, t, x, before.alpha);
  alpha = 1.0;
  situation.above.velocity = velocity_by_rows(surface, t, x, before.alpha);
  alpha = own;
  if (!find_drifts(situation)) return std::nullopt;
  return conclude(situation, surface, before.mode[at(surface)], 0);
}

/// What drifts say of a surface; nullopt where that is not clear.
/// @param mode  of the surface before
/// @param exit  the side to which sliding on it ends, 0 where it is met
std::optional<switching::SurfaceDecision> SingleSurface::conclude(switching::SurfaceSituation& situation, int surface,
                                                                  int mode, int exit) const {
  if (situation.below.drift == Drift::stays || situation.above.drift == Drift::stays) return std::nullopt;
  situation.arrival = arrival_from(mode);
  auto decision = switching::decide_surface(situation);
  if (!is_plain(decision, mode) || (exit != 0 && decision.mode != exit)) return std::nullopt;
  // Nothing slides on a kink: velocities that say so are rounding.
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
  return conclude(situation, surface, 0, is_below ? -1 : 1);
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
  append_reason(switching_context_.system, j, decision, before, switching_point, transition.reason);
}

}  // namespace saltus::event_integrator
