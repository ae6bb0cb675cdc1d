#include "saltus/event_integrator/decide/sets/find_resting_surfaces.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "saltus/event_integrator/decide/transition_internal.hpp"

namespace saltus::event_integrator {
namespace {

/// Rates of guards, and with them the held fields, are good to ten digits; what is less than this of its terms is 0.
constexpr double rate_accuracy = 1e-9;

class RestingSearch {
 public:
  RestingSearch(const SwitchingContext& s, Holding& holding, double t, const std::vector<double>& alpha,
                const std::vector<double>& x)
      : s_(s), holding_(holding), t_(t), alpha_(alpha) {
    points_.push_back({t, x});
    // Near by on the guards, also as time goes.
    for (const unsigned pattern : {0U, 1U}) {
      constexpr double step = 0x1p-10;
      Point point{t + step * (1.0 + std::abs(t)), x};
      for (std::size_t i = 0; i < x.size(); ++i) point.x[i] += displacement(i, x[i], step, pattern);
      static_cast<void>(holding.project(point.t, alpha, point.x));
      points_.push_back(std::move(point));
    }
  }

  RestingSurfaces run() {
    const int n_psi = s_.kernel.switching_functions();
    for (int j = 0; j < n_psi && found_.problem.empty(); ++j) {
      if (are_plain_surfaces(s_, {j}) && stays_at_zero(j) && moves_nothing(j)) take(j);
    }
    if (found_.problem.empty() && found_.surfaces.size() > 1) check_sum();
    return std::move(found_);
  }

 private:
  struct Point {
    double t = 0.0;
    std::vector<double> x;
  };

  [[nodiscard]] bool stays_at_zero(int j) const {
    std::vector<double> values(at(s_.kernel.event_functions())), magnitude(values.size()), slope(values.size());
    return std::all_of(points_.begin(), points_.end(), [&](const Point& point) {
      s_.kernel.functions(point.t, point.x.data(), alpha_.data(), values.data());
      s_.kernel.scales(point.t, point.x.data(), alpha_.data(), magnitude.data(), slope.data());
      // The points are displaced by 1e-3, the first one is where the guards are to rounding.
      return std::abs(values[at(j)]) <= rate_accuracy * (magnitude[at(j)] + slope[at(j)]);
    });
  }

  /// Whether f jumps across the surface, but not while the guards are held.
  [[nodiscard]] bool moves_nothing(int j) const {
    bool acts = false;
    for (const Point& point : points_) {
      std::vector<double> alpha = alpha_, below(point.x.size()), above(below.size());
      alpha[at(j)] = 0.0;
      const auto free_below = holding_.free_field(point.t, alpha, point.x);
      s_.kernel.field(point.t, point.x.data(), alpha.data(), below.data());
      alpha[at(j)] = 1.0;
      const auto free_above = holding_.free_field(point.t, alpha, point.x);
      s_.kernel.field(point.t, point.x.data(), alpha.data(), above.data());
      for (std::size_t i = 0; i < below.size(); ++i) {
        const double terms =
            std::max({std::abs(below[i]), std::abs(above[i]), std::abs(free_below[i]), std::abs(free_above[i])});
        if (!(std::abs(above[i] - below[i]) <= rate_accuracy * terms)) return false;
        acts = acts || std::abs(free_above[i] - free_below[i]) > rate_accuracy * terms;
      }
    }
    return acts;
  }

  /// What presses on each guard, in its own direction: > 0 while pressed on.
  [[nodiscard]] std::vector<double> pressures(const std::vector<double>& alpha) const {
    std::vector<double> values(holding_.guards().size());
    s_.kernel.hold_pressure(t_, points_.front().x.data(), alpha.data(), values.data());
    for (std::size_t k = 0; k < values.size(); ++k) values[k] *= holding_.guards()[k].inward;
    return values;
  }

  void take(int j) {
    std::vector<double> alpha = alpha_;
    alpha[at(j)] = 0.0;
    const auto below = pressures(alpha);
    alpha[at(j)] = 1.0;
    const auto above = pressures(alpha);
    double change = 0.0;
    int pressed = 0;
    for (std::size_t k = 0; k < below.size(); ++k) {
      const double own = above[k] - below[k];
      if (!(std::abs(own) > rate_accuracy * std::max(std::abs(above[k]), std::abs(below[k])))) continue;
      change = own;
      ++pressed;
    }
    if (pressed > 1) return refuse(j, "acts on several guards that are at rest");
    found_.surfaces.push_back(j);
    found_.alpha.push_back(change > 0.0 ? 1.0 : 0.0);
  }

  /// Together the selections press as the sum of each: else the most is not where each presses most.
  void check_sum() {
    std::vector<double> alpha = alpha_;
    for (const int j : found_.surfaces) alpha[at(j)] = 0.0;
    const auto none = pressures(alpha);
    auto sum = none, terms = none;
    for (double& term : terms) term = std::abs(term);
    for (std::size_t i = 0; i < found_.surfaces.size(); ++i) {
      auto own = alpha;
      own[at(found_.surfaces[i])] = found_.alpha[i];
      const auto one = pressures(own);
      for (std::size_t k = 0; k < sum.size(); ++k) {
        sum[k] += one[k] - none[k];
        terms[k] += std::abs(one[k] - none[k]);
      }
    }
    for (std::size_t i = 0; i < found_.surfaces.size(); ++i) alpha[at(found_.surfaces[i])] = found_.alpha[i];
    const auto all = pressures(alpha);
    for (std::size_t k = 0; k < sum.size(); ++k) {
      if (!(std::abs(all[k] - sum[k]) <= rate_accuracy * terms[k])) {
        return refuse(found_.surfaces.front(), "and others multiply each other in what presses on a guard at rest");
      }
    }
  }

  void refuse(int j, const char* why) {
    found_.problem = fmt::format(
        "the selection of '{}', which the guards keep at zero, {}: what follows is not "
        "determined by each of them alone",
        s_.system.switching[at(j)].name, why);
  }

  const SwitchingContext& s_;
  Holding& holding_;
  double t_;
  const std::vector<double>& alpha_;
  std::vector<Point> points_;
  RestingSurfaces found_;
};

}  // namespace

RestingSurfaces find_resting_surfaces(const SwitchingContext& switching_context, Holding& holding, double t,
                                      const std::vector<double>& alpha, const std::vector<double>& x) {
  if (holding.guards().empty() || switching_context.kernel.switching_functions() == 0) return {};
  return RestingSearch(switching_context, holding, t, alpha, x).run();
}

}  // namespace saltus::event_integrator
