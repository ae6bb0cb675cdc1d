// Both engines on random systems: where the solution is unique they find the same.
#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "campaign.hpp"
#include "random_systems_model.hpp"

namespace saltus::robustness {
namespace {

using result::EventKind;
using result::Result;
using result::Termination;

bool is_unique(const Result& result) {
  return std::all_of(result.events.begin(), result.events.end(), [](const auto& event) {
    return event.unique.value_or(false) && event.kind != EventKind::accumulation;
  });
}

/// Where two surfaces are met at once Filippov's set, all convex combinations of the fields around, is larger than that
/// of the multi-affine field: Stewart's form has other solutions there (docs/fesd.md).
bool meets_two_surfaces(const Result& result) {
  return std::any_of(result.events.begin(), result.events.end(), [](const auto& event) {
    if (!event.mode_before || !event.mode_after) return event.surfaces.size() > 1;
    const auto &before = *event.mode_before, &after = *event.mode_after;
    int surfaces = 0;
    for (std::size_t j = 0; j < before.size(); ++j) {
      surfaces += before[j] != after[j] || before[j] == 0 || after[j] == 0 ? 1 : 0;
    }
    return surfaces > 1;
  });
}

double distance(const Result& a, const Result& b) {
  double largest = 0.0, size = 1.0;
  for (std::size_t i = 0; i < a.final.x.size(); ++i) {
    largest = std::max(largest, std::abs(a.final.x[i] - b.final.x[i]));
    size = std::max(size, std::abs(a.final.x[i]));
  }
  return largest / size;
}

struct ElementTally {
  int compared = 0;
  int left_out = 0;  ///< not unique (also in the form), accumulating, outside the class, or too sensitive
  std::string disagreements;
};

struct Campaign {
  Family family = Family::affine;
  Reformulation form = Reformulation::step;
  std::uint64_t systems = 100;
};

void compare(const Campaign& campaign, std::uint64_t seed, ElementTally& tally) {
  const RandomSystem system = draw(campaign.family, seed);
  const Model model(system);
  const Result tight = model.run({Integrator::dop853, 1e-12}, system.start);
  const Result loose = model.run({Integrator::dop853, 1e-8}, system.start);
  const bool comparable = tight.status.termination == Termination::completed && is_unique(tight) &&
                          loose.events.size() == tight.events.size() && distance(loose, tight) < 1e-6;
  if (!comparable || model.has_equal_surfaces() ||
      (campaign.form == Reformulation::stewart && meets_two_surfaces(tight))) {
    ++tally.left_out;
    return;
  }
  ++tally.compared;
  const Result elements = model.run({.form = campaign.form});
  // Every event adds its error: one of the systems has a thousand.
  const double tolerance = 1e-8 * std::max(1.0, static_cast<double>(tight.events.size()) / 100.0);
  const double apart = elements.final.x.empty() ? INFINITY : distance(elements, tight);
  if (elements.status.termination == Termination::completed && apart < tolerance) return;
  tally.disagreements += fmt::format("seed {}: {} at t = {}, end states {} apart, {} and {} events\n", seed,
                                     name(elements.status.termination), elements.status.time_reached, apart,
                                     elements.events.size(), tight.events.size());
}

class RandomElements : public testing::TestWithParam<Campaign> {};

TEST_P(RandomElements, AgreeWithTheEventEngineWhereTheSolutionIsUnique) {
  const Campaign& campaign = GetParam();
  ElementTally tally;
  const std::uint64_t systems = of_campaign(campaign.systems);
  for (std::uint64_t seed = 0; seed < systems; ++seed) compare(campaign, seed, tally);
  EXPECT_EQ(tally.disagreements, "") << tally.compared << " compared, " << tally.left_out << " left out";
  EXPECT_GE(10 * static_cast<std::uint64_t>(tally.compared), 7 * systems);
}

INSTANTIATE_TEST_SUITE_P(Campaigns, RandomElements,
                         testing::Values(Campaign{Family::affine, Reformulation::step, 200},
                                         Campaign{Family::affine, Reformulation::stewart, 200},
                                         Campaign{Family::nested}, Campaign{Family::friction}, Campaign{Family::smooth},
                                         Campaign{Family::constant}),
                         [](const auto& instance) {
                           return name(instance.param.family) +
                                  (instance.param.form == Reformulation::step ? "_step" : "_stewart");
                         });

}  // namespace
}  // namespace saltus::robustness
