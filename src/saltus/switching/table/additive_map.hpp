// Whether selections enter additively, and what each of them adds.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "saltus/linalg/matrix.hpp"

namespace saltus::switching {

/// Holds value(alpha) = constant + effects alpha for alpha in [0, 1]^q.
struct AdditiveMap {
  linalg::Vector constant;  ///< r
  linalg::Matrix effects;   ///< r x q
};

/// What depends on q selections: a field, or velocities of switching functions.
using OfSelections = std::function<void(const std::vector<double>& alpha, linalg::Vector& value)>;

/// Asks at alpha = 0 and at each selection alone. Then it asks at corners with ones at every second, third, fourth
/// place, from each of the first ones on, and everywhere. Products of selections show in these.
/// @param q  number of selections
/// @return   nullopt where selections multiply each other; not finite where a value is not. Cost: q + 11 values.
[[nodiscard]] std::optional<AdditiveMap> additive_map(std::size_t q, const OfSelections& value);

}  // namespace saltus::switching
