// What people call a quantity: shown beside its numbers, not computed with.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace saltus::result {

struct Caption {
  std::string unit;   ///< any text
  std::string label;  ///< says what the name stands for
};

/// By the name of the state, control, parameter or output; those that have none are absent.
using Captions = std::vector<std::pair<std::string, Caption>>;

/// Returns the caption of a name; an empty one if it has none.
[[nodiscard]] inline Caption caption_of(const Captions& captions, const std::string& name) {
  for (const auto& [captioned, caption] : captions) {
    if (captioned == name) return caption;
  }
  return {};
}

}  // namespace saltus::result
