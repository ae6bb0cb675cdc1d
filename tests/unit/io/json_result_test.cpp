#include "saltus/io/json/json_result.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "saltus/io/json/json_document_internal.hpp"
#include "saltus/io/text_stream_internal.hpp"

namespace saltus::io {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// One of everything, with values whose shortest text is long.
result::Result sample() {
  result::Result r;
  r.model = {"stick-slip", "a \"block\", on a belt", "00ff", {{"mu", 0.1 + 0.2}, {"a", -0.0}}};
  r.status = {result::Termination::iteration_limit, "too many\nsteps", 5e-324};
  r.states = {"q", "v"};
  r.controls = {"u"};
  r.switching_functions = {"slip", "q-max(v,0.2)"};
  r.outputs = {"power"};
  r.final = {2.0, {1.7976931348623157e308, 0.2}, {0, -1}, {1.0 / 3.0, 0.0}, {nan}};
  result::Event event;
  event.t = 0.24468880178327183;
  event.kind = result::EventKind::enter_sliding;
  event.surfaces = {"slip"};
  event.mode_before = result::Mode{-1, -1};
  event.mode_after = result::Mode{0, -1};
  event.alpha_before = std::vector<double>{0.0, 0.0};
  event.alpha_after = std::vector<double>{nan, 0.0};
  event.x = {0.1, 0.2};
  event.x_after = {0.1, 0.2};
  event.unique = false;
  event.alternatives = {{{1, -1}, {1.0, 0.0}}, {{0, -1}, {nan, 0.0}}};
  event.reason = "both fields point to the surface";
  event.intersection = result::Intersection{
      {"slip", "q-max(v,0.2)"}, {{{1.0 / 3.0, -1, 2, 1e-300}, {4, 5, nan, 7}}}, {{0.25, 1.0}}, {0.5, 1.0 / 3.0}};
  r.events.push_back(event);
  event = {};
  event.kind = result::EventKind::user;
  event.name = "returns";
  event.x = event.x_after = {0.0, 1e-300};
  event.unique = std::nullopt;
  r.events.push_back(event);
  r.trajectory.t = {0.0, 2.0};
  r.trajectory.x = {{0.1, -0.0}, {1e22, 123456789.123456789}};
  r.trajectory.u = {{1.0}, {-2.5}};
  r.trajectory.alpha = {{nan, 1.0}, {0.25, 0.0}};
  r.trajectory.mode = {{0, 1}, {0, -1}};
  r.trajectory.outputs = {{3.0}, {4.0}};
  r.statistics = {12, 3, 9007199254740993, 0.01};
  r.options = {{"simulate.rtol", 1e-8},
               {"simulate.max_steps", std::int64_t{1000000}},
               {"simulate.output", std::string("steps")},
               {"simulate.from", 0.0},
               {"simulate.output.times", std::vector<double>{0.5, 1.0}},
               {"flag", true}};
  r.surfaces = {{"slip",
                 result::SurfaceRole::switching,
                 {"v"},
                 true,
                 result::AffineSurface{{1.0 / 3.0}, -0.5, 0.1 + 0.2},
                 {result::AffineSurface{{-1.0 / 7.0}, 2.0, 0.0}},
                 {}},
                {"hit",
                 result::SurfaceRole::jump,
                 {"q", "v"},
                 false,
                 std::nullopt,
                 {},
                 {{{{1.0, 1e-300}, {2.0, nan}}, {}}, {{{7.0}, {8.0}}, 0.5}}}};
  return r;
}

/// The sample, left at the second alternative of its first event by a branch, which the same sample leaves again.
result::Result with_branches() {
  auto root = sample();
  for (int depth = 0; depth < 2; ++depth) {
    auto parent = sample();
    root.left_at = {0, 1};
    parent.branches = {root, root};
    root = std::move(parent);
  }
  return root;
}

// Texts are compared, since NaN is unequal to itself: equal values give equal texts.
TEST(JsonResult, ReadsBackEqual) {
  const auto original = sample();
  const auto text = to_json(original);
  const auto read = parse_result(text, "r.json");
  ASSERT_TRUE(read) << to_text(read.error());
  EXPECT_EQ(to_json(*read), text);
  EXPECT_EQ(read->trajectory.x, original.trajectory.x);
  EXPECT_TRUE(std::signbit(read->trajectory.x[0][1]));
  EXPECT_EQ(read->model.parameters, original.model.parameters);
  EXPECT_EQ(read->model.description, original.model.description);
  EXPECT_EQ(read->status.message, original.status.message);
  EXPECT_EQ(read->status.time_reached, 5e-324);
  EXPECT_EQ(read->options, original.options);
  EXPECT_EQ(read->events[0].mode_before, original.events[0].mode_before);
  EXPECT_EQ(read->events[0].alternatives.size(), 2U);
  EXPECT_EQ(read->events[0].unique, std::optional<bool>(false));
  EXPECT_EQ(read->events[1].unique, std::nullopt);
  EXPECT_EQ(read->events[1].mode_before, std::nullopt);
  EXPECT_EQ(read->events[1].name, "returns");
  EXPECT_EQ(read->statistics.rhs_evaluations, 9007199254740993);
  ASSERT_EQ(read->surfaces.size(), 2U);
  EXPECT_EQ(read->surfaces[0].affine->gradient, original.surfaces[0].affine->gradient);
  EXPECT_EQ(read->surfaces[1].role, result::SurfaceRole::jump);
  EXPECT_EQ(read->surfaces[1].states, (std::vector<std::string>{"q", "v"}));
  EXPECT_EQ(read->surfaces[1].curves[0].coordinates[0], (std::vector<double>{1.0, 1e-300}));
}

TEST(JsonResult, ReadsComparisonsAndOrdersBack) {
  auto original = sample();
  result::ComparedRun absent{"fesd", "", "not for this model", {}, {}, {}, {}, {}, {}, {}};
  result::ComparedRun run{"event", "dop853", "", original.status, {0.1, 1e-300}, 3, 0.7, 1e-12, std::nullopt, {}};
  original.comparison = result::Comparison{{absent, run}, 1};
  result::OrderSeries series{"fesd", "radau_iia", 2, "stewart", {}, 3.01, std::nullopt};
  series.points = {{10, 0.1, 1e-3, std::nullopt, "", 0.5}, {20, 0.05, std::nullopt, std::nullopt, "stopped", 0.25}};
  original.order = result::OrderStudy{"event, dop853", 1e-13, 1e-12, {series}};
  const auto text = to_json(original);
  const auto read = parse_result(text, "r.json");
  ASSERT_TRUE(read) << to_text(read.error());
  EXPECT_EQ(to_json(*read), text);
  EXPECT_EQ(read->comparison->runs[0].reason, "not for this model");
  EXPECT_EQ(read->comparison->runs[1].switches, 3);
  EXPECT_EQ(read->comparison->runs[1].switch_time_difference, std::nullopt);
  EXPECT_EQ(read->order->series[0].slope, 3.01);
  EXPECT_EQ(read->order->series[0].points[1].reason, "stopped");
}

TEST(JsonResult, ReadsFamiliesAndTheirMembersBack) {
  auto original = with_branches();
  const auto mode = original.events[0].alternatives[1].mode;
  const auto alpha = original.events[0].alternatives[1].alpha;
  original.families = {{result::FamilyKind::later_departure, 0, 0.1, 0.7, {mode, alpha, {}}, std::nullopt},
                       {result::FamilyKind::spiral, 1, 0.3, 0.3, {mode, alpha, {}}, 81.0}};
  original.branches[1].left_at->member = {1, 0.25};
  original.surfaces[0].within = {{{0.5}, 0.0, -0.125}};
  const auto text = to_json(original);
  const auto read = parse_result(text, "r.json");
  ASSERT_TRUE(read) << to_text(read.error());
  EXPECT_EQ(to_json(*read), text);
  ASSERT_EQ(read->families.size(), 2U);
  EXPECT_EQ(read->families[0].until, 0.7);
  EXPECT_EQ(read->families[0].to.mode, mode);
  EXPECT_EQ(read->families[1].kind, result::FamilyKind::spiral);
  EXPECT_EQ(read->families[1].lap_ratio, 81.0);
  EXPECT_FALSE(read->branches[0].left_at->member.has_value());
  EXPECT_EQ(read->branches[1].left_at->member->family, 1U);
  EXPECT_EQ(read->branches[1].left_at->member->parameter, 0.25);
  EXPECT_EQ(read->surfaces[0].within[0].constant, -0.125);
  original.families.pop_back();
  const auto damaged = parse_result(to_json(original), "r.json");
  ASSERT_FALSE(damaged);
  EXPECT_NE(to_text(damaged.error()).find("at /branches/1/left_at: what it leaves has no family 1"), std::string::npos)
      << to_text(damaged.error());
}

TEST(JsonResult, ReadsBranchesBack) {
  const auto text = to_json(with_branches());
  const auto read = parse_result(text, "r.json");
  ASSERT_TRUE(read) << to_text(read.error());
  EXPECT_EQ(to_json(*read), text);
  ASSERT_EQ(read->branches.size(), 2U);
  EXPECT_FALSE(read->left_at.has_value());
  EXPECT_EQ(read->branches[1].left_at->alternative, 1U);
  EXPECT_EQ(read->branches[1].branches.size(), 2U);
}

TEST(JsonResult, ElementsSurviveBitForBit) {
  auto original = sample();
  original.elements = result::Elements{
      .points = 3,
      .selections = {{"a", result::SelectionForm::step}, {"a > 0, b < 0", result::SelectionForm::stewart}},
      .t = {0.0, 0.1, 1.0 / 3.0},
      .lambda = {{-1.0, 0.0}, {-0.5, 1e-17}, {0.0, 2.0 / 3.0}},
      .selection = {{0.0, 1.0}, {0.0, 1.0}, {0.3, 0.0}}};
  const auto text = to_json(original);
  const auto read = parse_result(text, "r.json");
  ASSERT_TRUE(read.has_value()) << read.error().message;
  EXPECT_EQ(to_json(*read), text);
  const auto& elements = read->elements.value();
  EXPECT_EQ(elements.points, 3U);
  EXPECT_EQ(elements.selections, original.elements->selections);
  EXPECT_EQ(elements.t, original.elements->t);
  EXPECT_EQ(elements.lambda, original.elements->lambda);
  EXPECT_EQ(elements.selection, original.elements->selection);

  const std::string points = "\"points\": 3";
  const auto place = text.find(points);
  ASSERT_NE(place, std::string::npos) << text;
  auto damaged = text;
  damaged.replace(place, points.size(), "\"points\": -3");
  const auto refused = parse_result(damaged, "r.json");
  ASSERT_FALSE(refused);
  EXPECT_NE(to_text(refused.error()).find("at /elements/points: expected a number from 0, found -3"), std::string::npos)
      << to_text(refused.error());
}

TEST(JsonResult, ReadsResultsFromBeforeSurfacesWereRecorded) {
  auto json = nlohmann::ordered_json::parse(to_json(sample()));
  json.erase("surfaces");
  const auto read = parse_result(json.dump(), "r.json");
  ASSERT_TRUE(read) << to_text(read.error());
  EXPECT_TRUE(read->surfaces.empty());
}

TEST(JsonResult, WritesNonFiniteNumbersAsNullAndReadsThemAsNan) {
  const auto text = to_json(sample());
  EXPECT_NE(text.find("\"outputs\": [null]"), std::string::npos) << text;
  const auto read = parse_result(text, "r.json");
  ASSERT_TRUE(read);
  EXPECT_TRUE(std::isnan(read->final.outputs[0]));
}

TEST(JsonResult, KeysAreInTheOrderOfTheContract) {
  const auto text = to_json(sample());
  std::size_t place = 0;
  for (const auto* key :
       {"format", "saltus", "model", "command", "method", "status", "states", "controls", "switching_functions",
        "outputs", "final", "events", "trajectory", "surfaces", "statistics", "options"}) {
    const auto next = text.find("\n  \"" + std::string(key) + "\": ", place);
    ASSERT_NE(next, std::string::npos) << key;
    place = next;
  }
}

/// With so much space in every list that none of them is parsed at once.
std::string with_long_lists(const std::string& text) {
  const std::string space(bytes_at_once, ' ');
  std::string longer;
  for (const char c : text) {
    longer += c;
    if (c == '[') longer += space;
  }
  return longer;
}

TEST(JsonResult, LongListsAreReadAsShortOnes) {
  const auto text = to_json(with_branches());
  const auto read = parse_result(with_long_lists(text), "r.json");
  ASSERT_TRUE(read) << to_text(read.error());
  EXPECT_EQ(to_json(*read), text);
}

struct Damage {
  const char* what;
  const char* from;
  const char* to;
  const char* expected;
};

class DamagedResult : public testing::TestWithParam<Damage> {};

TEST_P(DamagedResult, IsRefusedWithItsPlace) {
  auto text = to_json(with_branches());
  const auto place = text.find(GetParam().from);
  ASSERT_NE(place, std::string::npos);
  text.replace(place, std::string(GetParam().from).size(), GetParam().to);
  const auto read = parse_result(text, "r.json");
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().location.file, "r.json");
  EXPECT_NE(to_text(read.error()).find(GetParam().expected), std::string::npos) << to_text(read.error());
  const auto of_long_lists = parse_result(with_long_lists(text), "r.json");
  ASSERT_FALSE(of_long_lists);
  EXPECT_EQ(of_long_lists.error().message, read.error().message);
}

