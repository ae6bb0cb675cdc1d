// Switches that accumulate: the limit of their laps, and how it goes on behind it.
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "saltus/fesd_integrator/element/dense_system_internal.hpp"
#include "saltus/fesd_integrator/run/run_internal.hpp"

namespace saltus::fesd_integrator {

/// How well the time of a switch is known on either side of it.
double Run::resolution_of(const Condition& condition, const std::vector<double>& selections_before) {
  if (condition.kind != Condition::Kind::side) return 0.0;
  const auto j = static_cast<std::size_t>(condition.selection);
  double rate = 0.0;
  for (const std::vector<double>* selections : {&selections_before, &std::as_const(selections_)}) {
    kernel_.evaluate(t_, x_.data(), selections->data(), held_.data(), at_switch_);
    double sum = at_switch_.indicator_t[j];
    for (std::size_t i = 0; i < x_.size(); ++i) {
      sum += at_switch_.indicator_x[i * selections->size() + j] * at_switch_.f[i];
    }
    rate = std::max(rate, std::abs(sum));
  }
  return rate > 0.0 ? watch_.noise(condition) / rate : 0.0;
}

/// Newton steps of least norm onto the surfaces of these selections.
bool Run::put_on_surfaces(const ActiveSet& set, double t, std::vector<double>& x) {
  const std::size_t n = kernel_.selections(), n_x = x.size(), count = set.sliding().size();
  std::vector<double> middle(n, 0.5);
  DenseSystem system;
  system.reserve(static_cast<Eigen::Index>(count));
  constexpr int most_iterations = 20;
  double before = std::numeric_limits<double>::infinity();
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    kernel_.evaluate(t, x.data(), middle.data(), held_.data(), at_switch_);
    system.reset(static_cast<Eigen::Index>(count));
    auto matrix = system.matrix();
    for (std::size_t k = 0; k < count; ++k) {
      for (std::size_t l = 0; l < count; ++l) {
        for (std::size_t i = 0; i < n_x; ++i) {
          const double* column = at_switch_.indicator_x.data() + i * n;
          matrix(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(l)) +=
              set.surface(k, column) * set.surface(l, column);
        }
      }
      system.right()(static_cast<Eigen::Index>(k)) = -set.surface(k, at_switch_.indicator.data());
    }
    if (!system.solve(1e-13 * size_)) return false;
    double change = 0.0;
    for (std::size_t i = 0; i < n_x; ++i) {
      double step = 0.0;
      for (std::size_t k = 0; k < count; ++k) {
        step += set.surface(k, at_switch_.indicator_x.data() + i * n) * system.right()(static_cast<Eigen::Index>(k));
      }
      x[i] += step;
      change = std::max(change, std::abs(step));
    }
    if (change <= 1e-15 * size_ || change >= 0.5 * before) return change <= 1e-9 * size_;
    before = change;
  }
  return false;
}

