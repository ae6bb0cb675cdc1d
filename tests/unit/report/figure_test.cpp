#include "saltus/report/figure.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "saltus/report/figure/figure_columns_internal.hpp"
#include "sample_results.hpp"

namespace saltus::report {
namespace {

std::size_t occurrences(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
  return n;
}

TEST(Figure, OverTimeHasAPanelForWhatMoves) {
  const auto svg = to_svg(report_samples::stick_slip(40, 50));
  ASSERT_TRUE(svg);
  EXPECT_TRUE(svg->starts_with("<svg xmlns"));
  EXPECT_TRUE(svg->ends_with("</svg>\n"));
  for (const char* name : {">q<", ">v<", ">alpha(slip)<", ">slip<"}) EXPECT_EQ(occurrences(*svg, name), 1U) << name;
  EXPECT_EQ(occurrences(*svg, "<g "), occurrences(*svg, "</g>"));
  EXPECT_EQ(svg->find("nan"), std::string::npos);
}

TEST(Figure, OfAPlaneHasItsColumnsAsAxes) {
  const auto result = report_samples::stick_slip(40, 50);
  const auto axes = phase_axes(result, "q,alpha(slip)");
  ASSERT_TRUE(axes);
  EXPECT_EQ(axes->second, "alpha(slip)");
  const auto svg = to_svg(result, *axes);
  ASSERT_TRUE(svg);
  EXPECT_NE(svg->find("alpha(slip) over q"), std::string::npos);
}

TEST(Figure, SaysWhatItsLinesMean) {
  auto result = report_samples::stick_slip(40, 50);
  const auto over_time = to_svg(result);
  ASSERT_TRUE(over_time);
  for (const char* name : {">psi &lt; 0<", ">sliding<", ">event<"}) {
    EXPECT_EQ(occurrences(*over_time, name), 1U) << name;
  }
  EXPECT_EQ(occurrences(*over_time, ">psi &gt; 0<"), 0U) << "does not occur";
  result::Surface line{
      "slip", result::SurfaceRole::switching, {"v"}, false, result::AffineSurface{{1.0}, 0.0, -0.2}, {}, {}};
  result.surfaces = {line};
  result.vector_field.emplace();
  const auto plane = to_svg(result, PhaseAxes{"q", "v"});
  ASSERT_TRUE(plane);
  for (const char* name : {">solution<", ">sliding<", ">event<", ">start<", ">end<", ">vector field<", ">slip<"}) {
    EXPECT_EQ(occurrences(*plane, name), 1U) << name;
  }
}

TEST(Figure, EventsCloserThanLinesAreAreasUpToTheLast) {
  auto result = report_samples::stick_slip(40, 50);
  const double end = result.trajectory.t.back();
  result::Event event = result.events[0];
  result.events = {};
  constexpr int count = 2000;
  for (int i = 0; i <= count; ++i) {
    event.t = end * (0.5 + 0.5 * i / count);
    event.unique = true;
    result.events.push_back(event);
  }
  const auto svg = to_svg(result);
  ASSERT_TRUE(svg);
  EXPECT_EQ(occurrences(*svg, ">events closer than lines<"), 1U);
  EXPECT_EQ(occurrences(*svg, ">event<"), 0U) << "none stands alone";
  const auto area = svg->find("fill=\"#e9ecf0\"");
  ASSERT_NE(area, std::string::npos);
  const auto begin = svg->rfind("width=\"", area) + 7;
  EXPECT_GT(std::stod(svg->substr(begin)), 350.0) << "half the time";
}

TEST(Figure, ChatteringIsInItsLegend) {
  auto result = report_samples::stick_slip(40, 50);
  result.trajectory = {};
  constexpr int rows = 20000;
  for (int i = 0; i < rows; ++i) {
    result.trajectory.t.push_back(static_cast<double>(i) / rows);
    result.trajectory.x.push_back({1.0, 1.0});
    result.trajectory.mode.push_back(result::Mode{i % 2 == 0 ? 1 : -1});
  }
  const auto svg = to_svg(result);
  ASSERT_TRUE(svg);
  EXPECT_EQ(occurrences(*svg, ">chattering<"), 1U);
  EXPECT_EQ(occurrences(*svg, ">sliding<"), 0U) << "there is none";
}

TEST(Figure, LongNamesOfModelsAreShortenedInTheTitle) {
  auto result = report_samples::stick_slip(40, 50);
  result.model.name = std::string(300, 'm');
  for (const auto& svg : {to_svg(result), to_svg(result, PhaseAxes{"q", "v"})}) {
    ASSERT_TRUE(svg);
    EXPECT_EQ(occurrences(*svg, result.model.name), 1U) << "the element title has all of it";
    EXPECT_EQ(occurrences(*svg, "mm…: "), 1U);
  }
}

TEST(Figure, SmallColumnsBesideLargeOnesMove) {
  auto result = report_samples::decay();
  result.states = {"p", "z", "rest"};
  result.trajectory.x = {};
  for (std::size_t i = 0; i < result.trajectory.t.size(); ++i) {
    const auto step = static_cast<double>(i);
    result.trajectory.x.push_back({1e7 + step, 1e-9 * std::cos(step), 1e-17 * step});
  }
  result.options = {{"simulate.atol", 1e-14}};
  const auto svg = to_svg(result);
  ASSERT_TRUE(svg);
  EXPECT_EQ(occurrences(*svg, ">z<"), 1U);
  EXPECT_EQ(occurrences(*svg, ">rest<"), 0U) << "below the tolerance";
}

TEST(Figure, AllOfSeveralResultsAreInTheLegend) {
  const auto result = report_samples::stick_slip(40, 50);
  const auto svg = to_svg(result, std::nullopt, {}, {{"b.json", result}});
  ASSERT_TRUE(svg);
  for (const char* name : {">first result<", ">b.json<"}) EXPECT_EQ(occurrences(*svg, name), 1U) << name;
}

TEST(Figure, BreaksCurvesAtEventsWithoutRows) {
  const auto broken = [](result::Result result) {
    result.trajectory.t = {0.0, 1.0, 2.0};
    result.trajectory.x = result::Table<double>{{1.0}, {3.0}, {3.0}};
    result.trajectory.alpha = {}, result.trajectory.mode = {};
    result.states = {"x"}, result.switching_functions = {}, result.outputs = {"y"};
    result.trajectory.outputs = result::Table<double>{{1.0}, {3.0}, {4.0}};
    result::Event jump;
    jump.t = 0.5, jump.kind = result::EventKind::jump;
    jump.x = {2.0}, jump.x_after = {2.5};
    result.events = result::Events{jump};
    return to_svg(result, std::nullopt, {"x", "y"});
  };
  const auto svg = broken(report_samples::decay());
  ASSERT_TRUE(svg);
  EXPECT_EQ(occurrences(*svg, "stroke-dasharray=\"2 3\""), 1U) << "the jump of x";
  EXPECT_EQ(occurrences(*svg, "stroke-width=\"1.6\""), 3U) << "two pieces of x, one of y";
  EXPECT_EQ(occurrences(*svg, "<circle"), 1U) << "the first row of y lies alone";
}

TEST(Figure, BreaksCurvesAtEventsBetweenRowsOfOnePixel) {
  auto result = report_samples::decay();
  result.states = {"x"}, result.switching_functions = {}, result.outputs = {"y"};
  result.trajectory = {};
  constexpr int rows = 20000;
  for (int i = 0; i <= rows; ++i) {
    const double t = static_cast<double>(i) / rows;
    for (const double y : {i <= rows / 2 ? 6.0 : -6.0, i < rows / 2 ? 6.0 : -6.0}) {
      if (i != rows / 2 && !result.trajectory.t.empty() && result.trajectory.t.back() == t) continue;
      result.trajectory.t.push_back(t);
      result.trajectory.x.push_back({t});
      result.trajectory.outputs.push_back({y});
    }
  }
  result.events = {};
  const auto drawn = [&](const std::string& column) {
    const auto svg = to_svg(result, std::nullopt, {column});
    EXPECT_TRUE(svg);
    return std::pair(occurrences(*svg, "stroke-dasharray=\"2 3\""), occurrences(*svg, "stroke-width=\"1.6\""));
  };
  EXPECT_EQ(drawn("y"), (std::pair<std::size_t, std::size_t>{1, 2})) << "a jump, and a line on either side";
  EXPECT_EQ(drawn("x"), (std::pair<std::size_t, std::size_t>{0, 1}));
}

TEST(Figure, UnknownColumnsAreRefusedWithTheNearestName) {
  const auto result = report_samples::stick_slip(4, 5);
  for (const char* wrong : {"q,vv", "vv,q", "q", ""}) {
    const auto axes = phase_axes(result, wrong);
    ASSERT_FALSE(axes) << wrong;
    EXPECT_FALSE(axes.error().remedy.empty());
  }
  EXPECT_NE(phase_axes(result, "q,vv").error().message.find("'vv'"), std::string::npos);
}

TEST(Figure, NothingIsNoError) {
  for (const auto& result : {result::Result{}, report_samples::nothing(), report_samples::failed()}) {
    const auto svg = to_svg(result);
    ASSERT_TRUE(svg);
    EXPECT_EQ(svg->find("nan"), std::string::npos);
    EXPECT_EQ(svg->find("inf"), std::string::npos);
  }
}

TEST(Figure, NamesOfOthersStayText) {
  auto result = report_samples::stick_slip(4, 5);
  result.states[0] = "</svg><script>&";
  const auto svg = to_svg(result);
  EXPECT_EQ(occurrences(*svg, "<script>"), 0U);
  EXPECT_NE(svg->find("&lt;/svg&gt;&lt;script&gt;&amp;"), std::string::npos);
}

TEST(Figure, CurvesKeepTheirExtremesAndCutsAtJumps) {
  result::Trajectory trajectory;
  std::vector<double> y;
  for (int i = 0; i <= 10000; ++i) {
    trajectory.t.push_back(i / 1000.0);
    y.push_back(i == 5003 ? 7.0 : std::sin(i / 1000.0));
  }
  trajectory.t.push_back(10.0);
  y.push_back(3.0);
  const Plot plot{{0.0, 0.0}, 100.0, 100.0, {0.0, 10.0}, {-10.0, 10.0}};
  const auto pieces = curve_pieces(trajectory, trajectory.t, y, plot, 0.1, false);
  ASSERT_EQ(pieces.lines.size(), 2U);
  ASSERT_EQ(pieces.jumps.size(), 1U);
  EXPECT_LE(pieces.lines[0].points.size(), 410U);
  double highest = 100.0;
  for (const auto& point : pieces.lines[0].points) highest = std::min(highest, point.y);
  EXPECT_NEAR(highest, plot.place(5.003, 7.0).y, 1e-12);
}

TEST(Figure, ChatteringFillsBothHalvesOfABand) {
  result::Result result;
  result.states = {"x"};
  result.switching_functions = {"s"};
  for (int i = 0; i < 20000; ++i) {
    for (const double part : {0.0, 0.5})
      report_samples::add_row(result, {i + part, {0.0}, {part == 0.0 ? 1 : -1}, {0.0}});
  }
  report_samples::finish(result);
  const auto svg = to_svg(result);
  ASSERT_TRUE(svg);
  for (const char* color : {"#1f4e8c", "#9cc9ee"}) {
    EXPECT_GT(occurrences(*svg, color), 300U);
    EXPECT_LT(occurrences(*svg, color), 1000U);
  }
}

TEST(Figure, AMeanOfChatteringIsOneOfWholePeriods) {
  std::vector<double> t, y;
  for (int i = 0; i < 1000; ++i) {
    for (const double part : {0.0, 0.3, 0.3, 1.0}) t.push_back(i + part);
    for (const double value : {1.0, 1.0, 0.0, 0.0}) y.push_back(value);
  }
  const auto pixels = chattering_pixels(t, y, 2.5, 1e-5);
  ASSERT_GT(pixels.size(), 330U);
  for (const auto& pixel : pixels) {
    EXPECT_NEAR(pixel.mean, 0.3, 1e-9);
    EXPECT_EQ(pixel.low, 0.0);
    EXPECT_EQ(pixel.high, 1.0);
  }
  result::Trajectory trajectory;
  trajectory.t = t;
  const Plot plot{{0.0, 0.0}, 100.0, 100.0, {0.0, 1000.0}, {-1.0, 2.0}};
  EXPECT_TRUE(curve_pieces(trajectory, t, y, plot, 1.25, false, pixels).jumps.size() < 10);
  EXPECT_TRUE(chattering_pixels(t, y, 0.1, 1e-5).empty());
}

TEST(Figure, OfVeryManyStatesThoseThatMoveAreDrawn) {
  result::Result result;
  for (int i = 0; i < 60; ++i) result.states.push_back("x" + std::to_string(i));
  for (int row = 0; row < 3; ++row) {
    std::vector<double> x(60, 0.0);
    for (std::size_t i = 54; i < 60; ++i) x[i] = row * (1.0 + static_cast<double>(i));
    report_samples::add_row(result, {static_cast<double>(row), x, {}, {}});
  }
  report_samples::finish(result);
  const auto svg = to_svg(result);
  ASSERT_TRUE(svg);
  for (const char* name : {">x54<", ">x59<"}) EXPECT_EQ(occurrences(*svg, name), 1U) << name;
  EXPECT_EQ(occurrences(*svg, ">x0<"), 0U);
}

TEST(Figure, OfVeryManyBandsThoseThatChangeAreDrawn) {
  result::Result result;
  result.states = {"x"};
  for (int j = 0; j < 30; ++j) result.switching_functions.push_back("s" + std::to_string(j));
  for (int row = 0; row < 3; ++row) {
    result::Mode mode(30, 0);
    if (row > 0) mode.back() = 1;
    report_samples::add_row(result, {static_cast<double>(row), {0.0}, mode, std::vector<double>(30, 0.5)});
  }
  report_samples::finish(result);
  const auto svg = to_svg(result);
  ASSERT_TRUE(svg);
  EXPECT_EQ(occurrences(*svg, ">s29<"), 1U);
  EXPECT_EQ(occurrences(*svg, ">s0<"), 0U);
}

TEST(Figure, NamesOfColumnsMayContainCommas) {
  auto result = report_samples::stick_slip(4, 5);
  result.states[0] = "max(q,v)";
  const auto names = figure_names(result, "v,max(q,v),alpha(slip)");
  ASSERT_TRUE(names);
  EXPECT_EQ(*names, (std::vector<std::string>{"v", "max(q,v)", "alpha(slip)"}));
  for (const char* wrong : {"", "v,", ",v", "v,t", "w"}) EXPECT_FALSE(figure_names(result, wrong)) << wrong;
}

TEST(Figure, NumbersOfAxesAreRound) {
  for (const Range range : {Range{-0.9, 0.9}, Range{-0.3, 2.1}, Range{-60.0, 960.0}, Range{0.11, 0.19}})
    EXPECT_GE(round_numbers(range, 2).size(), 2U) << range.from;
  EXPECT_EQ(round_numbers({0.0, 1.0}, 5), (std::vector<double>{0.0, 0.2, 0.4, 0.6000000000000001, 0.8, 1.0}));
  EXPECT_EQ(round_numbers({-3.0, 40.0}, 5), (std::vector<double>{0.0, 10.0, 20.0, 30.0, 40.0}));
}

}  // namespace
}  // namespace saltus::report
