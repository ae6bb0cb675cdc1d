// Where steps start: the functions of a mode, their signs, and zeros that are known there.
#include <algorithm>
#include <cmath>
#include <utility>

#include "saltus/event_integrator/mode/at_surface.hpp"
#include "saltus/event_integrator/mode/mode_differences_internal.hpp"
#include "saltus/event_integrator/mode/region_ties.hpp"
#include "saltus/event_integrator/mode/small_internal.hpp"
#include "saltus/event_integrator/search/event_search_internal.hpp"

namespace saltus::event_integrator {
namespace {

/// Of the lower field of a sliding surface. On a repelling one (a forced mode) both fields leave and the signs are the
/// other way round.
int arriving_sign(const ExitValues& exit) { return exit.below >= exit.above ? +1 : -1; }

}  // namespace

/// A step that led from one event to the next was not settled: the zeros at its start are history.
void EventSearch::start_at(double t) {
  if (user_.zeros_at && *user_.zeros_at != t) {
    for (const std::size_t i : special_) mode_.functions[i].zero_order = 0;
    user_.forget_zeros();
  }
  user_.zeros_at = t;
}

/// Behind a crossing while sliding: the forms of the exits, whose fields are others now. Returns false where the mode
/// has to be entered afresh.
bool EventSearch::turn_exits(const double* x) {
  for (std::size_t row = 0; row < mode_.state.sliding.size(); ++row) {
    for (const auto& [i, side] :
         {std::pair{mode_.exit_function(row), Region::below}, {mode_.exit_function(row) + 1, Region::above}}) {
      const auto* form = field_.exit_row(row, side, x);
      if ((form != nullptr) != mode_.forms.has(i) || (form != nullptr && !mode_.forms.replace(i, *form))) return false;
    }
  }
  return true;
}

void EventSearch::cross(std::size_t surface, const ModeState& state, double t, const double* x) {
  start_at(t);
  mode_.forget_zeros(special_);
  mode_.turn(surface, state, 1);
  const std::size_t i = mode_.of_surface[surface];
  inspected_.assign(1, i);
  read_values(t, x, inspected_);
  mode_.functions[i].offset = point_[i];
  special_ = inspected_;
}

/// Returns whether the mode has the same functions as the one that was entered last, if surfaces were crossed only.
/// Their signs and what exits hold may differ.
bool EventSearch::may_flip(const ModeState& state) const {
  return mode_.flips && state.sliding == mode_.state.sliding && !state.higher && held_.nothing();
}

/// A crossing, of surfaces that nothing else of the mode depends on but the exits of what is slid on: only signs
/// change, and these; user functions are read anew. Returns false if the mode is another one than that: it is entered
/// afresh. Cost: O(1) for each surface crossed, but for the comparison of the modes.
bool EventSearch::flip(const ModeState& state, const std::vector<int>& zero_order, double t, const double* x) {
  if (!may_flip(state)) return false;
  inspected_.clear();
  bool crosses = true;
  for_each_difference(mode_.state.mode, state.mode, [&](std::size_t j) {
    crosses = crosses && state.mode[j] != 0 && mode_.state.mode[j] != 0;
    inspected_.push_back(j);
  });
  if (!crosses) return false;
  if (!mode_.state.sliding.empty()) field_.exits(t, x, mode_.exits.data());
  if (!turn_exits(x)) return false;
  for_each_nonzero(zero_order, [&](std::size_t j) {
    if (state.mode[j] == mode_.state.mode[j]) inspected_.push_back(j);
  });
  mode_.forget_zeros(special_);
  for (std::size_t& entry : inspected_) {
    const std::size_t j = entry;
    entry = mode_.of_surface[j];
    mode_.turn(j, state, zero_order[j]);
  }
  begin_flipped(state, t, x);
  return true;
}

bool EventSearch::pass(std::size_t surface, const ModeState& state, double t, const double* x) {
  start_at(t);
  if (!may_flip(state)) return false;
  mode_.exits.assign(1, field_.sides());
  if (!turn_exits(x)) return false;
  mode_.forget_zeros(special_);
  mode_.turn(surface, state, 1);
  inspected_.assign(1, mode_.of_surface[surface]);
  begin_flipped(state, t, x);
  return true;
}

/// What is left to do when the surfaces of `inspected_` have been turned: exits have other fields, and user functions
/// are read anew.
void EventSearch::begin_flipped(const ModeState& state, double t, const double* x) {
  for (std::size_t row = 0; row < state.sliding.size(); ++row) {
    const int arriving = arriving_sign(mode_.exits[row]);
    const auto j = at(state.sliding[row]);
    mode_.state.alpha[j] = state.alpha[j];
    for (const auto& [i, sign] :
         {std::pair{mode_.exit_function(row), arriving}, {mode_.exit_function(row) + 1, -arriving}}) {
      mode_.forms.ignore(i);
      mode_.functions[i].sign = sign;
      mode_.functions[i].zero_order = 0;
      mode_.functions[i].offset = 0.0;
      inspected_.push_back(i);
    }
  }
  for (std::size_t i = mode_.users; i < mode_.users_end; ++i) {
    mode_.forms.ignore(i);
    mode_.functions[i].zero_order = 0;
    mode_.functions[i].offset = 0.0;
    inspected_.push_back(i);
  }
  read_start(t, x);
  special_.clear();
  for (const std::size_t i : inspected_) sort(i);
}

/// Values of the functions that are looked at where a mode starts, and what follows for those at zero.
void EventSearch::read_start(double t, const double* x) {
  FunctionParts parts = mode_.parts_of(inspected_);
  // Exits have just been evaluated here; again they would be the same but for selections that are iterated.
  if (field_.solve() == SlidingSolve::decoupled) parts.exits = false;
  rescale(t, x, inspected_, parts);
  evaluate_parts(t, x, parts);
  for (const std::size_t i : inspected_) point_[i] = value(i, x);
  read_user_signs(t, x);
  for (const std::size_t i : inspected_) {
    auto& function = mode_.functions[i];
    const bool is_exit = function.kind == FunctionKind::exit_below || function.kind == FunctionKind::exit_above ||
                         function.kind == FunctionKind::instability || function.kind == FunctionKind::release;
    const bool is_cell = function.kind == FunctionKind::cell_upper || function.kind == FunctionKind::cell_lower;
    // A selection that starts at its bound (tangential entry) leaves its exit function a zero there.
    if ((is_exit || is_cell) && std::abs(point_[i]) <= levels_.noise[i]) function.zero_order = 1;
    // The event was located to the last bits of the time, which are not the last bits of psi: what is left there is the
    // zero of this start.
    if (function.zero_order > 0) function.offset = point_[i];
    if (any_nesting_ && is_exit && function.kind != FunctionKind::release) limit_by_tangency(i, t, x);
  }
}

/// The exit to a field that goes along the surface is 0 throughout the mode. Only its rounding is left of it, and the
/// errors of the dense output, which is not on the surface. It counts from where it is more than these.
void EventSearch::limit_by_tangency(std::size_t i, double t, const double* x) {
  auto& function = mode_.functions[i];
  const bool is_below = function.kind == FunctionKind::exit_below;
  if (!nesting_[at(function.index)] || field_.solve() != SlidingSolve::decoupled) return;
  if (!is_below && function.kind != FunctionKind::exit_above) return;
  const auto& exit = mode_.exits[at(function.row)];
  const double scale = std::abs(exit.below) + std::abs(exit.above);
  std::vector<double> alpha =
      mode_.state.sliding.size() == 1 ? mode_.state.corner_alpha[is_below ? 0 : 1] : mode_.state.alpha;
  alpha[at(function.index)] = is_below ? 0.0 : 1.0;
  if (!moves_along(kernel_, alpha, function.index, t, x, scale)) return;
  constexpr double errors = 1e4;  // of steps, which are smaller than those of dense outputs
  const double margin = std::clamp(errors * errors_.of_run().rtol, 1e-7, 1e-2) * scale;
  function.zero_order = 0;
  function.offset = -function.sign * margin;
}

/// Values of some functions into point_.
void EventSearch::read_values(double t, const double* x, const std::vector<std::size_t>& which) {
  if (which.size() == 1 && mode_.is_threshold(which.front())) {
    point_[which.front()] = mode_.forms.threshold_value(which.front(), x) - mode_.functions[which.front()].offset;
    return;
  }
  evaluate_parts(t, x, mode_.parts_of(which));
  for (const std::size_t i : which) point_[i] = value(i, x);
}

/// Surfaces outside the mode, but those that keep their values beside what is held.
void EventSearch::enter_surfaces(const ModeState& state, const std::vector<int>& zero_order) {
  const auto constant =
      kernel_.region_groups().empty() ? std::vector<bool>() : constant_beside_held(kernel_, state, rows_);
  for (int j = 0; j < kernel_.switching_functions(); ++j) {
    if (!constant.empty() && constant[at(j)]) continue;
    if (state.mode[at(j)] == 0 || (nesting_[at(j)] && !sliding_inside(kernel_, state, j).empty())) continue;
    mode_.of_surface[at(j)] = mode_.functions.size();
    mode_.functions.push_back({FunctionKind::surface, j, 0, state.mode[at(j)], zero_order[at(j)]});
  }
}

/// What ends sliding: exits, and selections that cease to exist.
void EventSearch::enter_exits(const ModeState& state, double t, const double* x) {
  mode_.first_exit = mode_.functions.size();
  mode_.exits.resize(state.sliding.size());
  if (!state.sliding.empty()) field_.exits(t, x, mode_.exits.data());
  for (std::size_t row = 0; row < state.sliding.size(); ++row) {
    const int r = static_cast<int>(row);
    const int arriving = arriving_sign(mode_.exits[row]);
    mode_.functions.push_back({FunctionKind::exit_below, state.sliding[row], r, arriving});
    mode_.functions.push_back({FunctionKind::exit_above, state.sliding[row], r, -arriving});
    // Where the value is 0 the event that led here was located on it: what follows keeps to the side it moves to.
    const auto side_of = [](double value) { return value < 0.0 ? -1 : 1; };
    if (field_.has_loss(row)) {
      mode_.functions.push_back({FunctionKind::loss, state.sliding[row], r, side_of(mode_.exits[row].loss)});
    }
    // A forced mode may lack it from the beginning.
    if (field_.has_stability(row) && mode_.exits[row].stability > 0.0) {
      mode_.functions.push_back({FunctionKind::instability, state.sliding[row], r, 1});
    }
  }
}

/// User functions, and the releases of those that are held.
void EventSearch::enter_users() {
  mode_.users = mode_.functions.size();
  const int n_psi = kernel_.switching_functions();
  const int user_end = n_psi + static_cast<int>(user_.sign.size());
  for (int u = n_psi; u < user_end; ++u) {
    if (!held_.holds(u)) mode_.functions.push_back({FunctionKind::user, u, 0, 0});
  }
  mode_.users_end = mode_.functions.size();
  held_.pressure.resize(held_.guards.size());
  for (std::size_t row = 0; row < held_.guards.size(); ++row) {
    mode_.functions.push_back(
        {FunctionKind::release, held_.guards[row].hold.function, static_cast<int>(row), held_.guards[row].inward});
  }
}

/// Room for the values of all functions.
void EventSearch::size_work() {
  levels_.reset(mode_.functions.size());
  point_.resize(mode_.functions.size());
  samples_.resize(mode_.functions.size() * ode::event_nodes);
  for (auto* list : {&suspects_, &sampled_, &candidates_, &special_, &mode_.curved, &inspected_})
    list->reserve(mode_.functions.size());
}

void EventSearch::enter(const ModeState& state, const std::vector<int>& zero_order, double t, const double* x) {
  start_at(t);
  if (flip(state, zero_order, t, x)) return;
  if (has_same_functions(state)) return renew(zero_order, t, x);
  mode_.state = state;
  mode_.functions.clear();
  load_rows();
  enter_surfaces(state, zero_order);
  enter_nested(state, zero_order);
  enter_exits(state, t, x);
  enter_users();
  enter_cells();
  set_forms(x);
  size_work();
  inspected_.clear();
  for (std::size_t i = 0; i < mode_.functions.size(); ++i) {
    const auto kind = mode_.functions[i].kind;
    const bool plain = kind == FunctionKind::surface || kind == FunctionKind::nested || kind == FunctionKind::loss;
    if (!plain || mode_.functions[i].zero_order > 0) inspected_.push_back(i);
  }
  read_start(t, x);
  sort_functions();
  const bool selections_are_plain =
      state.sliding.empty() || (field_.solve() == SlidingSolve::decoupled && kernel_.region_groups().empty());
  mode_.flips =
      !any_nesting_ && selections_are_plain && mode_.users_end == mode_.functions.size() && held_.followers.empty();
  only_signs_change_ = state.sliding.empty() && !state.higher && held_.nothing() && kernel_.cells() == 0 &&
                       kernel_.region_groups().empty();
}

/// Whether a mode is the one that was entered last, with functions that do not depend on the point it begins at.
bool EventSearch::has_same_functions(const ModeState& state) const {
  return only_signs_change_ && held_.nothing() && !state.higher && state.sliding.empty() &&
         state.mode == mode_.state.mode && state.alpha == mode_.state.alpha;
}

/// The mode that was entered last begins anew: with other values, and signs of user functions.
void EventSearch::renew(const std::vector<int>& zero_order, double t, const double* x) {
  inspected_.clear();
  for (std::size_t i = 0; i < mode_.functions.size(); ++i) {
    auto& function = mode_.functions[i];
    const bool is_surface = function.kind == FunctionKind::surface;
    function.zero_order = is_surface ? zero_order[at(function.index)] : 0;
    function.offset = 0.0;
    if (!is_surface || function.zero_order > 0) inspected_.push_back(i);
  }
  read_start(t, x);
  sort_functions();
}

void EventSearch::entered_cell(const EventFunction& reached) {
  // Its upper end is the lower end of the cell above, and the other way round.
  entered_[at(reached.row)] = reached.kind == FunctionKind::cell_upper ? reached.index + 1 : reached.index - 1;
}

void EventSearch::enter_cells() {
  for (int c = 0; c < kernel_.cells(); ++c) {
    const auto& table = kernel_.cell_table(c);
    const int upper = kernel_.cell_function(c);
    const int entered = std::exchange(entered_[at(c)], -1);
    if (std::isfinite(table.upper(kernel_.cell(c)))) {
      mode_.functions.push_back({FunctionKind::cell_upper, upper, c, -1, entered == upper ? 1 : 0});
    }
    if (std::isfinite(table.lower(kernel_.cell(c)))) {
      mode_.functions.push_back({FunctionKind::cell_lower, upper + 1, c, +1, entered == upper + 1 ? 1 : 0});
    }
  }
}

/// The functions that are affine in the mode. Selections of a mode are constants, so a function that holds some is
/// affine if it is for each value of theirs.
void EventSearch::load_rows() {
  if (rows_.start.empty() || any_nesting_ || kernel_.cells() > 0 || !kernel_.region_groups().empty()) {
    kernel_.affine_rows(mode_.state.alpha.data(), rows_);
    mode_.forms.load(rows_);
  }
}

/// These as forms.
void EventSearch::set_forms(const double* x) {
  for (auto& corner : values_.corners) kernel_.affine_rows(corner.alpha.data(), corner.rows);
  mode_.forms.reset(mode_.functions.size());
  mode_.curved.clear();
  mode_.prefilter.assign(mode_.functions.size(), false);
  for (std::size_t i = 0; i < mode_.functions.size(); ++i) {
    const auto& function = mode_.functions[i];
    switch (function.kind) {
      case FunctionKind::surface:
      case FunctionKind::user:
      case FunctionKind::cell_upper:
      case FunctionKind::cell_lower:
        mode_.forms.use_row(i, at(function.index));
        break;
      case FunctionKind::nested:
        mode_.forms.set(i, values_.corners[at(function.row)].rows, at(function.index));
        break;
      case FunctionKind::exit_below:
      case FunctionKind::exit_above: {
        const auto side = function.kind == FunctionKind::exit_below ? Region::below : Region::above;
        if (const auto* form = field_.exit_row(at(function.row), side, x)) mode_.forms.set(i, *form);
        break;
      }
      case FunctionKind::loss:
      case FunctionKind::instability:
      case FunctionKind::release:
        break;
    }
    if (mode_.forms.has(i)) continue;
    mode_.curved.push_back(i);
    // Functions that are not affine in the state may oscillate within a step: five nodes do not speak for them.
    mode_.prefilter[i] = five_nodes_suffice_ && !uses_phi(function);
  }
  mode_.forms.group();
  mode_.curved_parts = mode_.parts_of(mode_.curved);
}

/// What is watched by its form, and what is looked at in every step because its start is special.
void EventSearch::sort_functions() {
  mode_.forms.watch_none();
  special_.clear();
  for (std::size_t i = 0; i < mode_.functions.size(); ++i) sort(i);
}

void EventSearch::sort(std::size_t i) {
  const auto& function = mode_.functions[i];
  if (function.sign == 0 || function.zero_order != 0 || function.offset != 0.0) {
    special_.push_back(i);
  } else if (mode_.forms.has(i)) {
    mode_.forms.watch(i, function.sign);
  }
}

/// From the values in point_, at (t, x).
void EventSearch::read_user_signs(double t, const double* x) {
  for (std::size_t i = mode_.users; i < mode_.users_end; ++i) {
    auto& function = mode_.functions[i];
    const auto user = at(function.index - kernel_.switching_functions());
    const bool turns = user_.sign[user] * point_[i] < 0.0 && !user_.vanishes[user];
    const bool keeps_sign = turns && is_within_errors(function.index, point_[i], t, x);
    function.zero_order = keeps_sign ? 0 : user_.read(user, point_[i], levels_.noise[i]);
    function.sign = user_.sign[user];
  }
}

bool EventSearch::settle(double t, const double* x) {
  user_.forget_zeros();
  user_.zeros_at = t;
  if (special_.empty()) return false;
  bool unknown = false;
  const bool offset =
      std::any_of(special_.begin(), special_.end(), [&](auto i) { return mode_.functions[i].offset != 0.0; });
  if (offset) read_values(t, x, special_);
  std::size_t kept = 0;
  for (const std::size_t i : special_) {
    auto& function = mode_.functions[i];
    function.zero_order = 0;
    unknown = unknown || function.sign == 0;
    if (function.offset != 0.0 && function.has_left(point_[i])) function.offset = 0.0;
    if (function.offset != 0.0 || function.sign == 0) {
      special_[kept++] = i;
    } else if (mode_.forms.has(i)) {
      mode_.forms.watch(i, function.sign);
    }
  }
  special_.resize(kept);
  if (!unknown) return false;
  inspected_.clear();
  for (std::size_t i = mode_.users; i < mode_.users_end; ++i) inspected_.push_back(i);
  rescale(t, x, inspected_);
  read_values(t, x, inspected_);
  read_user_signs(t, x);
  sort_functions();
  return true;
}

void EventSearch::set_user_signs(const std::vector<int>& signs, const std::vector<bool>& vanish,
                                 const std::vector<int>& orders) {
  user_ = {signs, vanish, orders, std::nullopt};
}

void EventSearch::set_user_sign(std::size_t function, int sign, double t, const double* x) {
  const bool others_begin_anew = user_.zeros_at && *user_.zeros_at != t;
  start_at(t);
  auto& entry = mode_.functions[function];
  const auto user = at(entry.index - kernel_.switching_functions());
  entry.sign = sign;
  entry.zero_order = 1;
  entry.offset = 0.0;
  inspected_.assign(1, function);
  read_values(t, x, inspected_);
  entry.offset = point_[function];
  user_.put_at_zero(user, sign);
  if (others_begin_anew) return sort_functions();
  mode_.forms.ignore(function);
  if (std::find(special_.begin(), special_.end(), function) == special_.end()) special_.push_back(function);
}

}  // namespace saltus::event_integrator
