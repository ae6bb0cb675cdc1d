#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "saltus/base/at.hpp"
#include "saltus/linalg/fronts/equilibrate_internal.hpp"

namespace saltus::linalg::fronts {
namespace {

/// Rounds of equilibration: each halves the exponents that are left.
constexpr int rounds_of_scaling = 2;
/// The power of 2 next to 1 / sqrt(size), by the exponents of their bits; 1 where there is none.
[[nodiscard]] double scale_for(double size) {
  constexpr int fraction_bits = 52, bias = 1023, none = 2047;
  const auto exponent = static_cast<int>(std::bit_cast<std::uint64_t>(size) >> fraction_bits);
  if (exponent == 0 || exponent >= none) return 1.0;
  const int half = (exponent - bias + (exponent > bias ? 1 : 0)) / 2;
  return std::bit_cast<double>(static_cast<std::uint64_t>(bias - half) << fraction_bits);
}

}  // namespace

void equilibrate(std::span<const int> row, std::span<const int> column, std::span<double> values,
                 std::span<double> scale, std::span<double> work) {
  std::fill(scale.begin(), scale.end(), 1.0);
  for (int round = 0; round < rounds_of_scaling; ++round) {
    std::fill(work.begin(), work.end(), 0.0);
    for (std::size_t e = 0; e < values.size();) {
      const int j = column[e];
      double largest = 0.0;
      for (; e < values.size() && column[e] == j; ++e) {
        const auto i = at(row[e]);
        const double size = std::abs(values[e]) * scale[i] * scale[at(j)];
        work[i] = std::max(work[i], size);
        largest = std::max(largest, size);
      }
      work[at(j)] = std::max(work[at(j)], largest);
    }
    for (std::size_t i = 0; i < scale.size(); ++i) scale[i] *= scale_for(work[i]);
  }
  for (std::size_t e = 0; e < values.size(); ++e) values[e] *= scale[at(row[e])] * scale[at(column[e])];
}

}  // namespace saltus::linalg::fronts
