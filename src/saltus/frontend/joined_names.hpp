// Columns of tables that become one: some of them are in a part of the tables only.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <unordered_map>
#include <vector>

namespace saltus::frontend {

/// Holds all names of several lists, each once, in the order in which they come first.
class JoinedNames {
 public:
  static constexpr std::size_t missing = static_cast<std::size_t>(-1);

  void add(const std::vector<std::string>& names) {
    if (names == all_) return;
    for (const auto& name : names) {
      if (place_.emplace(name, all_.size()).second) all_.push_back(name);
    }
  }
  [[nodiscard]] const std::vector<std::string>& all() const { return all_; }
  /// Returns of each name where it stands in one of the lists, or `missing`.
  [[nodiscard]] std::vector<std::size_t> places_in(const std::vector<std::string>& names) const {
    std::vector<std::size_t> places(all_.size(), missing);
    for (std::size_t i = 0; i < names.size(); ++i) {
      const auto found = place_.find(names[i]);
      if (found != place_.end()) places[found->second] = std::min(places[found->second], i);
    }
    return places;
  }

 private:
  std::vector<std::string> all_;
  std::unordered_map<std::string, std::size_t> place_;
};

}  // namespace saltus::frontend
