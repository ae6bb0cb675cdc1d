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
  if (zeros_at_ && *zeros_at_ != t) {
    for (const std::size_t i : special_) functions_[i].zero_order = 0;
    if (!user_vanishes_.empty()) user_vanishes_.assign(user_vanishes_.size(), false);
  }
  zeros_at_ = t;
}

/// Behind a crossing while sliding: the forms of the exits, whose fields are others now. Returns false where the mode
/// has to be entered afresh.
bool EventSearch::turn_exits(const double* x) {
  for (std::size_t row = 0; row < state_.sliding.size(); ++row) {
    for (const auto& [i, side] :
         {std::pair{exit_function(row), Region::below}, {exit_function(row) + 1, Region::above}}) {
      const auto* form = field_.exit_row(row, side, x);
      if ((form != nullptr) != forms_.has(i) || (form != nullptr && !forms_.replace(i, *form))) return false;
    }
  }
  return true;
}

/// Zeros at the start of the mode before are history.
void EventSearch::forget_specials() {
  for (const std::size_t i : special_) {
    functions_[i].zero_order = 0;
    functions_[i].offset = 0.0;
    if (forms_.has(i) && functions_[i].sign != 0) forms_.watch(i, functions_[i].sign);
  }
}

/// The sign of a surface outside the mode, which may have a zero here.
void EventSearch::turn(std::size_t surface, const ModeState& state, int zero_order) {
  const std::size_t i = of_surface_[surface];
  state_.mode[surface] = state.mode[surface];
  state_.alpha[surface] = state.alpha[surface];
  functions_[i].sign = state.mode[surface];
  functions_[i].zero_order = zero_order;
  forms_.ignore(i);
}

void EventSearch::cross(std::size_t surface, const ModeState& state, double t, const double* x) {
  start_at(t);
  forget_specials();
  turn(surface, state, 1);
  const std::size_t i = of_surface_[surface];
  inspected_.assign(1, i);
  read_values(t, x, inspected_);
  functions_[i].offset = point_[i];
  special_ = inspected_;
}

/// Whether the mode has the same functions as the one that was entered last, but for their signs and what exits hold,
/// if surfaces were crossed only.
bool EventSearch::may_flip(const ModeState& state) const {
  return flips_ && state.sliding == state_.sliding && !state.higher && held_.empty() && followers_.empty();
}

/// A crossing, of surfaces that nothing else of the mode depends on but the exits of what is slid on: only signs
/// change, and these; user functions are read anew. Returns false if the mode is another one than that: it is entered
/// afresh. Cost: O(1) for each surface crossed, but for the comparison of the modes.
bool EventSearch::flip(const ModeState& state, const std::vector<int>& zero_order, double t, const double* x) {
  if (!may_flip(state)) return false;
  inspected_.clear();
  bool crosses = true;
  for_each_difference(state_.mode, state.mode, [&](std::size_t j) {
    crosses = crosses && state.mode[j] != 0 && state_.mode[j] != 0;
    inspected_.push_back(j);
  });
  if (!crosses) return false;
  if (!state_.sliding.empty()) field_.exits(t, x, exits_.data());
  if (!turn_exits(x)) return false;
  for_each_nonzero(zero_order, [&](std::size_t j) {
    if (state.mode[j] == state_.mode[j]) inspected_.push_back(j);
  });
  forget_specials();
  for (std::size_t& entry : inspected_) {
    const std::size_t j = entry;
    entry = of_surface_[j];
    turn(j, state, zero_order[j]);
  }
  begin_flipped(state, t, x);
  return true;
}

bool EventSearch::pass(std::size_t surface, const ModeState& state, double t, const double* x) {
  start_at(t);
  if (!may_flip(state)) return false;
  exits_.assign(1, field_.sides());
  if (!turn_exits(x)) return false;
  forget_specials();
  turn(surface, state, 1);
  inspected_.assign(1, of_surface_[surface]);
  begin_flipped(state, t, x);
  return true;
}

/// What is left to do when the surfaces of `inspected_` have been turned: exits have other fields, and user functions
/// are read anew.
void EventSearch::begin_flipped(const ModeState& state, double t, const double* x) {
  for (std::size_t row = 0; row < state.sliding.size(); ++row) {
    const int arriving = arriving_sign(exits_[row]);
    const auto j = at(state.sliding[row]);
    state_.alpha[j] = state.alpha[j];
    for (const auto& [i, sign] : {std::pair{exit_function(row), arriving}, {exit_function(row) + 1, -arriving}}) {
      forms_.ignore(i);
      functions_[i].sign = sign;
      functions_[i].zero_order = 0;
      functions_[i].offset = 0.0;
      inspected_.push_back(i);
    }
  }
  for (std::size_t i = users_; i < users_end_; ++i) {
    forms_.ignore(i);
    functions_[i].zero_order = 0;
    functions_[i].offset = 0.0;
    inspected_.push_back(i);
  }
  read_start(t, x);
  special_.clear();
  for (const std::size_t i : inspected_) sort(i);
}

