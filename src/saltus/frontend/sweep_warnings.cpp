#include "saltus/frontend/sweep_warnings.hpp"

#include <algorithm>
#include <cstddef>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace saltus::frontend {
namespace {

using Runs = std::set<std::size_t>;

/// "run 2", "runs 1 to 3, 5"; of many stretches the first ones.
std::string named(const Runs& runs) {
  constexpr std::size_t most = 4;
  std::vector<std::string> stretches;
  std::size_t told = 0;
  for (auto run = runs.begin(); run != runs.end() && stretches.size() < most;) {
    const std::size_t first = *run;
    std::size_t last = first;
    for (++run; run != runs.end() && *run == last + 1; ++run) last = *run;
    stretches.push_back(first == last ? fmt::format("{}", first) : fmt::format("{} to {}", first, last));
    told += last - first + 1;
  }
  const auto rest = told < runs.size() ? fmt::format(" and {} more", runs.size() - told) : std::string();
  return fmt::format("{} {}{}", runs.size() == 1 ? "run" : "runs", fmt::join(stretches, ", "), rest);
}

}  // namespace

std::vector<std::string> told_with_runs(const std::vector<pipeline::SweepWarning>& warnings) {
  std::vector<std::pair<std::string, Runs>> merged;
  for (const auto& warning : warnings) {
    auto known = std::find_if(merged.begin(), merged.end(), [&](const auto& one) { return one.first == warning.text; });
    if (known == merged.end()) known = merged.insert(known, {warning.text, {}});
    known->second.insert(warning.runs.begin(), warning.runs.end());
  }
  const auto first_run = [](const auto& warning) { return warning.second.empty() ? 0 : *warning.second.begin(); };
  std::stable_sort(merged.begin(), merged.end(),
                   [&](const auto& a, const auto& b) { return first_run(a) < first_run(b); });
  std::vector<std::string> told;
  for (const auto& [text, runs] : merged) {
    told.push_back(runs.empty() ? text : fmt::format("{} (in {})", text, named(runs)));
  }
  return told;
}

}  // namespace saltus::frontend
