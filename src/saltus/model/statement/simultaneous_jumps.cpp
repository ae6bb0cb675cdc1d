// Jumps with given times that set one state at one time, from values before either.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "saltus/base/at.hpp"
#include "saltus/base/contains.hpp"
#include "saltus/base/same_time.hpp"
#include "saltus/model/statement/jumps_internal.hpp"
#include "saltus/model/system.hpp"

namespace saltus::model {
namespace {

bool is_multiple(double time, double period) {
  const double multiple = std::round(time / period);
  return multiple > 0.0 && is_same_time(multiple * period, time);
}

/// Whether two jumps have a time in common, as far as their times say: periods are counted from 0.
bool come_together(const Jump& a, const Jump& b) {
  if (a.trigger != JumpTrigger::times || b.trigger != JumpTrigger::times) return false;
  if (a.every > 0.0 && b.every > 0.0) {
    constexpr int most_periods = 100;
    for (int k = 1; k <= most_periods; ++k) {
      if (is_multiple(k * a.every, b.every)) return true;
    }
    return false;
  }
  if (a.every > 0.0) return come_together(b, a);
  return std::any_of(a.times.begin(), a.times.end(), [&](double time) {
    if (b.every > 0.0) return is_multiple(time, b.every);
    return std::any_of(b.times.begin(), b.times.end(), [&](double other) { return is_same_time(time, other); });
  });
}

/// Whether a jump executes before another one that stands behind it in the file; nothing where only a run knows.
bool comes_first(const Jump& first, const Jump& behind) {
  if (!first.priority.is_constant() || !behind.priority.is_constant()) return true;
  return static_cast<double>(first.priority) >= static_cast<double>(behind.priority);
}

/// A state that both set and that the later one reads, so that what the earlier one has set is lost; -1 without.
int lost_state(const Jump& earlier, const Jump& later, const casadi::SX& x) {
  for (std::size_t i = 0; i < later.targets.size(); ++i) {
    const int state = later.targets[i];
    if (contains(earlier.targets, state) &&
        casadi::SX::depends_on(later.values(static_cast<casadi_int>(i)), x(state))) {
      return state;
    }
  }
  return -1;
}

}  // namespace

void warn_of_lost_values(const Statement& statement, const System& system, std::vector<std::string>& warnings) {
  const auto& jumps = system.jumps;
  for (std::size_t k = 0; k < jumps.size(); ++k) {
    for (std::size_t i = 0; i < k; ++i) {
      const bool in_order = comes_first(jumps[i], jumps[k]);
      const std::size_t first = in_order ? i : k, last = in_order ? k : i;
      const int state = statement.jumps[last].evaluated ? -1 : lost_state(jumps[first], jumps[last], system.x);
      if (state < 0 || !come_together(jumps[i], jumps[k])) continue;
      const auto& name = system.state_names[at(state)];
      warnings.push_back(located(
          statement.jumps[last].location,
          fmt::format("the jumps '{0}' and '{1}' come at one time, and what '{0}' sets {2} to is lost: '{1}' sets it "
                      "from the value before both; with values = \"execution\" it takes the one that '{0}' has set "
                      "(values = \"trigger\" says that the value before is meant)",
                      jumps[first].name, jumps[last].name, name)));
    }
  }
}

}  // namespace saltus::model
