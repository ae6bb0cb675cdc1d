// Sums over Runge-Kutta stages with coefficients known to the compiler: zeros cost nothing, loops over n vectorise.
#pragma once

#include <cstddef>
#include <utility>

#include "saltus/ode/explicit/lanes_internal.hpp"

namespace saltus::ode {

/// Returns sum + coefficient * value; nothing is added where the coefficient is 0, so that unused stages may hold
/// anything.
template <const auto& rows, std::size_t row, std::size_t stage, class Value>
inline Value add_stage(Value sum, const double* stages, std::size_t n, std::size_t i) {
  if constexpr (rows[row][stage] != 0.0) {
    constexpr Value coefficient = in_all_lanes<Value>(rows[row][stage]);
    return sum + coefficient * load<Value>(stages + stage * n + i);
  } else {
    return sum;
  }
}

template <const auto& rows, std::size_t row, class Value, std::size_t... stage>
inline Value stage_sum(const double* stages, std::size_t n, std::size_t i, std::index_sequence<stage...>) {
  Value sum{};
  ((sum = add_stage<rows, row, stage>(sum, stages, n, i)), ...);
  return sum;
}

/// Returns component i, or i and i + 1, of the sum over the stages j of rows[row][j] k_j.
template <const auto& rows, std::size_t row, class Value = double>
inline Value stage_sum(const double* stages, std::size_t n, std::size_t i) {
  return stage_sum<rows, row, Value>(stages, n, i, std::make_index_sequence<rows[row].size()>{});
}

}  // namespace saltus::ode