bool Run::put_at_rest(const ActiveSet& set, double t, std::vector<double>& x, double farthest) {
  if (!put_on_surfaces(set, t, x)) return false;
  const std::size_t n = kernel_.selections(), n_x = x.size(), count = set.sliding().size();
  std::vector<double> middle(n, 0.5);
  for (std::size_t j = 0; j < n; ++j) {
    if (set.modes()[j] != 0) middle[j] = selections_[j];
  }
  struct Rate {
    double value = 0.0;
    bool moved = false;  // by a selection, at once
  };
  const auto rate_of = [&](std::size_t k, const std::vector<double>& at) {
    kernel_.evaluate(t, at.data(), middle.data(), held_.data(), at_switch_);
    Rate rate{set.surface(k, at_switch_.indicator_t.data()), false};
    for (std::size_t i = 0; i < n_x; ++i) {
      const double gradient = set.surface(k, at_switch_.indicator_x.data() + i * n);
      rate.value += gradient * at_switch_.f[i];
      for (const Sliding& entry : set.sliding()) {
        double along = at_switch_.f_selection[static_cast<std::size_t>(entry.selection) * n_x + i];
        if (entry.reference >= 0) along -= at_switch_.f_selection[static_cast<std::size_t>(entry.reference) * n_x + i];
        rate.moved = rate.moved || gradient * along != 0.0;
      }
    }
    return rate;
  };
  // One after the other: as a rule there is one.
  for (std::size_t k = 0; k < count; ++k) {
    const Rate rate = rate_of(k, x);
    if (rate.moved || rate.value == 0.0) continue;
    std::vector<double> gradient(n_x);
    double square = 0.0, noise = 0.0;
    for (std::size_t i = 0; i < n_x; ++i) {
      // Central differences with the step of least error.
      const double step = 6e-6 * std::max(size_, std::abs(x[i]));
      auto above = x, below = x;
      above[i] += step;
      below[i] -= step;
      gradient[i] = (rate_of(k, above).value - rate_of(k, below).value) / (2.0 * step);
      square += gradient[i] * gradient[i];
      noise += 1e-14 * size_ * std::abs(gradient[i]);
    }
    if (std::abs(rate.value) <= noise) continue;
    if (!(square > 0.0)) return false;
    auto moved = x;
    double distance = 0.0;
    for (std::size_t i = 0; i < n_x; ++i) {
      moved[i] -= rate.value * gradient[i] / square;
      distance = std::max(distance, std::abs(moved[i] - x[i]));
    }
    if (!(distance <= farthest) || !put_on_surfaces(set, t, moved)) return false;
    if (std::abs(rate_of(k, moved).value) > std::max(noise, 1e-3 * std::abs(rate.value))) return false;
    x = std::move(moved);
  }
  return true;
}

/// If the switches up to here have a limit that nothing else precedes, and a set continues from there, the run goes on
/// with that.
bool Run::go_to_limit(LapSeries::Wanted wanted) {
  if (propagation_ != nullptr) return false;  // its derivatives are those of elements
  const auto limit = laps_.limit(wanted);
  if (!limit || limit->t > options_.until) return false;
  if (held_.next_change(t_, limit->t, x_.data()) < limit->t) return false;
  const double farthest = laps_.last_change();
  laps_.clear();
  lap_part_ = 0.0;
  // What a lap changes is at rest behind it: on all of its surfaces, in all of its regions.
  std::vector<int> at_zero, modes = set_.modes();
  for (std::size_t j = 0; j < modes.size(); ++j) {
    const bool changes = std::any_of(limit->modes.begin(), limit->modes.end(),
                                     [&](const std::vector<int>& other) { return other[j] != modes[j]; });
    if (!changes && modes[j] != 0) continue;
    if (changes) at_zero.push_back(static_cast<int>(j));
    modes[j] = 0;
  }
  for (const int j : on_surfaces()) at_zero.push_back(j);
  auto x = limit->x;
  if (!put_at_rest(ActiveSet(facts_.parts, modes), limit->t, x, farthest)) return false;
  auto found = transition_.continuations(
      {limit->t, x, held_.data(), nullptr, at_zero, size_, nominal_ / options_.elements / 128.0});
  if (found.empty()) return false;
  const auto resting = std::find_if(found.begin(), found.end(),
                                    [&](const Continuation& candidate) { return candidate.set.modes() == modes; });
  if (resting != found.end()) std::rotate(found.begin(), resting, resting + 1);
  const ActiveSet before = set_;
  const auto selections = selections_;
  // What is asked for on the way is too near to the limit to be told apart.
  for (; options_.rows == IntegrationOptions::Rows::at_times && next_time_ < options_.times.size() &&
         options_.times[next_time_] < limit->t;
       ++next_time_) {
    if (options_.times[next_time_] > t_) {
      recorder_.row(options_.times[next_time_], x_, set_, selections_, held_.data());
    }
  }
  recorder_.accumulated(limit->t, x_, x, {&before, &selections, held_.data()}, found, held_.data());
  t_ = limit->t;
  x_ = std::move(x);
  continue_with(found);
  previous_.reset();
  if (!user_events_.empty()) {
    fire(user_events_.update(t_, x_.data(), selections_.data(), held_.data(), std::nullopt), t_, x_, selections_);
  }
  row_here();
  return true;
}

}  // namespace saltus::fesd_integrator
