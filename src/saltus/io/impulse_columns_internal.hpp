// Columns of the impulses of contacts in tables of events.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "saltus/result/result.hpp"

namespace saltus::io {

/// Holds their names, impulse(contact) and impulse(contact)[k] along tangent k, and where their values are.
struct ImpulseColumns {
  explicit ImpulseColumns(const result::Result& result);

  /// Returns a column of an event, by their numbers; nothing where there is no impact.
  [[nodiscard]] std::optional<double> value(const result::Events& events, std::size_t event, std::size_t column) const;

  std::vector<std::string> names;
  std::vector<std::pair<std::size_t, std::size_t>> places;  ///< contact, and entry of its impulse
};

}  // namespace saltus::io