/// Values of the functions that are looked at where a mode starts, and what follows for those at zero.
void EventSearch::read_start(double t, const double* x) {
  Parts parts = parts_of(inspected_);
  // Exits have just been evaluated here; again they would be the same but for selections that are iterated.
  if (field_.solve() == SlidingSolve::decoupled) parts.exits = false;
  rescale(t, x, inspected_, parts);
  evaluate_parts(t, x, parts);
  for (const std::size_t i : inspected_) point_[i] = value(i, x);
  read_user_signs();
  for (const std::size_t i : inspected_) {
    auto& function = functions_[i];
    const bool is_exit = function.kind == FunctionKind::exit_below || function.kind == FunctionKind::exit_above ||
                         function.kind == FunctionKind::instability || function.kind == FunctionKind::release;
    const bool is_cell = function.kind == FunctionKind::cell_upper || function.kind == FunctionKind::cell_lower;
    // A selection that starts at its bound (tangential entry) leaves its exit function a zero there.
    if ((is_exit || is_cell) && std::abs(point_[i]) <= noise_[i]) function.zero_order = 1;
    // The event was located to the last bits of the time, which are not the last bits of psi: what is left there is the
    // zero of this start.
    if (function.zero_order > 0) function.offset = point_[i];
    if (any_nesting_ && is_exit && function.kind != FunctionKind::release) bear_tangency(i, t, x);
  }
}

/// The exit to a field that goes along the surface is 0 throughout the mode, but for its rounding and the errors of the
/// dense output, which is not on the surface: it counts from where it is more than these.
void EventSearch::bear_tangency(std::size_t i, double t, const double* x) {
  auto& function = functions_[i];
  const bool is_below = function.kind == FunctionKind::exit_below;
  if (!nesting_[at(function.index)] || field_.solve() != SlidingSolve::decoupled) return;
  if (!is_below && function.kind != FunctionKind::exit_above) return;
  const auto& exit = exits_[at(function.row)];
  const double scale = std::abs(exit.below) + std::abs(exit.above);
  std::vector<double> alpha = state_.sliding.size() == 1 ? state_.corner_alpha[is_below ? 0 : 1] : state_.alpha;
  alpha[at(function.index)] = is_below ? 0.0 : 1.0;
  if (!moves_along(kernel_, alpha, function.index, t, x, scale)) return;
  constexpr double errors = 1e4;  // of steps, which are smaller than those of dense outputs
  const double margin = std::clamp(errors * tolerances_.rtol, 1e-7, 1e-2) * scale;
  function.zero_order = 0;
  function.offset = -function.sign * margin;
}

/// Values of some functions into point_.
void EventSearch::read_values(double t, const double* x, const std::vector<std::size_t>& which) {
  if (which.size() == 1 && is_threshold(which.front())) {
    point_[which.front()] = forms_.threshold_value(which.front(), x) - functions_[which.front()].offset;
    return;
  }
  evaluate_parts(t, x, parts_of(which));
  for (const std::size_t i : which) point_[i] = value(i, x);
}

/// Surfaces outside the mode, but those that keep their values beside what is held.
void EventSearch::enter_surfaces(const ModeState& state, const std::vector<int>& zero_order) {
  const auto constant =
      kernel_.region_groups().empty() ? std::vector<bool>() : constant_beside_held(kernel_, state, rows_);
  for (int j = 0; j < kernel_.switching_functions(); ++j) {
    if (!constant.empty() && constant[at(j)]) continue;
    if (state.mode[at(j)] == 0 || (nesting_[at(j)] && !sliding_inside(kernel_, state, j).empty())) continue;
    of_surface_[at(j)] = functions_.size();
    functions_.push_back({FunctionKind::surface, j, 0, state.mode[at(j)], zero_order[at(j)]});
  }
}

/// What ends sliding: exits, and selections that cease to exist.
void EventSearch::enter_exits(const ModeState& state, double t, const double* x) {
  first_exit_ = functions_.size();
  exits_.resize(state.sliding.size());
  if (!state.sliding.empty()) field_.exits(t, x, exits_.data());
  for (std::size_t row = 0; row < state.sliding.size(); ++row) {
    const int r = static_cast<int>(row);
    const int arriving = arriving_sign(exits_[row]);
    functions_.push_back({FunctionKind::exit_below, state.sliding[row], r, arriving});
    functions_.push_back({FunctionKind::exit_above, state.sliding[row], r, -arriving});
    // Where the value is 0 the event that led here was located on it: what follows keeps to the side it moves to.
    const auto side_of = [](double value) { return value < 0.0 ? -1 : 1; };
    if (field_.has_loss(row)) {
      functions_.push_back({FunctionKind::loss, state.sliding[row], r, side_of(exits_[row].loss)});
    }
    // A forced mode may lack it from the beginning.
    if (field_.has_stability(row) && exits_[row].stability > 0.0) {
      functions_.push_back({FunctionKind::instability, state.sliding[row], r, 1});
    }
  }
}

