#include <algorithm>
#include <cmath>

#include "saltus/base/rounding_unit.hpp"
#include "saltus/fesd_integrator/run/output_rows_internal.hpp"

namespace saltus::fesd_integrator {

void OutputRows::row_inside(double t) {
  recorder_.row(t, interior_.x(), interior_.set(), interior_.selections(), context_.held.data());
}

void OutputRows::keep(const Element& element, const std::vector<double>& selections, double until) {
  const bool is_first = pieces_.empty() || pieces_.back().end <= position_.t();
  const double begin = is_first ? position_.t() : pieces_.back().end;
  constexpr std::size_t most_numbers = std::size_t{1} << 27U;
  numbers_ += element.x.size() + 2 * element.stage_states.size() + element.stage_selections.size() + element.end.size();
  if (!(begin < until) || numbers_ > most_numbers) return;
  const double* held = context_.held.data();
  const auto sets = interior_.stage_sets();
  pieces_.push_back({begin,
                     until,
                     is_first,
                     element,
                     selections,
                     position_.set(),
                     {sets.begin(), sets.end()},
                     {held, held + context_.facts.held.size()}});
}

void OutputRows::emit(const Element& element, const std::vector<double>& selections, double until) {
  if (context_.options.pieces) keep(element, selections, until);
  if (at_times() && context_.options.clock) return emit_clock_times(element, selections, until);
  const auto& times = at_times() ? context_.options.times : chosen_;
  for (; next_ < times.size() && times[next_] < until; ++next_) {
    if (recorder_.ends_at(times[next_])) continue;  // an event inside has put it there, to the rounding of its state
    interior_.go_to(element, selections, (times[next_] - element.t) / element.h);
    row_inside(times[next_]);
  }
}

double OutputRows::clock_at(const Element& element, const std::vector<double>& selections, double theta) {
  interior_.go_to(element, selections, theta);
  return interior_.x()[*context_.options.clock];
}

double OutputRows::theta_of(double value, const Element& element, const std::vector<double>& selections, double last,
                            double end) {
  const double rounding = 4.0 * rounding_unit * std::max(1.0, std::abs(value));
  double low = 0.0, high = last, below = clock_at(element, selections, low) - value, above = end - value;
  double theta = low, difference = below;
  constexpr int most_steps = 100;
  for (int i = 0; i < most_steps && std::abs(difference) > rounding && high > low; ++i) {
    // The secant where it divides well, else the middle.
    const double secant = low - below * (high - low) / (above - below);
    theta = i % 3 == 2 || !(secant > low && secant < high) ? 0.5 * (low + high) : secant;
    difference = clock_at(element, selections, theta) - value;
    (difference < 0.0 ? low : high) = theta;
    (difference < 0.0 ? below : above) = difference;
  }
  return theta;
}

/// The clock never goes back, so that every value is passed once.
void OutputRows::emit_clock_times(const Element& element, const std::vector<double>& selections, double until) {
  const auto& times = context_.options.times;
  const double last = (until - element.t) / element.h, end = clock_at(element, selections, last);
  for (; next_ < times.size() && times[next_] < end; ++next_) {
    const double theta = theta_of(times[next_], element, selections, last, end);
    row_inside(element.t + theta * element.h);
  }
}

void OutputRows::columns_at(const Element& element, const std::vector<double>& selections, double theta,
                            double* columns) {
  const double t = element.t + theta * element.h;
  const double* held = context_.held.data();
  interior_.go_to(element, selections, theta);
  columns = std::copy(interior_.x().begin(), interior_.x().end(), columns);
  context_.functions.inputs(t, held, columns);
  columns += context_.facts.n_u;
  context_.functions.outputs(t, interior_.x().data(), interior_.selections().data(), held, columns);
  columns += context_.facts.n_y;
  const auto view = recorder_.view(interior_.set(), interior_.selections(), held);
  std::copy(view.alpha.begin(), view.alpha.end(), columns);
}

void OutputRows::begin_element(const Element& element, const std::vector<double>& selections) {
  const Facts& facts = context_.facts;
  if (!(context_.options.straight > 0.0)) return;
  if (!ranges_) {
    const ode::Tolerances floor{1e-9, 1e-12};  // of states that do nothing
    ranges_.emplace(facts.n_x + facts.n_u + facts.n_y + facts.n_functions, context_.options.straight, floor);
  }
  tolerance_.resize(ranges_->size());
  for (const double theta : {0.0, 1.0}) {
    columns_at(element, selections, theta, tolerance_.data());
    for (std::size_t k = 0; k < tolerance_.size(); ++k) ranges_->widen(k, tolerance_[k]);
  }
  for (std::size_t k = 0; k < tolerance_.size(); ++k) tolerance_[k] = ranges_->tolerance(k);
  chosen_.clear();
  next_ = 0;
  const auto columns = [&](double theta, double* out) { columns_at(element, selections, theta, out); };
  for (const double theta : lines_.points(columns, 1.0, 2, tolerance_)) {
    const double t = element.t + theta * element.h;
    if (t > position_.t()) chosen_.push_back(t);
  }
}

void OutputRows::emit_here() {
  const auto& times = context_.options.times;
  const double now = context_.options.clock ? position_.x()[*context_.options.clock] : position_.t();
  const bool asked = at_times() && next_ < times.size() && times[next_] == now;
  if (asked) ++next_;
  if (recorder_.ends_at(position_.t())) return;
  if (asked || !at_times()) {
    recorder_.row(position_.t(), position_.x(), position_.set(), position_.selections(), context_.held.data());
  }
}

void OutputRows::pass(double until) {
  const auto& times = context_.options.times;
  for (; at_times() && next_ < times.size() && times[next_] < until; ++next_) {
    if (times[next_] <= position_.t()) continue;
    recorder_.row(times[next_], position_.x(), position_.set(), position_.selections(), context_.held.data());
  }
}

}  // namespace saltus::fesd_integrator
