// Whether more than one motion follows.
#pragma once

#include <string>

namespace saltus::event_integrator {

/// Says why more than one motion follows.
struct OpenMotion {
  std::string text;           ///< empty if only one does, or nobody knows
  bool is_undecided = false;  ///< there are too many combinations of modes to try them all

  void clear() { *this = {}; }
};

}  // namespace saltus::event_integrator