/// User functions, and the releases of those that are held.
void EventSearch::enter_users() {
  const auto is_held = [&](int u) {
    const auto is_it = [u](const HeldGuard& guard) { return guard.hold.function == u; };
    return std::any_of(held_.begin(), held_.end(), is_it) || std::any_of(followers_.begin(), followers_.end(), is_it);
  };
  users_ = functions_.size();
  const int n_psi = kernel_.switching_functions();
  const int user_end = n_psi + static_cast<int>(user_sign_.size());
  for (int u = n_psi; u < user_end; ++u) {
    if (!is_held(u)) functions_.push_back({FunctionKind::user, u, 0, 0});
  }
  users_end_ = functions_.size();
  pressure_.resize(held_.size());
  for (std::size_t row = 0; row < held_.size(); ++row) {
    functions_.push_back({FunctionKind::release, held_[row].hold.function, static_cast<int>(row), held_[row].inward});
  }
}

/// Room for the values of all functions.
void EventSearch::size_work() {
  noise_.assign(functions_.size(), 0.0);
  accuracy_.assign(functions_.size(), 0.0);
  point_.resize(functions_.size());
  samples_.resize(functions_.size() * ode::event_nodes);
  for (auto* list : {&suspects_, &sampled_, &candidates_, &special_, &curved_, &inspected_})
    list->reserve(functions_.size());
}

void EventSearch::enter(const ModeState& state, const std::vector<int>& zero_order, double t, const double* x) {
  start_at(t);
  if (flip(state, zero_order, t, x)) return;
  if (has_same_functions(state)) return renew(zero_order, t, x);
  state_ = state;
  functions_.clear();
  load_rows();
  enter_surfaces(state, zero_order);
  enter_nested(state, zero_order);
  enter_exits(state, t, x);
  enter_users();
  enter_cells();
  set_forms(x);
  size_work();
  inspected_.clear();
  for (std::size_t i = 0; i < functions_.size(); ++i) {
    const auto kind = functions_[i].kind;
    const bool plain = kind == FunctionKind::surface || kind == FunctionKind::nested || kind == FunctionKind::loss;
    if (!plain || functions_[i].zero_order > 0) inspected_.push_back(i);
  }
  read_start(t, x);
  sort_functions();
  const bool selections_are_plain =
      state.sliding.empty() || (field_.solve() == SlidingSolve::decoupled && kernel_.region_groups().empty());
  flips_ = !any_nesting_ && selections_are_plain && users_end_ == functions_.size() && followers_.empty();
  only_signs_change_ = state.sliding.empty() && !state.higher && held_.empty() && followers_.empty() &&
                       kernel_.cells() == 0 && kernel_.region_groups().empty();
}

/// Whether a mode is the one that was entered last, with functions that do not depend on the point it begins at.
bool EventSearch::has_same_functions(const ModeState& state) const {
  return only_signs_change_ && held_.empty() && followers_.empty() && !state.higher && state.sliding.empty() &&
         state.mode == state_.mode && state.alpha == state_.alpha;
}

/// The mode that was entered last begins anew: with other values, and signs of user functions.
void EventSearch::renew(const std::vector<int>& zero_order, double t, const double* x) {
  inspected_.clear();
  for (std::size_t i = 0; i < functions_.size(); ++i) {
    auto& function = functions_[i];
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
      functions_.push_back({FunctionKind::cell_upper, upper, c, -1, entered == upper ? 1 : 0});
    }
    if (std::isfinite(table.lower(kernel_.cell(c)))) {
      functions_.push_back({FunctionKind::cell_lower, upper + 1, c, +1, entered == upper + 1 ? 1 : 0});
    }
  }
}

/// The functions that are affine in the mode. Selections of a mode are constants, so a function that holds some is
/// affine if it is for each value of theirs.
void EventSearch::load_rows() {
  if (rows_.start.empty() || any_nesting_ || kernel_.cells() > 0 || !kernel_.region_groups().empty()) {
    kernel_.affine_rows(state_.alpha.data(), rows_);
    forms_.load(rows_);
  }
}

