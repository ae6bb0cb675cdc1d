#include <fmt/format.h>

#include "saltus/base/contains.hpp"
#include "saltus/io/impulse_columns_internal.hpp"

namespace saltus::io {

ImpulseColumns::ImpulseColumns(const result::Result& result) {
  for (std::size_t i = 0; i < result.contacts.size(); ++i) {
    const auto& contact = result.contacts[i];
    const auto has = [&](const char* tangent) {
      return contains(result.outputs, fmt::format("friction({}){}", contact, tangent));
    };
    const std::size_t tangents = has("[2]") ? 2 : has("") ? 1 : 0;
    for (std::size_t entry = 0; entry <= tangents; ++entry) {
      const std::string name = fmt::format("impulse({})", contact);
      names.push_back(entry == 0 ? name : fmt::format("{}[{}]", name, entry));
      places.emplace_back(i, entry);
    }
  }
}

std::optional<double> ImpulseColumns::value(const result::Events& events, std::size_t event, std::size_t column) const {
  if (events.kind(event) != result::EventKind::impact) return std::nullopt;
  const auto impulse = events[event].impulse;
  const auto [contact, entry] = places[column];
  return impulse ? std::optional((*impulse)[contact][entry]) : std::nullopt;
}

}  // namespace saltus::io
