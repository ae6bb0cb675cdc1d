// Campaigns over other seeds than those of the tests: saltus_random_campaign FAMILY FIRST COUNT.
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <iterator>
#include <string>

#include <fmt/format.h>

#include "random_systems_campaign.hpp"

using namespace saltus::robustness;

int main(int count, char** arguments) {
  const auto family = std::find_if(std::begin(families), std::end(families),
                                   [&](Family f) { return count == 4 && name(f) == arguments[1]; });
  if (family == std::end(families)) {
    fmt::print(stderr, "usage: saltus_random_campaign affine|constant|smooth|nested|friction FIRST COUNT\n");
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
