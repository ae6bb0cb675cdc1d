// Lists as sets.
#pragma once

#include <algorithm>
#include <vector>

namespace saltus {

/// Sorts, ascending, and keeps one of equal entries.
template <class Entry>
void drop_repeats(std::vector<Entry>& entries) {
  std::sort(entries.begin(), entries.end());
  entries.erase(std::unique(entries.begin(), entries.end()), entries.end());
}

}  // namespace saltus
