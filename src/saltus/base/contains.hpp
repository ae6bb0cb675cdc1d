// Whether a list has an entry.
#pragma once

#include <algorithm>
#include <iterator>

namespace saltus {

template <class List, class Entry>
[[nodiscard]] bool contains(const List& list, const Entry& entry) {
  return std::find(std::begin(list), std::end(list), entry) != std::end(list);
}

}  // namespace saltus