/// These as forms.
void EventSearch::set_forms(const double* x) {
  for (auto& corner : corners_) kernel_.affine_rows(corner.alpha.data(), corner.rows);
  forms_.reset(functions_.size());
  curved_.clear();
  prefilter_.assign(functions_.size(), false);
  for (std::size_t i = 0; i < functions_.size(); ++i) {
    const auto& function = functions_[i];
    switch (function.kind) {
      case FunctionKind::surface:
      case FunctionKind::user:
      case FunctionKind::cell_upper:
      case FunctionKind::cell_lower:
        forms_.use_row(i, at(function.index));
        break;
      case FunctionKind::nested:
        forms_.set(i, corners_[at(function.row)].rows, at(function.index));
        break;
      case FunctionKind::exit_below:
      case FunctionKind::exit_above: {
        const auto side = function.kind == FunctionKind::exit_below ? Region::below : Region::above;
        if (const auto* form = field_.exit_row(at(function.row), side, x)) forms_.set(i, *form);
        break;
      }
      case FunctionKind::loss:
      case FunctionKind::instability:
      case FunctionKind::release:
        break;
    }
    if (forms_.has(i)) continue;
    curved_.push_back(i);
    // Functions that are not affine in the state may oscillate within a step: five nodes do not speak for them.
    prefilter_[i] = five_nodes_suffice_ && !uses_phi(function);
  }
  forms_.group();
  curved_parts_ = parts_of(curved_);
}

/// What is watched by its form, and what is looked at in every step because its start is special.
void EventSearch::sort_functions() {
  forms_.watch_none();
  special_.clear();
  for (std::size_t i = 0; i < functions_.size(); ++i) sort(i);
}

void EventSearch::sort(std::size_t i) {
  const auto& function = functions_[i];
  if (function.sign == 0 || function.zero_order != 0 || function.offset != 0.0) {
    special_.push_back(i);
  } else if (forms_.has(i)) {
    forms_.watch(i, function.sign);
  }
}

/// From the values in point_.
void EventSearch::read_user_signs() {
  for (std::size_t i = users_; i < users_end_; ++i) {
    auto& function = functions_[i];
    const auto user = at(function.index - kernel_.switching_functions());
    auto& sign = user_sign_[user];
    const bool at_zero = user_vanishes_[user] || std::abs(point_[i]) <= noise_[i];
    if (!at_zero) sign = sign_of(point_[i]);
    function.sign = sign;
    const int order = user_vanishes_[user] && !user_order_.empty() ? user_order_[user] : 1;
    function.zero_order = at_zero ? order : 0;
  }
}

bool EventSearch::settle(double t, const double* x) {
  if (!user_vanishes_.empty()) user_vanishes_.assign(user_vanishes_.size(), false);
  zeros_at_ = t;
  if (special_.empty()) return false;
  bool unknown = false;
  const bool offset =
      std::any_of(special_.begin(), special_.end(), [&](auto i) { return functions_[i].offset != 0.0; });
  if (offset) read_values(t, x, special_);
  std::size_t kept = 0;
  for (const std::size_t i : special_) {
    auto& function = functions_[i];
    function.zero_order = 0;
    unknown = unknown || function.sign == 0;
    if (function.offset != 0.0 && function.has_left(point_[i])) function.offset = 0.0;
    if (function.offset != 0.0 || function.sign == 0) {
      special_[kept++] = i;
    } else if (forms_.has(i)) {
      forms_.watch(i, function.sign);
    }
  }
  special_.resize(kept);
  if (!unknown) return false;
  inspected_.clear();
  for (std::size_t i = users_; i < users_end_; ++i) inspected_.push_back(i);
  rescale(t, x, inspected_);
  read_values(t, x, inspected_);
  read_user_signs();
  sort_functions();
  return true;
}

void EventSearch::set_user_signs(const std::vector<int>& signs, const std::vector<bool>& vanish,
                                 const std::vector<int>& orders) {
  user_sign_ = signs;
  user_vanishes_ = vanish;
  user_order_ = orders;
  zeros_at_.reset();
}

void EventSearch::set_user_sign(std::size_t function, int sign, double t, const double* x) {
  const bool others_begin_anew = zeros_at_ && *zeros_at_ != t;
  start_at(t);
  auto& entry = functions_[function];
  const auto user = at(entry.index - kernel_.switching_functions());
  entry.sign = sign;
  entry.zero_order = 1;
  entry.offset = 0.0;
  inspected_.assign(1, function);
  read_values(t, x, inspected_);
  entry.offset = point_[function];
  user_sign_[user] = sign;
  user_vanishes_[user] = true;
  if (!user_order_.empty()) user_order_[user] = 1;
  if (others_begin_anew) return sort_functions();
  forms_.ignore(function);
  if (std::find(special_.begin(), special_.end(), function) == special_.end()) special_.push_back(function);
}

}  // namespace saltus::event_integrator
