// Where steps start: the functions of a mode, their signs, and zeros that are known there.
#include <algorithm>
#include <cmath>
#include <utility>

#include "saltus/base/contains.hpp"
#include "saltus/base/contracts.hpp"
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
  if (mode_.start != t) {
    for (const std::size_t i : special_) mode_.functions[i].zero_order = 0;
  }
  mode_.start = t;
  ledger_.begin(t);
}

void EventSearch::begin(const ModeChange& change, const Position& here) {
  if (!change.is_single()) return enter(here.state, *change.zero_order, here.t, here.x.data());
  SALTUS_ASSERT(mode_.plain);
  start_at(here.t);
  mode_.forget_zeros(special_);
  const auto j = at(change.surface);
  inspected_.clear();
  turn(j, here.state, change.order());
  if (change.crosses() && change.slid == nullptr) {  // nothing is slid on, and there are no user functions
    read_values(here.t, here.x.data(), inspected_);
    mode_.functions[j].offset = point_[j];
    special_ = inspected_;
    return;
  }
  turned_.surfaces.assign(1, j);
  finish_move(here.state, here.t, here.x.data());
}

/// A surface of a plain mode that has changed, or has a zero here.
void EventSearch::turn(std::size_t surface, const ModeState& state, int zero_order) {
  mode_.turn(surface, state, zero_order);
  if (state.mode[surface] != 0) inspected_.push_back(surface);
}

/// Whether each surface, and each exit, has its place among the functions of a mode whose field was entered.
bool EventSearch::is_plain(const ModeState& state) const {
  const bool selections_are_plain = state.sliding.empty() || field_.solve() == SlidingSolve::decoupled;
  return !any_nesting_ && selections_are_plain && !state.higher && held_.empty() && kernel_.has_fixed_constants();
}

/// From one plain mode to another one: surfaces that were crossed, met or left, and exits that know of that, are
/// others; user functions are read anew. Returns false if one of the modes is not plain: it is entered afresh. Cost:
/// some operations for each surface that is slid on, but for the comparison of the modes.
bool EventSearch::move(const ModeState& state, const std::vector<int>& zero_order, double t, const double* x) {
  if (!mode_.plain || !is_plain(state)) return false;
  mode_.forget_zeros(special_);
  inspected_.clear();
  turned_.surfaces.clear();
  for_each_difference(mode_.state.mode, state.mode, [&](std::size_t j) { turned_.surfaces.push_back(j); });
  for (const std::size_t j : turned_.surfaces) turn(j, state, zero_order[j]);
  for_each_nonzero(zero_order, [&](std::size_t j) {
    const bool turned = std::binary_search(turned_.surfaces.begin(), turned_.surfaces.end(), j);
    if (state.mode[j] != 0 && !turned) turn(j, state, zero_order[j]);
  });
  finish_move(state, t, x);
  return true;
}

