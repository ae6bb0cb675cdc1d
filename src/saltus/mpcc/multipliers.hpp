// Multipliers of a problem with complementarities.
#pragma once

#include "saltus/linalg/matrix.hpp"

namespace saltus::mpcc {

/// Holds multipliers of L = f + rows'g + lower'(l - w) + upper'(w - u) - G'G - H'H, lower and upper >= 0.
struct Multipliers {
  linalg::Vector rows, lower, upper, G, H;
};

}  // namespace saltus::mpcc
