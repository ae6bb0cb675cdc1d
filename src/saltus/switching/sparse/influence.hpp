// Which of many surfaces depend on which: an order of deciding them, and which of them can be probed at once.
#pragma once

#include <vector>

namespace saltus::switching {

/// influence[i] lists the surfaces whose selections change the normal component on surface i, ascending; with i itself
/// or without it.
using Influence = std::vector<std::vector<int>>;

/// Returns the surfaces in parts that depend on each other, directly or through others, in an order in which none
/// depends on a later part; each part is ascending. Cost: the entries of `influence` (strongly connected components by
/// Tarjan's search).
[[nodiscard]] std::vector<std::vector<int>> ordered_parts(const Influence& influence);

/// Returns colours 0, 1, … of the selections such that no surface depends on two of one colour, or itself and another
/// one of its own: all selections of a colour can be changed together, and every surface shows the effect of one.
/// Greedy. Cost: for each surface the square of the number that it depends on.
[[nodiscard]] std::vector<int> selection_colours(const Influence& influence);

/// Returns the rows and columns of `part` (ascending), numbered by their places in it.
[[nodiscard]] Influence restricted_to(const Influence& influence, const std::vector<int>& part);

}  // namespace saltus::switching
