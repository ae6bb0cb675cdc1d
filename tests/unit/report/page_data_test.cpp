#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "saltus/report/page_data_internal.hpp"
#include "sample_optimization.hpp"
#include "sample_results.hpp"

namespace saltus::report {
namespace {

using nlohmann::json;

TEST(PageData, HoldsTheTrajectoryByColumnsExactly) {
  const auto result = report_samples::stick_slip(4, 7);
  const json data = json::parse(to_script_text(page_data(result)));
  const auto& rows = result.trajectory;
  ASSERT_EQ(data["trajectory"]["t"].size(), rows.t.size());
  EXPECT_EQ(data["trajectory"]["rows"], rows.t.size());
  for (std::size_t i = 0; i < rows.t.size(); ++i) {
    EXPECT_EQ(data["trajectory"]["t"][i].get<double>(), rows.t[i]);
    EXPECT_EQ(data["trajectory"]["x"][1][i].get<double>(), rows.x[i][1]);
    EXPECT_EQ(data["trajectory"]["alpha"][0][i].get<double>(), rows.alpha[i][0]);
  }
}

TEST(PageData, ModesAreTheIntervalsBetweenEvents) {
  const auto result = report_samples::stick_slip(4, 7);
  const json modes = page_data(result)["trajectory"]["modes"][0];
  EXPECT_EQ(modes["values"], (json{0, -1, 0, -1, 0}));
  ASSERT_EQ(modes["edges"].size(), 6U);
  EXPECT_EQ(modes["edges"][0], result.trajectory.t.front());
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(modes["edges"][i + 1], result.events[i].t);
  EXPECT_EQ(modes["edges"][5], result.trajectory.t.back());
}

TEST(PageData, SeveralRowsAtOneTimeMakeNoInterval) {
  result::Result result;
  result.states = {"x"};
  result.switching_functions = {"psi"};
  for (const auto& [t, k] : {std::pair{0.0, -1}, {1.0, -1}, {1.0, 0}, {1.0, 1}, {2.0, 1}}) {
    report_samples::add_row(result, {t, {0.0}, {k}, {0.0}});
  }
  const json modes = page_data(result)["trajectory"]["modes"][0];
  EXPECT_EQ(modes["edges"], (json{0.0, 1.0, 2.0}));
  EXPECT_EQ(modes["values"], (json{-1, 1}));
}

TEST(PageData, NonFiniteNumbersAndMissingModesAreNull) {
  auto result = report_samples::failed();
  report_samples::change_event(result, 0, [](result::Event& event) { event.mode_before.reset(); });
  const json data = json::parse(to_script_text(page_data(result)));
  EXPECT_TRUE(data["trajectory"]["x"][0].back().is_null());
  EXPECT_TRUE(data["trajectory"]["x"][1].back().is_null());
  EXPECT_TRUE(data["final"]["x"][0].is_null());
  EXPECT_TRUE(data["events"][0]["mode_before"].is_null());
  EXPECT_TRUE(data["events"][0]["name"].is_null());
  EXPECT_EQ(data["status"]["done"], false);
}

TEST(PageData, TextSurvivesEscaping) {
  auto result = report_samples::failed();
  result.model.description = "a </script> <!-- b";
  const std::string text = to_script_text(page_data(result));
  EXPECT_EQ(text.find('<'), std::string::npos);
  const json data = json::parse(text);
  EXPECT_EQ(data["model"]["description"], result.model.description);
  EXPECT_EQ(data["states"][0], result.states[0]);
  EXPECT_EQ(data["switching_functions"][0], result.switching_functions[0]);
}

TEST(PageData, EventsKeepUniquenessWithAlternatives) {
  const json data = json::parse(to_script_text(page_data(report_samples::failed())));
  int refused = 0, undecided = 0;
  for (const auto& event : data["events"]) {
    if (event["unique"].is_null()) ++undecided;
    if (event["unique"] == false) {
      ++refused;
      EXPECT_EQ(event["alternatives"][0]["mode"], (json{1, -1}));
      EXPECT_TRUE(event["alternatives"][1]["alpha"][1].is_null());
    }
  }
  EXPECT_EQ(refused, 1);
  EXPECT_EQ(undecided, 1);
}

TEST(PageData, OptionsAndParametersKeepTheirOrderAndType) {
  const json data = page_data(report_samples::stick_slip(2, 3));
  EXPECT_EQ(data["model"]["parameters"], (json::array({{"mu_s", 1.0}, {"mu_d", 0.4}})));
  EXPECT_EQ(data["options"][2], (json::array({"simulate.method", "event"})));
  EXPECT_EQ(data["options"][5][1].size(), 8U);
}

TEST(PageData, LongTrajectoriesAreThinnedAndSayHowManyRowsThereWere) {
  const auto result = report_samples::many_rows(40000);
  const json data = page_data(result, 8000);
  const std::size_t kept = data["trajectory"]["t"].size();
  EXPECT_EQ(data["trajectory"]["rows"], result.trajectory.t.size());
  // Four columns and 40 events: at most the limit and the rows that are always kept.
  EXPECT_LE(kept, 8000 / 4 + 2 * 40 + 2);
  EXPECT_GE(kept, 200U);
  double greatest = -1.0;
  for (const auto& value : data["trajectory"]["x"][1]) greatest = std::max(greatest, value.get<double>());
  EXPECT_EQ(greatest, 25.0);
}

TEST(PageData, SurfacesNameTheirStatesByColumn) {
  auto result = report_samples::stick_slip(2, 3);
  result.surfaces = {
      {"slip", result::SurfaceRole::switching, {"v"}, true, result::AffineSurface{{2.0}, 0.5, -0.2}, {}, {}},
      {"hit</script>",
       result::SurfaceRole::jump,
       {"q", "v"},
       false,
       std::nullopt,
       {},
       {{{{1.0, 2.0}, {3.0, 4.0}}, {}}}}};
  const std::string text = to_script_text(page_data(result));
  EXPECT_EQ(text.find('<'), std::string::npos);
  const json surfaces = json::parse(text)["surfaces"];
  ASSERT_EQ(surfaces.size(), 2U);
  EXPECT_EQ(surfaces[0]["states"], (json{1}));
  EXPECT_EQ(surfaces[0]["affine"], (json{{"gradient", {2.0}}, {"rate", 0.5}, {"constant", -0.2}}));
  EXPECT_EQ(surfaces[0]["depends_on_time"], true);
  EXPECT_EQ(surfaces[1]["name"], "hit</script>");
  EXPECT_EQ(surfaces[1]["role"], "jump");
  EXPECT_EQ(surfaces[1]["states"], (json{0, 1}));
  EXPECT_TRUE(surfaces[1]["affine"].is_null());
  ASSERT_EQ(surfaces[1]["curves"].size(), 1U);
  EXPECT_TRUE(surfaces[1]["curves"][0]["t"].is_null());
  EXPECT_EQ(surfaces[1]["curves"][0]["coordinates"], (json::array({{1.0, 2.0}, {3.0, 4.0}})));
}

TEST(PageData, OfVeryManyStatesTheFirstAreShownAndTheSizesTold) {
  result::Result result;
  const std::size_t size = 4 * columns_in_page;
  std::vector<double> x;
  for (std::size_t i = 0; i < size; ++i) {
    result.states.push_back("x" + std::to_string(i));
    x.push_back(static_cast<double>(i));
  }
  for (int i = 0; i < 50; ++i) report_samples::add_row(result, {1.0 * i, x, {}, {}});
  report_samples::finish(result);
  result::Event event;
  event.x = event.x_after = x;
  result.events = std::vector<result::Event>(1000, event);
  result.surfaces = {{"first", {}, {"x0"}, false, std::nullopt, {}, {}},
                     {"last", {}, {result.states.back()}, false, {}, {}, {}}};
  const json data = page_data(result, 100000);
  EXPECT_EQ(data["states"].size(), columns_in_page);
  EXPECT_EQ(data["sizes"]["states"], size);
  EXPECT_EQ(data["trajectory"]["x"].size(), columns_in_page);
  EXPECT_EQ(data["final"]["x"].size(), columns_in_page);
  // An eighth of 100000 numbers for 1000 events with six lists each are two; four are the least.
  EXPECT_EQ(data["events"][999]["x"].size(), 4U);
  ASSERT_EQ(data["surfaces"].size(), 1U);
  EXPECT_EQ(data["surfaces"][0]["name"], "first");
}

TEST(PageData, AnEmptyResultIsNoError) {
  const json data = json::parse(to_script_text(page_data(result::Result{})));
  EXPECT_EQ(data["trajectory"]["t"].size(), 0U);
  EXPECT_EQ(data["events"].size(), 0U);
}

TEST(PageData, BranchesAreAListWithTheirParents) {
  auto root = report_samples::failed();
  auto branch = report_samples::failed();
  std::vector<result::Event> left = branch.events;
  left.erase(left.begin());
  branch.events = left;
  branch.left_at = {1, 0};
  auto inner = branch;
  inner.left_at = {2, 1};
  branch.branches = {inner};
  root.branches = {branch, inner};
  constexpr std::size_t limit = 4000;
  const auto data = page_data(root, limit);
  const auto& branches = data["branches"];
  ASSERT_EQ(branches.size(), 3U);
  std::size_t numbers = 0;
  for (const auto& entry : branches) numbers += 7 * entry["trajectory"]["t"].size();
  EXPECT_LT(numbers, 2 * limit);
  EXPECT_EQ(branches[0]["label"], "1");
  EXPECT_EQ(branches[1]["label"], "1.1");
  EXPECT_EQ(branches[1]["parent"], 1);
  EXPECT_EQ(branches[2]["label"], "2");
  EXPECT_EQ(branches[2]["parent"], 0);
  EXPECT_EQ(branches[1]["left_at"]["event"], 2);
  EXPECT_EQ(branches[0]["left_at"]["t"], branch.events[0].t);
  EXPECT_EQ(branches[0]["status"]["termination"], "evaluation_failed");
  std::size_t open = 0;
  for (const auto& entry : result::tree(root)) open += result::not_followed(*entry.result);
  EXPECT_EQ(data["not_followed"], open);
}

TEST(PageData, OfAnOptimisationHasControlsBoundsPathAndWords) {
  EXPECT_TRUE(page_data(report_samples::decay())["optimization"].is_null());
  const auto data = nlohmann::json::parse(page_data(report_samples::turbo_car()).dump())["optimization"];
  EXPECT_EQ(data["objective"], 11.8);
  EXPECT_EQ(data["terms"], nlohmann::json::parse(R"([["time", 11.8]])"));
  EXPECT_EQ(data["grid"].size(), 21U);
  EXPECT_EQ(data["u"].size(), 1U);
  EXPECT_EQ(data["u"][0].size(), 20U);
  EXPECT_EQ(data["u"][0][19], -5.0);
  EXPECT_EQ(data["bounds"], nlohmann::json::parse(R"({"x": [[null, null], [-25.0, 25.0]], "u": [[-5.0, 5.0]]})"));
  EXPECT_EQ(data["homotopy"][12]["phase"], "branch");
  EXPECT_EQ(data["multipliers"].size(), 23U);
  EXPECT_EQ(data["open_loop"]["x"].size(), 2U);
  EXPECT_EQ(data["open_loop"]["x"][1].size(), data["open_loop"]["t"].size());
  EXPECT_EQ(data["certificate"][0]["tone"], "good");
  EXPECT_EQ(data["verification"].size(), 4U);
  EXPECT_EQ(data["statistics"]["pairs"], 240);
}

TEST(PageData, OfAnOptimisationWithoutSimulationHasNoOpenLoop) {
  auto result = report_samples::turbo_car();
  result.optimization->verification.reset();
  EXPECT_TRUE(page_data(result)["optimization"]["open_loop"].is_null());
  *result.optimization = {};
  EXPECT_EQ(page_data(result)["optimization"]["bounds"]["x"].size(), 2U);
}

}  // namespace
}  // namespace saltus::report
