// Which parts of a model are undefined, in words.
#pragma once

#include <string>
#include <vector>

#include "saltus/model/layout.hpp"

namespace saltus::event_integrator {

/// Returns the entries of a vector over the states that are not finite, by name: "'v' (nan), 'w' (inf)", the first
/// three of more; empty if all are finite.
[[nodiscard]] std::string undefined_states(const model::Layout& layout, const std::vector<double>& values);

}  // namespace saltus::event_integrator
