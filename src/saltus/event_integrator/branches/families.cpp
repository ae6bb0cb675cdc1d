#include "saltus/event_integrator/branches/families.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "saltus/base/components.hpp"
#include "saltus/base/contains.hpp"
#include "saltus/event_integrator/decide/continuations.hpp"
#include "saltus/event_integrator/decide/projected_fields.hpp"
#include "saltus/event_integrator/mode/resolution.hpp"
#include "saltus/event_integrator/mode/small_internal.hpp"
#include "saltus/switching/plane/admissible_modes.hpp"

namespace saltus::event_integrator {

using switching::Drift;
using switching::GroupMode;

namespace {

/// All modes of four surfaces take longer than a step.
constexpr std::size_t most_watched = 3;

bool has(const std::vector<GroupMode>& modes, const std::vector<int>& mode) {
  return std::any_of(modes.begin(), modes.end(), [&](const auto& other) { return other.mode == mode; });
}

/// Whether an open family is that of a group of surfaces, and if so of which mode.
std::optional<std::vector<int>> mode_of(const Families::Open& family, const std::vector<int>& surfaces) {
  const auto is_it = [](const GivenMode& given, int surface) { return given.surface == surface; };
  if (!std::equal(family.given.begin(), family.given.end(), surfaces.begin(), surfaces.end(), is_it))
    return std::nullopt;
  std::vector<int> mode;
  for (const auto& given : family.given) mode.push_back(given.mode);
  return mode;
}

double distance(const std::vector<double>& a, const std::vector<double>& b) {
  double square = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) square += (a[k] - b[k]) * (a[k] - b[k]);
  return std::sqrt(square);
}

}  // namespace

Families::Families(const SwitchingContext& switching_context)
    : s_(switching_context),
      alpha_(at(s_.kernel.switching_functions())),
      f_(at(s_.kernel.states())),
      row_(f_.size()),
      x_(f_.size()) {}

bool Families::is_watched(int surface) const {
  return s_.layout.surfaces[at(surface)].role == model::SwitchingRole::listed;
}

/// Whether no other sliding surface influences this one, or is influenced by it.
bool Families::is_alone(int surface) const {
  return std::none_of(state_.sliding.begin(), state_.sliding.end(), [&](int other) {
    return other != surface && (s_.kernel.depends(surface, other) || s_.kernel.depends(other, surface));
  });
}

/// Connected groups of two and more.
void Families::find_groups() {
  groups_.clear();
  const auto joins = [&](int a, int b) { return s_.kernel.depends(a, b) || s_.kernel.depends(b, a); };
  for (auto& surfaces : components_of(state_.sliding, joins)) {
    const bool is_small = surfaces.size() > 1 && surfaces.size() <= most_watched;
    if (!is_small || !std::all_of(surfaces.begin(), surfaces.end(), [&](int j) { return is_watched(j); })) continue;
    std::vector<double> alpha;
    for (const int j : surfaces) alpha.push_back(state_.alpha[at(j)]);
    groups_.push_back({std::move(surfaces), std::move(alpha), {}});
  }
}

bool Families::is_on(const ModeState& state) const {
  // Roots that are compared are those of one point: they differ by their rounding, or by much more.
  const auto has_root = [&](const Group& group) {
    std::vector<double> alpha;
    for (const int j : group.surfaces) alpha.push_back(state.alpha[at(j)]);
    return distance(alpha, group.alpha) <= same_selection;
  };
  return state.mode == state_.mode && std::all_of(groups_.begin(), groups_.end(), has_root);
}

/// Families whose surfaces are no longer slid on, or no longer in the company that they were; behind a change of the
/// root, those that led to the other one.
void Families::close_those_that_ended(double t, Root root) {
  std::erase_if(open_, [&](const Open& family) {
    bool goes_on = true;
    for (const auto& given : family.given) goes_on = goes_on && state_.mode[at(given.surface)] == 0;
    if (root == Root::other) {
      const auto slides = [](const GivenMode& given) { return given.mode == 0; };
      goes_on = goes_on && !std::all_of(family.given.begin(), family.given.end(), slides);
    }
    if (goes_on && family.given.size() == 1) goes_on = is_alone(family.given.front().surface);
    if (goes_on && family.given.size() > 1) {
      goes_on = std::any_of(groups_.begin(), groups_.end(),
                            [&](const Group& group) { return mode_of(family, group.surfaces).has_value(); });
    }
    if (!goes_on) recorded_[family.number].until = t;
    return !goes_on;
  });
}

void Families::enter(const Point& point, const ModeState& state, std::size_t event, std::optional<bool> unique) {
  const Root root = state.mode == state_.mode ? Root::other : Root::any;
  state_ = state;
  event_ = event;
  if (state.higher || !s_.affine_in_alpha) state_.sliding.clear();
  find_groups();
  close_those_that_ended(point.t, root);
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
  family.lap_ratio = transition.beyond_spiral->cycle_ratio;
  recorded_.push_back(std::move(family));
}