INSTANTIATE_TEST_SUITE_P(
    Cases, DamagedResult,
    testing::Values(
        Damage{"format", "saltus-result/1", "saltus-result/2", "at /format: expected \"saltus-result/1\""},
        Damage{"missing key", "\"command\"", "\"comand\"", "'command' is missing"},
        Damage{"kind", "enter_sliding", "entering", "at /events/0/kind: 'entering' is no kind"},
        Damage{"termination", "iteration_limit", "tired", "at /status/termination: 'tired' is no termination"},
        Damage{"type", "\"states\": [\"q\",\"v\"]", "\"states\": [1,2]", "at /states: expected a text, found 1"},
        Damage{"mode", "[0,-1],", "[2,-1],", "expected -1, 0 or 1, found 2"},
        Damage{"width", "\"controls\": [\"u\"]", "\"controls\": []", "at /trajectory/u/0: expected 0 entries, found 1"},
        Damage{"rows", "\"t\": [0.0,2.0]", "\"t\": [0.0]",
               "at /trajectory/x: expected as many rows as times, 1, found 2"},
        Damage{"role", "\"role\": \"jump\"", "\"role\": \"wall\"", "at /surfaces/1/role: 'wall' is no role"},
        Damage{"surface state", "\"states\": [\"v\"]", "\"states\": [\"w\"]", "at /surfaces/0/states: 'w' is no state"},
        Damage{"gradient", "\"gradient\": [", "\"gradient\": [1.0,",
               "at /surfaces/0/affine/gradient: expected 1 entries, found 2"},
        Damage{"curve", "[7.0],", "[7.0,5.0],", "at /surfaces/1/curves/1/coordinates: expected 2 entries, found 1"},
        Damage{"velocities", "[0.3333333333333333,-1.0,", "[-1.0,",
               "at /events/0/intersection/velocities: expected 4 entries, found 3"},
        Damage{"branches", "\"branches\": [", "\"branches\": [7,", "at /branches/0: expected an object, found 7"},
        Damage{"departure", "\"left_at\"", "\"left\"", "at /branches/0: 'left_at' is missing"},
        Damage{"alternative", "\"alternative\":1", "\"alternative\":2",
               "at /branches/0/left_at: what it leaves has no alternative 2 of an event 0"},
        Damage{"event", "\"event\":0", "\"event\":-1",
               "at /branches/0/left_at/event: expected a number from 0, found -1"},
        Damage{"syntax", "\"saltus\": ", "\"saltus\" ", "r.json:3:"}),
    [](const auto& damage) {
      std::string name = damage.param.what;
      std::replace(name.begin(), name.end(), ' ', '_');
      return name;
    });

