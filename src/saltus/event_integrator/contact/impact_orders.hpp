// Where impacts of several contacts end if they follow each other.
#pragma once

#include <optional>
#include <vector>

#include "saltus/event_integrator/contact/contact_point.hpp"
#include "saltus/linalg/matrix.hpp"

namespace saltus::event_integrator {

/// Holds where impacts end that follow each other, and where they end together: in the velocity that differs most.
struct OtherEnd {
  std::vector<int> order;  ///< contacts, of the first impacts
  bool are_more = false;   ///< impacts than those
  int contact = 0;
  std::optional<int> tangent;  ///< none: the rate of its gap
  double velocity = 0.0, together = 0.0;
};

/// Compares impulses of all contacts at once with those of one contact behind the other, each until it closes no more.
/// That is done in all orders of up to three contacts; of more, each of those that close is the first once. Sequences
/// without an end are followed to their limit. Orders that are too long, or have no limit, say nothing.
///
/// @param touching  contacts whose gap is 0
/// @param impulses  r, of the process of all contacts
/// @return nothing where velocities behind all orders agree to nine digits
[[nodiscard]] std::optional<OtherEnd> find_other_end(const ContactPoint& point, const std::vector<int>& touching,
                                                     const linalg::Vector& impulses);

}  // namespace saltus::event_integrator
