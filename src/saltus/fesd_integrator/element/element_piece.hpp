// What a run leaves of its elements.
#pragma once

#include <vector>

#include "saltus/fesd_integrator/element/active_set.hpp"
#include "saltus/fesd_integrator/element/element.hpp"

namespace saltus::fesd_integrator {

/// Holds an element, or a part of one between events that change nothing of it.
struct ElementPiece {
  double begin = 0.0, end = 0.0;
  bool is_first = true;  ///< begins where its element does
  Element element;
  std::vector<double> selections;  ///< at the left end of the element
  ActiveSet set;
  std::vector<ActiveSet> stage_sets;  ///< without switch detection
  std::vector<double> held;
};

}  // namespace saltus::fesd_integrator
