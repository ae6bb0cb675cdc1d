#include "saltus/event_integrator/steps/local_field.hpp"

#include <algorithm>

#include "saltus/base/at.hpp"
#include "saltus/base/without_repeats.hpp"
#include "saltus/event_integrator/mode/large_system.hpp"
#include "saltus/switching/table/surface_decision.hpp"

namespace saltus::event_integrator {
namespace {

/// Larger parts cost as much as all states, restarted.
constexpr std::size_t largest_share = 4;

}  // namespace

bool LocalField::is_known() {
  if (structure_ != nullptr) return true;
  structure_ = structure_of_large(kernel_);
  if (structure_ == nullptr) return false;
  const auto n = at(kernel_.states()), surfaces = at(kernel_.switching_functions());
  alpha_.assign(surfaces, 0.5);
  kernel_.affine_rows(alpha_.data(), gradients_);
  of_state_.resize(n);
  for (std::size_t j = 0; j < surfaces; ++j) {
    for (std::size_t k = gradients_.start[j]; k < gradients_.start[j + 1]; ++k)
      of_state_[gradients_.column[k]].push_back(j);
  }
  inside_.assign(n, false);
  is_input_.assign(n, false);
  x_.resize(n);
  slope_.resize(n);
  return true;
}

bool LocalField::begin(int surface, const ModeState& mode) {
  const auto is_affine = [&](int j) { return kernel_.is_affine(j); };
  if (!std::all_of(mode.sliding.begin(), mode.sliding.end(), is_affine)) return false;
  mode_ = &mode;
  for (const std::size_t row : rows_) inside_[row] = false;
  rows_.clear();
  for (const std::size_t row : structure_->rows_of_selection[at(surface)]) add(row);
  return complete();
}

bool LocalField::grow() {
  for (std::size_t k = 0, count = rows_.size(); k < count; ++k) add_what_moves(rows_[k]);
  return complete();
}

void LocalField::add(std::size_t row) {
  if (inside_[row]) return;
  inside_[row] = true;
  rows_.push_back(row);
}

/// The states that a state moves, by their rows or by selections in these.
void LocalField::add_what_moves(std::size_t state) {
  for (const std::size_t row : structure_->rows_of_state[state]) {
    add(row);
    for (const std::size_t j : of_state_[row]) {
      if (!slides(j)) continue;
      for (const std::size_t other : structure_->rows_of_selection[j]) add(other);
    }
  }
}

/// Of a surface that is slid on all states or none are in the part.
bool LocalField::complete() {
  held_.clear();
  for (std::size_t k = 0; k < rows_.size(); ++k) {
    for (const std::size_t j : of_state_[rows_[k]]) {
      if (!slides(j)) continue;
      const Slid surface = slid(j);
      const auto known = [&](const Slid& other) { return other.surface == j; };
      if (std::any_of(held_.begin(), held_.end(), known)) continue;
      held_.push_back(surface);
      for (std::size_t i = surface.begin; i < surface.end; ++i) {
        const std::size_t column = gradients_.column[i];
        for (const std::size_t other : of_state_[column]) {
          if (other != j && slides(other)) return false;
        }
        add(column);
      }
    }
    if (largest_share * rows_.size() > inside_.size()) return false;
  }
  if (rows_.empty()) return false;
  std::sort(rows_.begin(), rows_.end());
  if (!find_selections()) return false;
  find_inputs();
  find_border();
  return true;
}

/// The surfaces that are slid on whose selections the rows hold; false where one is not alone in that.
bool LocalField::find_selections() {
  std::vector<std::size_t> surfaces;
  for (const std::size_t row : rows_) {
    for (const std::size_t j : structure_->selections[row]) {
      if (slides(j)) surfaces.push_back(j);
    }
  }
  drop_repeats(surfaces);
  selections_ = mode_->alpha.data();
  if (!surfaces.empty()) {
    alpha_ = mode_->alpha;
    selections_ = alpha_.data();
  }
  selected_.clear();
  for (const std::size_t j : surfaces) {
    selected_.push_back(slid(j));
    const auto& neighbours = kernel_.neighbours(static_cast<int>(j));
    if (std::any_of(neighbours.begin(), neighbours.end(), [&](int i) { return slides(at(i)); })) return false;
  }
  return true;
}

/// States beside the part that its rows, and the selections in them, are made of.
void LocalField::find_inputs() {
  for (const std::size_t state : inputs_) is_input_[state] = false;
  inputs_.clear();
  const auto read = [&](std::size_t row) {
    for (const std::size_t state : structure_->states[row]) {
      if (inside_[state] || is_input_[state]) continue;
      is_input_[state] = true;
      inputs_.push_back(state);
    }
  };
  for (const std::size_t row : rows_) read(row);
  for (const auto& surface : selected_) {
    for (std::size_t k = surface.begin; k < surface.end; ++k) read(gradients_.column[k]);
  }
}

void LocalField::find_border() {
  border_.clear();
  const auto inside = [&](std::size_t row) { return static_cast<bool>(inside_[row]); };
  const auto all_inside = [&](const std::vector<std::size_t>& rows) {
    return std::all_of(rows.begin(), rows.end(), inside);
  };
  for (const std::size_t state : rows_) {
    const auto& moved = structure_->rows_of_state[state];
    const bool none_beside = all_inside(moved) && std::all_of(moved.begin(), moved.end(), [&](std::size_t row) {
                               return std::all_of(of_state_[row].begin(), of_state_[row].end(), [&](std::size_t j) {
                                 return !slides(j) || all_inside(structure_->rows_of_selection[j]);
                               });
                             });
    if (!none_beside) border_.push_back(state);
  }
}

/// grad psi . f + d psi/dt, for the selections in force.
double LocalField::velocity(const Slid& surface, double t) const {
  double rate = gradients_.rate[surface.surface];
  for (std::size_t k = surface.begin; k < surface.end; ++k) {
    rate += gradients_.coefficient[k] * kernel_.field_row(gradients_.column[k], t, x_.data(), selections_);
  }
  return rate;
}

/// The selections at x_.
void LocalField::select(double t) {
  for (const auto& surface : selected_) {
    alpha_[surface.surface] = 0.0;
    const double below = velocity(surface, t);
    alpha_[surface.surface] = 1.0;
    alpha_[surface.surface] = switching::sliding_alpha(below, velocity(surface, t));
  }
}

void LocalField::operator()(const ode::DenseStep& others, double t, const double* y, double* slope) {
  const double theta = std::clamp((t - others.t) / others.h, 0.0, 1.0);
  for (const std::size_t input : inputs_) x_[input] = others.value(input, theta);
  for (std::size_t i = 0; i < rows_.size(); ++i) x_[rows_[i]] = y[i];
  select(t);
  for (const std::size_t row : rows_) slope_[row] = kernel_.field_row(row, t, x_.data(), selections_);
  // What rounding has left of psi'.
  for (const auto& surface : held_) {
    double normal = gradients_.rate[surface.surface], square = 0.0;
    for (std::size_t k = surface.begin; k < surface.end; ++k) {
      normal += gradients_.coefficient[k] * slope_[gradients_.column[k]];
      square += gradients_.coefficient[k] * gradients_.coefficient[k];
    }
    for (std::size_t k = surface.begin; k < surface.end; ++k)
      slope_[gradients_.column[k]] -= gradients_.coefficient[k] * (normal / square);
    if (surface.end == surface.begin + 1 && gradients_.rate[surface.surface] == 0.0)
      slope_[gradients_.column[surface.begin]] *= 0.0;  // NaN stays
  }
  for (std::size_t i = 0; i < rows_.size(); ++i) slope[i] = slope_[rows_[i]];
}

}  // namespace saltus::event_integrator
