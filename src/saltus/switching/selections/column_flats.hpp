// Which columns of a matrix lie in one hyperplane: its matroid's flats of rank r - 1.
#pragma once

#include <optional>
#include <vector>

#include "saltus/linalg/matrix.hpp"

namespace saltus::switching {

/// Returns for each hyperplane that columns span its first basis in lexical order; these in lexical order. Of m points'
/// differences e_i - e_j, for instance, 2^(m-1) - 1 hyperplanes, one for each way to part the points.
/// @param columns  r x q of rank r; of any lengths, since only directions count
/// @return nothing where some rank has more than `most` flats, or a column is not finite
/// Method: flats of rank k + 1 hold those of rank k, and what is outside of one of rank k is parted by those that hold
/// it. Cost: r q (k + q) per flat of rank k; columns within 1e-9 of a span are in it.
[[nodiscard]] std::optional<std::vector<std::vector<linalg::Index>>> column_hyperplanes(const linalg::Matrix& columns,
                                                                                        std::size_t most);

}  // namespace saltus::switching