/// Behind the surfaces that were turned: exits, and user functions.
void EventSearch::finish_move(const ModeState& state, double t, const double* x) {
  mode_.state.alpha = state.alpha;
  mode_.state.sliding = state.sliding;
  move_exits(t, x);
  mode_.curved_parts = mode_.parts_of(mode_.curved);
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

void EventSearch::move_exits(double t, const double* x) {
  const auto& sliding = mode_.state.sliding;
  if (sliding.empty()) return;
  // With user functions there may be jumps: the state is another one than at the end of the mode before.
  const bool may_jump = mode_.users_end > mode_.users;
  mode_.exits = field_.all_sides();
  if (may_jump) field_.exits(t, x, mode_.exits.data());
  const auto mark = [&](bool beside) {
    for (const std::size_t j : turned_.surfaces) {
      for (const int k : kernel_.neighbours(static_cast<int>(j))) turned_.beside[at(k)] = beside;
    }
  };
  mark(true);
  for (std::size_t row = 0; row < sliding.size(); ++row) {
    if (may_jump || exits_change(row, x)) {
      renew_exits(row, x);
    } else {
      const std::size_t i = mode_.exit_of(at(sliding[row]));
      mode_.functions[i].row = mode_.functions[i + 1].row = static_cast<int>(row);
    }
  }
  mark(false);
}

/// Whether exits of a surface are others than in the mode before, or may be at zero.
bool EventSearch::exits_change(std::size_t row, const double* x) const {
  constexpr double near = 1e-6;
  const auto j = at(mode_.state.sliding[row]);
  const auto& function = mode_.functions[mode_.exit_of(j)];
  const auto& [below, above, loss, stability] = mode_.exits[row];
  const bool is_away = std::min(std::abs(below), std::abs(above)) > near * (std::abs(below) + std::abs(above));
  return function.kind == FunctionKind::absent || turned_.beside[j] || !is_away ||
         function.sign != arriving_sign(mode_.exits[row]) || field_.kept_state(row, x).value != mode_.kept_states[j];
}

void EventSearch::renew_exits(std::size_t row, const double* x) {
  const int surface = mode_.state.sliding[row];
  const int arriving = arriving_sign(mode_.exits[row]);
  mode_.kept_states[at(surface)] = field_.kept_state(row, x).value;
  const auto renew_one = [&](std::size_t i, FunctionKind kind, Region side, int sign) {
    mode_.forms.ignore(i);
    mode_.put(i, {kind, surface, static_cast<int>(row), sign});
    mode_.forms.replace(i, field_.exit_row(row, side, x));
    mode_.list_curved(i);
    mode_.prefilter[i] = true;
    inspected_.push_back(i);
  };
  const std::size_t first = mode_.exit_of(at(surface));
  renew_one(first, FunctionKind::exit_below, Region::below, arriving);
  renew_one(first + 1, FunctionKind::exit_above, Region::above, -arriving);
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
    const bool is_exit =
        function.is_side() || function.kind == FunctionKind::instability || function.kind == FunctionKind::release;
    const bool is_cell = function.kind == FunctionKind::cell_upper || function.kind == FunctionKind::cell_lower;
    // A selection that starts at its bound (tangential entry) leaves its exit function a zero there.
    if ((is_exit || is_cell) && std::abs(point_[i]) <= levels_.noise[i]) function.zero_order = 1;
    // The event was located to the last bits of the time, which are not the last bits of psi: what is left there is the
    // zero of this start.
    if (function.zero_order > 0) function.offset = point_[i];
    // At the edge of sliding the exit function may stay within its rounding for long: it counts from where it is more.
    if (function.is_side() && function.zero_order > 0) {
      function.zero_order = 0;
      function.offset = -function.sign * levels_.noise[i];
    }
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
  constexpr double least = 1e-7, most = 1e-2;
  const double margin = std::clamp(errors * errors_.of_run().rtol, least, most) * scale;
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
    if (state.mode[at(j)] == 0 && mode_.plain) mode_.functions.push_back({FunctionKind::absent, j});
    if (state.mode[at(j)] == 0 || (nesting_[at(j)] && !sliding_inside(kernel_, state, j).empty())) continue;
    mode_.functions.push_back({FunctionKind::surface, j, 0, state.mode[at(j)], zero_order[at(j)]});
  }
}

