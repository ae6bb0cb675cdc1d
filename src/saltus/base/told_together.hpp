// Warnings of one kind as one.
#pragma once

#include <string>
#include <vector>

namespace saltus {

/// Returns the texts. Of several that differ in places and first names in quotes there is the first one, with the count
/// of the others: "parameter 'a' is never used (and 3 more like it: 'b', 'c', 'd')".
[[nodiscard]] std::vector<std::string> told_together(const std::vector<std::string>& texts);

}  // namespace saltus
