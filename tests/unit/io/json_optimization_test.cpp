#include <cmath>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "../report/sample_optimization.hpp"
#include "saltus/io/json/json_result.hpp"

namespace saltus::io {
namespace {

using nlohmann::ordered_json;

// Texts are compared, since NaN is unequal to itself: equal values give equal texts.
TEST(JsonOptimization, ReadsBackEqual) {
  auto original = report_samples::turbo_car();
  original.optimization->verification->path_violations = {{"v <= 25", 3.5, 0.25, 0.01}};
  const auto text = to_json(original);
  const auto read = parse_result(text, "r.json");
  ASSERT_TRUE(read) << to_text(read.error());
  EXPECT_EQ(to_json(*read), text);
  ASSERT_TRUE(read->optimization);
  const auto& optimization = *read->optimization;
  EXPECT_EQ(optimization.u, original.optimization->u);
  EXPECT_EQ(optimization.h, original.optimization->h);
  EXPECT_EQ(optimization.nodes, original.optimization->nodes);
  EXPECT_EQ(optimization.parameters, original.optimization->parameters);
  EXPECT_EQ(optimization.primal, original.optimization->primal);
  EXPECT_TRUE(std::signbit(optimization.primal[2]));
  EXPECT_EQ(optimization.dual_rows, original.optimization->dual_rows);
  EXPECT_EQ(optimization.dual_lower, original.optimization->dual_lower);
  EXPECT_EQ(optimization.dual_upper, original.optimization->dual_upper);
  EXPECT_EQ(optimization.statistics.pairs, 240);
  EXPECT_EQ(optimization.statistics.linear_algebra_seconds, 0.29);
  EXPECT_EQ(optimization.homotopy.size(), 13U);
  EXPECT_EQ(optimization.homotopy[4].message, "no better point within 300 iterations");
  EXPECT_EQ(optimization.homotopy[11].phase, result::HomotopyPhase::lpcc);
  EXPECT_EQ(optimization.verification->interval, 3);
  EXPECT_EQ(optimization.verification->path_violations.at(0).time, 3.5);
  EXPECT_EQ(optimization.verification->open_loop.x, original.optimization->verification->open_loop.x);
  EXPECT_EQ(optimization.multipliers[1].value, 1.0 / 15.0);
}

TEST(JsonOptimization, HasTheKeysOfTheContractAndItsOwnStatistics) {
  const auto json = ordered_json::parse(to_json(report_samples::turbo_car()));
  for (const auto* key : {"objective", "objective_terms", "horizon", "parameters", "u", "grid", "h", "multipliers",
                          "homotopy", "certificate", "verification", "start_values"}) {
    EXPECT_TRUE(json.contains(key)) << key;
  }
  EXPECT_EQ(json["command"], "optimize");
  EXPECT_EQ(json["parameters"], ordered_json({{"k", 3.0}}));
  EXPECT_EQ(json["statistics"]["iterations"], 263);
  EXPECT_FALSE(json["statistics"].contains("steps"));
  EXPECT_FALSE(json.contains("speed_of_time"));
  EXPECT_FALSE(json["homotopy"][0].contains("message"));
  EXPECT_EQ(json["certificate"]["stationarity_type"], "S");
  EXPECT_TRUE(json["certificate"]["lpcc_decrease"].is_null());
}

TEST(JsonOptimization, AMultiplierThatIsNotUniqueHasARange) {
  auto original = report_samples::turbo_car();
  auto& multiplier = original.optimization->multipliers[1];
  multiplier.value = std::numeric_limits<double>::quiet_NaN();
  multiplier.range = {0.375, std::numeric_limits<double>::infinity()};
  original.optimization->certificate.licq = false;
  original.optimization->certificate.dependent = {"v == 0"};
  const auto text = to_json(original);
  const auto json = ordered_json::parse(text);
  EXPECT_TRUE(json["multipliers"][1]["value"].is_null());
  EXPECT_EQ(json["multipliers"][1]["range"], ordered_json::array({0.375, nullptr}));
  EXPECT_FALSE(json["multipliers"][0].contains("range"));
  EXPECT_EQ(json["certificate"]["licq"], false);
  EXPECT_TRUE(json["certificate"]["sosc"].is_null());
  const auto back = parse_result(text, "r.json");
  ASSERT_TRUE(back) << to_text(back.error());
  EXPECT_EQ(back->optimization->multipliers[1].range.front(), 0.375);
  EXPECT_FALSE(std::isfinite(back->optimization->multipliers[1].range.back()));
  EXPECT_EQ(back->optimization->certificate.dependent, original.optimization->certificate.dependent);
}

TEST(JsonOptimization, WhatIsNotKnownIsNull) {
  auto original = report_samples::turbo_car();
  auto& optimization = *original.optimization;
  optimization.certificate.stationarity_type.reset();
  optimization.certificate.b_stationary.reset();
  optimization.certificate.stationarity = std::numeric_limits<double>::quiet_NaN();
  optimization.verification->interval = -1;
  optimization.verification->open_loop.amplification = std::numeric_limits<double>::quiet_NaN();
  optimization.verification->closed_loop = optimization.verification->open_loop;
  optimization.verification->closed_loop->gains = {{0.5, 1, {{-2.0, 0.1}}}};
  optimization.speed_of_time.assign(20, 2.0);
  const auto text = to_json(original);
  const auto json = ordered_json::parse(text);
  EXPECT_TRUE(json["certificate"]["stationarity_type"].is_null());
  EXPECT_TRUE(json["certificate"]["b_stationary"].is_null());
  EXPECT_TRUE(json["certificate"]["stationarity"].is_null());
  EXPECT_TRUE(json["verification"]["interval"].is_null());
  EXPECT_TRUE(json["start_values"]["state_upper"][0].is_null());
  const auto read = parse_result(text, "r.json");
  ASSERT_TRUE(read) << to_text(read.error());
  EXPECT_EQ(to_json(*read), text);
  EXPECT_EQ(read->optimization->certificate.b_stationary, std::nullopt);
  EXPECT_EQ(read->optimization->verification->interval, -1);
  EXPECT_EQ(read->optimization->speed_of_time.size(), 20U);
  EXPECT_EQ(json["verification"]["closed_loop"]["gains"][0]["K"], ordered_json::array({{-2.0, 0.1}}));
  EXPECT_EQ(read->optimization->verification->closed_loop->gains.front().K,
            (std::vector<std::vector<double>>{{-2.0, 0.1}}));
}

TEST(JsonOptimization, AnUnfinishedOneHasNoVerificationAndPerhapsNoControls) {
  auto original = report_samples::turbo_car();
  original.optimization = result::Optimization{};
  const auto read = parse_result(to_json(original), "r.json");
  ASSERT_TRUE(read) << to_text(read.error());
  EXPECT_FALSE(read->optimization->verification.has_value());
}

struct Corruption {
  const char* pointer;
  ordered_json value;
  const char* expected;
};

class MistakenOptimization : public testing::TestWithParam<Corruption> {};

TEST_P(MistakenOptimization, IsRefusedWithItsPlace) {
  auto json = ordered_json::parse(to_json(report_samples::turbo_car()));
  json[ordered_json::json_pointer(GetParam().pointer)] = GetParam().value;
  const auto read = parse_result(json.dump(), "r.json");
  ASSERT_FALSE(read);
  EXPECT_NE(to_text(read.error()).find(GetParam().expected), std::string::npos) << to_text(read.error());
}

INSTANTIATE_TEST_SUITE_P(
    Cases, MistakenOptimization,
    testing::Values(
        Corruption{"/homotopy/2/phase", "relax", "at /homotopy/2/phase: 'relax' is no phase"},
        Corruption{"/homotopy/2/iterations", -1, "at /homotopy/2/iterations: expected a number from 0, found -1"},
        Corruption{"/homotopy/2/iterations", 4000000000,
                   "at /homotopy/2/iterations: expected a number up to 2147483647"},
        Corruption{"/certificate/stationarity_type", "B", "at /certificate/stationarity_type: 'B' is no type"},
        Corruption{"/certificate/b_stationary", 1, "at /certificate/b_stationary: expected true or false, found 1"},
        Corruption{"/verification/open_loop/termination", "fell", "'fell' is no termination"},
        Corruption{"/verification/open_loop/x/4", {1.0}, "at /verification/open_loop/x/4: expected 2 entries, found 1"},
        Corruption{"/u/3", {1.0, 2.0}, "at /u/3: expected 1 entries, found 2"},
        Corruption{"/grid", {0.0, 1.0}, "at /grid: expected 21 entries, found 2"},
        Corruption{"/h", ordered_json::array(), "at /h: expected 20 entries, found 0"},
        Corruption{"/speed_of_time", {1.0}, "at /speed_of_time: expected 20 entries, found 1"},
        Corruption{"/parameters", 3, "at /parameters: expected an object, found 3"},
        Corruption{"/multipliers/0/value", "x", "at /multipliers/0/value: expected a number or null"},
        Corruption{"/objective_terms", {{"running", 0.0}}, "at /objective_terms: 'terminal' is missing"},
        Corruption{"/start_values", ordered_json::object(), "at /start_values: 'nodes' is missing"}),
    [](const auto& mistake) { return "Number" + std::to_string(mistake.index); });

}  // namespace
}  // namespace saltus::io
