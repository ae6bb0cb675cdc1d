#include "saltus/event_integrator/instant/instant_rows.hpp"

#include <limits>

namespace saltus::event_integrator {
namespace {

constexpr double any_time = -std::numeric_limits<double>::infinity();

/// Whether a selection is another one than before that is no kink: one of time only, which makes no event.
bool selections_jumped(const RunState& run, const ModeState& before) {
  const auto& mode = run.here.state.mode;
  for (std::size_t j = 0; j < mode.size() && j < before.mode.size(); ++j) {
    if (mode[j] != before.mode[j] && !run.switching.layout.surfaces[j].is_kink) return true;
  }
  return false;
}

/// Rows before an event or a restart: at requested times that are this time to rounding, and here.
void rows_before(const InstantContext& c) {
  auto& [run, cascade, out] = c;
  const auto write = [&](double t) { run.recorder.row_before(t, out.x_before, out.before, out.events_before); };
  in_mode_before(c, [&] {
    run.rows.each_before(any_time, run.here.t, write);
    write(run.here.t);
  });
}

/// The row behind an event: the field of the mode behind it was evaluated here, unless something jumps.
void row_behind(const InstantContext& c) {
  auto& [run, cascade, out] = c;
  const Position& here = run.here;
  if (!out.evaluated || out.jumped) return run.row(here.t, here.x);
  run.recorder.row(here.t, here.x, here.state, here.state.sliding.empty() ? here.state.alpha : run.field.alpha());
}

}  // namespace

void in_mode_before(const InstantContext& c, FunctionRef<void()> write) {
  auto& [run, cascade, out] = c;
  const auto cells_behind = run.cells.indices();
  const auto activities_behind = run.contacts.activities();
  run.cells.put(out.cells_before);
  run.kernel.set_activities(out.before.activities);
  write();
  run.cells.put(cells_behind);
  run.kernel.set_activities(activities_behind);
}

void arrive(const InstantContext& c, bool row_is_written) {
  auto& [run, cascade, out] = c;
  run.evaluate_here();
  out.begin();
  out.before = run.here.state;
  out.x_before = run.here.x;
  out.cells_before = run.cells.indices();
  out.events_before = run.recorder.events();
  out.row = row_is_written ? OutputRows::Arrival::written : OutputRows::Arrival::missing;
  run.rows.arrive(out.row);
}

void write_rows(const InstantContext& c) {
  auto& [run, cascade, out] = c;
  const bool event = run.recorder.events() > out.events_before;
  const Position& here = run.here;
  if (event || !run.running) {
    if (out.row == OutputRows::Arrival::missing) rows_before(c);
    if (event) row_behind(c);
  } else if (run.rows.at_steps()) {
    // Inputs and outputs may jump here: their values before and behind.
    const bool jumps =
        out.cell_change == CellChange::jump || (run.rows.asks_for_lines() && selections_jumped(run, out.before));
    if (jumps) rows_before(c);
    run.row(here.t, here.x);
  }
  // A requested time at a restart that is no event still gets its row.
  run.rows.each_until(any_time, here.t, [&](double t) {
    const bool restarts = t == here.t || out.cell_change != CellChange::none;
    if (restarts && !event && !run.rows.at_steps() && run.running) run.row(t, here.x);
  });
  if (event) run.last_event = here.t;
}

void pass_to(RunState& run, double t, const std::vector<double>& x) {
  Position& here = run.here;
  run.rows.each_before(here.t, t, [&](double requested) { run.row(requested, here.x); });
  const bool time_passes = t > here.t;
  here.move_to(t, here.x.data());
  run.rows.skip_here();
  if (time_passes) run.row(here.t, here.x);
  here.move_to(t, x.data());
}

}  // namespace saltus::event_integrator
