// Reading and building what is large in proportion to its text, by counts: they are the same on every machine.
#include <cstddef>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "../counted_allocations.hpp"
#include "saltus/base/symbolic_lock.hpp"
#include "saltus/io/check/model_overview.hpp"
#include "saltus/io/json/json_result.hpp"
#include "saltus/io/toml/toml_model.hpp"
#include "saltus/model/build.hpp"
#include "saltus/model/summary.hpp"

namespace saltus::io {
namespace {

/// Blocks in a row on springs, each with dry friction; a definition for each.
std::string chain(int blocks) {
  std::string states, definitions, dynamics, outputs;
  for (int i = 1; i <= blocks; ++i) {
    states += fmt::format("q{0} = 0.1\nv{0} = 0.5\n", i);
    definitions += fmt::format("pull{0} = \"-2*q{0}{1}{2}\"\n", i, i > 1 ? fmt::format(" + q{}", i - 1) : "",
                               i < blocks ? fmt::format(" + q{}", i + 1) : "");
    dynamics += fmt::format("q{0} = \"v{0}\"\nv{0} = \"pull{0} - sign(v{0} - 0.2)\"\n", i);
    outputs += fmt::format("power{0} = \"v{0}*pull{0}\"\n", i);
  }
  return "[model]\nname = \"chain\"\n[states]\n" + states + "[definitions]\n" + definitions + "[dynamics]\n" +
         dynamics + "[outputs]\n" + outputs + "[simulate]\nuntil = 1\n";
}

struct Cost {
  double allocations = 0.0, bytes = 0.0;
};

Cost cost_of(int blocks) {
  const auto text = chain(blocks);
  const long before = tests::allocations;
  const std::size_t bytes_before = tests::allocated_bytes;
  {
    const SymbolicLock lock;
    const auto file = parse_model(text, "m.toml");
    EXPECT_TRUE(file);
    if (!file) return {};
    const auto system = model::build(file->description, {});
    EXPECT_TRUE(system);
    if (!system) return {};
    EXPECT_EQ(overview_of(file->description, model::summary_of(*system)).surfaces.size(),
              static_cast<std::size_t>(blocks));
  }
  return {static_cast<double>(tests::allocations - before), static_cast<double>(tests::allocated_bytes - bytes_before)};
}

TEST(Building, OfFourTimesTheBlocksTakesFourTimesAsMuch) {
  static_cast<void>(cost_of(10));  // what is made once
  const Cost small = cost_of(100), large = cost_of(400);
  EXPECT_LT(large.allocations / small.allocations, 4.6);
  EXPECT_LT(large.bytes / small.bytes, 4.8);
}

/// A relay that has switched so often.
std::string switched(int times) {
  result::Result result;
  result.states = {"x", "v"};
  result.switching_functions = {"v"};
  result::Event event;
  event.reason = "the field crosses the surface";
  event.surfaces = {"v"};
  for (int i = 0; i < times; ++i) {
    event.t = i / 7.0;
    event.x = event.x_after = {1.0 / (i + 1), i / 3.0};
    const int sign = i % 2 == 0 ? 1 : -1;
    event.mode_before = {-sign};
    event.mode_after = {sign};
    event.alpha_before = {i % 2 * 1.0};
    event.alpha_after = {1.0 - i % 2};
    result.events.push_back(event);
    result.trajectory.t.push_back(event.t);
    result.trajectory.x.push_back(event.x);
    result.trajectory.u.push_back(std::vector<double>{});
    result.trajectory.outputs.push_back(std::vector<double>{});
    result.trajectory.alpha.push_back(*event.alpha_after);
    result.trajectory.mode.push_back(*event.mode_after);
  }
  result.final = {event.t, event.x, *event.mode_after, *event.alpha_after, {}};
  return to_json(result);
}

// A tree of all of it would take six times the memory of the text.
TEST(ReadingAResult, HoldsNoTreeOfItsLists) {
  const auto text = switched(20000);
  const std::size_t before = tests::most_held_bytes = tests::held_bytes;
  const auto result = parse_result(text, "r.json");
  ASSERT_TRUE(result) << to_text(result.error());
  EXPECT_EQ(result->events.size(), 20000U);
  EXPECT_LT(static_cast<double>(tests::most_held_bytes - before), 0.7 * static_cast<double>(text.size()));
}

}  // namespace
}  // namespace saltus::io
