// Linear equations by few numbers that are not negative.
#pragma once

#include "saltus/linalg/matrix.hpp"

namespace saltus::switching {

/// Returns the x >= 0 with the least |A x - b|, by the active sets of Lawson and Hanson [lawson1974]. The columns of
/// its entries that are not 0 are independent; shorter columns are taken before longer ones.
/// Cost: a least-squares problem for each of these, and for each that is left again.
[[nodiscard]] linalg::Vector nonnegative_solution(const linalg::Matrix& A, const linalg::Vector& b);

}  // namespace saltus::switching
