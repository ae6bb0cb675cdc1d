// That is no problem of switching/point, as the motion is known. Functions are looked for that are 0 wherever it is
// held, and the end of a selection's bounds at which most presses.
#include "saltus/event_integrator/decide/sets/find_resting_surfaces.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "saltus/base/function_ref.hpp"
#include "saltus/event_integrator/decide/transition_internal.hpp"

namespace saltus::event_integrator {
namespace {

/// Rates of guards, and with them the held fields, are good to ten digits; what is less than this of its terms is 0.
constexpr double rate_accuracy = 1e-9;

struct NearPoint {
  double t = 0.0;
  std::vector<double> x;
};

/// Puts a point on what is held.
using Projection = FunctionRef<void(double t, std::vector<double>& x)>;

/// A point, and two near by on what is held, also as time goes.
std::vector<NearPoint> points_near(const SwitchingContext& s, double t, const std::vector<double>& x,
                                   const Projection& project) {
  std::vector<NearPoint> points{{t, x}};
  for (const unsigned pattern : {0U, 1U}) {
    constexpr double step = 0x1p-10;
    NearPoint point{t + step * (1.0 + std::abs(t)), x};
    for (std::size_t i = 0; i < x.size(); ++i) {
      if (!s.layout.discrete_states[i]) point.x[i] += displacement(i, x[i], step, pattern);
    }
    project(point.t, point.x);
    points.push_back(std::move(point));
  }
  return points;
}

/// Holds the functions at a point, and the sizes of what they are made of.
struct SizedValues {
  std::vector<double> values, magnitude, slope;
  /// Whether a function is 0 to the rounding that points have which were displaced by 1e-3.
  [[nodiscard]] bool is_zero(int j) const {
    return std::abs(values[at(j)]) <= rate_accuracy * (magnitude[at(j)] + slope[at(j)]);
  }
};

SizedValues sized_values(const SwitchingContext& s, double t, const std::vector<double>& x,
                         const std::vector<double>& alpha) {
  SizedValues sized;
  for (auto* list : {&sized.values, &sized.magnitude, &sized.slope}) list->resize(at(s.kernel.event_functions()));
  s.kernel.functions(t, x.data(), alpha.data(), sized.values.data());
  s.kernel.scales(t, x.data(), alpha.data(), sized.magnitude.data(), sized.slope.data());
  return sized;
}

bool stays_at_zero(const SwitchingContext& s, const std::vector<NearPoint>& points, const std::vector<double>& alpha,
                   int j) {
  return std::all_of(points.begin(), points.end(),
                     [&](const NearPoint& point) { return sized_values(s, point.t, point.x, alpha).is_zero(j); });
}

/// f at a point as if nothing was held.
using FreeField = FunctionRef<std::vector<double>(const NearPoint& point, const std::vector<double>& alpha)>;

/// Whether f jumps across a surface, but not while what holds the points is held.
bool moves_nothing(const SwitchingContext& s, const std::vector<NearPoint>& points, const std::vector<double>& alpha,
                   int j, const FreeField& free_field) {
  bool acts = false;
  for (const NearPoint& point : points) {
    std::vector<double> own = alpha, below(point.x.size()), above(below.size());
    own[at(j)] = 0.0;
    const auto free_below = free_field(point, own);
    s.kernel.field(point.t, point.x.data(), own.data(), below.data());
    own[at(j)] = 1.0;
    const auto free_above = free_field(point, own);
    s.kernel.field(point.t, point.x.data(), own.data(), above.data());
    for (std::size_t i = 0; i < below.size(); ++i) {
      const double terms =
          std::max({std::abs(below[i]), std::abs(above[i]), std::abs(free_below[i]), std::abs(free_above[i])});
      if (!(std::abs(above[i] - below[i]) <= rate_accuracy * terms)) return false;
      acts = acts || std::abs(free_above[i] - free_below[i]) > rate_accuracy * terms;
    }
  }
  return acts;
}

class RestingSearch {
 public:
  RestingSearch(const SwitchingContext& s, Holding& holding, double t, const std::vector<double>& alpha,
                const std::vector<double>& x)
      : s_(s),
        holding_(holding),
        t_(t),
        alpha_(alpha),
        points_(points_near(s, t, x, [&](double time, std::vector<double>& point) {
          static_cast<void>(holding.project(time, alpha, point));
        })) {}

