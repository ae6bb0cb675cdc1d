// Reading and building a large model in proportion to its text, by counts: they are the same on every machine.
#include <cstddef>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "../counted_allocations.hpp"
#include "saltus/base/symbolic_lock.hpp"
#include "saltus/io/check/model_overview.hpp"
#include "saltus/io/toml/toml_model.hpp"
#include "saltus/model/build.hpp"

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
    EXPECT_EQ(overview_of(file->description, *system).surfaces.size(), static_cast<std::size_t>(blocks));
  }
  return {static_cast<double>(tests::allocations - before),
          static_cast<double>(tests::allocated_bytes - bytes_before)};
}

TEST(Building, OfFourTimesTheBlocksTakesFourTimesAsMuch) {
  static_cast<void>(cost_of(10));  // what is made once
  const Cost small = cost_of(100), large = cost_of(400);
  EXPECT_LT(large.allocations / small.allocations, 4.6);
  EXPECT_LT(large.bytes / small.bytes, 4.8);
}

}  // namespace
}  // namespace saltus::io
