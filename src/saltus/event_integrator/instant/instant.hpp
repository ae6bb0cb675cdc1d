// What a run comes to at one time, and what has come of it.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "saltus/event_integrator/accumulate/accumulation.hpp"
#include "saltus/event_integrator/decide/transition.hpp"
#include "saltus/event_integrator/jumps/holding.hpp"
#include "saltus/event_integrator/record/output_rows.hpp"
#include "saltus/event_integrator/search/cells.hpp"
#include "saltus/event_integrator/search/locate.hpp"

namespace saltus::event_integrator {

/// Holds what a run comes to at one time, before anything is decided. The state is there already.
struct Instant {
  enum class Cause : std::int8_t {
    zeros,              ///< functions vanish
    due,                ///< jumps are due
    departure,          ///< the mode is left as a member of a family
    limit_of_jumps,     ///< of a sequence of jumps that accumulate
    limit_of_switches,  ///< of a sequence of switches
    given               ///< the mode begins anew, with zeros that are known; no event
  };
  Cause cause = Cause::zeros;
  const Located* located = nullptr;    ///< of zeros
  SeriesLimit limit = {};              ///< of limits
  std::vector<HeldGuard> guards = {};  ///< of limits of jumps: those that are left at 0 there
  double rate = 0.0;                   ///< of limits of jumps: the largest |dg/dt| of these when they were at 0 last
  bool of_contacts = false;            ///< of limits of jumps: gaps close there
  Transition transition = {};      ///< of departures, limits of switches, and where it is given: into the mode behind
  std::vector<double> x = {};      ///< of limits: on the surfaces that meet there
  std::vector<int> surfaces = {};  ///< of limits of switches: those that do
  bool row_is_written = false;     ///< that before it

  [[nodiscard]] bool is_limit() const { return cause == Cause::limit_of_jumps || cause == Cause::limit_of_switches; }
};

/// Holds what was before an instant, and what has happened there.
struct Outcome {
  ModeState before;  ///< the mode before it
  ModeState slid;    ///< that mode with what a released guard has kept at zero slid on
  std::vector<double> x_before;
  std::vector<long> cells_before;
  long events_before = 0;  ///< recorded before it
  OutputRows::Arrival row = OutputRows::Arrival::missing;
  CellChange cell_change = CellChange::none;
  bool released = false;          ///< guards at rest were
  bool jumped = false;            ///< jumps were executed, or contacts began anew
  bool switched = false;          ///< a switch was decided, and its mode entered
  bool by_one_surface = false;    ///< that was decided by one surface alone
  bool evaluated = false;         ///< the field of the mode behind it, where that begins, and nothing since
  bool listed_only = false;       ///< zeros of [[events]], which change nothing
  std::vector<int> last_bounces;  ///< jumps of contacts that end in it
  std::vector<int> freed;         ///< surfaces that a guard has kept at zero, which it has released
  SwitchingPoint switching_point;
  Transition transition;
  std::optional<SpiralStart> spiral;  ///< of the mode that it begins: time and state jump over the first cycle
  int rooted = -1;                    ///< of that mode: the surface that it leaves along a root

  void begin();
};

}  // namespace saltus::event_integrator