  RestingSurfaces run() {
    const auto free_field = [this](const NearPoint& point, const std::vector<double>& alpha) {
      return holding_.free_field(point.t, alpha, point.x);
    };
    const int n_psi = s_.kernel.switching_functions();
    for (int j = 0; j < n_psi && found_.problem.empty(); ++j) {
      if (!are_plain_surfaces(s_, {j}) || !stays_at_zero(s_, points_, alpha_, j)) continue;
      if (moves_nothing(s_, points_, alpha_, j, free_field)) take(j);
    }
    if (found_.problem.empty() && found_.surfaces.size() > 1) check_sum();
    return std::move(found_);
  }

 private:
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
        s_.layout.surfaces[at(j)].name, why);
  }

  const SwitchingContext& s_;
  Holding& holding_;
  double t_;
  const std::vector<double>& alpha_;
  std::vector<NearPoint> points_;
  RestingSurfaces found_;
};

/// The selection with which most presses on all contacts that it presses on; as it is where these do not agree.
double pressing_selection(const SwitchingContext& s, const Contacts& contacts, const NearPoint& point,
                          std::vector<double> alpha, int j) {
  const double own = alpha[at(j)];
  std::vector<double> below(at(s.kernel.event_functions())), above(below.size());
  alpha[at(j)] = 0.0;
  s.kernel.functions(point.t, point.x.data(), alpha.data(), below.data());
  alpha[at(j)] = 1.0;
  s.kernel.functions(point.t, point.x.data(), alpha.data(), above.data());
  bool more = false, less = false;
  for (std::size_t k = 0; k < below.size(); ++k) {
    if (!contacts.guards(static_cast<int>(k))) continue;
    const double change = below[k] - above[k];  // guards are negative while a mode lasts
    if (!(std::abs(change) > rate_accuracy * std::max(std::abs(below[k]), std::abs(above[k])))) continue;
    (change > 0.0 ? more : less) = true;
  }
  return more == less ? own : more ? 1.0 : 0.0;
}

}  // namespace

RestingSurfaces find_resting_surfaces(const SwitchingContext& switching_context, Holding& holding, double t,
                                      const std::vector<double>& alpha, const std::vector<double>& x) {
  if (holding.guards().empty() || switching_context.kernel.switching_functions() == 0) return {};
  return RestingSearch(switching_context, holding, t, alpha, x).run();
}

void add_kept_by_contacts(const SwitchingContext& s, Contacts& contacts, double t, const std::vector<double>& alpha,
                          const std::vector<double>& x, RestingSurfaces& resting) {
  const auto onto_contacts = [&](double time, std::vector<double>& point) {
    static_cast<void>(contacts.project(time, alpha, point));
  };
  const auto free_field = [&](const NearPoint& point, const std::vector<double>& own) {
    std::vector<double> f(point.x.size());
    contacts.free_field(point.t, point.x, own, f.data());
    return f;
  };
  const SizedValues here = sized_values(s, t, x, alpha);
  std::vector<NearPoint> points;
  for (int j = 0; j < s.kernel.switching_functions(); ++j) {
    const bool kink = s.layout.surfaces[at(j)].is_kink;
    const auto place = std::lower_bound(resting.surfaces.begin(), resting.surfaces.end(), j);
    if (place != resting.surfaces.end() && *place == j) continue;
    if (kink ? !s.kernel.inner(j).empty() : !are_plain_surfaces(s, {j})) continue;
    if (!here.is_zero(j)) continue;
    if (points.empty()) points = points_near(s, t, x, onto_contacts);
    if (!stays_at_zero(s, points, alpha, j)) continue;
    if (!kink && !moves_nothing(s, points, alpha, j, free_field)) continue;
    resting.alpha.insert(resting.alpha.begin() + (place - resting.surfaces.begin()),
                         kink ? 1.0 : pressing_selection(s, contacts, points.front(), alpha, j));
    resting.surfaces.insert(place, j);
  }
}

}  // namespace saltus::event_integrator
