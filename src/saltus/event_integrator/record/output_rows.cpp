#include "saltus/event_integrator/record/output_rows.hpp"

#include <algorithm>
#include <span>

#include "saltus/base/at.hpp"
#include "saltus/event_integrator/steps/step_tolerances.hpp"

namespace saltus::event_integrator {

OutputRows::OutputRows(const evaluation::ModelKernel& kernel, const IntegrationOptions& options, const Position& here,
                       ModeField& field, Holding& holding, Recorder& recorder)
    : kernel_(kernel),
      options_(options),
      here_(here),
      field_(field),
      holding_(holding),
      recorder_(recorder),
      x_(here.x.size()),
      slope_(x_.size()) {
  if (options.output.pieces) pieces_.emplace(options.method);
  if (!(options.output.straight > 0.0)) return;
  const std::size_t columns = x_.size() + at(kernel.controls() + kernel.outputs() + kernel.switching_functions());
  const StepTolerances tolerances(options.tolerances);
  lines_.emplace(Lines{ode::ColumnRanges(columns, options.output.straight, tolerances.step())});
  recorder_.widen(lines_->ranges, options.output.selections);
}

std::shared_ptr<const Pieces> OutputRows::take_pieces(const std::vector<double>& row_times) {
  if (!pieces_ || row_times.empty()) return nullptr;
  return std::make_shared<const Pieces>(pieces_->take_from(row_times.front()));
}

void OutputRows::write(double t, const std::vector<double>& x) {
  const bool slides = !here_.state.sliding.empty();
  if (slides) field_(t, x.data(), slope_.data());
  recorder_.row(t, x, here_.state, slides ? field_.alpha() : here_.state.alpha);
}

void OutputRows::write_end_of_step() {
  const bool requested = next_ < times().size() && times()[next_] == here_.t;
  if (requested) ++next_;
  if (here_.t >= options_.until || requested || (at_steps() && !is_too_close(here_.t))) write_here();
}

/// No picture shows rows between events as closely as this, where there are many; files of them grow without end.
bool OutputRows::is_too_close(double t) {
  if (!lines_ || recorder_.rows() < many_rows) return false;
  const double closest = (options_.until - options_.from) / static_cast<double>(many_rows);
  if (t - recorder_.last_row() >= closest) return false;
  if (!thinned_from_) thinned_from_ = recorder_.last_row();
  return true;
}

void OutputRows::write_before(double end, FunctionRef<void(double t, double* x)> curve) {
  each_before(here_.t, end, [&](double t) {
    curve(t, x_.data());
    write_on_surfaces(t);
  });
}

/// The row of x_, not yet on the surfaces of the mode.
void OutputRows::write_on_surfaces(double t) {
  field_.project(t, x_.data());
  static_cast<void>(holding_.project(t, here_.state.alpha, x_));
  write(t, x_);
}

bool OutputRows::may_bend(const ode::Stepper& stepper) {
  auto& rows = *lines_;
  if (kernel_.controls() > 0 || kernel_.outputs() > 0 || !here_.state.sliding.empty()) return true;
  // The bounds of a series may be those of its ends, however it bends between them.
  if (stepper.method() == ode::Method::taylor) return true;
  rows.low.resize(x_.size());
  rows.high.resize(x_.size());
  if (!stepper.bounds(rows.low.data(), rows.high.data())) return true;
  rows.ranges.widen(0, std::span(stepper.x_new(), x_.size()));
  for (std::size_t i = 0; i < x_.size(); ++i) {
    const double begin = here_.x[i], end = stepper.x_new()[i];
    // The bounds are those of the chord, widened by the other terms.
    const double bend = std::max(rows.high[i] - std::max(begin, end), std::min(begin, end) - rows.low[i]);
    if (bend > rows.ranges.tolerance(i)) return true;
  }
  return false;
}

/// States, inputs, outputs and sliding selections of the step under way.
void OutputRows::columns_at(double theta, const ode::DenseStep& dense, double* columns) {
  const double t = dense.t + theta * dense.h;
  dense.evaluate(theta, x_.data());
  columns = std::copy(x_.begin(), x_.end(), columns);
  if (!here_.state.sliding.empty()) field_(t, x_.data(), slope_.data());
  const std::vector<double>& alpha = here_.state.sliding.empty() ? here_.state.alpha : field_.alpha();
  if (kernel_.controls() > 0) kernel_.inputs(t, alpha.data(), columns);
  columns += kernel_.controls();
  if (kernel_.outputs() > 0) kernel_.outputs(t, x_.data(), alpha.data(), columns);
  columns += kernel_.outputs();
  for (std::size_t k = 1; k <= options_.output.selections; ++k) *(columns - k) = std::clamp(*(columns - k), 0.0, 1.0);
  for (const int j : here_.state.sliding) *columns++ = alpha[at(j)];
}

void OutputRows::write_lines(double t_end, const ode::DenseStep& dense) {
  auto& [ranges, points, tolerance, low, high] = *lines_;
  const auto& sliding = here_.state.sliding;
  const std::size_t first_selection = x_.size() + at(kernel_.controls()) + at(kernel_.outputs());
  const double end = (t_end - dense.t) / dense.h;
  // What the end of the step adds to the ranges.
  tolerance.resize(first_selection + sliding.size());
  columns_at(end, dense, tolerance.data());
  const auto column = [&](std::size_t k) {
    return k < first_selection ? k : first_selection + at(sliding[k - first_selection]);
  };
  ranges.widen(0, std::span(tolerance).first(first_selection));
  for (std::size_t k = first_selection; k < tolerance.size(); ++k) ranges.widen(column(k), tolerance[k]);
  for (std::size_t k = 0; k < tolerance.size(); ++k) tolerance[k] = ranges.tolerance(column(k));
  // Stiff steps may have bends that nobody would see, nor wait for.
  constexpr double invisible = 1e-7;
  if (t_end - here_.t <= invisible * (options_.until - options_.from) || is_too_close(t_end)) return;
  // Series take steps over whole periods.
  const int parts = dense.is_series() ? 8 : 2;
  const auto curve = [&](double theta, double* columns) { columns_at(theta, dense, columns); };
  for (const double theta : points.points(curve, end, parts, tolerance)) {
    const double t = dense.t + theta * dense.h;
    if (!(t > here_.t && t < t_end) || is_too_close(t)) continue;
    dense.evaluate((t - dense.t) / dense.h, x_.data());
    write_on_surfaces(t);
  }
}

}  // namespace saltus::event_integrator
