#include "saltus/event_integrator/families.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "saltus/event_integrator/continuations.hpp"
#include "saltus/event_integrator/projected_fields.hpp"
#include "saltus/event_integrator/small_internal.hpp"

namespace saltus::event_integrator {

using switching::PlaneMode;
using switching::PlaneModes;

namespace {

bool has(const PlaneModes& modes, const PlaneMode& mode) {
  return std::any_of(modes.begin(), modes.end(), [&](const auto& other) { return other.mode == mode; });
}

/// Whether an open family is that of a pair of surfaces, and if so of which mode.
std::optional<PlaneMode> mode_of(const Families::Open& family, const std::array<int, 2>& surfaces) {
  const auto& given = family.given;
  if (given.size() != 2 || given[0].surface != surfaces[0] || given[1].surface != surfaces[1]) return std::nullopt;
  return PlaneMode{given[0].mode, given[1].mode};
}

}  // namespace

Families::Families(const Surroundings& surroundings)
    : s_(surroundings),
      alpha_(at(s_.kernel.switching_functions())),
      f_(at(s_.kernel.states())),
      row_(f_.size()),
      x_(f_.size()) {}

bool Families::is_watched(int surface) const {
  return s_.system.switching[at(surface)].role == model::SwitchingRole::listed;
}

/// Whether no other sliding surface influences this one, or is influenced by it.
bool Families::is_alone(int surface) const {
  return std::none_of(state_.sliding.begin(), state_.sliding.end(), [&](int other) {
    return other != surface && (s_.kernel.depends(surface, other) || s_.kernel.depends(other, surface));
  });
}

void Families::find_pairs() {
  pairs_.clear();
  const auto& sliding = state_.sliding;
  const auto influence = [&](int i, int j) { return s_.kernel.depends(i, j) || s_.kernel.depends(j, i); };
  for (std::size_t a = 0; a < sliding.size(); ++a) {
    for (std::size_t b = a + 1; b < sliding.size(); ++b) {
      const std::array surfaces{sliding[a], sliding[b]};
      if (!influence(surfaces[0], surfaces[1]) || !is_watched(surfaces[0]) || !is_watched(surfaces[1])) continue;
      const bool with_third = std::any_of(sliding.begin(), sliding.end(), [&](int other) {
        return other != surfaces[0] && other != surfaces[1] &&
               (influence(other, surfaces[0]) || influence(other, surfaces[1]));
      });
      if (with_third) continue;
      pairs_.push_back({surfaces, {state_.alpha[at(surfaces[0])], state_.alpha[at(surfaces[1])]}, {}});
    }
  }
}

/// Families whose surfaces are no longer slid on, or no longer in the company that they were.
void Families::close_those_that_ended(double t) {
  std::erase_if(open_, [&](const Open& family) {
    bool goes_on = true;
    for (const auto& given : family.given) goes_on = goes_on && state_.mode[at(given.surface)] == 0;
    if (goes_on && family.given.size() == 1) goes_on = is_alone(family.given.front().surface);
    if (goes_on && family.given.size() == 2) {
      goes_on = std::any_of(pairs_.begin(), pairs_.end(),
                            [&](const Pair& pair) { return mode_of(family, pair.surfaces).has_value(); });
    }
    if (!goes_on) recorded_[family.number].until = t;
    return !goes_on;
  });
}

void Families::enter(const Point& point, const ModeState& state, std::size_t event, std::optional<bool> unique) {
  state_ = state;
  event_ = event;
  if (state.higher || !s_.affine_in_alpha) state_.sliding.clear();
  find_pairs();
  close_those_that_ended(point.t);
  if (unique != true) watch_singles(point);
  look(point, point.t, [](double, double*) {});
}

void Families::close(double t) {
  for (const auto& family : open_) recorded_[family.number].until = t;
  open_.clear();
}

void Families::add_spirals(double t, std::size_t event, const Transition& transition) {
  Recording::Family family;
  family.kind = result::FamilyKind::spiral;
  family.event = event;
  family.from = family.until = t;
  family.mode = transition.state.mode;
  family.alpha = transition.state.alpha;
  family.lap_ratio = transition.beyond_spiral->lap_ratio;
  recorded_.push_back(std::move(family));
}

/// If the run could go on so, from the place where it is.
void Families::add(const Point& point, std::vector<GivenMode> given, double from) {
  Occasion occasion;
  occasion.t = point.t;
  occasion.x = point.x;
  occasion.time_scale = point.time_scale;
  occasion.at_zero = occasion.touched = state_.sliding;
  const auto left = decide_with(s_, state_, occasion, given);
  if (!left) return;
  Recording::Family family;
  family.event = event_;
  family.from = family.until = from;
  family.mode = left->state.mode;
  family.alpha = left->state.alpha;
  open_.push_back({std::move(given), recorded_.size()});
  recorded_.push_back(std::move(family));
}

void Families::watch_singles(const Point& point) {
  Occasion occasion;
  occasion.t = point.t;
  occasion.x = point.x;
  for (const int j : state_.sliding) {
    const bool known = std::any_of(open_.begin(), open_.end(), [&](const Open& family) {
      return family.given.size() == 1 && family.given.front().surface == j;
    });
    if (known || !is_watched(j) || !is_alone(j)) continue;
    const ProjectedFields fields(s_.kernel, occasion);
    const double below = fields.velocities(fields.corner_alpha(state_.alpha, {j}, 0), {j}).front();
    const double above = fields.velocities(fields.corner_alpha(state_.alpha, {j}, 1), {j}).front();
    if (!(below < 0.0 && above > 0.0)) continue;
    for (const int side : {-1, 1}) add(point, {{j, side}}, point.t);
  }
}

/// All modes of two surfaces that influence each other.
PlaneModes Families::modes_at(double t, const double* x, const std::array<int, 2>& surfaces) {
  Velocities velocities{};
  alpha_ = state_.alpha;
  for (std::size_t corner = 0; corner < 4; ++corner) {
    for (std::size_t k = 0; k < 2; ++k) alpha_[at(surfaces[k])] = (corner >> k & 1U) != 0 ? 1.0 : 0.0;
    s_.kernel.field(t, x, alpha_.data(), f_.data());
    for (std::size_t k = 0; k < 2; ++k) {
      double& velocity = velocities[k][corner];
      s_.kernel.gradient(surfaces[k], t, x, state_.alpha.data(), row_.data(), &velocity);
      for (std::size_t i = 0; i < f_.size(); ++i) velocity += row_[i] * f_[i];
      if (!std::isfinite(velocity)) return {};
    }
  }
  return switching::admissible_modes(switching::plane_table(velocities));
}

/// Without the root that is slid on.
PlaneModes Families::others_at(double t, const double* x, Pair& pair) {
  const PlaneModes all = modes_at(t, x, pair.surfaces);
  const switching::PlaneContinuation* own = nullptr;
  double nearest = 0.0;
  for (const auto& mode : all) {
    if (mode.mode != PlaneMode{0, 0}) continue;
    const double distance = std::hypot(mode.alpha[0] - pair.alpha[0], mode.alpha[1] - pair.alpha[1]);
    if (own == nullptr || distance < nearest) {
      own = &mode;
      nearest = distance;
    }
  }
  PlaneModes others;
  for (const auto& mode : all) {
    if (&mode != own) others.push(mode);
  }
  if (own != nullptr) pair.alpha = own->alpha;
  return others;
}

/// The time between two at which a mode is admissible and not, to the last digits.
double Families::change(double t_begin, double t_end, const Pair& pair, const PlaneMode& mode,
                        FunctionRef<void(double t, double* x)> state_at) {
  const auto admissible = [&](double t) {
    Pair probe = pair;
    state_at(t, x_.data());
    return has(others_at(t, x_.data(), probe), mode);
  };
  const bool at_begin = admissible(t_begin);
  for (int halving = 0; halving < 60; ++halving) {
    const double middle = t_begin + 0.5 * (t_end - t_begin);
    if (middle <= t_begin || middle >= t_end) break;
    (admissible(middle) == at_begin ? t_begin : t_end) = middle;
  }
  return t_end;
}

void Families::watch(const Point& point, Pair& pair, double t_begin, FunctionRef<void(double t, double* x)> state_at) {
  const bool in_a_step = t_begin < point.t;
  const Pair before{pair.surfaces, pair.alpha, {}};
  const PlaneModes others = others_at(point.t, point.x, pair);
  std::erase_if(open_, [&](const Open& family) {
    const auto mode = mode_of(family, pair.surfaces);
    if (!mode || has(others, *mode)) return false;
    recorded_[family.number].until = in_a_step ? change(t_begin, point.t, before, *mode, state_at) : point.t;
    return true;
  });
  std::erase_if(pair.refused, [&](const PlaneMode& mode) { return !has(others, mode); });
  for (const auto& other : others) {
    const auto known = std::find_if(open_.begin(), open_.end(),
                                    [&](const Open& family) { return mode_of(family, pair.surfaces) == other.mode; });
    if (known != open_.end()) {
      // Roots move.
      for (std::size_t k = 0; k < 2; ++k) known->given[k].alpha = other.alpha[k];
      continue;
    }
    if (std::find(pair.refused.begin(), pair.refused.end(), other.mode) != pair.refused.end()) continue;
    const std::size_t count = recorded_.size();
    add(point, {{pair.surfaces[0], other.mode[0], other.alpha[0]}, {pair.surfaces[1], other.mode[1], other.alpha[1]}},
        in_a_step ? change(t_begin, point.t, before, other.mode, state_at) : point.t);
    if (recorded_.size() == count) pair.refused.push_back(other.mode);
  }
}

void Families::look(const Point& point, double t_begin, FunctionRef<void(double t, double* x)> state_at) {
  for (auto& pair : pairs_) watch(point, pair, t_begin, state_at);
}

}  // namespace saltus::event_integrator
