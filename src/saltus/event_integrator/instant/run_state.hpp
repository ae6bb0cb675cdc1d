// What a run is made of at one time.
#pragma once

#include <limits>
#include <string>

#include "saltus/event_integrator/contact/contacts.hpp"
#include "saltus/event_integrator/decide/transition.hpp"
#include "saltus/event_integrator/field/mode_field.hpp"
#include "saltus/event_integrator/jumps/holding.hpp"
#include "saltus/event_integrator/jumps/jumps.hpp"
#include "saltus/event_integrator/mode/position.hpp"
#include "saltus/event_integrator/options.hpp"
#include "saltus/event_integrator/point/ledger.hpp"
#include "saltus/event_integrator/record/output_rows.hpp"
#include "saltus/event_integrator/record/recorder.hpp"
#include "saltus/event_integrator/search/cells.hpp"
#include "saltus/event_integrator/search/event_search.hpp"
#include "saltus/event_integrator/search/user_events.hpp"
#include "saltus/event_integrator/steps/step_tolerances.hpp"
#include "saltus/result/result.hpp"

namespace saltus::event_integrator {

/// RunState holds what a motion depends on between two instants, and what is written of it: the position with its mode,
/// the field and the functions of that, cells, jumps, contacts, guards at rest, and the recording. Steps move it along
/// the mode; Resolver makes it the next one.
struct RunState {
  RunState(evaluation::ModelKernel& kernel, const IntegrationOptions& options);
  RunState(const RunState&) = delete;
  RunState& operator=(const RunState&) = delete;

  evaluation::ModelKernel& kernel;
  const IntegrationOptions& options;
  SwitchingContext switching;
  ModeField field;
  Position here;
  StepTolerances tolerances;
  Cells cells;
  Ledger ledger;
  EventSearch search;
  UserEvents user_events;
  Jumps jumps;
  Contacts contacts;
  Holding holding;
  Recorder recorder;
  OutputRows rows;
  result::Status status = {};
  bool running = true;
  double last_event = -std::numeric_limits<double>::infinity();  ///< time of the last one that was recorded

  /// Evaluates the field here, and takes the selections of what slides; where these are 0/0 in the last bit, as both
  /// fields are tangent, those that the mode began with are as good.
  void evaluate_here();
  /// Ends the run here.
  void end(result::Termination termination, std::string message);
  /// Writes a row in the mode here.
  void row(double t, const std::vector<double>& x) { rows.write(t, x); }
  [[nodiscard]] double span() const { return options.until - options.from; }
  /// Returns the time and what is slid on, for messages.
  [[nodiscard]] std::string where() const;
  [[nodiscard]] ContactMoment contact_moment() const {
    return {here.t, here.state.alpha, here.time_scale, tolerances.mode()};
  }
};

}  // namespace saltus::event_integrator
