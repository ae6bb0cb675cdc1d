#include "saltus/switching/sparse/influence.hpp"

#include <algorithm>
#include <cstddef>

#include "saltus/base/at.hpp"

namespace saltus::switching {
namespace {

/// Tarjan's search with a stack of its own: a chain may be as long as there are surfaces.
class PartSearch {
 public:
  explicit PartSearch(const Influence& influence)
      : influence_(influence),
        number_(influence.size(), -1),
        low_(influence.size(), 0),
        is_open_(influence.size(), false) {}

  std::vector<std::vector<int>> run() {
    for (std::size_t first = 0; first < influence_.size(); ++first) {
      if (number_[first] >= 0) continue;
      enter(static_cast<int>(first));
      while (!path_.empty()) advance();
    }
    return std::move(parts_);
  }

 private:
  struct Place {
    int surface = 0;
    std::size_t next = 0;  ///< in its list
  };

  void enter(int surface) {
    number_[at(surface)] = low_[at(surface)] = count_++;
    is_open_[at(surface)] = true;
    open_.push_back(surface);
    path_.push_back({surface, 0});
  }

  void advance() {
    auto& [surface, next] = path_.back();
    const auto& felt = influence_[at(surface)];
    if (next < felt.size()) {
      const int other = felt[next++];
      if (number_[at(other)] < 0) return enter(other);
      if (is_open_[at(other)]) low_[at(surface)] = std::min(low_[at(surface)], number_[at(other)]);
      return;
    }
    const int left = surface;
    path_.pop_back();
    if (!path_.empty()) {
      int& low = low_[at(path_.back().surface)];
      low = std::min(low, low_[at(left)]);
    }
    if (low_[at(left)] == number_[at(left)]) close(left);
  }

  /// What a surface depends on has been closed before it.
  void close(int first) {
    std::vector<int> part;
    int surface = -1;
    do {
      surface = open_.back();
      open_.pop_back();
      is_open_[at(surface)] = false;
      part.push_back(surface);
    } while (surface != first);
    std::sort(part.begin(), part.end());
    parts_.push_back(std::move(part));
  }

  const Influence& influence_;
  int count_ = 0;
  std::vector<int> number_, low_, open_;
  std::vector<bool> is_open_;
  std::vector<Place> path_;
  std::vector<std::vector<int>> parts_;
};

}  // namespace

std::vector<std::vector<int>> ordered_parts(const Influence& influence) { return PartSearch(influence).run(); }

std::vector<int> selection_colours(const Influence& influence) {
  const std::size_t m = influence.size();
  std::vector<std::vector<int>> felt_by(m);
  const auto row_of = [&](std::size_t i) {
    auto row = influence[i];
    const auto place = std::lower_bound(row.begin(), row.end(), static_cast<int>(i));
    if (place == row.end() || *place != static_cast<int>(i)) row.insert(place, static_cast<int>(i));
    return row;
  };
  std::vector<std::vector<int>> rows(m);
  for (std::size_t i = 0; i < m; ++i) {
    rows[i] = row_of(i);
    for (const int j : rows[i]) felt_by[at(j)].push_back(static_cast<int>(i));
  }
  std::vector<int> colour(m, -1);
  std::vector<std::size_t> taken_for(m + 1, m);
  for (std::size_t j = 0; j < m; ++j) {
    for (const int i : felt_by[j]) {
      for (const int other : rows[at(i)]) {
        if (colour[at(other)] >= 0) taken_for[at(colour[at(other)])] = j;
      }
    }
    int free = 0;
    while (taken_for[at(free)] == j) ++free;
    colour[j] = free;
  }
  return colour;
}

Influence restricted_to(const Influence& influence, const std::vector<int>& part) {
  std::vector<int> place(influence.size(), -1);
  for (std::size_t k = 0; k < part.size(); ++k) place[at(part[k])] = static_cast<int>(k);
  Influence result(part.size());
  for (std::size_t k = 0; k < part.size(); ++k) {
    for (const int other : influence[at(part[k])]) {
      if (place[at(other)] >= 0) result[k].push_back(place[at(other)]);
    }
  }
  return result;
}

}  // namespace saltus::switching