/// What ends sliding: exits, and selections that cease to exist.
void EventSearch::enter_exits(const ModeState& state, double t, const double* x) {
  mode_.exits.resize(state.sliding.size());
  if (!state.sliding.empty()) field_.exits(t, x, mode_.exits.data());
  if (mode_.plain) return enter_plain_exits(x);
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

/// All of them in their places.
void EventSearch::enter_plain_exits(const double* x) {
  const auto& state = mode_.state;
  for (std::size_t j = 0; j < state.mode.size(); ++j) {
    for (int side = 0; side < 2; ++side) mode_.functions.push_back({FunctionKind::absent, static_cast<int>(j)});
  }
  for (std::size_t row = 0; row < state.sliding.size(); ++row) {
    const int surface = state.sliding[row];
    const int arriving = arriving_sign(mode_.exits[row]);
    const std::size_t first = mode_.exit_of(at(surface));
    mode_.functions[first] = {FunctionKind::exit_below, surface, static_cast<int>(row), arriving};
    mode_.functions[first + 1] = {FunctionKind::exit_above, surface, static_cast<int>(row), -arriving};
    mode_.kept_states[at(surface)] = field_.kept_state(row, x).value;
  }
}

/// User functions, and the releases of those that are held.
void EventSearch::enter_users() {
  mode_.users = mode_.functions.size();
  const int n_psi = kernel_.switching_functions();
  const int user_end = n_psi + static_cast<int>(ledger_.signs().size());
  for (int u = n_psi; u < user_end; ++u) {
    if (!held_.holds(u)) mode_.functions.push_back({FunctionKind::user, u, 0, 0});
  }
  mode_.users_end = mode_.functions.size();
  values_.pressure.resize(held_.guards.size());
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
  for (auto& checks : checks_) checks.reserve(mode_.functions.size());
}

void EventSearch::enter(const ModeState& state, const std::vector<int>& zero_order, double t, const double* x) {
  start_at(t);
  if (move(state, zero_order, t, x)) return;
  if (has_same_functions(state)) return renew(zero_order, t, x);
  mode_.state = state;
  mode_.plain = is_plain(state);
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
  mode_.present = 0;
  for (std::size_t i = 0; i < mode_.functions.size(); ++i) {
    const auto kind = mode_.functions[i].kind;
    if (kind == FunctionKind::absent) continue;
    ++mode_.present;
    const bool regular = kind == FunctionKind::surface || kind == FunctionKind::nested || kind == FunctionKind::loss;
    if (!regular || mode_.functions[i].zero_order > 0) inspected_.push_back(i);
  }
  read_start(t, x);
  sort_functions();
  only_signs_change_ = state.sliding.empty() && !state.higher && held_.empty() && kernel_.has_fixed_constants();
}

/// Whether a mode is the one that was entered last, with functions that do not depend on the point it begins at.
bool EventSearch::has_same_functions(const ModeState& state) const {
  return only_signs_change_ && held_.empty() && !state.higher && state.sliding.empty() &&
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
  if (rows_.start.empty() || any_nesting_ || !kernel_.has_fixed_constants()) {
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
      case FunctionKind::absent:
        // A surface keeps its form, for when it is there again.
        if (i < mode_.state.mode.size()) mode_.forms.use_row(i, at(function.index));
        continue;
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
    mode_.prefilter[i] = !uses_phi(function);
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
  if (function.kind == FunctionKind::absent) return;
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
    const int user = function.index;
    function.zero_order = ledger_.order(user);
    if (function.zero_order == 0) {
      const bool turns = ledger_.sign(user) * point_[i] < 0.0;
      const bool keeps_sign = turns && is_within_errors(user, point_[i], t, x);
      if (!keeps_sign && std::abs(point_[i]) <= levels_.noise[i]) {
        function.zero_order = 1;
      } else if (!keeps_sign) {
        ledger_.set_sign(user, sign_of(point_[i]));
      }
    }
    function.sign = ledger_.sign(user);
  }
}

bool EventSearch::settle(double t, const double* x) {
  mode_.start = t;
  ledger_.begin(t);
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

void EventSearch::turn_users(double t, const double* x) {
  const bool others_begin_anew = mode_.start != t;
  start_at(t);
  inspected_.clear();
  for (std::size_t i = mode_.users; i < mode_.users_end; ++i) {
    auto& entry = mode_.functions[i];
    const int sign = ledger_.sign(entry.index), order = ledger_.order(entry.index);
    if (order == 0 || (entry.sign == sign && entry.zero_order == order)) continue;
    entry.sign = sign;
    entry.zero_order = order;
    entry.offset = 0.0;
    inspected_.push_back(i);
  }
  if (!inspected_.empty()) read_values(t, x, inspected_);
  for (const std::size_t i : inspected_) {
    mode_.functions[i].offset = point_[i];
    mode_.forms.ignore(i);
    if (!contains(special_, i)) special_.push_back(i);
  }
  if (others_begin_anew) sort_functions();
}

}  // namespace saltus::event_integrator
