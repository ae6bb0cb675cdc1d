#include "saltus/frontend/best_of_starts.hpp"

#include <algorithm>
#include <cstddef>
#include <string_view>
#include <utility>

#include "saltus/base/contracts.hpp"
#include "saltus/result/better_start.hpp"

namespace saltus::frontend {
namespace {

constexpr std::string_view seed_key = "optimize.mpcc.seed";

/// The result is one of all starts: that it was found from one alone is no setting of it.
void forget_seed(result::Result& optimum) {
  std::erase_if(optimum.model.settings,
                [](const auto& setting) { return setting.starts_with(seed_key) && setting[seed_key.size()] == '='; });
  for (auto& [key, value] : optimum.options) {
    if (key == seed_key) value = std::string("none");
  }
}

}  // namespace

result::Result best_of_starts(const std::vector<std::shared_ptr<result::Result>>& optima) {
  std::vector<std::pair<result::StartOutcome, std::size_t>> all;
  for (std::size_t i = 0; i < optima.size(); ++i) {
    SALTUS_ASSERT(optima[i]->optimization && optima[i]->optimization->starts.size() == 1);
    all.emplace_back(optima[i]->optimization->starts.front(), i);
    all.back().first.is_taken = false;
  }
  SALTUS_ASSERT(!all.empty());
  std::sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.first.seed < b.first.seed; });
  const auto taken = std::min_element(all.begin(), all.end(), [](const auto& a, const auto& b) {
    return is_better(a.first, b.first);  // the first of equals
  });
  taken->first.is_taken = true;
  result::Result best = *optima[taken->second];
  auto& of = *best.optimization;
  of.starts.clear();
  for (const auto& [outcome, index] : all) {
    of.starts.push_back(outcome);
    if (index != taken->second) of.statistics.iterations += outcome.iterations;
  }
  if (of.starts.size() == 1) of.starts.clear();
  forget_seed(best);
  return best;
}

}  // namespace saltus::frontend
