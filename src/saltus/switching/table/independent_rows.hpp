// Which of several conditions say something that those before them do not.
#pragma once

#include <cstddef>
#include <vector>

#include "saltus/linalg/matrix.hpp"

namespace saltus::switching {

/// What gradients leave of another one, relative to it, where it is one of their combinations but for rounding:
/// gradients by differences are good to ten digits, and surfaces that touch have gradients that nearly agree.
inline constexpr double dependent_part = 1e-6;

/// Returns the rows of J (one per condition) that those chosen before them leave more of than `dependent_part`,
/// ascending: a basis of all rows. Rows of zeros are in none.
/// @param gradients  J, m x n
/// Cost: m^2 n.
[[nodiscard]] std::vector<std::size_t> independent_rows(const linalg::Matrix& gradients);

}  // namespace saltus::switching
