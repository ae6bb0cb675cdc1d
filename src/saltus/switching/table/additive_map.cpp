#include "saltus/switching/table/additive_map.hpp"

#include <cmath>

#include "saltus/switching/table/field_accuracy.hpp"

namespace saltus::switching {
namespace {

using linalg::Index;

constexpr std::size_t longest_stride = 4;

}  // namespace

std::optional<AdditiveMap> additive_map(std::size_t q, const OfSelections& value) {
  std::vector<double> alpha(q, 0.0);
  AdditiveMap map;
  value(alpha, map.constant);
  map.effects.resize(map.constant.size(), static_cast<Index>(q));
  linalg::Vector at_corner;
  for (std::size_t i = 0; i < q; ++i) {
    alpha[i] = 1.0;
    value(alpha, at_corner);
    map.effects.col(static_cast<Index>(i)) = at_corner - map.constant;
    alpha[i] = 0.0;
  }
  if (!map.constant.all_finite() || !map.effects.all_finite()) return map;
  for (std::size_t stride = 1; stride <= longest_stride; ++stride) {
    for (std::size_t first = 0; first < stride && first < q; ++first) {
      linalg::Vector sum = map.constant, terms = map.constant.abs();
      alpha.assign(q, 0.0);
      for (std::size_t i = first; i < q; i += stride) {
        alpha[i] = 1.0;
        sum += map.effects.col(static_cast<Index>(i));
        terms += map.effects.col(static_cast<Index>(i)).abs();
      }
      value(alpha, at_corner);
      for (Index row = 0; row < sum.size(); ++row) {
        if (!(std::abs(at_corner[row] - sum[row]) <= field_accuracy * terms[row])) return std::nullopt;
      }
    }
  }
  return map;
}

}  // namespace saltus::switching
