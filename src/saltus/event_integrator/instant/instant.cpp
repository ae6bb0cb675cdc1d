#include "saltus/event_integrator/instant/instant.hpp"

namespace saltus::event_integrator {

void Outcome::begin() {
  cell_change = CellChange::none;
  released = jumped = switched = by_one_surface = evaluated = listed_only = false;
  switching_point.touched.clear();
  last_bounces.clear();
  freed.clear();
}

}  // namespace saltus::event_integrator
