// Which surfaces differ between two modes: two that follow each other differ in one or two of however many.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <vector>

namespace saltus::event_integrator {

/// Calls visit(j) for every j at which two modes, or the selections of two, of the same surfaces, differ; ascending.
/// Cost: a comparison of memory.
template <class Number, class Visit>
void for_each_difference(const std::vector<Number>& a, const std::vector<Number>& b, Visit&& visit) {
  constexpr std::size_t block = 64;
  for (std::size_t begin = 0; begin < a.size(); begin += block) {
    const std::size_t end = std::min(begin + block, a.size());
    if (std::memcmp(a.data() + begin, b.data() + begin, (end - begin) * sizeof(Number)) == 0) continue;
    for (std::size_t j = begin; j < end; ++j) {
      if (std::memcmp(&a[j], &b[j], sizeof(Number)) != 0) visit(j);
    }
  }
}

/// Calls visit(j) for every entry that is not 0, ascending.
template <class Visit>
void for_each_nonzero(const std::vector<int>& entries, Visit&& visit) {
  constexpr std::size_t block = 32;
  for (std::size_t begin = 0; begin < entries.size(); begin += block) {
    const std::size_t end = std::min(begin + block, entries.size());
    int any = 0;
    for (std::size_t j = begin; j < end; ++j) any |= entries[j];  // vectorises: no branch
    if (any == 0) continue;
    for (std::size_t j = begin; j < end; ++j) {
      if (entries[j] != 0) visit(j);
    }
  }
}

}  // namespace saltus::event_integrator
