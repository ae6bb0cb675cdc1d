#include "saltus/event_integrator/instant/run_state.hpp"

#include <utility>

#include <fmt/format.h>

#include "saltus/base/at.hpp"
#include "saltus/event_integrator/mode/small_internal.hpp"

namespace saltus::event_integrator {

RunState::RunState(evaluation::ModelKernel& model, const IntegrationOptions& wanted)
    : kernel(model),
      options(wanted),
      switching{kernel, kernel.layout().affine_in_selections, options.selection, options.scaling},
      field(kernel, switching.affine_in_alpha),
      here(options.from, kernel.initial_state()),
      tolerances(options.tolerances),
      cells(kernel),
      ledger(kernel),
      search(kernel, field, ledger, options.method, tolerances.step()),
      user_events(kernel),
      jumps(kernel, {options.from, options.until, options.begun}),
      contacts(kernel),
      holding(kernel),
      recorder(kernel),
      rows(kernel, options, here, field, holding, recorder) {
  holding.keep(&contacts);
}

void RunState::evaluate_here() {
  field(here.t, here.x.data(), here.slope.data());
  if (!here.state.sliding.empty() && is_finite(field.alpha())) here.state.alpha = field.alpha();
}

void RunState::end(result::Termination termination, std::string message) {
  status.termination = termination;
  status.message = std::move(message);
  running = false;
}

std::string RunState::where() const {
  std::string text;
  for (const int j : here.state.sliding) {
    text += (text.empty() ? "" : ", ") + switching.layout.surfaces[at(j)].name;
  }
  return fmt::format("t = {:.17g}{}", here.t, text.empty() ? "" : " while sliding on " + text);
}

}  // namespace saltus::event_integrator
