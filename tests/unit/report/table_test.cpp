#include "saltus/report/table.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "sample_optimization.hpp"

namespace saltus::report {
namespace {

result::Event crossing(double t, std::string surface) {
  result::Event event;
  event.t = t;
  event.surfaces = {std::move(surface)};
  event.mode_before = result::Mode{-1, 0};
  event.mode_after = result::Mode{1, 0};
  return event;
}

result::Result sample() {
  result::Result r;
  r.model.name = "m";
  r.states = {"x"};
  r.switching_functions = {"a", "b"};
  r.final = {2.0, {0.1}, {1, 0}, {1.0, 0.25}, {}};
  r.status.time_reached = 2.0;
  return r;
}

std::vector<std::string> lines(const std::string& text) {
  std::vector<std::string> list;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) list.push_back(line);
  return list;
}

/// Characters on the screen, of UTF-8 text.
std::ptrdiff_t columns(const std::string& line) {
  return std::count_if(line.begin(), line.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; });
}

TEST(Table, ShowsTheEndAndWhereItSlides) {
  const auto text = to_table(sample());
  EXPECT_NE(text.find("end state   x = 0.1\n"), std::string::npos) << text;
  EXPECT_NE(text.find("sliding on  b = 0 (alpha 0.25)\n"), std::string::npos) << text;
  EXPECT_NE(text.find("events      none\n"), std::string::npos) << text;
}

TEST(Table, SaysWhatAHysteresisTurnedTo) {
  auto r = sample();
  r.states = {"x", "heats"};
  r.final.x = {0.1, 1.0};
  auto jump = crossing(1.0, "heats");
  jump.kind = result::EventKind::jump;
  jump.name = "heats";
  jump.x = {0.5, 1.0}, jump.x_after = {0.5, 0.0};
  auto back = jump;
  std::swap(back.x, back.x_after);
  r.events = {jump, back};
  const auto text = to_table(r);
  EXPECT_NE(text.find("jump  heats off "), std::string::npos) << text;
  EXPECT_NE(text.find("jump  heats on "), std::string::npos) << text;
  r.final.x[1] = 3.0;  // a counter of that name
  EXPECT_EQ(to_table(r).find("heats on"), std::string::npos);
}

/// Two continuations beside the one taken.
result::Event ambiguous(double t) {
  auto event = crossing(t, "a");
  event.unique = false;
  event.alternatives = {{{0, 0}, {0.5, 0.5}}, {{-1, 0}, {0.0, 0.5}}};
  return event;
}

TEST(Table, SaysHowManyOtherContinuationsThereAre) {
  auto r = sample();
  EXPECT_EQ(to_table(r).find("branches"), std::string::npos);
  r.events = {crossing(0.5, "a"), ambiguous(1.5)};
  EXPECT_NE(to_table(r).find("branches    2 other continuations not followed: --branch all follows them\n"),
            std::string::npos)
      << to_table(r);
}

TEST(Table, HasALineForEveryBranch) {
  auto r = sample();
  r.events = {crossing(0.5, "a"), ambiguous(1.5)};
  auto branch = sample();
  auto first = ambiguous(1.5);
  first.mode_after = result::Mode{0, 0};
  branch.events = {first, ambiguous(1.75)};
  branch.left_at = {1, 0};
  branch.status = {result::Termination::iteration_limit, "", 1.875};
  auto inner = branch;
  inner.left_at = {1, 1};
  inner.events = {ambiguous(1.75)};
  branch.branches = {inner};
  r.branches = {branch};
  const auto table = lines(to_table(r));
  const auto head =
      std::find_if(table.begin(), table.end(), [](const auto& line) { return line.starts_with("branches"); });
  ASSERT_NE(head, table.end());
  EXPECT_EQ(*head, "branches    2, 2 more not followed");
  EXPECT_EQ(head[2], "  1    main, event 2  1.5   00    2       iteration_limit at 1.875  x = 0.1");
  EXPECT_EQ(head[3], "  1.1  1, event 2     1.75  +0    1       iteration_limit at 1.875  x = 0.1");
}

TEST(Table, ColumnsOfEventsAreAligned) {
  auto r = sample();
  auto second = crossing(1.5, "größer");
  second.unique = false;
  r.events = {crossing(1.0 / 3.0, "a"), second};
  const auto table = lines(to_table(r));
  const auto head = std::find_if(table.begin(), table.end(), [](const auto& line) { return line.starts_with("  #"); });
  ASSERT_NE(head, table.end());
  EXPECT_EQ(head[1].find("crossing"), head->find("kind"));
  EXPECT_EQ(head[1].find("-0 > +0"), head->find("mode"));
  EXPECT_EQ(columns(head[2].substr(0, head[2].find("-0 > +0"))), static_cast<std::ptrdiff_t>(head->find("mode")));
  EXPECT_TRUE(head[2].ends_with("not unique")) << head[2];
}

