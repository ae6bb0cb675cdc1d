// Campaigns over other seeds than those of the tests: saltus_random_campaign FAMILY FIRST COUNT.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>

#include <fmt/format.h>

#include "hybrid_systems.hpp"
#include "random_systems_campaign.hpp"
#include "region_systems.hpp"

using namespace saltus::robustness;

namespace {

/// A campaign in parts, whose complaints are printed as they come.
int run(const std::string& family, std::uint64_t first, std::uint64_t last, std::uint64_t at_once,
        const std::function<Tally(std::uint64_t, std::uint64_t)>& campaign) {
  Tally total;
  for (std::uint64_t seed = first; seed < last; seed += at_once) {
    const Tally tally = campaign(seed, std::min(at_once, last - seed));
    total += tally;
    for (const auto& failure : tally.failures) fmt::print("{}\n", failure);
    std::fflush(stdout);
  }
  fmt::print("{} {} to {}: {} systems, {} completed, {} outside the class, {} not unique, {} sensitive, {} events",
             family, first, last - 1, total.systems, total.completed, total.outside_class, total.not_unique,
             total.sensitive, total.events);
  if (total.jumps > 0) fmt::print(" ({} jumps, {} limits)", total.jumps, total.accumulations);
  if (total.held_by_three > 0) fmt::print(", {} rows with three regions and more", total.held_by_three);
  fmt::print(", {} complaints\n", total.failures.size());
  return total.failures.empty() ? 0 : 1;
}

}  // namespace

int main(int count, char** arguments) {
  const std::string wanted = count == 4 ? arguments[1] : "";
  const std::uint64_t first = count == 4 ? std::strtoull(arguments[2], nullptr, 10) : 0;
  const std::uint64_t last = count == 4 ? first + std::strtoull(arguments[3], nullptr, 10) : 0;
  if (wanted == "regions") return run(wanted, first, last, 1, run_region_campaign);
  for (const HybridFamily family : hybrid_families) {
    if (name(family) != wanted) continue;
    return run(wanted, first, last, 1, [&](auto from, auto systems) { return run_campaign(family, from, systems); });
  }
  for (const Family family : families) {
    if (name(family) != wanted) continue;
    return run(wanted, first, last, 100, [&](auto from, auto systems) { return run_campaign(family, from, systems); });
  }
  fmt::print(stderr,
             "usage: saltus_random_campaign affine|constant|smooth|nested|friction|jumps|relays|regions FIRST COUNT\n");
  return 2;
}
