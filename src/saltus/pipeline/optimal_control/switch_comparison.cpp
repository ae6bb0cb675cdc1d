#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "saltus/base/at.hpp"
#include "saltus/pipeline/optimal_control/switch_comparison_internal.hpp"

namespace saltus::pipeline {
namespace {

/// How good a way of pairing is: more pairs, then less time between the two of each.
struct Pairing {
  int pairs = 0;
  double distance = 0.0;
  [[nodiscard]] bool is_better_than(const Pairing& other) const {
    return pairs != other.pairs ? pairs > other.pairs : distance < other.distance;
  }
};

bool is_same(const Switch& a, const Switch& b) { return a.place == b.place && a.from == b.from && a.to == b.to; }

/// Pairs (number in a, number in b) in ascending order: the longest common subsequence, and the nearest one of those.
std::vector<std::pair<std::size_t, std::size_t>> paired(const std::vector<Switch>& a, const std::vector<Switch>& b) {
  const std::size_t width = b.size() + 1;
  std::vector<Pairing> best((a.size() + 1) * width);  // of a from i on with b from j on
  const auto at_place = [&](std::size_t i, std::size_t j) -> Pairing& { return best[i * width + j]; };
  const auto with_pair = [&](std::size_t i, std::size_t j) {
    Pairing pairing = at_place(i + 1, j + 1);
    return Pairing{pairing.pairs + 1, pairing.distance + std::abs(a[i].t - b[j].t)};
  };
  for (std::size_t i = a.size(); i-- > 0;) {
    for (std::size_t j = b.size(); j-- > 0;) {
      Pairing& here = at_place(i, j);
      here = at_place(i + 1, j);
      if (at_place(i, j + 1).is_better_than(here)) here = at_place(i, j + 1);
      if (!is_same(a[i], b[j])) continue;
      if (const auto taken = with_pair(i, j); taken.is_better_than(here)) here = taken;
    }
  }
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (std::size_t i = 0, j = 0; i < a.size() && j < b.size();) {
    // Equal, as it was computed like this.
    const auto& here = at_place(i, j);
    const auto stays = [&](const Pairing& other) { return !here.is_better_than(other); };
    if (stays(at_place(i + 1, j))) {
      ++i;
    } else if (stays(at_place(i, j + 1))) {
      ++j;
    } else {
      pairs.emplace_back(i++, j++);
    }
  }
  return pairs;
}

struct TimeSpan {
  double from = 0.0, until = 0.0;
  double tolerance = 0.0;
  [[nodiscard]] bool reaches(double t) const { return t >= from - tolerance && t <= until + tolerance; }
  [[nodiscard]] bool is_inside(double t) const { return t > from + tolerance && t < until - tolerance; }
};

/// The comparison of one place after the other within one interval.
class OneInterval {
 public:
  OneInterval(const TimeSpan& interval, const std::vector<Switch>& simulated, const std::vector<Switch>& solution,
              std::vector<bool>& found, SwitchComparison& comparison)
      : interval_(interval), simulated_(simulated), solution_(solution), found_(found), comparison_(comparison) {}

  void compare() {
    std::set<std::size_t> places;
    for (const auto& entry : simulated_) places.insert(entry.place);
    for (const std::size_t place : places) compare_at(place);
  }

 private:
  void compare_at(std::size_t place) {
    std::vector<Switch> a, b;
    std::vector<std::size_t> numbers;
    for (const auto& entry : simulated_) {
      if (entry.place == place) a.push_back(entry);
    }
    for (std::size_t i = 0; i < solution_.size(); ++i) {
      if (solution_[i].place != place || found_[i] || !interval_.reaches(solution_[i].t)) continue;
      b.push_back(solution_[i]);
      numbers.push_back(i);
    }
    std::vector<bool> seen(a.size(), false);
    for (const auto& [i, j] : paired(a, b)) {
      seen[i] = true;
      found_[numbers[j]] = true;
      comparison_.time_error = std::max(comparison_.time_error, std::abs(a[i].t - b[j].t));
    }
    for (std::size_t i = 0; i < a.size(); ++i) {
      if (!seen[i] && interval_.is_inside(a[i].t)) ++comparison_.missed;
    }
  }

  const TimeSpan interval_;
  const std::vector<Switch>& simulated_;
  const std::vector<Switch>& solution_;
  std::vector<bool>& found_;
  SwitchComparison& comparison_;
};

}  // namespace

std::vector<Switch> switches_of(const result::Events& events, const std::vector<bool>& is_listed) {
  std::vector<Switch> switches;
  for (const auto& event : events) {
    if (event.mode_before && event.mode_after) {
      const auto &before = *event.mode_before, &after = *event.mode_after;
      for (std::size_t i = 0; i < before.size(); ++i) {
        if (before[i] == after[i] || !is_listed[i]) continue;
        switches.push_back({event.t, 2 * i, fmt::format("{}", before[i]), fmt::format("{}", after[i])});
      }
    }
    if (!event.regions_before || !event.regions_after) continue;
    for (std::size_t g = 0; g < event.regions_before->size(); ++g) {
      auto before = (*event.regions_before)[g], after = (*event.regions_after)[g];
      std::sort(before.begin(), before.end());
      std::sort(after.begin(), after.end());
      if (before == after) continue;
      switches.push_back(
          {event.t, 2 * g + 1, fmt::format("{}", fmt::join(before, " ")), fmt::format("{}", fmt::join(after, " "))});
    }
  }
  return switches;
}

SwitchComparison compare_switches(const std::vector<double>& times, const std::vector<std::vector<Switch>>& simulated,
                                  const std::vector<Switch>& solution, double end_tolerance) {
  SwitchComparison comparison;
  std::vector<bool> found(solution.size(), false);
  std::vector<TimeSpan> intervals;
  for (std::size_t k = 0; k + 1 < times.size(); ++k) {
    intervals.push_back({times[k], times[k + 1], end_tolerance * (times[k + 1] - times[k])});
    OneInterval(intervals.back(), simulated[k], solution, found, comparison).compare();
  }
  for (std::size_t i = 0; i < solution.size(); ++i) {
    const auto inside = [&](const TimeSpan& interval) { return interval.is_inside(solution[i].t); };
    if (!found[i] && std::any_of(intervals.begin(), intervals.end(), inside)) ++comparison.extra;
  }
  return comparison;
}

}  // namespace saltus::pipeline
