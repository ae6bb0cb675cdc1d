#include "saltus/event_integrator/decide/fast/surface_pair.hpp"

#include <algorithm>
#include <cmath>

#include "saltus/event_integrator/decide/projected_fields.hpp"
#include "saltus/event_integrator/mode/small_internal.hpp"
#include "saltus/switching/plane/plane_table.hpp"

namespace saltus::event_integrator {
namespace {

using switching::PlaneDecision;
using switching::PlaneMode;

double product(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

}  // namespace

SurfacePair::SurfacePair(const SwitchingContext& switching_context)
    : switching_context_(switching_context),
      f_(at(switching_context.kernel.states())),
      rows_{f_, f_},
      corners_(switching_context.kernel),
      field_(switching_context.kernel, switching_context.affine_in_alpha) {
  const auto& kernel = switching_context.kernel;
  any_ = switching_context.affine_in_alpha && kernel.switching_functions() > 1 && kernel.region_groups().empty();
  for (int j = 0; j < kernel.switching_functions(); ++j) any_ = any_ && kernel.inner(j).empty();
}

bool SurfacePair::applies(const ModeState& before, const SwitchingPoint& switching_point) const {
  if (!any_ || switching_point.start || before.higher || switching_point.at_zero.size() != 2 ||
      before.sliding.size() > 1) {
    return false;
  }
  for (const auto* surfaces : {&switching_point.exit_below, &switching_point.exit_above, &switching_point.coalesced,
                               &switching_point.destabilised}) {
    if (!surfaces->empty()) return false;
  }
  // A kink of the surface that is slid on touches that one, too.
  if (switching_point.touched.size() != 2 - before.sliding.size()) return false;
  const int i = switching_point.at_zero[0];
  const int j = switching_point.at_zero[1];
  for (const int surface : {i, j}) {
    if (switching_context_.layout.surfaces[at(surface)].role != model::SwitchingRole::listed) return false;
  }
  return switching_context_.kernel.depends(i, j) || switching_context_.kernel.depends(j, i);
}

bool SurfacePair::find_normals(const SwitchingPoint& switching_point) {
  const auto& kernel = switching_context_.kernel;
  const std::array<int, 2> pair{switching_point.at_zero[0], switching_point.at_zero[1]};
  if (pair == constant_rows_) return true;
  constant_rows_ = {-1, -1};
  for (std::size_t k = 0; k < 2; ++k) {
    kernel.gradient(switching_point.at_zero[k], switching_point.t, switching_point.x, alpha_.data(), rows_[k].data(),
                    &rates_[k]);
    if (!is_finite(rows_[k]) || !(product(rows_[k], rows_[k]) > 0.0)) return false;
    columns_[k].clear();
    for (std::size_t i = 0; i < rows_[k].size(); ++i) {
      if (rows_[k][i] != 0.0) columns_[k].push_back(i);
    }
  }
  if (kernel.is_affine(pair[0]) && kernel.is_affine(pair[1])) constant_rows_ = pair;  // nothing is nested around them
  return true;
}

/// Normal components of a field; false if it is not finite.
bool SurfacePair::project(const std::vector<double>& f, std::array<double, 2>& velocities) const {
  if (!is_finite(f)) return false;
  for (std::size_t k = 0; k < 2; ++k) {
    velocities[k] = rates_[k];
    for (const std::size_t i : columns_[k]) velocities[k] += rows_[k][i] * f[i];
  }
  return true;
}

/// Whether all of the four fields are clear of both surfaces.
bool SurfacePair::find_table(const SwitchingPoint& switching_point, const KnownFields& known) {
  scales_ = {0.0, 0.0};
  const auto& kernel = switching_context_.kernel;
  const bool same_constants = kernel.has_fixed_constants();
  const std::size_t pair = at(switching_point.at_zero[0]) * alpha_.size() + at(switching_point.at_zero[1]);
  for (std::size_t corner = 0; corner < 4; ++corner) {
    for (std::size_t k = 0; k < 2; ++k) alpha_[at(switching_point.at_zero[k])] = (corner >> k & 1U) != 0 ? 1.0 : 0.0;
    if (known[corner] == nullptr) {
      if (same_constants) {
        kernel.prepared_field(switching_point.t, switching_point.x, corners_.of(alpha_, 4 * pair + corner), f_.data());
      } else {
        kernel.field(switching_point.t, switching_point.x, alpha_.data(), f_.data());
      }
    }
    std::array<double, 2> velocities{};
    if (!project(known[corner] != nullptr ? *known[corner] : f_, velocities)) return false;
    for (std::size_t k = 0; k < 2; ++k) {
      velocities_[k][corner] = velocities[k];
      scales_[k] = std::max(scales_[k], std::abs(velocities[k]));
    }
  }
  for (std::size_t k = 0; k < 2; ++k) {
    const auto is_clear = [&](double velocity) { return std::abs(velocity) > sign_tolerance * scales_[k]; };
    if (!std::all_of(velocities_[k].begin(), velocities_[k].end(), is_clear)) return false;
  }
  return true;
}

/// Whether the field of the new mode leaves the surfaces to where the mode says, clearly.
bool SurfacePair::moves_there(const SwitchingPoint& switching_point, ModeState& state) {
  const int i = switching_point.at_zero[0];
  const int j = switching_point.at_zero[1];
  if (state.mode[at(i)] == 0 && state.mode[at(j)] == 0) return slides_on_both(switching_point, state);
  alpha_[at(i)] = state.alpha[at(i)];
  alpha_[at(j)] = state.alpha[at(j)];
  for (const int surface : state.sliding) {
    if (!(alpha_[at(surface)] >= 0.0 && alpha_[at(surface)] <= 1.0)) return false;
  }
  switching_context_.kernel.field(switching_point.t, switching_point.x, alpha_.data(), f_.data());
  std::array<double, 2> velocities{};
  if (!project(f_, velocities)) return false;
  for (std::size_t k = 0; k < 2; ++k) {
    const int mode = state.mode[at(switching_point.at_zero[k])];
    if (mode != 0 && !(mode * velocities[k] > sign_tolerance * scales_[k])) return false;
  }
  return true;
}

/// Takes the selections from the field of the mode.
bool SurfacePair::slides_on_both(const SwitchingPoint& switching_point, ModeState& state) {
  const double mixed = product(rows_[0], rows_[1]);
  const double squares = product(rows_[0], rows_[0]) * product(rows_[1], rows_[1]);
  // Gradients that nearly depend on each other: another reason to stop may be the right one.
  constexpr double nearly = 1e-6;
  if (!(squares - mixed * mixed > nearly * squares)) return false;
  field_.enter(state);
  field_(switching_point.t, switching_point.x, f_.data());
  if (!is_finite(f_)) return false;
  for (const int surface : state.sliding) {
    const double selection = field_.alpha()[at(surface)];
    if (!(selection >= 0.0 && selection <= 1.0)) return false;
    state.alpha[at(surface)] = selection;
  }
  return true;
}

bool SurfacePair::look(const ModeState& before, const SwitchingPoint& switching_point, const ModeField* field) {
  if (!applies(before, switching_point)) return false;
  alpha_ = before.alpha;
  KnownFields known{};
  if (field != nullptr && before.sliding.size() == 1) {
    const auto& pair = switching_point.at_zero;
    const std::size_t slid = before.mode[at(pair[0])] == 0 ? 0 : 1;
    const std::size_t here = before.mode[at(pair[1 - slid])] > 0 ? std::size_t{1} << (1 - slid) : 0;
    known[here] = &field->field_of(Region::below);
    known[here | std::size_t{1} << slid] = &field->field_of(Region::above);
  }
  return find_normals(switching_point) && find_table(switching_point, known);
}

std::optional<SlidAcross> SurfacePair::across(const ModeState& before, const SwitchingPoint& switching_point) const {
  if (before.sliding.size() != 1) return std::nullopt;
  const auto& pair = switching_point.at_zero;
  const auto behind =
      switching::pass_across(switching::plane_table(velocities_), {before.mode[at(pair[0])], before.mode[at(pair[1])]});
  // All four fields are clear of both surfaces, so is what lies between them.
  if (!behind) return std::nullopt;
  const int slid = before.sliding.front();
  return SlidAcross{slid, before.alpha[at(slid)], behind->alpha[slid == pair[0] ? 0 : 1], switching::Leaf::E3,
                    meeting(before, switching_point)};
}

bool SurfacePair::decide(const ModeState& before, const SwitchingPoint& switching_point, Transition& transition) {
  return look(before, switching_point, nullptr) && conclude(before, switching_point, transition);
}

bool SurfacePair::conclude(const ModeState& before, const SwitchingPoint& switching_point, Transition& transition) {
  const auto& pair = switching_point.at_zero;
  const auto table = switching::plane_table(velocities_);
  const PlaneMode incoming{before.mode[at(pair[0])], before.mode[at(pair[1])]};
  const PlaneDecision decision = before.sliding.empty()
                                     ? switching::decide_corner_arrival(table, incoming)
                                     : switching::decide_entering(table, incoming, switching_context_.policy);
  if (!decision.undecided.empty() || decision.ambiguous || !decision.unique()) return false;
  begin_transition(before, switching_point, at(switching_context_.kernel.states()), transition);
  auto& state = transition.state;
  for (std::size_t k = 0; k < 2; ++k) {
    set_surface(state, pair[k], decision.chosen.mode[k], decision.chosen.alpha[k]);
    if (decision.chosen.mode[k] != 0) transition.zero_order[at(pair[k])] = 1;
  }
  set_corner_alpha(state);
  if (!moves_there(switching_point, state)) return false;
  transition.meeting = meeting(before, switching_point);
  append_meeting(switching_context_.layout, transition.meeting->surfaces, decision.leaf, decision.reason,
                 transition.reason);
  return true;
}

Meeting SurfacePair::meeting(const ModeState& before, const SwitchingPoint& switching_point) const {
  Meeting meeting;
  auto& alpha = meeting.alpha.emplace();
  for (std::size_t k = 0; k < 2; ++k) {
    meeting.surfaces[k] = switching_point.at_zero[k];
    alpha[k] = std::clamp(before.alpha[at(switching_point.at_zero[k])], 0.0, 1.0);
  }
  meeting.velocities = velocities_;
  return meeting;
}

}  // namespace saltus::event_integrator
