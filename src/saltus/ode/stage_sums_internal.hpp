// Sums over Runge-Kutta stages with coefficients known to the compiler: zeros cost nothing, loops over n vectorise.
#pragma once

#include <cstddef>
#include <utility>

namespace saltus::ode {

/// sum + coefficient * value; nothing is added where the coefficient is 0, so that unused stages may hold anything.
template <const auto& rows, std::size_t row, std::size_t stage>
inline double add_stage(double sum, const double* stages, std::size_t n, std::size_t i) {
  if constexpr (rows[row][stage] != 0.0) {
    return sum + rows[row][stage] * stages[stage * n + i];
  } else {
    return sum;
  }
}

template <const auto& rows, std::size_t row, std::size_t... stage>
inline double stage_sum(const double* stages, std::size_t n, std::size_t i, std::index_sequence<stage...>) {
  double sum = 0.0;
  ((sum = add_stage<rows, row, stage>(sum, stages, n, i)), ...);
  return sum;
}

/// Component i of the sum over the stages j of rows[row][j] k_j.
template <const auto& rows, std::size_t row>
inline double stage_sum(const double* stages, std::size_t n, std::size_t i) {
  return stage_sum<rows, row>(stages, n, i, std::make_index_sequence<rows[row].size()>{});
}

}  // namespace saltus::ode