TEST(JsonResult, RefusesTextsThatAreNoResult) {
  EXPECT_NE(to_text(parse_result("", "r.json").error()).find("the file is empty"), std::string::npos);
  EXPECT_NE(to_text(parse_result("[]", "r.json").error()).find("expected an object, found array"), std::string::npos);
  EXPECT_NE(to_text(parse_result("{", "r.json").error()).find("not valid JSON"), std::string::npos);
  EXPECT_FALSE(parse_result(std::string(100000, '['), "r.json"));
  EXPECT_FALSE(parse_result(R"({"format": 1e999})", "r.json"));
  const auto whole = to_json(sample());
  for (std::size_t length = 0; length + 2 < whole.size(); length += 7) {
    EXPECT_FALSE(parse_result(whole.substr(0, length), "r.json")) << length;
  }
}

TEST(CsvTrajectory, HasTheHeaderOfTheContractWithQuotedNames) {
  const auto text = to_csv(sample());
  const auto header = text.substr(0, text.find('\n'));
  EXPECT_EQ(header, "t,side,q,v,u,power,alpha(slip),\"alpha(q-max(v,0.2))\",mode(slip),\"mode(q-max(v,0.2))\"");
  EXPECT_NE(text.find("\n2,0,1e+22,123456789.12345679,-2.5,4,0.25,0,0,-1\n"), std::string::npos) << text;
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 3);
}

