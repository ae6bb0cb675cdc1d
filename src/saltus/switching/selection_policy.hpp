// Which solution is taken where regularised ones have several limits.
#pragma once

namespace saltus::switching {

/// Says which of several continuations is taken where they are limits of regularised solutions.
enum class SelectionPolicy {
  active_dominant,   ///< weight on the surface that was slid on: kappa_active / kappa_passive -> infinity
  passive_dominant,  ///< weight on the surface that is reached
  scaled,            ///< the given kappa: `by_scaling` says where the hidden dynamics has to be asked
  report,            ///< like active_dominant
};

}  // namespace saltus::switching
