// Friction of rows that depend on each other: which forces hold, and which follow from them.
#pragma once

#include <vector>

#include "saltus/event_integrator/contact/contact_forces.hpp"

namespace saltus::event_integrator {

/// Returns tangential rows of sticking contacts whose forces may keep their share of the friction cone, lambda_T =
/// share friction lambda_N. They are as many as forces are open: with the rows that are held they determine all forces.
/// Cost: a null space, and k^2 operations for each row, where k are open.
[[nodiscard]] std::vector<int> rows_that_follow(const ContactPoint& point, const std::vector<int>& resting,
                                                const ContactForces& found);

}  // namespace saltus::event_integrator
