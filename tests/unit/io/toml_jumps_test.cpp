// [[jumps]] in model files.
#include <gtest/gtest.h>

#include "saltus/expression/parser.hpp"
#include "saltus/io/toml/toml_model.hpp"

namespace saltus::io {
namespace {

constexpr std::string_view jump_head = "[model]\nname = 'm'\n[states]\nx = 1\nn = 0\n[dynamics]\nx = 1\n";

Error refused(const std::string& rest) {
  const auto model = parse_model(std::string(jump_head) + rest, "m.toml");
  EXPECT_FALSE(model.has_value()) << "the file was accepted: " << rest;
  return model ? Error{} : model.error();
}

TEST(TomlJumps, EveryKeyIsRead) {
  const auto model = parse_model(std::string(jump_head) +
                                     "[[jumps]]\nname = 'dose'\nwhen = 'x < 0.1 and t > 2'\n"
                                     "set = { n = 'n + 1', x = 3 }\nat_start = true\npriority = 'x'\ndelay = 0.5\n"
                                     "persistent = false\nvalues = 'execution'\n"
                                     "[[jumps]]\nwhen = 'x'\ndirection = 'down'\nset = { x = 1 }\n"
                                     "[[jumps]]\nevery = '2*0.5'\nset.x = 'x/2'\n"
                                     "[[jumps]]\nat = [1, 'pi']\n[jumps.set]\nx = 0\n",
                                 "m.toml");
  ASSERT_TRUE(model.has_value()) << to_text(model.error());
  const auto& jumps = model->description.jumps;
  ASSERT_EQ(jumps.size(), 4U);
  EXPECT_EQ(jumps[0].name, "dose");
  EXPECT_EQ(jumps[0].trigger, model::JumpTrigger::condition);
  EXPECT_EQ(expression::to_text(*jumps[0].when), "x<0.1 and t>2");
  EXPECT_EQ(jumps[0].location.line, 8);
  EXPECT_EQ(jumps[0].when->location.line, 10);
  ASSERT_EQ(jumps[0].set.size(), 2U);
  EXPECT_EQ(jumps[0].set[0].name, "n");
  EXPECT_EQ(expression::to_text(*jumps[0].set[0].expression), "n+1");
  EXPECT_EQ(jumps[0].set[0].location.line, 11);
  EXPECT_EQ(jumps[0].set[1].name, "x");
  EXPECT_TRUE(jumps[0].at_start);
  EXPECT_EQ(expression::to_text(*jumps[0].priority), "x");
  EXPECT_EQ(expression::to_text(*jumps[0].delay), "0.5");
  EXPECT_FALSE(jumps[0].persistent);
  EXPECT_EQ(jumps[0].values, model::JumpValues::at_execution);
  EXPECT_EQ(jumps[1].trigger, model::JumpTrigger::guard_down);
  EXPECT_FALSE(jumps[1].name.has_value());
  EXPECT_FALSE(jumps[1].at_start);
  EXPECT_TRUE(jumps[1].persistent);
  EXPECT_FALSE(jumps[1].values);
  EXPECT_EQ(jumps[2].trigger, model::JumpTrigger::times);
  EXPECT_EQ(expression::to_text(*jumps[2].every), "2*0.5");
  EXPECT_EQ(jumps[3].trigger, model::JumpTrigger::times);
  ASSERT_EQ(jumps[3].at.size(), 2U);
  EXPECT_EQ(expression::to_text(*jumps[3].at[1]), "pi");
}

struct Mistake {
  std::string text;
  int line;
  std::string message;
  std::string remedy;
};

TEST(TomlJumps, MistakesAreFoundWithTheirPlace) {
  const std::vector<Mistake> mistakes{
      {"[[jumps]]\nset = { x = 1 }\n", 8, "no `when`", "every = 0.5"},
      {"[[jumps]]\nwhen = 'x > 0'\n", 8, "no `set`", "set = {"},
      {"[[jumps]]\nwhen = 'x > 0'\nset = {}\n", 10, "`set` is empty", "states that change"},
      {"[[jumps]]\nwhen = 'x > 0'\nset = 'x'\n", 10, "expected a table of states", ""},
      {"[[jumps]]\nwhen = 'x > 0'\nset = { x = true }\n", 10, "an expression in quotes", ""},
      {"[[jumps]]\nwhen = 'x > 0'\nset = { x = 1, x = 2 }\n", 10, "not valid TOML", ""},
      {"[[jumps]]\nwhen = 'x > 0'\nevery = 1\nset = { x = 1 }\n", 8, "`when` and `every`", "a jump for each"},
      {"[[jumps]]\nat = [1]\nevery = 1\nset = { x = 1 }\n", 8, "`every` and `at`", "a jump for each"},
      {"[[jumps]]\nat = []\nset = { x = 1 }\n", 9, "is empty", "at = [1, 2.5]"},
      {"[[jumps]]\nat = 1\nset = { x = 1 }\n", 9, "expected a list of times", ""},
      {"[[jumps]]\nevery = 1\ndirection = 'up'\nset = { x = 1 }\n", 10, "`direction` belongs to jumps with `when`", ""},
      {"[[jumps]]\nevery = 1\nat_start = true\nset = { x = 1 }\n", 10, "`at_start` belongs to", "a jump of its own"},
      {"[[jumps]]\nevery = 1\npersistent = false\nset = { x = 1 }\n", 10, "`persistent` belongs to", "no condition"},
      {"[[jumps]]\nwhen = 'x'\ndirection = 'upp'\nset = { x = 1 }\n", 10, "found the string \"upp\"", "'up'"},
      {"[[jumps]]\nwhen = 'x > 0'\nvalues = 'triger'\nset = { x = 1 }\n", 10, "\"trigger\"", "'trigger'"},
      {"[[jumps]]\nwhen = 'x > 0'\npriorty = 1\nset = { x = 1 }\n", 10, "unknown key 'priorty'", "'priority'"},
      {"[[jumps]]\nwhen = 'x > 0'\nat_start = 1\nset = { x = 1 }\n", 10, "expected true or false", ""},
      {"[[jumps]]\nwhen = 'x >'\nset = { x = 1 }\n", 9, "found the end", ""},
      {"[jumps]\nwhen = 'x > 0'\n", 8, "[[jumps]]", ""},
  };
  for (const auto& mistake : mistakes) {
    const Error error = refused(mistake.text);
    EXPECT_NE(error.message.find(mistake.message), std::string::npos) << mistake.text << error.message;
    EXPECT_NE(error.remedy.find(mistake.remedy), std::string::npos) << mistake.text << error.remedy;
    EXPECT_EQ(error.location.line, mistake.line) << mistake.text;
  }
}

}  // namespace
}  // namespace saltus::io
