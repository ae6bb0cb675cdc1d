// What every source of this module needs of small things.
#pragma once

#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "saltus/base/at.hpp"
#include "saltus/base/contains.hpp"
#include "saltus/base/rounding_unit.hpp"

namespace saltus::event_integrator {

inline constexpr double infinity = std::numeric_limits<double>::infinity();
inline constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

inline bool is_finite(const std::vector<double>& values) {
  double none = 0.0;  // NaN if a value is not finite: without a way out of the loop
  for (const double value : values) none += 0.0 * value;
  return none == 0.0;
}

/// Returns what state k is moved by to look near by, `step` of its size or so: neighbours by different weights, of
/// signs by pattern, so that no symmetry of the model cancels them.
inline double displacement(std::size_t k, double x, double step, unsigned pattern) {
  const double weight = (pattern >> (k % 2) & 1U) != 0 ? -1.0 : 1.0;
  return weight * step * (1.0 + std::abs(x)) * (1.0 + 0.37 * static_cast<double>(k % 5));
}

/// Holds a list whose items keep their own storage when it is cleared: append() returns one that holds what an earlier
/// one has left there.
template <class Item>
class ReusedList {
 public:
  Item& append() {
    if (size_ == items_.size()) items_.emplace_back();
    return items_[size_++];
  }
  void clear() { size_ = 0; }
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] bool empty() const { return size_ == 0; }
  [[nodiscard]] Item& back() { return items_[size_ - 1]; }
  [[nodiscard]] std::span<const Item> items() const { return {items_.data(), size_}; }

 private:
  std::vector<Item> items_;
  std::size_t size_ = 0;
};

}  // namespace saltus::event_integrator
