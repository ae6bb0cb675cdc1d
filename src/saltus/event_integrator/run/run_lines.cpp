// Rows between steps, which keep straight lines between rows close to the solution.
#include <algorithm>
#include <cmath>

#include "saltus/event_integrator/run/run_internal.hpp"

namespace saltus::event_integrator {

/// Whether straight lines may be too far from the last attempt, without looking at it closely.
bool Run::may_bend() {
  auto& rows = *line_rows_;
  if (kernel_.controls() > 0 || kernel_.outputs() > 0 || !state_.sliding.empty()) return true;
  // The bounds of a series may be those of its ends, however it bends between them.
  if (stepper_.method() == ode::Method::taylor) return true;
  rows.low.resize(x_.size());
  rows.high.resize(x_.size());
  if (!stepper_.bounds(rows.low.data(), rows.high.data())) return true;
  for (std::size_t i = 0; i < x_.size(); ++i) {
    const double end = stepper_.x_new()[i];
    rows.ranges.widen(i, end);
    // The bounds are those of the chord, widened by the other terms.
    const double bend = std::max(rows.high[i] - std::max(x_[i], end), std::min(x_[i], end) - rows.low[i]);
    if (bend > rows.ranges.tolerance(i)) return true;
  }
  return false;
}

/// States, inputs, outputs and sliding selections of the step under way.
void Run::columns_at(double theta, double* columns) {
  const double t = dense_.t + theta * dense_.h;
  dense_.evaluate(theta, row_x_.data());
  columns = std::copy(row_x_.begin(), row_x_.end(), columns);
  if (!state_.sliding.empty()) field_(t, row_x_.data(), row_slope_.data());
  const std::vector<double>& alpha = state_.sliding.empty() ? state_.alpha : field_.alpha();
  if (kernel_.controls() > 0) kernel_.inputs(t, alpha.data(), columns);
  columns += kernel_.controls();
  if (kernel_.outputs() > 0) kernel_.outputs(t, row_x_.data(), alpha.data(), columns);
  columns += kernel_.outputs();
  for (std::size_t k = 1; k <= options_.output.selections; ++k) *(columns - k) = std::clamp(*(columns - k), 0.0, 1.0);
  for (const int j : state_.sliding) *columns++ = alpha[at(j)];
}

/// Rows in (t_, t_end), from the dense output of the step under way.
void Run::rows_between_steps(double t_end) {
  auto& [ranges, lines, tolerance, low, high] = *line_rows_;
  const std::size_t first_selection = x_.size() + at(kernel_.controls()) + at(kernel_.outputs());
  const double end = (t_end - dense_.t) / dense_.h;
  // What the end of the step adds to the ranges.
  tolerance.resize(first_selection + state_.sliding.size());
  columns_at(end, tolerance.data());
  const auto column = [&](std::size_t k) {
    return k < first_selection ? k : first_selection + at(state_.sliding[k - first_selection]);
  };
  for (std::size_t k = 0; k < tolerance.size(); ++k) ranges.widen(column(k), tolerance[k]);
  for (std::size_t k = 0; k < tolerance.size(); ++k) tolerance[k] = ranges.tolerance(column(k));
  // Series take steps over whole periods.
  const int parts = dense_.is_series() ? 8 : 2;
  const auto& points =
      lines.points([&](double theta, double* columns) { columns_at(theta, columns); }, end, parts, tolerance);
  for (const double theta : points) {
    const double t = dense_.t + theta * dense_.h;
    if (!(t > t_ && t < t_end)) continue;
    dense_.evaluate((t - dense_.t) / dense_.h, row_x_.data());
    row_inside(t);
  }
}

}  // namespace saltus::event_integrator
