// Campaigns over other seeds than those of the tests: saltus_random_campaign FAMILY FIRST COUNT.
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <iterator>
#include <string>

#include <fmt/format.h>

#include "hybrid_systems.hpp"
#include "random_systems_campaign.hpp"
#include "region_systems.hpp"

using namespace saltus::robustness;

namespace {

/// The same for the families with jumps.
int run_hybrid(HybridFamily family, std::uint64_t first, std::uint64_t last) {
  HybridTally total;
  for (std::uint64_t seed = first; seed < last; ++seed) {
    const HybridTally tally = run_campaign(family, seed, 1);
    total.systems += tally.systems;
    total.completed += tally.completed;
    total.outside_class += tally.outside_class;
    total.sensitive += tally.sensitive;
    total.events += tally.events;
    total.jumps += tally.jumps;
    total.accumulations += tally.accumulations;
    total.failures.insert(total.failures.end(), tally.failures.begin(), tally.failures.end());
    for (const auto& failure : tally.failures) fmt::print("{}\n", failure);
    std::fflush(stdout);
  }
  fmt::print(
      "{} {} to {}: {} systems, {} completed, {} outside the class, {} sensitive, {} events ({} of jumps, {} limits), "
      "{} complaints\n",
      name(family), first, last - 1, total.systems, total.completed, total.outside_class, total.sensitive, total.events,
      total.jumps, total.accumulations, total.failures.size());
  return total.failures.empty() ? 0 : 1;
}

int run_regions(std::uint64_t first, std::uint64_t last) {
  RegionTally total;
  for (std::uint64_t seed = first; seed < last; ++seed) {
    const RegionTally tally = run_region_campaign(seed, 1);
    total.systems += tally.systems;
    total.completed += tally.completed;
    total.outside_class += tally.outside_class;
    total.not_unique += tally.not_unique;
    total.sensitive += tally.sensitive;
    total.events += tally.events;
    total.held_by_three += tally.held_by_three;
    total.failures.insert(total.failures.end(), tally.failures.begin(), tally.failures.end());
    for (const auto& failure : tally.failures) fmt::print("{}\n", failure);
    std::fflush(stdout);
  }
  fmt::print(
      "regions {} to {}: {} systems, {} completed, {} outside the class, {} not unique, {} sensitive, {} events, {} "
      "rows "
      "with three and more, {} complaints\n",
      first, last - 1, total.systems, total.completed, total.outside_class, total.not_unique, total.sensitive,
      total.events, total.held_by_three, total.failures.size());
  return total.failures.empty() ? 0 : 1;
}

}  // namespace

int main(int count, char** arguments) {
  const auto hybrid = std::find_if(std::begin(hybrid_families), std::end(hybrid_families),
                                   [&](HybridFamily f) { return count == 4 && name(f) == arguments[1]; });
  if (count == 4 && std::string(arguments[1]) == "regions") {
    const std::uint64_t first = std::strtoull(arguments[2], nullptr, 10);
    return run_regions(first, first + std::strtoull(arguments[3], nullptr, 10));
  }
  if (hybrid != std::end(hybrid_families)) {
    const std::uint64_t first = std::strtoull(arguments[2], nullptr, 10);
    return run_hybrid(*hybrid, first, first + std::strtoull(arguments[3], nullptr, 10));
  }
  const auto family = std::find_if(std::begin(families), std::end(families),
                                   [&](Family f) { return count == 4 && name(f) == arguments[1]; });
  if (family == std::end(families)) {
    fmt::print(
        stderr,
        "usage: saltus_random_campaign affine|constant|smooth|nested|friction|jumps|relays|regions FIRST COUNT\n");
    return 2;
  }
  const std::uint64_t first = std::strtoull(arguments[2], nullptr, 10);
  const std::uint64_t last = first + std::strtoull(arguments[3], nullptr, 10);
  constexpr std::uint64_t at_once = 100;
  Tally total;
  for (std::uint64_t seed = first; seed < last; seed += at_once) {
    const Tally tally = run_campaign(*family, seed, std::min(at_once, last - seed));
    total.systems += tally.systems;
    total.completed += tally.completed;
    total.outside_class += tally.outside_class;
    total.not_unique += tally.not_unique;
    total.sensitive += tally.sensitive;
    total.events += tally.events;
    total.failures.insert(total.failures.end(), tally.failures.begin(), tally.failures.end());
    for (const auto& failure : tally.failures) fmt::print("{}\n", failure);
    std::fflush(stdout);
  }
  fmt::print(
      "{} {} to {}: {} systems, {} completed, {} outside the class, {} not unique, {} sensitive, {} events, "
      "{} complaints\n",
      name(*family), first, last - 1, total.systems, total.completed, total.outside_class, total.not_unique,
      total.sensitive, total.events, total.failures.size());
  return total.failures.empty() ? 0 : 1;
}
