// Campaigns over other seeds than those of the tests: saltus_random_campaign FAMILY FIRST COUNT.
// With --outcomes before these no check is made, and each system has a line of outcomes.hpp (outcomes.py compares
// them).
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "hybrid_systems.hpp"
#include "outcomes.hpp"
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

/// Seeds first to last - 1 of a family.
struct Part {
  std::string family;
  std::uint64_t first = 0, last = 0;
};

int print_outcomes(const Part& part, const std::function<std::string(std::uint64_t)>& outcome) {
  fmt::print("{}\n", outcome_columns());
  for (std::uint64_t seed = part.first; seed < part.last; ++seed) fmt::print("{}\n", outcome(seed));
  return 0;
}

int outcomes(const Part& part) {
  if (part.family == "regions") return print_outcomes(part, outcome_of_regions);
  for (const HybridFamily family : hybrid_families) {
    if (name(family) != part.family) continue;
    return print_outcomes(part, [family](std::uint64_t seed) { return outcome_of(family, seed); });
  }
  for (const Family family : families) {
    if (name(family) != part.family) continue;
    return print_outcomes(part, [family](std::uint64_t seed) { return outcome_of(family, seed); });
  }
  return 2;
}

int campaign(const Part& part) {
  const auto& [wanted, first, last] = part;
  if (wanted == "regions") return run(wanted, first, last, 1, run_region_campaign);
  for (const HybridFamily family : hybrid_families) {
    if (name(family) != wanted) continue;
    return run(wanted, first, last, 1, [&](auto from, auto systems) { return run_campaign(family, from, systems); });
  }
  for (const Family family : families) {
    if (name(family) != wanted) continue;
    return run(wanted, first, last, 100, [&](auto from, auto systems) { return run_campaign(family, from, systems); });
  }
  return 2;
}

}  // namespace

int main(int count, char** arguments) {
  const bool listed = count > 1 && std::string_view(arguments[1]) == "--outcomes";
  const int given = count - (listed ? 2 : 1);
  int outcome = 2;
  if (given == 3) {
    char** const words = arguments + (listed ? 2 : 1);
    const std::uint64_t first = std::strtoull(words[1], nullptr, 10);
    const Part part{words[0], first, first + std::strtoull(words[2], nullptr, 10)};
    outcome = listed ? outcomes(part) : campaign(part);
  }
  if (outcome == 2) {
    fmt::print(stderr,
               "usage: saltus_random_campaign [--outcomes] affine|constant|smooth|nested|friction|jumps|relays|regions "
               "FIRST COUNT\n");
  }
  return outcome;
}
