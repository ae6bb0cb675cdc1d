// Every verified decision of two surfaces as a system of its own: fields with exactly those normal components at the
// event, simulated through it.
#include <array>
#include <cmath>
#include <fstream>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "problems/simulator.hpp"
#include "source_folder.hpp"

namespace saltus::problems {
namespace {

using nlohmann::json;

constexpr std::array<const char*, 4> corners{"--", "+-", "-+", "++"};

/// Step weights of a corner.
std::string weight(std::size_t corner) {
  return fmt::format("*{}*{}", (corner & 1U) != 0 ? "step(s1)" : "(1 - step(s1))",
                     (corner & 2U) != 0 ? "step(s2)" : "(1 - step(s2))");
}

/// psi_j = y_j; y_j' = f_j^k + t rate_j^k.
std::string model(const json& f1, const json& f2, const json& rate1, const json& rate2, std::array<double, 2> start) {
  std::string text = "[model]\nname = \"verified-case\"\n[states]\n";
  text += fmt::format("y1 = {}\ny2 = {}\n[switching]\ns1 = \"y1\"\ns2 = \"y2\"\n[dynamics]\n", start[0], start[1]);
  for (const int row : {1, 2}) {
    text += fmt::format("y{} = \"0", row);
    for (std::size_t k = 0; k < 4; ++k) {
      const double velocity = (row == 1 ? f1 : f2).at(corners[k]);
      const double rate = (row == 1 ? rate1 : rate2).at(corners[k]);
      text += fmt::format(" + (({}) + ({})*t){}", velocity, rate, weight(k));
    }
    text += "\"\n";
  }
  return text;
}

json no_rate() { return {{"--", 0.0}, {"+-", 0.0}, {"-+", 0.0}, {"++", 0.0}}; }

json cases(const std::string& situation) {
  std::ifstream file(tests::source_folder("tests/data/switching_cases.json"));
  const json data = json::parse(file);
  json result = json::array();
  for (const auto& one : data.at("cases")) {
    if (one.at("situation") == situation) result.push_back(one);
  }
  return result;
}

/// The switch at t = `time` goes over into the first expected mode, or into another one of them if `any_expected`.
enum class Expected { first, any };
void expect_switch(const result::Result& result, double time, double tolerance, const json& one, Expected which) {
  EXPECT_EQ(result.status.termination, result::Termination::completed) << result.status.message;
  const auto switches = switches_of(result);
  ASSERT_FALSE(switches.empty());
  const auto& event = switches.front();
  EXPECT_NEAR(event.t, time, tolerance) << event.reason;
  const json& expected = one.at("expected");
  std::size_t outcome = 0;
  for (std::size_t i = 0; which == Expected::any && i < expected.size(); ++i) {
    if (expected[i].at("mode") == json(event.mode_after.value())) outcome = i;
  }
  EXPECT_EQ(json(event.mode_after.value()), expected[outcome].at("mode")) << event.reason;
  for (std::size_t j = 0; j < 2; ++j) {
    const double alpha = 0.5 * (1.0 + expected[outcome].at("lambda")[j].get<double>());
    EXPECT_NEAR(event.alpha_after.value()[j], alpha, 1e-9) << event.reason;
  }
}

/// The system, and the same one reflected, scaled and in other orders.
void expect_switch(const std::string& text, double time, double tolerance, const json& one, Expected which) {
  SCOPED_TRACE(one.at("id").get<std::string>() + "\n" + text);
  const Simulator simulator = Simulator::from_text(text);
  expect_switch(simulator.run(with(simulator.options(), fine)), time, tolerance, one, which);
  for (const Relabelling& relabelling : relabellings()) {
    SCOPED_TRACE(relabelling.name);
    const Simulator other = Simulator::from_text(text, relabelling);
    const auto result = other.run(with(other.options(), fine));
    expect_switch(in_original_words(result, relabelling, {"s1", "s2"}), time, tolerance, one, which);
  }
}

TEST(SwitchingCases, SlidingOnOneSurfaceReachesTheOther) {
  const json all = cases("enter_codim2_from_codim1");
  EXPECT_EQ(all.size(), 120U);
  for (const auto& one : all) {
    const auto incoming = one.at("incoming").get<std::array<int, 2>>();
    // From a distance that the sliding solution covers in half a unit of time.
    const std::size_t active = incoming[0] == 0 ? 0 : 1;
    const int side = incoming[1 - active];
    const std::size_t low = side > 0 ? std::size_t{2} >> active : 0;
    const std::size_t high = low | std::size_t{1} << active;
    const json& own = one.at(active == 0 ? "f1" : "f2");
    const json& across = one.at(active == 0 ? "f2" : "f1");
    const double below = own.at(corners[low]), above = own.at(corners[high]);
    const double velocity =
        (across.at(corners[low]).get<double>() * above - across.at(corners[high]).get<double>() * below) /
        (above - below);
    std::array<double, 2> start{};
    start[1 - active] = -0.5 * velocity;
    const std::string text = model(one.at("f1"), one.at("f2"), no_rate(), no_rate(), start);
    expect_switch(text + "[simulate]\nuntil = 0.6\n", 0.5, 1e-12, one, Expected::first);
  }
}

constexpr const char* sliding_on_both = "[simulate]\nfrom = {}\nuntil = {}\ninitial_mode = {{ s1 = 0, s2 = 0 }}\n";

/// All cases of a situation, with the rates of their fields, slide on both surfaces to the switch at t = 0.
void expect_exits(const std::string& situation, std::size_t count, double tolerance) {
  const json all = cases(situation);
  EXPECT_EQ(all.size(), count);
  for (const auto& one : all) {
    const json& rate = one.at("dfdt");
    const std::string text = model(one.at("f1"), one.at("f2"), rate.at("df1"), rate.at("df2"), {0.0, 0.0});
    expect_switch(text + fmt::format(sliding_on_both, -1e-3, 1e-3), 0.0, tolerance, one, Expected::first);
  }
}

TEST(SwitchingCases, SelectionLeavesTheSquare) { expect_exits("exit_codim2_a", 30, 1e-12); }

// The data touch to 1e-12 only.
TEST(SwitchingCases, RootsVanish) { expect_exits("exit_codim2_b", 70, 1e-9); }

TEST(SwitchingCases, NoScalingStabilisesTheRoot) {
  const json all = cases("exit_codim2_c2");
  EXPECT_EQ(all.size(), 80U);
  for (const auto& one : all) {
    // The diagonal element that is 0 grows through it, while the root stays where it is.
    const auto lambda = one.at("lambda_event").get<std::array<double, 2>>();
    const auto diagonal = [&](std::size_t j) {
      const json& f = one.at(j == 0 ? "f1" : "f2");
      const double other = 0.5 * (1.0 + lambda[1 - j]);
      const auto difference = [&](std::size_t base) {
        return f.at(corners[base | std::size_t{1} << j]).get<double>() - f.at(corners[base]).get<double>();
      };
      return (1.0 - other) * difference(0) + other * difference(std::size_t{2} >> j);
    };
    const std::size_t vanishing = std::abs(diagonal(0)) < std::abs(diagonal(1)) ? 0 : 1;
    std::array<json, 2> rate{no_rate(), no_rate()};
    for (std::size_t k = 0; k < 4; ++k) {
      rate[vanishing][corners[k]] = ((k >> vanishing & 1U) != 0 ? 1.0 : -1.0) - lambda[vanishing];
    }
    const std::string text =
        model(one.at("f1"), one.at("f2"), rate[0], rate[1], {0.0, 0.0}) + fmt::format(sliding_on_both, -1e-3, 1e-3);
    if (!one.at("spiral_out").get<bool>()) {
      expect_switch(text, 0.0, 1e-9, one, Expected::any);
      continue;
    }
    SCOPED_TRACE(one.at("id").get<std::string>() + "\n" + text);
    const Simulator simulator = Simulator::from_text(text);
    const auto switches = switches_of(simulator.run(with(simulator.options(), fine)));
    ASSERT_GE(switches.size(), 5U);  // it goes round
    EXPECT_NEAR(switches[0].t, 0.0, 1e-9);
    for (std::size_t k = 0; k < switches.size(); ++k) {
      const auto& event = switches[k];
      EXPECT_NE(event.mode_after.value()[0] * event.mode_after.value()[1], 0) << event.reason;
      // Only where it begins do both surfaces meet, and every cycle takes longer than the one before.
      EXPECT_EQ(event.intersection.has_value(), k == 0) << event.reason;
      if (k < 9) continue;
      EXPECT_GT(event.t - switches[k - 4].t, switches[k - 4].t - switches[k - 8].t) << event.reason;
    }
    EXPECT_EQ(switches[0].unique, false);
  }
}

}  // namespace
}  // namespace saltus::problems
