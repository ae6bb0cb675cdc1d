// An impact of contacts that all touch.
#pragma once

#include <optional>

#include "saltus/event_integrator/contact/contact_point.hpp"
#include "saltus/linalg/matrix.hpp"

namespace saltus::event_integrator {

/// Returns the impulses of all contacts of a point; see impact().
[[nodiscard]] std::optional<linalg::Vector> impact_of_all(const ContactPoint& point, std::optional<int> pushed);

}  // namespace saltus::event_integrator
