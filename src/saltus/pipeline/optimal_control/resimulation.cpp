#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/linalg/factors.hpp"
#include "saltus/linalg/spectra.hpp"
#include "saltus/model/ocp.hpp"
#include "saltus/pipeline/optimal_control/resimulation_internal.hpp"
#include "saltus/pipeline/optimal_control/touching_bodies_internal.hpp"

namespace saltus::pipeline {
namespace {

using event_integrator::Integration;
using event_integrator::IntegrationOptions;
using event_integrator::OutputTimes;
using result::Termination;

/// So small that defects of 1e-9 of the range are those of the solution.
constexpr ode::Tolerances verification_tolerances{1e-10, 1e-12};
/// Of one interval, and of the whole horizon: enough for everything but stiff systems, which are tried again.
constexpr long most_explicit_steps = 100'000;
constexpr long most_resimulated_events = 20'000;
/// Rows to look for violations in, beside those around events.
constexpr std::size_t rows_per_interval = 50;
/// Of the open loop, which is drawn: a page shows no more.
constexpr std::size_t most_drawn_rows = 1000;
/// Of the range of a state: differences of runs to 1e-10 are then known to 1e-5.
constexpr double difference_step = 1e-5;
/// Of an interval: switches so near to its start are there, to what switching times are found to.
constexpr double at_start = 1e-6;
/// Of switching functions that a solution slides on: what its equations leave of them.
constexpr double on_surface = 1e-7;

/// The mode of the solution at the start of interval k, over the columns of the result; nullopt if no event says it.
std::optional<result::Mode> mode_at_start(const OptimizedPath& path, std::size_t k) {
  const double t = path.times[k] + at_start * (path.times[k + 1] - path.times[k]);
  std::optional<result::Mode> mode;
  for (const auto& event : path.events) {
    if (event.t > t) return mode ? mode : event.mode_before;
    if (event.mode_after) mode = event.mode_after;
  }
  return mode;
}

bool starts_in(const Integration& run, const result::Mode& mode) {
  return !run.events.empty() && run.events.front().kind == result::EventKind::start &&
         run.events.front().mode_after == mode;
}

bool is_complete(const Integration& run, const IntegrationOptions& options) {
  // What happens at the end itself, where controls jump, belongs to the next interval, and so do its failures.
  return run.status.termination != Termination::stopped_by_user && run.status.time_reached >= options.until &&
         std::all_of(run.final.x.begin(), run.final.x.end(), [](double value) { return std::isfinite(value); });
}

/// The state of the plan behind a switch of it: where elements have no length the last one.
const std::vector<double>* plan_behind(const OptimizedPath& path, double t, double within) {
  const std::vector<double>* state = nullptr;
  for (const auto& element : path.elements) {
    if (std::abs(element.t - t) <= within) state = &element.x;
  }
  return state;
}

/// The options of the part of a run that ends, or begins, at a time.
IntegrationOptions part_of(IntegrationOptions options, double from, double until) {
  std::erase_if(options.output.times, [&](double t) { return t <= from || t >= until; });
  options.output.times.insert(options.output.times.begin(), from);
  options.output.times.push_back(until);
  options.from = from;
  options.until = until;
  return options;
}

/// One run behind the other; the start of the second one becomes a switch.
Integration joined(Integration first, Integration second) {
  bool is_first = true;
  for (result::Event event : second.events) {
    if (std::exchange(is_first, false)) {
      event.mode_before = first.final.mode;
      if (event.regions_after) event.regions_before = first.final.regions;
    }
    first.events.push_back(std::move(event));
  }
  for (std::size_t row = 0; row < second.trajectory.t.size(); ++row) first.trajectory.append(second.trajectory, row);
  first.final = std::move(second.final);
  first.status = std::move(second.status);
  return first;
}

/// n + 1 times of equal distance.
std::vector<double> equal_times(double from, double until, std::size_t n) {
  std::vector<double> times;
  for (std::size_t i = 0; i <= n; ++i) {
    times.push_back(i == n ? until : from + (until - from) * (static_cast<double>(i) / static_cast<double>(n)));
  }
  return times;
}

}  // namespace

IntegrationOptions resimulation_options(double from, double until, std::size_t rows) {
  IntegrationOptions options;
  options.method = ode::Method::dop853;
  options.tolerances = verification_tolerances;
  options.from = from;
  options.until = until;
  options.max_steps = most_explicit_steps;
  options.max_events = most_resimulated_events;
  options.output.rows = OutputTimes::Rows::at_times;
  options.output.times = equal_times(from, until, rows);
  return options;
}

Resimulation::Resimulation(model::System system, evaluation::ModelKernel kernel, const OptimizedPath& path)
    : system_(std::move(system)), kernel_(std::move(kernel)), path_(&path) {}

Expected<Resimulation> Resimulation::make(const model::System& system, const OptimizedPath& path) {
  model::System controlled = system;
  controlled.parameter_values = path.parameters;
  controlled.events.clear();  // they would stop it
  controlled = model::with_controls(
      std::move(controlled), {path.times.begin(), path.times.begin() + index(path.controls.size())}, path.controls);
  auto kernel = evaluation::ModelKernel::compile(controlled, evaluation::NativeCode::automatic);
  if (!kernel) return tl::unexpected(kernel.error());
  return Resimulation(std::move(controlled), std::move(*kernel), path);
}

Integration Resimulation::run(const IntegrationOptions& options, const std::function<bool()>& is_interrupted) {
  const auto observer = [&](const result::Progress&) {
    return is_interrupted && is_interrupted() ? result::Continue::no : result::Continue::yes;
  };
  auto run = event_integrator::integrate(kernel_, options, observer);
  if (run.status.termination != Termination::iteration_limit || run.statistics.steps < options.max_steps / 2) {
    return run;
  }
  auto stiff = options;
  stiff.method = ode::Method::radau5;
  return event_integrator::integrate(kernel_, stiff, observer);
}

std::vector<std::pair<int, int>> Resimulation::forced_mode(const Integration& run,
                                                           const std::optional<result::Mode>& wanted) const {
  if (run.events.empty() || run.events.front().kind != result::EventKind::start) return {};
  const auto& start = run.events.front();
  if (!wanted || !start.mode_after || *wanted == *start.mode_after) return {};
  const bool is_offered = std::any_of(start.alternatives.begin(), start.alternatives.end(),
                                      [&](const auto& alternative) { return alternative.mode == *wanted; });
  if (!is_offered) return {};
  std::vector<std::pair<int, int>> forced;
  for (std::size_t c = 0; c < wanted->size(); ++c) {
    const auto& column = system_.columns[c];
    if ((*wanted)[c] != (*start.mode_after)[c]) {
      forced.emplace_back(column.function, column.orientation * (*wanted)[c]);
    }
  }
  return forced;
}

/// A surface that repels is left at once by a state that is a rounding beside it.
void Resimulation::put_on_surfaces(double t, const result::Mode& mode, std::vector<double>& x) const {
  const std::vector<double> alpha(at(kernel_.switching_functions()), 0.5);
  std::vector<double> values(at(kernel_.event_functions()));
  kernel_.functions(t, x.data(), alpha.data(), values.data());
  linalg::Matrix rows = linalg::Matrix::zero(index(mode.size()), index(x.size()));
  linalg::Vector beside = linalg::Vector::zero(index(mode.size()));
  std::vector<double> row(x.size());
  for (std::size_t c = 0; c < mode.size(); ++c) {
    const int function = system_.columns[c].function;
    if (mode[c] != 0 || !(std::abs(values[at(function)]) <= on_surface)) continue;
    double rate = 0.0;
    kernel_.gradient(function, t, x.data(), alpha.data(), row.data(), &rate);
    rows.row(index(c)) = linalg::ConstView(row);
    beside[index(c)] = values[at(function)];
  }
  const linalg::Vector change = linalg::least_squares(rows, beside);
  if (!change.all_finite()) return;
  for (std::size_t i = 0; i < x.size(); ++i) x[i] -= change[index(i)];
}

Resimulation::Piece Resimulation::piece(std::vector<double> start, IntegrationOptions options,
                                        const std::optional<result::Mode>& wanted,
                                        const std::function<bool()>& is_interrupted) {
  if (wanted) put_on_surfaces(options.from, *wanted, start);
  kernel_.set_initial_state(start);
  Piece piece{std::move(start), options, {run(options, is_interrupted), false, false}};
  piece.segment.is_complete = is_complete(piece.segment.run, options);
  options.initial_mode = forced_mode(piece.segment.run, wanted);
  if (options.initial_mode.empty()) return piece;
  auto other = run(options, is_interrupted);
  if (is_complete(other, options)) {
    piece.segment = {std::move(other), true, true};
    piece.options = std::move(options);
  }
  return piece;
}

Resimulation::Segment Resimulation::in_pieces(std::size_t k, Piece last, Restart restart,
                                              const std::function<bool()>& is_interrupted) {
  const double rounding = at_start * (path_->times[k + 1] - path_->times[k]);
  IntegrationOptions options = last.options;
  options.initial_mode.clear();  // that of its start
  std::optional<Integration> before;
  std::vector<double> off(path_->nodes[k].size(), 0.0);
  bool was_chosen = last.segment.was_chosen;
  for (const auto& event : path_->events) {
    const bool is_inside = event.t > last.options.from + rounding && event.t < options.until - rounding;
    const auto* planned = plan_behind(*path_, event.t, rounding);
    if (!is_inside || !event.mode_after) continue;
    const auto until_there = part_of(last.options, last.options.from, event.t);
    kernel_.set_initial_state(last.start);
    Integration there = run(until_there, is_interrupted);
    if (!is_complete(there, until_there)) continue;
    Piece next = piece(restart == Restart::at_plan && planned ? *planned : there.final.x,
                       part_of(options, event.t, options.until), event.mode_after, is_interrupted);
    if (!next.segment.is_complete || !starts_in(next.segment.run, *event.mode_after)) continue;
    for (std::size_t i = 0; i < off.size(); ++i) {
      off[i] = std::max(off[i], std::abs(there.final.x[i] - next.start[i]));
    }
    before = before ? joined(std::move(*before), std::move(there)) : std::move(there);
    was_chosen = was_chosen || next.segment.was_chosen;
    last = std::move(next);
  }
  Integration whole = before ? joined(std::move(*before), std::move(last.segment.run)) : std::move(last.segment.run);
  return {std::move(whole), last.segment.is_complete, was_chosen, std::move(off)};
}

Resimulation::Segment Resimulation::from_node(std::size_t k, const IntegrationOptions& options, Restart restart,
                                              const IsNear& is_near, const std::function<bool()>& is_interrupted) {
  auto whole = piece(path_->nodes[k], options, mode_at_start(*path_, k), is_interrupted);
  const auto& [run, is_complete, was_chosen, moved] = whole.segment;
  if (run.status.termination == Termination::stopped_by_user || (is_complete && is_near(run.final.x))) {
    return std::move(whole.segment);
  }
  auto pieces = in_pieces(k, whole, restart, is_interrupted);
  const bool is_nearer = pieces.is_complete && pieces.was_chosen && is_near(pieces.run.final.x);
  return is_nearer ? std::move(pieces) : std::move(whole.segment);
}

Resimulation::Segment Resimulation::interval(std::size_t k, const IsNear& is_near,
                                             const std::function<bool()>& is_interrupted) {
  return from_node(k, resimulation_options(path_->times[k], path_->times[k + 1], rows_per_interval), Restart::at_plan,
                   is_near, is_interrupted);
}

Resimulation::Segment Resimulation::open_loop(const IsNear& is_near, const std::function<bool()>& is_interrupted) {
  const std::size_t rows = std::clamp(20 * path_->controls.size(), std::size_t{200}, most_drawn_rows);
  return from_node(0, resimulation_options(path_->times.front(), path_->times.back(), rows), Restart::where_it_is,
                   is_near, is_interrupted);
}

linalg::Vector Resimulation::end_of(std::size_t k, std::vector<double> start,
                                    const std::function<bool()>& is_interrupted) {
  kernel_.set_initial_state(std::move(start));
  const double until = path_->times[k + 1];
  const auto ended = run(resimulation_options(path_->times[k], until, 1), is_interrupted);
  if (ended.status.termination == Termination::stopped_by_user || !(ended.status.time_reached >= until)) {
    return linalg::Vector::constant(index(ended.final.x.size()), std::numeric_limits<double>::quiet_NaN());
  }
  return linalg::ConstView(ended.final.x);
}

double Resimulation::amplification(const std::vector<double>& scales, const std::function<bool()>& is_interrupted) {
  const auto n = index(scales.size());
  linalg::Matrix product = linalg::Matrix::identity(n, n), derivative(n, n);
  TouchingBodies bodies(kernel_);
  for (std::size_t k = 0; k < path_->controls.size(); ++k) {
    const auto modes = bodies.modes_at(path_->times[k], path_->nodes[k]);
    for (std::size_t j = 0; j < scales.size(); ++j) {
      auto above = path_->nodes[k], below = path_->nodes[k];
      above[j] += difference_step * scales[j];
      below[j] -= difference_step * scales[j];
      const double width = above[j] - below[j];
      bodies.project(path_->times[k], modes, above);
      bodies.project(path_->times[k], modes, below);
      const linalg::Vector at_above = end_of(k, std::move(above), is_interrupted);
      derivative.col(index(j)) = (at_above - end_of(k, std::move(below), is_interrupted)) / width;
      if (!derivative.col(index(j)).all_finite()) return std::numeric_limits<double>::quiet_NaN();
    }
    product = derivative * product;
  }
  return product.all_finite() ? linalg::spectral_norm(product) : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace saltus::pipeline
