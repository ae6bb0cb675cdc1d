#include "saltus/report/overlay.hpp"

#include <gtest/gtest.h>

#include "saltus/report/page_overlays_internal.hpp"
#include "sample_results.hpp"

namespace saltus::report {
namespace {

TEST(Overlay, ColumnsAreFoundByName) {
  const auto first = report_samples::stick_slip(4, 7);
  auto other = report_samples::stick_slip(6, 7);
  other.switching_functions = {"another"};
  other.model.parameters.front().second = 1.5;
  const auto data = overlays_data(first, {{"b.json", other}}, 100000);
  ASSERT_EQ(data.size(), 1U);
  EXPECT_EQ(data[0]["label"], "b.json");
  EXPECT_EQ(data[0]["trajectory"]["x"][1].size(), other.trajectory.t.size());
  EXPECT_EQ(data[0]["trajectory"]["x"][1][3].get<double>(), other.trajectory.x[3][1]);
  EXPECT_EQ(data[0]["trajectory"]["alpha"][0].size(), 0U);
  EXPECT_EQ(data[0]["parameters"], (nlohmann::json::array({{"mu_s", 1.5}})));
  EXPECT_EQ(data[0]["events"], other.events.size());
}

TEST(Overlay, OfAnotherModelIsRefused) {
  const auto first = report_samples::stick_slip(4, 7);
  EXPECT_TRUE(check_overlay(first, {"b.json", first}));
  auto other = first;
  other.model.name = "another";
  EXPECT_NE(check_overlay(first, {"b.json", other}).error().message.find("'another'"), std::string::npos);
  other = first;
  other.states = {"v", "q"};
  EXPECT_FALSE(check_overlay(first, {"b.json", other}));
}

}  // namespace
}  // namespace saltus::report