TEST(Table, LongListsShowTheFirstAndTheLastTen) {
  auto r = sample();
  for (int i = 0; i < 20; ++i) r.events.push_back(crossing(i, "a"));
  EXPECT_EQ(to_table(r).find("…"), std::string::npos);
  r.events.push_back(crossing(20, "a"));
  const auto text = to_table(r);
  EXPECT_NE(text.find("events      21, the first and the last 10\n"), std::string::npos) << text;
  EXPECT_EQ(text.find("\n  11 "), std::string::npos);
  EXPECT_NE(text.find("\n  10 "), std::string::npos);
  EXPECT_NE(text.find("\n  12 "), std::string::npos);
  EXPECT_NE(text.find("\n  21 "), std::string::npos);
}

TEST(Table, SaysOnceWhenARunStopped) {
  auto r = sample();
  r.status = {result::Termination::iteration_limit, "max_steps = 20 reached at t = 5.0893121064278066",
              5.0893121064278066};
  auto text = to_table(r);
  EXPECT_EQ(text.find("5.08931210643"), std::string::npos) << text;
  EXPECT_NE(text.find("5.0893121064278066"), std::string::npos);
  r.status.message = "interrupted";
  text = to_table(r);
  EXPECT_NE(text.find("iteration_limit at t = 5.08931210643"), std::string::npos) << text;
}

TEST(Table, FitsAHundredColumnsWhateverTheModel) {
  auto r = sample();
  r.model.description = std::string(30, 'w') + " " + std::string(30, 'w') + " " + std::string(30, 'w');
  r.status = {result::Termination::outside_class, "", 2.0};
  for (int i = 0; i < 40; ++i) r.status.message += "word ";
  r.states.clear();
  r.final.x.clear();
  for (int i = 0; i < 30; ++i) {
    r.states.push_back(fmt::format("state{}", i));
    r.final.x.push_back(-1.0 / 3.0 * i);
  }
  r.switching_functions = {std::string(200, 's'), "b"};
  auto event = crossing(-1.23456789012e-100, std::string(200, 's'));
  event.kind = result::EventKind::change_sliding;
  event.unique = std::nullopt;
  r.events = {event};
  for (const auto& line : lines(to_table(r))) EXPECT_LE(columns(line), 100) << line;
}

TEST(Table, OfAnOptimisationSaysWhatWasFoundAndWhatItIsWorth) {
  const auto text = to_table(report_samples::turbo_car());
  for (const auto* line :
       {"method      fesd (radau_iia, 2 stages, 20 intervals of 3 elements)\n", "objective   11.8 (time)\n",
        "horizon     11.8\n", "optimised   k = 3\n",
        "certificate Feasible to 3e-12; complementarity 0; stationary to 1e-11.\n", "B-stationary (S): no feasible",
        "simulated   Simulated event by event", "off by at most 5e-08", "in interval 3 (t = 1.77 to 2.36)",
        "No switch is missed or added", "events      2\n", "size        1204 variables, 1165 equations, 240 pairs\n",
        "statistics  13 problems (11 relaxed, 1 branch, 1 linear), 263 iterations; 0.83 s"}) {
    EXPECT_NE(text.find(line), std::string::npos) << line << "\n" << text;
  }
  EXPECT_EQ(text.find("rejected"), std::string::npos) << text;
  for (const auto& line : lines(text)) EXPECT_LE(columns(line), 100) << line;
}

TEST(Table, OfAnOptimisationThatFailedNamesEveryFailure) {
  auto r = report_samples::turbo_car();
  r.status.termination = result::Termination::not_converged;
  auto& optimization = *r.optimization;
  const double nan = std::nan("");
  optimization.terms.running = 1.5;
  optimization.certificate.primal_infeasibility = 3e-3;
  optimization.certificate.complementarity_residual = 1e-4;
  optimization.certificate.stationarity = nan;
  optimization.certificate.biactive = 4;
  optimization.certificate.stationarity_type = result::StationarityType::C;
  optimization.certificate.b_stationary = false;
  optimization.certificate.lpcc_decrease = -0.03;
  auto& verification = *optimization.verification;
  verification.interval_defect = 0.02;
  verification.switches_missed = 1;
  verification.switches_extra = 2;
  verification.path_violation = 0.2;
  verification.path_violations = {{"x^2 <= 1", 0.25, 0.2, 0.1}, {"v", 1.0, 1e-4, 1e-5}};
  verification.open_loop.termination = result::Termination::step_size_too_small;
  auto text = to_table(r);
  std::replace(text.begin(), text.end(), '\n', ' ');
  for (std::size_t at = 0; (at = text.find("  ", at)) != std::string::npos;) text.erase(at, 1);
  for (const auto* part :
       {"objective 11.8 (running 1.5, time 11.8)", "NOT feasible: a bound or row is violated by 0.003",
        "complementarity NOT reached: 0.0001", "stationarity NOT known", "(allowed 1e-08)", "NOT B-stationary (C)",
        "4 pairs have both sides at zero", "off by at most 0.02 of the range of `v`", "MORE than the allowed 0.001",
        "1 switch of the simulation not in the solution, 2 switches of the solution not in the simulation",
        "`x^2 <= 1` is violated by at most 0.2 (0.1 of its range) at t = 0.25; 1 more is by a smaller share",
        "ended early (step_size_too_small)"}) {
    EXPECT_NE(text.find(part), std::string::npos) << part << "\n" << text;
  }
  verification.interval_defect = verification.path_violation = nan;
  verification.switches_missed = verification.switches_extra = 0;
  verification.switch_time_error = 0.0;
  text = to_table(r);
  EXPECT_NE(text.find("Not every interval could be simulated"), std::string::npos) << text;
  EXPECT_NE(text.find("No switch is missed or added.\n"), std::string::npos) << text;
  EXPECT_NE(text.find("between the nodes is not known"), std::string::npos) << text;
  optimization.certificate.b_stationary.reset();
  optimization.verification.reset();
  text = to_table(r);
  EXPECT_NE(text.find("Not decided whether it is B-stationary (multipliers: C)"), std::string::npos) << text;
  EXPECT_NE(text.find("Not simulated again."), std::string::npos) << text;
}

