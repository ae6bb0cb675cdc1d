// Where modes begin: from nothing, or behind a change of one surface.
#include <algorithm>
#include <utility>

#include "saltus/base/contracts.hpp"
#include "saltus/event_integrator/field/mode_field.hpp"
#include "saltus/event_integrator/mode/at_surface.hpp"
#include "saltus/event_integrator/mode/large_system.hpp"
#include "saltus/event_integrator/mode/small_internal.hpp"

namespace saltus::event_integrator {

void ModeField::enter(const ModeState& state) {
  linear_motion_.forget();
  known_ = nullptr;
  // Alone, a surface is one group whatever happens around it.
  const bool same_single = is_single() && state.sliding == sliding_ && !state.higher && kernel_.region_groups().empty();
  sliding_ = state.sliding;
  start_alpha_ = state.alpha;
  alpha_ = state.alpha;
  solve_ = SlidingSolve::none;
  rows_.independent.rows.clear();
  ties_.known = true;
  if (sliding_.empty()) {
    kernel_.prepare_field(alpha_.data(), constants_[0]);
    return;
  }
  // Cells, references and activities may change a gradient that is constant in each.
  const bool same_rows = same_single && rows_.is_constant.front() && kernel_.has_fixed_constants();
  if (!same_rows) resize_rows();
  if (same_single) {
    solve_ = SlidingSolve::decoupled;
  } else {
    find_regions(state);
    find_groups();
  }
  if (state.higher) {
    solve_ = SlidingSolve::higher_order;
    higher_order_.emplace(kernel_);
    higher_order_->enter(*state.higher, sliding_, state.alpha);
  }
  single_ = is_single() ? sliding_.front() : -1;
  find_rooted_rows();
  if (sliding_.size() != 1) return prepare_corners();
  between_.clear();
  for (std::size_t corner = 0; corner < 2; ++corner) {
    corner_[corner] = state.corner_alpha[corner];
    kernel_.prepare_field(corner_[corner].data(), constants_[corner]);
  }
  for (std::size_t i = 0; i < alpha_.size(); ++i) {
    if (corner_[0][i] == corner_[1][i]) {
      alpha_[i] = corner_[0][i];
    } else {
      between_.push_back(i);
    }
  }
  if (same_rows) refer_to_constants();
}

/// Of several sliding surfaces: all selections at 0, and those at 1 that no other one influences.
void ModeField::prepare_corners() {
  for (auto& corner : corner_) {
    corner = start_alpha_;
    for (const int j : sliding_) corner[at(j)] = 0.0;
  }
  for (const std::size_t row : groups_.alone) corner_[1][at(sliding_[row])] = 1.0;
  for (std::size_t corner = 0; corner < 2; ++corner) {
    kernel_.prepare_field(corner_[corner].data(), constants_[corner]);
  }
}

/// Of large systems, whose fields at all corners say what f is: with one selection in a row it lies between two of
/// them.
void ModeField::find_moved() {
  groups_.moved.clear();
  const auto* structure = solve_ == SlidingSolve::decoupled && kernel_.region_groups().empty() && sliding_.size() > 1
                              ? structure_of_large(kernel_)
                              : nullptr;
  if (structure == nullptr) return;
  groups_.is_moved.resize(at(kernel_.states()), false);
  bool several = false;
  for (const std::size_t row : groups_.alone) {
    for (const std::size_t state : structure->rows_of_selection[at(sliding_[row])]) {
      several = several || groups_.is_moved[state];
      groups_.is_moved[state] = true;
      groups_.moved.push_back({state, row});
    }
  }
  for (const auto& [state, row] : groups_.moved) groups_.is_moved[state] = false;
  if (several) groups_.moved.clear();
}

void ModeField::resize_rows() {
  const bool dense = sliding_.size() == 1 || !kernel_.region_groups().empty();
  rows_.resize(sliding_.size(), at(kernel_.states()), dense);
  exits_.assign(sliding_.size(), {});
}

void ModeField::find_rooted_rows() {
  rooted_rows_.clear();
  for (std::size_t row = 0; row < sliding_.size(); ++row) {
    if (is_around_root(kernel_, sliding_[row])) rooted_rows_.push_back(row);
  }
}

void ModeField::begin(const ModeChange& change) {
  if (!change.is_single()) return enter(*change.mode_after);
  linear_motion_.forget();
  known_ = nullptr;
  const auto j = at(change.surface);
  start_alpha_[j] = alpha_[j] = change.alpha_after;
  if (change.slid != nullptr) return begin_across(change);
  if (change.after == 0) return begin_sliding(change);
  if (change.before == 0) {
    if (change.after > 0) std::swap(constants_[0], constants_[1]);
    sliding_.clear();
    solve_ = SlidingSolve::none;
  } else if (change.beyond[0] != nullptr) {
    constants_[0] = *change.beyond[0];
  } else {
    constants_[0].alpha[j] = change.alpha_after;
    constants_[0].motion = nullptr;
    constants_[0].direct = nullptr;
  }
}

bool ModeField::prepare() {
  if (constants_[0].motion != nullptr || constants_[0].alpha.empty()) return false;
  SALTUS_ASSERT(sliding_.empty());
  kernel_.prepare_field(alpha_.data(), constants_[0]);
  return true;
}

/// From a region onto its border with the one beyond it.
void ModeField::begin_sliding(const ModeChange& change) {
  const bool from_above = change.before > 0;
  if (from_above) std::swap(constants_[0], constants_[1]);
  constants_[from_above ? 0 : 1] = *change.beyond[0];
  for (std::size_t corner = 0; corner < 2; ++corner) corner_[corner] = constants_[corner].alpha;
  sliding_.assign(1, change.surface);
  between_.assign(1, at(change.surface));
  if (single_ != change.surface) {
    resize_rows();
    find_groups();
    SALTUS_ASSERT(is_single());
    single_ = change.surface;
  }
  solve_ = SlidingSolve::decoupled;
  refer_to_constants();
}

/// Along the only surface that is slid on, across another one.
void ModeField::begin_across(const ModeChange& change) {
  const auto slid = at(change.slid->surface);
  start_alpha_[slid] = alpha_[slid] = change.slid->alpha_after;
  for (std::size_t corner = 0; corner < 2; ++corner) {
    corner_[corner][at(change.surface)] = change.alpha_after;
    constants_[corner] = *change.beyond[corner];
  }
  refer_to_constants();
}

/// For native steps on one surface.
void ModeField::refer_to_constants() {
  sliding_constants_ = {
      constants_[0].values.data(), constants_[1].values.data(), rows_.dense.data(), rows_.rates[0], rows_.square,
      rows_.coordinate[0]};
}

}  // namespace saltus::event_integrator
