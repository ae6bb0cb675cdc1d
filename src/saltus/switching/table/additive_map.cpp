#include "saltus/switching/table/additive_map.hpp"

#include "saltus/switching/table/field_accuracy.hpp"

namespace saltus::switching {
namespace {

using Eigen::Index;

constexpr std::size_t longest_stride = 4;

}  // namespace

std::optional<AdditiveMap> additive_map(std::size_t q, const OfSelections& value) {
  std::vector<double> alpha(q, 0.0);
  AdditiveMap map;
  value(alpha, map.constant);
  map.effects.resize(map.constant.size(), static_cast<Index>(q));
  Eigen::VectorXd at_corner;
  for (std::size_t i = 0; i < q; ++i) {
    alpha[i] = 1.0;
    value(alpha, at_corner);
    map.effects.col(static_cast<Index>(i)) = at_corner - map.constant;
    alpha[i] = 0.0;
  }
  if (!map.constant.allFinite() || !map.effects.allFinite()) return map;
  for (std::size_t stride = 1; stride <= longest_stride; ++stride) {
    for (std::size_t first = 0; first < stride && first < q; ++first) {
      Eigen::VectorXd sum = map.constant, terms = map.constant.cwiseAbs();
      alpha.assign(q, 0.0);
      for (std::size_t i = first; i < q; i += stride) {
        alpha[i] = 1.0;
        sum += map.effects.col(static_cast<Index>(i));
        terms += map.effects.col(static_cast<Index>(i)).cwiseAbs();
      }
      value(alpha, at_corner);
      if (!((at_corner - sum).cwiseAbs().array() <= field_accuracy * terms.array()).all()) return std::nullopt;
    }
  }
  return map;
}

}  // namespace saltus::switching