TEST(Table, SaysWhichMultipliersAreNotUnique) {
  result::Result r = report_samples::turbo_car();
  auto& optimization = *r.optimization;
  EXPECT_EQ(to_table(r).find("is not unique"), std::string::npos);
  optimization.multipliers[1].range = {0.375, std::numeric_limits<double>::infinity()};
  optimization.multipliers[0].range = {-std::numeric_limits<double>::infinity(), 2.0};
  optimization.certificate.licq = false;
  optimization.certificate.dependent_rows = 2;
  optimization.certificate.dependent = {"v == 0", "q == 200"};
  optimization.certificate.sosc = false;
  optimization.certificate.other_sides_tried = false;
  const auto unwrapped = [&] {
    std::string text = to_table(r);
    for (std::size_t end = text.find("\n  "); end != std::string::npos; end = text.find("\n  ")) {
      text.replace(end, text.find_first_not_of(' ', end + 1) - end, " ");
    }
    return text;
  };
  const std::string text = unwrapped(), usual = "That is usual while a contact stays closed";
  EXPECT_EQ(text.find(usual), std::string::npos) << text;
  r.contacts = {"ground"};
  EXPECT_NE(unwrapped().find(usual), std::string::npos) << unwrapped();
  for (const char* part : {"The multiplier of `q == 200` at t = ", "is not unique: at most 2; 1 more is not.",
                           "2 of them are combinations of others (`v == 0`, `q == 200`)", "NOT second-order sufficient",
                           "Not every mode sequence of this point was tried"}) {
    EXPECT_NE(text.find(part), std::string::npos) << part << "\n" << text;
  }
}

/// Two families of names, and one that stands alone.
result::Result many_states() {
  result::Result r = sample();
  r.states = {"total"};
  r.final.x = {7.5};
  for (int i = 1; i <= 1000; ++i) {
    for (const char* letter : {"q", "v"}) {
      r.states.push_back(letter + std::to_string(i));
      r.final.x.push_back(letter[0] == 'q' ? i : -0.5 * i);
    }
  }
  r.events = {};
  return r;
}

TEST(Table, OfManyStatesItSaysTheirRange) {
  const auto text = to_table(many_states());
  EXPECT_NE(text.find("end state   2001 states; --show NAME"), std::string::npos) << text;
  EXPECT_NE(text.find("q1 … q1000  1000  from  1     (q1)     to  1000  (q1000)"), std::string::npos) << text;
  EXPECT_NE(text.find("v1 … v1000  1000  from  -500  (v1000)  to  -0.5  (v1)"), std::string::npos) << text;
  EXPECT_NE(text.find("total = 7.5"), std::string::npos) << text;
  EXPECT_LT(lines(text).size(), 20U);
}

TEST(Table, ShowsWhatIsNamed) {
  auto r = many_states();
  r.model.captions = {{"total", {"", "sum"}}, {"q1", {"", "first"}}};
  const auto text = to_table(r, events_at_each_end, {"v7*", "total"});
  EXPECT_NE(text.find("end state   v7 = -3.5  v70 = -35"), std::string::npos) << text;
  EXPECT_NE(text.find("total = 7.5"), std::string::npos) << text;
  EXPECT_NE(text.find("\nwhere       total: sum\n"), std::string::npos) << text;
  EXPECT_EQ(text.find("q1"), std::string::npos);
  EXPECT_TRUE(check_names({"v7*", "total"}, r.states, r.outputs, r.switching_functions));
  const auto unknown = check_names({"w1"}, r.states, r.outputs, r.switching_functions);
  ASSERT_FALSE(unknown);
  EXPECT_NE(unknown.error().message.find("'w1'"), std::string::npos);
}

TEST(Table, SaysInWhichModesContactsEnd) {
  auto r = sample();
  r.contacts = {"heel", "toe"};
  r.final.contact_modes = {result::ContactMode::stick, result::ContactMode::open};
  EXPECT_NE(to_table(r).find("contacts    heel: stick  toe: open\n"), std::string::npos) << to_table(r);
}

}  // namespace
}  // namespace saltus::report
