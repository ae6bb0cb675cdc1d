// [[modes]] in model files.
#include <gtest/gtest.h>

#include "saltus/expression/parser.hpp"
#include "saltus/io/toml/toml_model.hpp"

namespace saltus::io {
namespace {

constexpr std::string_view modal_head = "[model]\nname = 'm'\n[states]\nx = 1\nz = 1\n[switching]\nc = 'x'\n";

Error modes_refused(const std::string& rest) {
  const auto model = parse_model(std::string(modal_head) + rest, "m.toml");
  EXPECT_FALSE(model.has_value()) << "the file was accepted";
  return model ? Error{} : model.error();
}

TEST(TomlModes, AreReadInTheOrderOfTheFile) {
  const auto model = parse_model(std::string(modal_head) +
                                     "[[modes]]\nwhen = 'c > 0'\ndynamics = { z = 'x', x = 2 }\n"
                                     "[[modes]]\nwhen = 'otherwise'\ngroup = 'g'\n[modes.dynamics]\nx = '-z'\n"
                                     "[[modes]]\nindicator = 'x^2'\nname = 'near'\ndynamics = {}\n",
                                 "m.toml");
  ASSERT_TRUE(model.has_value()) << to_text(model.error());
  const auto& modes = model->description.modes;
  ASSERT_EQ(modes.size(), 3U);
  EXPECT_EQ(expression::to_text(*modes[0].when), "c>0");
  EXPECT_EQ(modes[0].when->location.line, 9);
  EXPECT_EQ(modes[0].location.line, 8);
  ASSERT_EQ(modes[0].dynamics.size(), 2U);
  EXPECT_EQ(modes[0].dynamics[0].name, "z");
  EXPECT_EQ(expression::to_text(*modes[0].dynamics[1].expression), "2");
  EXPECT_EQ(modes[1].group, "g");
  EXPECT_EQ(expression::to_text(*modes[1].dynamics.at(0).expression), "-z");
  EXPECT_EQ(modes[2].when, nullptr);
  EXPECT_EQ(expression::to_text(*modes[2].indicator), "x^2");
  EXPECT_EQ(modes[2].name, "near");
}

TEST(TomlModes, MistakesAreFoundWithTheirPlace) {
  const Error no_dynamics = modes_refused("[[modes]]\nwhen = 'c > 0'\n");
  EXPECT_NE(no_dynamics.message.find("no `dynamics`"), std::string::npos) << no_dynamics.message;
  EXPECT_EQ(no_dynamics.location.line, 8);
  const Error key = modes_refused("[[modes]]\nwhen = 'c > 0'\ndynamic = {}\n");
  EXPECT_NE(key.remedy.find("'dynamics'"), std::string::npos) << key.remedy;
  EXPECT_EQ(key.location.line, 10);
  const Error number = modes_refused("[[modes]]\nwhen = true\ndynamics = {}\n");
  EXPECT_NE(number.message.find("an expression in quotes"), std::string::npos) << number.message;
  EXPECT_EQ(number.location.line, 9);
  const Error list = modes_refused("[[modes]]\nwhen = 'c > 0'\ndynamics = ['x']\n");
  EXPECT_NE(list.message.find("found a list"), std::string::npos) << list.message;
  const Error table = modes_refused("[modes]\nwhen = 'c > 0'\n");
  EXPECT_NE(table.message.find("[[modes]]"), std::string::npos) << table.message;
}

}  // namespace
}  // namespace saltus::io
