// Results as a simulation might give them, for the tests of the report and to look at it (scripts/look_at_report.sh).
#pragma once

#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "saltus/result/result.hpp"

namespace saltus::report_samples {

struct Row {
  double t;
  std::vector<double> x;
  result::Mode mode;
  std::vector<double> alpha;
};

inline void add_row(result::Result& result, const Row& row) {
  result.trajectory.t.push_back(row.t);
  result.trajectory.x.push_back(row.x);
  result.trajectory.mode.push_back(row.mode);
  result.trajectory.alpha.push_back(row.alpha);
}

/// The event between two rows at one time, not yet in the result; adds both rows.
inline result::Event event_between(result::Result& result, const Row& before, const Row& after,
                                   const std::string& reason) {
  add_row(result, before);
  add_row(result, after);
  result::Event event;
  event.t = before.t;
  event.kind = result::kind_of_switch(before.mode, after.mode);
  for (std::size_t j = 0; j < before.mode.size(); ++j) {
    if (before.mode[j] != after.mode[j]) event.surfaces.push_back(result.switching_functions[j]);
  }
  event.mode_before = before.mode;
  event.mode_after = after.mode;
  event.alpha_before = before.alpha;
  event.alpha_after = after.alpha;
  event.x = before.x;
  event.x_after = after.x;
  event.reason = reason;
  return event;
}

inline void add_event(result::Result& result, const Row& before, const Row& after, const std::string& reason) {
  result.events.push_back(event_between(result, before, after, reason));
}

/// Changes one event of a result.
template <class Change>
void change_event(result::Result& result, std::size_t number, Change change) {
  std::vector<result::Event> events = result.events;
  change(events[number]);
  result.events = events;
}

inline void finish(result::Result& result) {
  const auto& trajectory = result.trajectory;
  std::vector<double> outputs;
  if (!trajectory.outputs.empty()) outputs = trajectory.outputs.back();
  result.final = {trajectory.t.back(), trajectory.x.back(), trajectory.mode.back(), trajectory.alpha.back(), outputs};
  result.status.time_reached = trajectory.t.back();
  result.statistics = {812, 37, 5904, 0.0031};
  result.options = {{"simulate.until", trajectory.t.back()},
                    {"simulate.from", trajectory.t.front()},
                    {"simulate.method", std::string("event")},
                    {"simulate.rtol", 1e-8},
                    {"simulate.atol", 1e-10},
                    {"simulate.output", std::vector<double>{0.0, 0.25, 0.5, 0.75, 1.0, 1.25, 1.5, 1.75}},
                    {"simulate.max_steps", std::int64_t{1000000}},
                    {"simulate.event.integrator", std::string("dopri5")}};
}

/// A block on a belt that moves with 0.2, in closed form: it sticks up to q = 1, then slides back under friction 0.4
/// until it has the velocity of the belt again. Two events per period.
inline result::Result stick_slip(std::size_t events, std::size_t rows_per_phase) {
  result::Result result;
  result.model = {"stick-slip",
                  "Block on a moving belt, held by a spring; friction falls from 1 at rest to 0.4.",
                  "9f86d081884c7d659a2feaa0c55ad015a3bf4f1b2b0b822cd15d6c15b0f00a08",
                  {{"mu_s", 1.0}, {"mu_d", 0.4}}};
  result.states = {"q", "v"};
  result.switching_functions = {"slip"};
  const double belt = 0.2, start = -0.2, phase = std::atan2(belt, 0.6);
  double t = 0.0, q = start;
  Row last{t, {q, belt}, {0}, {0.5 * (1.0 + q)}};
  add_row(result, last);
  for (std::size_t k = 0; k < events; ++k) {
    const bool sticks = k % 2 == 0;
    // Slip: q = 0.4 + a cos(s - phase), v = -a sin(s - phase); v = 0.2 at s = 0 and at s = pi + 2 phase.
    const double a = std::hypot(0.6, belt);
    const double duration = sticks ? (1.0 - q) / belt : std::acos(-1.0) + 2.0 * phase;
    const double q0 = q;
    for (std::size_t i = 1; i <= rows_per_phase; ++i) {
      const double s = duration * static_cast<double>(i) / static_cast<double>(rows_per_phase);
      last.t = t + s;
      last.x = sticks ? std::vector<double>{q0 + belt * s, belt}
                      : std::vector<double>{0.4 + a * std::cos(s - phase), -a * std::sin(s - phase)};
      last.mode = {sticks ? 0 : -1};
      last.alpha = {sticks ? 0.5 * (1.0 + last.x[0]) : 0.0};
      if (i < rows_per_phase) add_row(result, last);
    }
    t = last.t;
    q = last.x[0];
    const Row after{t, last.x, {sticks ? -1 : 0}, {sticks ? 0.0 : 0.5 * (1.0 + q)}};
    add_event(result, last, after, sticks ? "alpha reached 1 and leaves [0, 1]" : "both fields point to the surface");
  }
  add_row(result, {t + 0.3, result.trajectory.x.back(), result.trajectory.mode.back(), result.trajectory.alpha.back()});
  finish(result);
  return result;
}

/// One state without switching functions, no events.
inline result::Result decay() {
  result::Result result;
  result.model.name = "decay";
  result.states = {"x"};
  for (int i = 0; i <= 200; ++i) add_row(result, {0.05 * i, {std::exp(-0.05 * i)}, {}, {}});
  finish(result);
  return result;
}

/// Twelve states of different size, four switching functions that cross at different times, two outputs, two inputs.
inline result::Result twelve_states() {
  result::Result result;
  result.model = {"gene-network", "Twelve concentrations with four thresholds.", "", {{"k1", 0.1}, {"k2", 3.25e-7}}};
  result.switching_functions = {"x1-0.4", "x2-0.3", "threshold_three", "relative_velocity_of_block_2"};
  result.outputs = {"power", "energy"};
  result.controls = {"u", "brake"};
  for (int i = 1; i <= 12; ++i) result.states.push_back("x" + std::to_string(i));
  const auto row_at = [](double t) {
    Row row{t, {}, {}, {}};
    for (int i = 0; i < 12; ++i) row.x.push_back((i < 8 ? 1.0 : 250.0) * std::sin(t * (1.0 + 0.1 * i)) + 0.1 * i);
    for (int j = 0; j < 4; ++j) {
      const double phase = std::fmod(t * (0.5 + 0.2 * j), 3.0);
      row.mode.push_back(phase < 1.0 ? -1 : (phase < 2.0 ? 1 : 0));
      row.alpha.push_back(row.mode.back() == 0 ? phase - 2.0 : 0.5 * (1.0 + row.mode.back()));
    }
    return row;
  };
  Row last = row_at(0.0);
  for (int i = 0; i <= 3000; ++i) {
    const Row row = row_at(0.01 * i);
    if (i > 0 && row.mode != last.mode) {
      Row before = row;
      before.mode = last.mode;
      before.alpha = last.alpha;
      add_event(result, before, row, "threshold passed");
    } else {
      add_row(result, row);
    }
    last = row;
  }
  for (const double t : result.trajectory.t) {
    result.trajectory.outputs.push_back({std::sin(t) * std::cos(3 * t), std::exp(-0.1 * t)});
    result.trajectory.u.push_back({std::floor(t / 5.0) - 2.0, t < 12.0 ? 0.0 : 1.0});
  }
  finish(result);
  return result;
}

/// Stops early with NaN; names that would break out of HTML or of a script, jumps, an event that is not unique.
inline result::Result failed() {
  result::Result result;
  result.model = {"<b>bad</b> & \"odd\" </script><!-- κόσμος",
                  "Ends early. <img src=x onerror=alert(1)> </ScRiPt><script>alert(2)</script> naïve Ω \xff",
                  "",
                  {}};
  result.states = {"höhe<z>", "v&w"};
  result.switching_functions = {"z<0 & v>\"0\"", "ψ₂"};
  const double nan = std::numeric_limits<double>::quiet_NaN();
  double z = 1.0, v = 0.0, t = 0.0;
  result::Mode mode{1, -1};
  std::vector<double> alpha{1.0, 0.0};
  for (int i = 0; i < 900; ++i) {
    t = 0.005 * i;
    v -= 0.05;
    z += 0.005 * v;
    if (z < 0.0 && v < 0.0) {
      const double after = -0.8 * v;
      auto event =
          event_between(result, {t, {z, v}, mode, alpha}, {t, {z, after}, mode, alpha}, "<i>restitution</i> 0.8");
      event.kind = result::EventKind::jump;
      event.surfaces = {"ground & floor"};
      result.events.push_back(event);
      v = after;
    } else if (i == 300) {
      auto event = event_between(result, {t, {z, v}, mode, alpha}, {t, {z, v}, {0, -1}, {0.25, 0.0}},
                                 "active_dominant: kept the slow motion");
      event.unique = false;
      event.alternatives = {{{1, -1}, {1.0, 0.0}}, {{-1, 0}, {0.0, nan}}};
      result.events.push_back(event);
      mode = {0, -1};
      alpha = {0.25, 0.0};
    } else if (i == 500) {
      auto event = event_between(result, {t, {z, v}, mode, alpha}, {t, {z, v}, {1, 1}, {1.0, 1.0}},
                                 "more than three coupled surfaces");
      event.unique = std::nullopt;
      result.events.push_back(event);
      mode = {1, 1};
      alpha = {1.0, 1.0};
    } else {
      add_row(result, {t, {z, v}, mode, alpha});
    }
  }
  add_row(result, {t + 0.005, {nan, std::numeric_limits<double>::infinity()}, mode, {nan, 1.0}});
  finish(result);
  result.status.termination = result::Termination::evaluation_failed;
  result.status.message = "The right-hand side of 'v&w' is not finite at t = 4.5 <br>; check sqrt(z) for z < 0.";
  return result;
}

/// Stops before the first row.
inline result::Result nothing() {
  result::Result result;
  result.states = {"x", "y"};
  result.switching_functions = {"psi"};
  result.status.termination = result::Termination::no_admissible_mode;
  result.status.message = "No mode continues the start.";
  return result;
}

/// Stick-slip with one row that sticks out, in many rows.
inline result::Result many_rows(std::size_t rows) {
  result::Result result = stick_slip(40, rows / 40);
  result.model.name = "many rows";
  result.trajectory.x.change(rows / 3)[1] = 25.0;
  return result;
}

/// A relay with more switches than anybody can look at one by one.
inline result::Result many_events(std::size_t events) {
  result::Result result = stick_slip(events, 4);
  result.model.name = "many events";
  change_event(result, events / 2, [](result::Event& event) { event.unique = false; });
  return result;
}

}  // namespace saltus::report_samples
