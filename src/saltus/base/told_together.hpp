// Warnings of one kind as one.
#pragma once

#include <string>
#include <vector>

namespace saltus {

/// Returns the texts. Of several that differ in numbers and names in quotes only there is the first one, with the count
/// of the others: "parameter 'a' is never used (and 2 more like it: 'b', 'c')".
[[nodiscard]] std::vector<std::string> told_together(const std::vector<std::string>& texts);

}  // namespace saltus
