// Definitions that need definitions: the call stack does not depend on how many.
#include <fmt/format.h>

#include "model_text.hpp"

namespace saltus::model {
namespace {

constexpr int length = 3000;  // a recursion this deep overflows a stack of 8 MB under AddressSanitizer

/// name0 = formula(name1), name1 = formula(name2), …, and last.
template <class Formula>
Table chain(const std::string& name, Formula formula, const std::string& last, int links = length) {
  Table table;
  for (int i = 0; i < links; ++i) table.push_back({fmt::format("{}{}", name, i), formula(i + 1)});
  table.push_back({fmt::format("{}{}", name, links), last});
  return table;
}

TEST(DefinitionChains, NumbersOfAnyLength) {
  const System system = built({.states = {{"x", "2"}},
                               .definitions = chain(
                                   "d", [](int i) { return fmt::format("d{} + x", i); }, "x"),
                               .dynamics = {{"x", "d0"}}});
  EXPECT_EQ(values(system, system.f, {2.0}, {}).at(0), 2.0 * (length + 1));
}

TEST(DefinitionChains, Conditions) {
  const System system = built({.states = {{"x", "2"}},
                               .definitions = chain(
                                   "c", [](int i) { return fmt::format("c{} and x < 3", i); }, "x > 1", 1000),
                               .dynamics = {{"x", "if(c0, 1, 2)"}}});
  EXPECT_EQ(system.switching.size(), 2);
}

TEST(DefinitionChains, ThroughSwitchingFunctions) {
  const int pairs = 200;
  Table definitions, switching;
  for (int i = 0; i < pairs; ++i) {
    definitions.push_back({fmt::format("d{}", i), fmt::format("s{} + x", i)});
    switching.push_back({fmt::format("s{}", i), i + 1 < pairs ? fmt::format("d{} - 1", i + 1) : "x - 1"});
  }
  const System system = built(
      {.states = {{"x", "2"}}, .definitions = definitions, .switching = switching, .dynamics = {{"x", "-sign(s0)"}}});
  EXPECT_EQ(system.switching.size(), 1);  // all are multiples of x - 1
}

TEST(DefinitionChains, ACycleIsFoundWhereItCloses) {
  Table table = chain(
      "d", [](int i) { return fmt::format("1 + d{}", i); }, "2*d0");
  const Error error = refused({.states = {{"x", "0"}}, .definitions = table, .dynamics = {{"x", "d0"}}});
  EXPECT_NE(error.message.find("'d0' is defined by itself: d0 -> d1 -> "), std::string::npos) << to_text(error);
  EXPECT_EQ(error.location.line, length + 2);
  EXPECT_EQ(error.location.column, 23);
}

}  // namespace
}  // namespace saltus::model
