// Selection policies in whole simulations: the verified instances of the ambiguous leaves, entered by sliding.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "problems/simulator.hpp"
#include "source_folder.hpp"

namespace saltus::problems {
namespace {

using nlohmann::json;
using result::Result;
using result::Termination;

std::vector<json> ambiguous_entries() {
  std::ifstream file(tests::source_folder("tests/data/switching_cases.json"));
  const json document = json::parse(file);
  std::vector<json> found;
  for (const json& instance : document.at("cases")) {
    const auto leaf = instance.at("leaf").get<std::string>();
    if (leaf == "E10" || leaf == "E12") found.push_back(instance);
  }
  return found;
}

/// Constant fields in the quadrants; the start is on one axis, at distance 1 from the other one.
std::string text_of(const json& instance, const std::string& simulate) {
  const auto incoming = instance.at("incoming").get<std::vector<int>>();
  std::string text =
      fmt::format("[model]\nname = \"ambiguous\"\n[states]\ny1 = {}\ny2 = {}\n", incoming[0], incoming[1]);
  text += "[switching]\ns1 = \"y1\"\ns2 = \"y2\"\n";
  for (const std::string region : {"--", "-+", "+-", "++"}) {
    const auto side = [&](std::size_t j) { return region[j] == '+' ? ">" : "<"; };
    text +=
        fmt::format("[[modes]]\nwhen = \"s1 {} 0 and s2 {} 0\"\ndynamics = {{ y1 = \"{}\", y2 = \"{}\" }}\n", side(0),
                    side(1), instance.at("f1").at(region).get<double>(), instance.at("f2").at(region).get<double>());
  }
  return text + "[simulate]\nuntil = 1000\nmax_events = 10\n" + simulate;
}

/// The event at the intersection, the second one.
result::Event at_intersection(const json& instance, const std::string& simulate) {
  const Simulator simulator = Simulator::from_text(text_of(instance, simulate));
  const Result result = simulator.run(simulator.options());
  EXPECT_EQ(result.status.termination, Termination::completed) << instance.at("id") << result.status.message;
  if (result.events.size() < 2) return {};
  return result.events[1];
}

std::vector<int> expected_mode(const json& instance, const std::string& limit) {
  return instance.at("expected").at(instance.at(limit) == "second" ? 1 : 0).at("mode").get<std::vector<int>>();
}

TEST(Policies, DominantOnesTakeTheirLimit) {
  const auto instances = ambiguous_entries();
  ASSERT_EQ(instances.size(), 20U);
  bool differ = false;
  for (const json& instance : instances) {
    const auto active = at_intersection(instance, "[simulate.event]\nselection = \"active_dominant\"\n");
    EXPECT_EQ(active.mode_after, expected_mode(instance, "active_dominant_limit")) << instance.at("id");
    const auto passive = at_intersection(instance, "[simulate.event]\nselection = \"passive_dominant\"\n");
    EXPECT_EQ(passive.mode_after, expected_mode(instance, "passive_dominant_limit")) << instance.at("id");
    differ = differ || active.mode_after != passive.mode_after;
  }
  EXPECT_TRUE(differ);
}

TEST(Policies, ReportGoesOnLikeActiveDominantAndListsAll) {
  for (const json& instance : ambiguous_entries()) {
    const auto event = at_intersection(instance, "[simulate.event]\nselection = \"report\"\n");
    EXPECT_EQ(event.mode_after, expected_mode(instance, "active_dominant_limit")) << instance.at("id");
    EXPECT_EQ(event.unique, false) << instance.at("id");
    const auto other = instance.at("expected").at(1).at("mode").get<std::vector<int>>();
    const auto is_other = [&](const auto& alternative) { return alternative.mode == other; };
    EXPECT_TRUE(std::any_of(event.alternatives.begin(), event.alternatives.end(), is_other)) << instance.at("id");
  }
}

// The engine weighs a surface by 1 over its largest normal component times what the user says; the instances were
// verified for weights as they stand.
TEST(Policies, ScaledTakesWhatTheHiddenDynamicsDoUnderThatScaling) {
  int second = 0;
  for (const json& instance : ambiguous_entries()) {
    for (const json& verified : instance.at("verified").at("scalings")) {
      double scaling[2];
      for (std::size_t j = 0; j < 2; ++j) {
        double largest = 0.0;
        for (const json& f : instance.at(j == 0 ? "f1" : "f2")) largest = std::max(largest, std::abs(f.get<double>()));
        scaling[j] = verified.at("kappa").at(j).get<double>() * largest;
      }
      const auto event = at_intersection(
          instance, fmt::format("[simulate.event]\nselection = \"scaled\"\nscaling = {{ s1 = {}, s2 = {} }}\n",
                                scaling[0], scaling[1]));
      const auto mode = verified.at("mode").get<std::vector<int>>();
      EXPECT_EQ(event.mode_after, mode) << instance.at("id") << ", " << verified.at("kappa");
      second += mode == std::vector<int>{0, 0} ? 0 : 1;
    }
  }
  EXPECT_GT(second, 10);
}

}  // namespace
}  // namespace saltus::problems
