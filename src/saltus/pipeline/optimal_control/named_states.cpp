#include <algorithm>
#include <cmath>
#include <functional>

#include "saltus/base/at.hpp"
#include "saltus/pipeline/optimal_control/named_states_internal.hpp"

namespace saltus::pipeline {
namespace {

using model::CostPoints;
using Row = std::vector<double>;

/// Of a state, for differences of costs. They are exact for squares, whatever the step.
constexpr double relative_step = 1e-2;
/// Second differences below this, relative to the cost, are rounding.
constexpr double least_bend = 1e-12;
/// Passes over all states: squares of sums need more than one.
constexpr int passes = 3;

class NamedStates {
 public:
  NamedStates(const model::Ocp& ocp, PointValues& values, const OcpStart& start)
      : ocp_(ocp), values_(values), start_(start), intervals_(start.controls.size()) {
    for (std::size_t k = 0; k <= intervals_; ++k) {
      nodes_.push_back(smallest(k, [&](const Row& y, std::size_t interval) { return running_cost(y, interval); }));
    }
    end_ = smallest(intervals_, [&](const Row& y, std::size_t interval) { return terminal_cost(y, interval); });
  }

  /// One state at a share of the horizon; `target` of a terminal constraint.
  [[nodiscard]] double value(std::size_t i, double share, const std::optional<double>& target) const {
    const double initial = start_.initial_state[i];
    const auto curve = [&](double s) {
      if (!nodes_.front()[i]) return 0.0;
      const double place = s * static_cast<double>(intervals_);
      const auto k = std::min(static_cast<std::size_t>(place), intervals_ - 1);
      const double left = nodes_[k][i].value_or(initial), right = nodes_[k + 1][i].value_or(initial);
      return left + (place - static_cast<double>(k)) * (right - left);
    };
    const double wanted = nodes_.front()[i] ? curve(1.0) : initial;
    const double last = target ? *target : end_[i].value_or(wanted);
    return curve(share) + (1.0 - share) * (initial - curve(0.0)) + share * (last - curve(1.0));
  }

 private:
  using Named = std::vector<std::optional<double>>;
  using Cost = std::function<double(const Row& outputs, std::size_t interval)>;

  [[nodiscard]] double squares(const Row& y, std::size_t interval, bool is_end) const {
    double sum = 0.0;
    for (const auto& term : ocp_.least_squares) {
      if (term.at == CostPoints::times || (term.at == CostPoints::end) != is_end) continue;
      const bool has_samples = term.samples_per_interval() > 0;  // a row per interval, that of its end
      Row r(term.of.size());
      for (std::size_t i = 0; i < r.size(); ++i) {
        r[i] = y[at(term.of[i])];
        if (!term.reference.empty()) r[i] -= y[at(term.reference[i])];
        if (has_samples) r[i] -= term.samples(index(interval), index(i));
      }
      for (std::size_t i = 0; i < r.size(); ++i) {
        for (std::size_t j = 0; j < r.size(); ++j) sum += term.weight(index(i), index(j)) * r[i] * r[j];
      }
    }
    return sum;
  }
  [[nodiscard]] double running_cost(const Row& y, std::size_t interval) const {
    return (ocp_.running_cost ? y[at(*ocp_.running_cost)] : 0.0) + squares(y, interval, false);
  }
  [[nodiscard]] double terminal_cost(const Row& y, std::size_t interval) const {
    return (ocp_.terminal_cost ? y[at(*ocp_.terminal_cost)] : 0.0) + squares(y, interval, true);
  }

  /// One state after the other by Newton's method, with differences; none for states whose cost does not bend upwards.
  [[nodiscard]] Named smallest(std::size_t node, const Cost& cost) {
    const double t = ocp_.from + start_.horizon * static_cast<double>(node) / static_cast<double>(intervals_);
    const std::size_t interval = node > 0 ? node - 1 : 0;
    ModelPoint point{t, start_.initial_state, start_.controls[interval], start_.parameters};
    if (ocp_.clock) point.x[at(ocp_.clock->state)] = t;
    const auto cost_at = [&](std::size_t i, double x) {
      const double before = std::exchange(point.x[i], x);
      const double value = cost(values_.outputs(point), interval);
      point.x[i] = before;
      return value;
    };
    Named named(point.x.size());
    for (int pass = 0; pass < passes; ++pass) {
      for (std::size_t i = 0; i < point.x.size(); ++i) {
        if (ocp_.clock && at(ocp_.clock->state) == i) continue;
        const double x = point.x[i], step = relative_step * std::max(1.0, std::abs(x));
        const double middle = cost_at(i, x), left = cost_at(i, x - step), right = cost_at(i, x + step);
        const double bend = left - 2.0 * middle + right;
        if (!(bend > least_bend * std::max(std::abs(middle), least_bend))) continue;
        const double next = std::clamp(x - step * (right - left) / (2.0 * bend), ocp_.system.state_lower[i],
                                       ocp_.system.state_upper[i]);
        if (cost_at(i, next) <= middle) point.x[i] = next;
        named[i] = point.x[i];
      }
    }
    return named;
  }

  const model::Ocp& ocp_;
  PointValues& values_;
  const OcpStart& start_;
  std::size_t intervals_;
  std::vector<Named> nodes_;
  Named end_;
};

}  // namespace

std::vector<std::vector<double>> named_states(const model::Ocp& ocp, PointValues& values, const OcpStart& start,
                                              const std::vector<std::optional<double>>& targets,
                                              const std::vector<double>& times) {
  const NamedStates named(ocp, values, start);
  std::vector<std::vector<double>> rows;
  for (const double t : times) {
    const double share = std::clamp((t - ocp.from) / start.horizon, 0.0, 1.0);
    auto& x = rows.emplace_back(start.initial_state.size());
    for (std::size_t i = 0; i < x.size(); ++i) x[i] = named.value(i, share, targets[i]);
  }
  return rows;
}

}  // namespace saltus::pipeline
