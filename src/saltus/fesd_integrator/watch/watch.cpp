#include "saltus/fesd_integrator/watch/watch.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "saltus/base/at.hpp"
#include "saltus/base/contains.hpp"
#include "saltus/ode/bernstein.hpp"

namespace saltus::fesd_integrator {
namespace {

/// Value at theta of the k-th Lagrange polynomial of these points.
double lagrange(const std::vector<double>& points, std::size_t k, double theta) {
  double product = 1.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i != k) product *= (theta - points[i]) / (points[k] - points[i]);
  }
  return product;
}

/// Regions are compared with each other: all of a simplex have the roundings of the largest.
void share_noise(const ActiveSet& set, std::vector<double>& noise) {
  const auto n = static_cast<int>(noise.size());
  for (int j = 0; j < n; ++j) {
    const int reference = set.reference(j);
    if (reference >= 0) noise[at(reference)] = std::max(noise[at(reference)], noise[at(j)]);
  }
  for (int j = 0; j < n; ++j) {
    if (set.reference(j) >= 0) noise[at(j)] = noise[at(set.reference(j))];
  }
}

/// Roundings of a selection: those of a few operations, amplified by the solution of a small linear system.
constexpr double selection_noise = 1e-12;

constexpr double time_rounding = 16.0 * std::numeric_limits<double>::epsilon();

}  // namespace

void indicator_noise(const discretization::StageValues& values, double t, double size, std::vector<double>& noise) {
  constexpr double roundings = 16.0 * std::numeric_limits<double>::epsilon();
  const std::size_t n = values.indicator.size();
  noise.resize(n);
  const std::size_t n_x = values.f.size();
  for (std::size_t j = 0; j < n; ++j) noise[j] = std::abs(values.indicator_t[j] * t) + std::abs(values.indicator[j]);
  for (std::size_t i = 0; i < n_x; ++i) {
    visit_column(values.pattern->indicator_x, values.indicator_x, i,
                 [&](std::size_t j, double gradient) { noise[j] += std::abs(gradient) * size; });
  }
  for (double& level : noise) level *= roundings;
}

Watch::Watch(const discretization::StageKernel& kernel, const ElementSolver& solver)
    : kernel_(kernel), solver_(solver), projected_(kernel), defect_(solver), points_(solver.watch_points().size()) {
  interpolations_.push_back(interpolation_for({}));
  indicators_.resize(points_ * kernel.selections());
  selections_.resize(points_ * kernel.selections());
  values_.resize(points_);
  x_.resize(kernel.states());
  kernel.size(left_);
}

Watch::Interpolation Watch::interpolation_for(const TimeWarp& warp) const {
  Interpolation made{warp, {}, {}, 1.0};
  for (const double tau : solver_.watch_points()) made.thetas.push_back(warp.at(tau));
  for (const double node : ode::interpolation_nodes()) {
    for (std::size_t k = 0; k < points_; ++k) made.to_nodes.push_back(lagrange(made.thetas, k, node));
  }
  constexpr int samples = 200;
  for (int i = 0; i <= samples; ++i) {
    double sum = 0.0;
    for (std::size_t k = 0; k < points_; ++k) {
      sum += std::abs(lagrange(made.thetas, k, static_cast<double>(i) / samples));
    }
    made.lebesgue = std::max(made.lebesgue, sum);
  }
  made.lebesgue *= 1.01;  // between the samples
  return made;
}

/// Those of few warps are asked for; they are kept.
std::size_t Watch::find_interpolation(const TimeWarp& warp) {
  for (std::size_t k = 0; k < interpolations_.size(); ++k) {
    if (interpolations_[k].warp == warp) return k;
  }
  interpolations_.push_back(interpolation_for(warp));
  return interpolations_.size() - 1;
}

double Watch::noise(const Condition& condition) const {
  return condition.kind == Condition::Kind::side ? noise_[at(condition.selection)] : selection_noise;
}

double Watch::left_value(const ActiveSet& set, const Condition& condition) const { return value_at(set, condition, 0); }

double Watch::end_value(const ActiveSet& set, const Condition& condition) const {
  return value_at(set, condition, points_ - 1);
}

double Watch::value_at(const ActiveSet& set, const Condition& condition, std::size_t point) const {
  const std::size_t row = point * kernel_.selections();
  if (condition.kind == Condition::Kind::side || set.is_determined(condition.selection)) {
    return set.value(condition, indicators_.data() + row, selections_.data() + row);
  }
  const auto& margins = condition.kind == Condition::Kind::lower ? lower_ : upper_;
  return margins[row + static_cast<std::size_t>(condition.selection)];
}

/// Of selections that are not determined; they become those nearest to 1/2.
void Watch::note_margins(const ActiveSet& set, std::size_t point, double* selections) {
  const std::size_t n = kernel_.selections();
  lower_.resize(selections_.size());
  upper_.resize(selections_.size());
  DenseMatrices memory;
  margins_.evaluate(set, field_view(projected_.values(), memory), selections);
  for (const auto& balance : set.balances()) {
    for (const std::size_t k : balance.rows) {
      const int j = set.sliding()[k].selection;
      lower_[point * n + static_cast<std::size_t>(j)] = margins_.value({Condition::Kind::lower, j});
      upper_[point * n + static_cast<std::size_t>(j)] = margins_.value({Condition::Kind::upper, j});
    }
  }
}

