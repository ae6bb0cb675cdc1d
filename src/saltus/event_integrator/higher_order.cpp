#include "saltus/event_integrator/higher_order.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "saltus/event_integrator/small_internal.hpp"

namespace saltus::event_integrator {

HigherOrderField::HigherOrderField(const evaluation::ModelKernel& kernel)
    : kernel_(kernel), functions_(kernel), motion_(at(kernel.states())), x_(motion_.size()) {}

void HigherOrderField::enter(const HigherOrderSet& set, const std::vector<int>& sliding,
                             const std::vector<double>& alpha) {
  set_ = set;
  sliding_ = sliding;
  alpha_ = alpha;
  for (const int j : sliding_) alpha_[at(j)] = 0.5;
  functions_.set(set_.functions, alpha_);
  trial_ = alpha_;
  ranges_.assign(set_.balances.size(), {});
  std::size_t corners = 0;
  for (const auto& balance : set_.balances) corners = std::max(corners, std::size_t{1} << balance.rows.size());
  corners_.assign(corners, std::vector<double>(motion_.size()));
  velocities_.assign(corners, 0.0);
}

void HigherOrderField::evaluate(const Balance& balance, BalanceRange& range, double t, const double* x) {
  const std::size_t corners = std::size_t{1} << balance.rows.size();
  range = {};
  trial_ = functions_.alpha();
  for (std::size_t corner = 0; corner < corners; ++corner) {
    for (std::size_t i = 0; i < balance.rows.size(); ++i) {
      trial_[at(sliding_[balance.rows[i]])] = selection(corner, i);
    }
    kernel_.field(t, x, trial_.data(), corners_[corner].data());
    const double velocity = functions_.velocity(balance.function, corners_[corner]);
    velocities_[corner] = velocity;
    range.terms = std::max(range.terms, functions_.velocity_terms(balance.function, corners_[corner]));
    // NOTE: a NaN stays in both, whatever comes behind it.
    if (corner == 0 || !(velocity >= range.min)) {
      range.min = velocity;
      range.lowest = corner;
    }
    if (corner == 0 || !(velocity <= range.max)) {
      range.max = velocity;
      range.highest = corner;
    }
  }
}

/// Whether all selections that fulfil a balance give the same field: f is a function of its velocity then.
bool HigherOrderField::determines(const Balance& balance, const BalanceRange& range) const {
  if (balance.rows.size() < 2) return true;
  const std::size_t corners = std::size_t{1} << balance.rows.size();
  const auto& low = corners_[range.lowest];
  const auto& high = corners_[range.highest];
  for (std::size_t corner = 0; corner < corners; ++corner) {
    const double share = (velocities_[corner] - range.min) / (range.max - range.min);
    for (std::size_t i = 0; i < low.size(); ++i) {
      const double size = std::max({std::abs(low[i]), std::abs(high[i]), std::abs(corners_[corner][i])});
      const double difference = corners_[corner][i] - (low[i] + share * (high[i] - low[i]));
      // Velocities are good to about ten digits.
      if (!(std::abs(difference) <= 1e-8 * size)) return false;
    }
  }
  return true;
}

void HigherOrderField::evaluate(double t, const double* point) {
  // The field is that of the nearest point of the set: beside it, where an implicit method looks, too, it may be
  // undefined.
  std::copy(point, point + x_.size(), x_.begin());
  static_cast<void>(functions_.project(t, x_.data()));
  const double* x = x_.data();
  functions_.differentiate(t, x);
  bool determined = true;
  for (std::size_t b = 0; b < set_.balances.size(); ++b) {
    const auto& balance = set_.balances[b];
    auto& range = ranges_[b];
    evaluate(balance, range, t, x);
    determined = determined && determines(balance, range);
    const double share = range.min / (range.min - range.max);
    for (std::size_t i = 0; i < balance.rows.size(); ++i) {
      const double low = selection(range.lowest, i);
      alpha_[at(sliding_[balance.rows[i]])] = low + share * (selection(range.highest, i) - low);
    }
  }
  kernel_.field(t, x, alpha_.data(), motion_.data());
  functions_.remove_normal_part(motion_);
  if (!determined) std::fill(motion_.begin(), motion_.end(), std::numeric_limits<double>::quiet_NaN());
}

}  // namespace saltus::event_integrator