TEST(CsvTrajectory, NumbersTheSidesOfRowsAtOneTime) {
  auto result = sample();
  result.trajectory.t = {2.0, 2.0};
  const auto text = to_csv(result);
  EXPECT_NE(text.find("\n2,0,"), std::string::npos) << text;
  EXPECT_NE(text.find("\n2,1,"), std::string::npos) << text;
}

TEST(CsvEvents, HasALinePerEventAndEmptyFieldsForWhatIsNotThere) {
  const auto text = collected([](Sink sink) { return write_events_csv(sample(), sink); });
  EXPECT_EQ(text.substr(0, text.find('\n')),
            "t,kind,name,surfaces,q,v,after(q),after(v),mode_before(slip),\"mode_before(q-max(v,0.2))\","
            "mode_after(slip),\"mode_after(q-max(v,0.2))\",alpha_before(slip),\"alpha_before(q-max(v,0.2))\","
            "alpha_after(slip),\"alpha_after(q-max(v,0.2))\",unique,reason");
  EXPECT_NE(text.find("0178327182,enter_sliding,,slip,0.1,0.2,0.1,0.2,-1,-1,0,-1,0,0,nan,0,false,both "
                      "fields point to the surface\n"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("\n0,user,returns,,0,1e-300,0,1e-300,,,,,,,,,,\n"), std::string::npos) << text;
}

}  // namespace
}  // namespace saltus::io