Watch::Answer Watch::look(const Element& element, const ActiveSet& set, const double* held,
                          std::vector<double>& selections, Violation& earliest, std::span<const int> only) {
  const std::size_t n = kernel_.selections();
  interpolation_ = find_interpolation(element.warp);
  const auto& thetas = interpolations_[interpolation_].thetas;
  const bool slides = !set.sliding().empty();
  // Gradients at the left end give the rounding level; between the ends of an element it is the same.
  kernel_.evaluate(element.t, element.x.data(), selections.data(), held, left_);
  indicator_noise(left_, element.t + element.h, element.size, noise_);
  find_left_rates();
  share_noise(set, noise_);
  find_errors(element, set, held, selections);
  may_miss_ = false;
  const double rounding = ProjectedField::rounding_of_rates(element.size, element.h);
  for (std::size_t i = 0; i < points_; ++i) {
    const double t = element.t + thetas[i] * element.h;
    double* at = selections_.data() + i * n;
    std::copy(selections.begin(), selections.end(), at);
    solver_.watch_state(element, i, x_.data());
    if (slides) {
      if (!projected_.solve(t, x_.data(), set, held, at, rounding)) return Answer::not_finite;
      if (!projected_.regular() && !stage_holds(element, set, i)) return Answer::not_finite;
      if (!projected_.regular()) take_from_stages(element, set, i, at);
      if (!set.balances().empty()) note_margins(set, i, at);
      std::copy(at, at + n, selections.begin());
    }
    kernel_.indicators(t, x_.data(), held, indicators_.data() + i * n);
  }
  bool found = false;
  earliest.theta = std::numeric_limits<double>::infinity();
  for (const Condition& condition : set.conditions()) {
    if (!only.empty() && !contains(only, condition.selection)) continue;
    for (std::size_t i = 0; i < points_; ++i) {
      values_[i] = value_at(set, condition, i);
      if (!std::isfinite(values_[i])) return Answer::not_finite;
    }
    first_change(set, element, condition, earliest, found);
  }
  return found ? Answer::violated : Answer::holds;
}

/// Whether the selections of a stage are near their bounds at least, where equations of the projected field hold some
/// of them together only: these may be anything there.
bool Watch::stage_holds(const Element& element, const ActiveSet& set, std::size_t point) const {
  const int stage = solver_.watch_stage(point);
  if (stage < 0 || !set.balances().empty()) return true;
  constexpr double near = 0.5;  // the order of selections at stages is low
  const double* selections = element.stage_selections.data() + static_cast<std::size_t>(stage) * kernel_.selections();
  for (std::size_t k = 0; k < set.sliding().size(); ++k) {
    const double value = selections[at(set.sliding()[k].selection)];
    if (!projected_.in_no_equation(k) && !(std::abs(value - 0.5) <= 0.5 + near)) return false;
  }
  return true;
}

/// Selections that the projected field does not determine, where a stage has them (second-order sliding).
void Watch::take_from_stages(const Element& element, const ActiveSet& set, std::size_t point, double* selections) {
  const int stage = solver_.watch_stage(point);
  if (stage < 0) return;
  const std::size_t n = kernel_.selections();
  projected_.take_undetermined(set, element.stage_selections.data() + static_cast<std::size_t>(stage) * n, selections);
}

void Watch::find_errors(const Element& element, const ActiveSet& set, const double* held,
                        const std::vector<double>& selections) {
  const double* f = left_.f.data();
  const TimeWarp& warp = element.warp;
  if (const double place = defect_.place(); place > 0.0) {
    const double theta = warp.at(place), t = element.t + theta * element.h;
    solver_.interpolate(element, theta, x_.data());
    at_place_ = selections;
    slope_.resize(x_.size());
    if (set.sliding().empty() || projected_.solve(t, x_.data(), set, held, at_place_.data())) {
      kernel_.field(t, x_.data(), at_place_.data(), held, slope_.data());
    }
    f = slope_.data();
  }
  if (warp.is_none()) {
    defect_.errors(element, f, left_.f.data(), errors_);
  } else {
    find_warped_errors(element, set, f, held, selections);
  }
  // What errors of one component do to another one within the element.
  const std::size_t n = kernel_.selections(), n_x = errors_.size();
  slope_ = errors_;
  for (std::size_t k = 0; k < n_x; ++k) {
    const double moved = 0.5 * element.h * errors_[k];
    visit_column(left_.pattern->f_x, left_.f_x, k,
                 [&](std::size_t i, double derivative) { slope_[i] += std::abs(derivative) * moved; });
  }
  indicator_errors_.assign(n, 0.0);
  for (std::size_t i = 0; i < n_x; ++i) {
    visit_column(left_.pattern->indicator_x, left_.indicator_x, i,
                 [&](std::size_t j, double gradient) { indicator_errors_[j] += std::abs(gradient) * slope_[i]; });
  }
}

