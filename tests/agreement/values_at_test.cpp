#include "saltus/pipeline/values_at.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "saltus/io/toml/toml_model.hpp"
#include "saltus/model/build.hpp"

namespace saltus::pipeline {
namespace {

struct Model {
  model::System system;
  SimulateOptions options;
};

Model model_of(const std::string& text) {
  auto file = io::parse_model(text, "m.toml");
  EXPECT_TRUE(file) << to_text(file.error());
  auto system = model::build(file->description, {});
  EXPECT_TRUE(system) << to_text(system.error());
  file->simulate.native = Native::off;
  return {std::move(*system), file->simulate};
}

const char* const ball =
    "[model]\nname = \"ball\"\n[states]\ny = 1\nv = 0\n[dynamics]\ny = \"v\"\nv = \"-9.81\"\n[outputs]\nenergy = "
    "\"9.81*y + v^2/2\"\n[[jumps]]\nname = \"bounce\"\nwhen = \"y\"\ndirection = \"down\"\nset = { v = \"-0.8*v\" }\n"
    "[simulate]\nuntil = 2\n";

/// sign(sin t) is integrated: 100 switches of a surface that moves.
const char* const through_switches =
    "[model]\nname = \"waves\"\n[states]\nx = 1\nv = 0\nw = 0\ns = 0.5\n[dynamics]\nx = \"v\"\nv = \"-x\"\nw = "
    "\"x*sign(s - 0.05)\"\ns = \"0.5*v\"\n[simulate]\nuntil = 320\nrtol = 1e-3\natol = 1e-3\n";

TEST(ValuesAt, AreTheRowsAtTheseTimesInTheirOrder) {
  auto [system, options] = model_of(ball);
  const auto values = values_at(system, options, {1.5, 0.25, 1.5, 0.0, 2.0});
  ASSERT_TRUE(values) << to_text(values.error());
  EXPECT_EQ(values->t, (std::vector<double>{1.5, 0.25, 1.5, 0.0, 2.0}));
  options.output = AtTimes{{0.0, 0.25, 1.5, 2.0}};
  const auto run = simulate(system, options);
  for (const auto& [t, place] : {std::pair{1.5, 0U}, {0.25, 1U}, {1.5, 2U}, {0.0, 3U}, {2.0, 4U}}) {
    const auto& rows = run->trajectory;
    const auto row = static_cast<std::size_t>(std::find(rows.t.begin(), rows.t.end(), t) - rows.t.begin());
    ASSERT_LT(row, rows.t.size());
    EXPECT_EQ(values->x[place], rows.x[row]);
    EXPECT_EQ(values->outputs[place], rows.outputs[row]);
  }
  EXPECT_NEAR(values->x[1][0], 1.0 - 0.5 * 9.81 * 0.0625, 1e-12);
}

TEST(ValuesAt, AreSimulatedNoFurtherThanToTheLastOfThem) {
  auto [system, options] = model_of(ball);
  options.until = 1e9;
  double reached = 0.0;
  const auto values =
      values_at(system, options, {0.25, 0.5}, SideOfEvent::behind, {.on_step = [&](const StepRecord& step) {
                  reached = step.t;
                  return Proceed::on;
                }});
  ASSERT_TRUE(values) << to_text(values.error());
  EXPECT_LT(reached, 2.0);
  options.until = 2.0;
  EXPECT_NEAR(values->x[1][0], values_at(system, options, {0.25, 0.5})->x[1][0], 1e-9);
}

TEST(ValuesAt, AreThoseOfTheWholeSpanWhereTimeIsFrozen) {
  const char* const hopping =
      "[model]\nname = \"ball\"\n[states]\ny = 1\nv = 0\n[mechanics]\npositions = [\"y\"]\nvelocities = "
      "[\"v\"]\nforce = { v = \"-10\" }\n[[contacts]]\nname = \"ground\"\ngap = \"y\"\nrestitution = 0.5\n"
      "[simulate]\nuntil = 0.85\nmethod = \"fesd\"\n";
  const auto [system, options] = model_of(hopping);
  ASSERT_TRUE(system.frozen);
  const auto values = values_at(system, options, {0.25, 0.8});
  ASSERT_TRUE(values) << to_text(values.error());
  EXPECT_NEAR(values->x[0][0], 1.0 - 5.0 * 0.0625, 1e-6);
  const double flight = 0.8 - std::sqrt(0.2);
  EXPECT_NEAR(values->x[1][0], 0.5 * std::sqrt(20.0) * flight - 5.0 * flight * flight, 1e-4);
}

TEST(ValuesAt, HaveTwoSidesAtAnEvent) {
  const auto [system, options] = model_of(ball);
  const auto run = simulate(system, options);
  const auto& event = run->events.front();
  EXPECT_EQ(values_at(system, options, {event.t}, SideOfEvent::before)->x.front(), event.x);
  EXPECT_EQ(values_at(system, options, {event.t})->x.front(), event.x_after);
}

TEST(ValuesAt, AreKnownWithinTheSpanOnly) {
  const auto [system, options] = model_of(ball);
  for (const double t : {-1e-9, 2.1, std::numeric_limits<double>::quiet_NaN()}) {
    const auto values = values_at(system, options, {1.0, t});
    ASSERT_FALSE(values);
    EXPECT_NE(values.error().message.find("lies outside the solution, which is known from 0 to 2"), std::string::npos);
  }
}

TEST(ValuesAt, ConvergeWithTheOrderOfTheDenseOutputThroughEvents) {
  auto [system, options] = model_of(through_switches);
  std::vector<double> times;
  for (int k = 1; k <= 500; ++k) times.push_back(0.637 * k);
  const auto error = [&](double step) {
    options.event.max_step = step;
    const auto values = values_at(system, options, times);
    EXPECT_TRUE(values);
    double largest = 0.0;
    for (std::size_t k = 0; k < times.size(); ++k) {
      largest = std::max(largest, std::abs(values->x[k][0] - std::cos(times[k])));
    }
    return largest;
  };
  EXPECT_GE(simulate(system, options)->events.size(), 100U);
  const double coarse = error(0.2), fine = error(0.1);
  EXPECT_LT(fine, 1e-4);
  EXPECT_GT(std::log2(coarse / fine), 3.5);  // the polynomial has degree 4
}

}  // namespace
}  // namespace saltus::pipeline
