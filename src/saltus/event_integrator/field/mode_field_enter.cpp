// Where modes begin: in general, and the fast paths from one region to its neighbour.
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
  // Cells may change a gradient that is constant in each.
  const bool same_rows = same_single && rows_.is_constant.front() && kernel_.cells() == 0;
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

void ModeField::cross(std::size_t surface, const evaluation::FieldConstants& other) {
  linear_motion_.forget();
  known_ = nullptr;
  start_alpha_[surface] = alpha_[surface] = other.alpha[surface];
  constants_[0] = other;
}

void ModeField::cross(std::size_t surface, double alpha) {
  linear_motion_.forget();
  known_ = nullptr;
  start_alpha_[surface] = alpha_[surface] = constants_[0].alpha[surface] = alpha;
  constants_[0].motion = nullptr;
  constants_[0].direct = nullptr;
}

bool ModeField::prepare() {
  if (constants_[0].motion != nullptr || constants_[0].alpha.empty()) return false;
  SALTUS_ASSERT(sliding_.empty());
  kernel_.prepare_field(alpha_.data(), constants_[0]);
  return true;
}

void ModeField::slide_from_region(std::size_t surface, double selection, Region side,
                                  const evaluation::FieldConstants& other) {
  linear_motion_.forget();
  known_ = nullptr;
  start_alpha_[surface] = alpha_[surface] = selection;
  if (side == Region::below) std::swap(constants_[0], constants_[1]);
  constants_[side == Region::below ? 0 : 1] = other;
  for (std::size_t corner = 0; corner < 2; ++corner) corner_[corner] = constants_[corner].alpha;
  const int j = static_cast<int>(surface);
  sliding_.assign(1, j);
  between_.assign(1, surface);
  if (single_ != j) {
    resize_rows();
    find_groups();
    SALTUS_ASSERT(is_single());
    single_ = j;
  }
  solve_ = SlidingSolve::decoupled;
  refer_to_constants();
}

void ModeField::leave_to(Region side) {
  linear_motion_.forget();
  known_ = nullptr;
  const auto j = at(sliding_.front());
  start_alpha_[j] = alpha_[j] = side == Region::below ? 0.0 : 1.0;
  if (side == Region::above) std::swap(constants_[0], constants_[1]);
  sliding_.clear();
  solve_ = SlidingSolve::none;
}

void ModeField::pass(std::size_t surface, double alpha, double selection,
                     FunctionRef<const evaluation::FieldConstants&(const std::vector<double>&)> constants_of) {
  linear_motion_.forget();
  known_ = nullptr;
  const auto slid = at(sliding_.front());
  start_alpha_[surface] = alpha_[surface] = alpha;
  start_alpha_[slid] = alpha_[slid] = selection;
  for (std::size_t corner = 0; corner < 2; ++corner) {
    corner_[corner][surface] = alpha;
    constants_[corner] = constants_of(corner_[corner]);
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