/// Where the element begins at the zero of a root, the derivatives there are infinite: those in its middle are taken.
void Watch::find_warped_errors(const Element& element, const ActiveSet& set, const double* f, const double* held,
                               const std::vector<double>& selections) {
  const std::size_t n_x = x_.size();
  std::vector<double> slope(n_x), left_slope(n_x);
  const double factor = element.warp.slope(defect_.place()), left_factor = element.warp.slope(0.0);
  for (std::size_t i = 0; i < n_x; ++i) {
    slope[i] = factor * f[i];
    left_slope[i] = left_factor * left_.f[i];
  }
  defect_.errors(element, slope.data(), left_slope.data(), errors_);
  constexpr double middle = 0.5;
  const double t = element.t + middle * element.h;
  solver_.interpolate(element, middle, x_.data());
  at_place_ = selections;
  if (!set.sliding().empty()) static_cast<void>(projected_.solve(t, x_.data(), set, held, at_place_.data()));
  kernel_.evaluate(t, x_.data(), at_place_.data(), held, left_);
}

double Watch::error_of(const ActiveSet& set, const Condition& condition) const {
  if (condition.kind != Condition::Kind::side) {
    // Selections are functions of the state whose derivatives nobody has: how much they bend in this element.
    const double last = values_.back() - values_.front();
    double bend = 0.0;
    for (std::size_t k = 0; k < points_; ++k) {
      bend = std::max(bend, std::abs(values_[k] - values_.front() - interpolations_[interpolation_].thetas[k] * last));
    }
    return bend;
  }
  const int reference = set.reference(condition.selection);
  return indicator_errors_[at(condition.selection)] + (reference >= 0 ? indicator_errors_[at(reference)] : 0.0);
}

/// d psi / dt at the left end. NOTE: left_ is that of the middle later on, where a root is zero at the left end.
void Watch::find_left_rates() {
  left_rates_ = left_.indicator_t;
  for (std::size_t i = 0; i < left_.f.size(); ++i) {
    visit_column(left_.pattern->indicator_x, left_.indicator_x, i,
                 [&](std::size_t j, double gradient) { left_rates_[j] += gradient * left_.f[i]; });
  }
}

void Watch::first_change(const ActiveSet& set, const Element& element, const Condition& condition, Violation& earliest,
                         bool& found) {
  const double h = element.h;
  const Interpolation& interpolation = interpolations_[interpolation_];
  const auto [low, high] = std::minmax_element(values_.begin(), values_.end());
  constexpr double safety = 2.0;
  const double error = safety * error_of(set, condition);
  if (0.5 * (*low + *high) > interpolation.lebesgue * 0.5 * (*high - *low) + error) return;
  const double level = noise(condition);
  std::array<double, ode::event_nodes> nodes{};
  for (std::size_t node = 0; node < nodes.size(); ++node) {
    for (std::size_t k = 0; k < points_; ++k) nodes[node] += interpolation.to_nodes[node * points_ + k] * values_[k];
  }
  nodes.front() = values_.front();
  nodes.back() = values_.back();
  const auto polynomial = ode::to_bernstein(nodes);
  int zero_order = 0;
  const bool side = condition.kind == Condition::Kind::side;
  const double rate = side ? std::abs(set.side(condition.selection, left_rates_.data())) : 0.0;
  // Where a step ends at a switch, its time is rounded, too.
  if (std::abs(values_.front()) <= level + time_rounding * std::abs(element.t) * rate) {
    // Behind the end of sliding psi begins with a double zero: the rate there tells, not the interpolant, whose error
    // in the slope would be a dip near by.
    constexpr double tangent = 1e-3;
    const double largest = std::max(std::abs(*low), std::abs(*high));
    const bool flat = side && rate * h <= tangent * largest;
    zero_order = flat ? 2 : 1;
  }
  if (!may_miss_ && error > level && std::isfinite(error)) {
    // Less what the error may grow to from the left end, where there is none.
    auto lowest = polynomial;
    for (std::size_t i = 1; i < lowest.size(); ++i) {
      lowest[i] -= error * static_cast<double>(i) / static_cast<double>(ode::event_degree);
    }
    may_miss_ = !ode::certainly_no_sign_change(lowest, 1, zero_order, level) &&
                ode::first_sign_change(lowest, 1, zero_order, level).has_value();
  }
  if (ode::certainly_no_sign_change(polynomial, 1, zero_order, level)) return;
  const auto change = ode::first_sign_change(polynomial, 1, zero_order, level);
  if (!change || change->lower >= earliest.theta) return;
  found = true;
  constexpr double small = 1e-4;
  const double at = std::clamp(change->upper, small, 1.0 - small);
  earliest = {condition, change->upper,
              (ode::evaluate(polynomial, at + small) - ode::evaluate(polynomial, at - small)) / (2.0 * small * h)};
  if (change->upper == 0.0 || change->lower == 0.0) earliest.theta = change->upper <= 1e-12 ? 0.0 : change->upper;
}

}  // namespace saltus::fesd_integrator