/// If the run could go on so, from the place where it is.
void Families::add(const Point& point, std::vector<GivenMode> given, double from) {
  SwitchingPoint switching_point;
  switching_point.t = point.t;
  switching_point.x = point.x;
  switching_point.time_scale = point.time_scale;
  switching_point.at_zero = switching_point.touched = state_.sliding;
  const auto left = decide_with(s_, state_, switching_point, given);
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
  SwitchingPoint switching_point;
  switching_point.t = point.t;
  switching_point.x = point.x;
  for (const int j : state_.sliding) {
    const bool known = std::any_of(open_.begin(), open_.end(), [&](const Open& family) {
      return family.given.size() == 1 && family.given.front().surface == j;
    });
    if (known || !is_watched(j) || !is_alone(j)) continue;
    const ProjectedFields fields(s_.kernel, switching_point);
    const double below = fields.velocities(fields.corner_alpha(state_.alpha, {j}, 0), {j}).front();
    const double above = fields.velocities(fields.corner_alpha(state_.alpha, {j}, 1), {j}).front();
    if (!(below < 0.0 && above > 0.0)) continue;
    for (const int side : {-1, 1}) add(point, {{j, side}}, point.t);
  }
}

/// All modes of surfaces that influence each other.
Families::Modes Families::modes_at(double t, const double* x, const std::vector<int>& surfaces) {
  const std::size_t m = surfaces.size(), corners = std::size_t{1} << m;
  table_.surfaces = static_cast<int>(m);
  table_.arrival.assign(m, switching::Arrival::along);
  table_.sides.resize(m * corners);
  alpha_ = state_.alpha;
  for (std::size_t corner = 0; corner < corners; ++corner) {
    for (std::size_t k = 0; k < m; ++k) alpha_[at(surfaces[k])] = (corner >> k & 1U) != 0 ? 1.0 : 0.0;
    s_.kernel.field(t, x, alpha_.data(), f_.data());
    for (std::size_t k = 0; k < m; ++k) {
      double velocity = 0.0;
      s_.kernel.gradient(surfaces[k], t, x, state_.alpha.data(), row_.data(), &velocity);
      for (std::size_t i = 0; i < f_.size(); ++i) velocity += row_[i] * f_[i];
      if (!std::isfinite(velocity)) return {};
      table_.sides[k * corners + corner] = {velocity, velocity > 0.0   ? Drift::up
                                                      : velocity < 0.0 ? Drift::down
                                                                       : Drift::stays};
    }
  }
  if (m > 2) return switching::admissible_modes(table_);
  Modes modes;
  for (const auto& mode : switching::admissible_modes(switching::plane_table(table_))) {
    modes.push_back({{mode.mode.begin(), mode.mode.end()}, {mode.alpha.begin(), mode.alpha.end()}});
  }
  return modes;
}

/// Without the root that is slid on.
Families::Modes Families::others_at(double t, const double* x, Group& group) {
  Modes modes = modes_at(t, x, group.surfaces);
  const std::vector<int> sliding(group.surfaces.size(), 0);
  auto own = modes.end();
  for (auto mode = modes.begin(); mode != modes.end(); ++mode) {
    if (mode->mode != sliding) continue;
    if (own == modes.end() || distance(mode->alpha, group.alpha) < distance(own->alpha, group.alpha)) own = mode;
  }
  if (own == modes.end()) return modes;
  group.alpha = own->alpha;
  modes.erase(own);
  return modes;
}

/// The time between two at which a mode is admissible and not, to the last digits.
double Families::change(double t_begin, double t_end, const Group& group, const std::vector<int>& mode,
                        FunctionRef<void(double t, double* x)> state_at) {
  const auto admissible = [&](double t) {
    Group probe = group;
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

void Families::watch(const Point& point, Group& group, double t_begin,
                     FunctionRef<void(double t, double* x)> state_at) {
  const bool in_a_step = t_begin < point.t;
  const Group before{group.surfaces, group.alpha, {}};
  const Modes others = others_at(point.t, point.x, group);
  std::erase_if(open_, [&](const Open& family) {
    const auto mode = mode_of(family, group.surfaces);
    if (!mode || has(others, *mode)) return false;
    recorded_[family.number].until = in_a_step ? change(t_begin, point.t, before, *mode, state_at) : point.t;
    return true;
  });
  std::erase_if(group.refused, [&](const std::vector<int>& mode) { return !has(others, mode); });
  for (const auto& other : others) {
    const auto known = std::find_if(open_.begin(), open_.end(),
                                    [&](const Open& family) { return mode_of(family, group.surfaces) == other.mode; });
    if (known != open_.end()) {
      // Roots move.
      for (std::size_t k = 0; k < group.surfaces.size(); ++k) known->given[k].alpha = other.alpha[k];
      continue;
    }
    if (contains(group.refused, other.mode)) continue;
    const std::size_t count = recorded_.size();
    std::vector<GivenMode> given;
    for (std::size_t k = 0; k < group.surfaces.size(); ++k) {
      given.push_back({group.surfaces[k], other.mode[k], other.alpha[k]});
    }
    add(point, std::move(given), in_a_step ? change(t_begin, point.t, before, other.mode, state_at) : point.t);
    if (recorded_.size() == count) group.refused.push_back(other.mode);
  }
}

void Families::look(const Point& point, double t_begin, FunctionRef<void(double t, double* x)> state_at) {
  for (auto& group : groups_) watch(point, group, t_begin, state_at);
}

}  // namespace saltus::event_integrator
