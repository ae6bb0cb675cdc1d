// A model with its settings, as the tool and the Python package state it.
#include "saltus/frontend/model_input.hpp"

#include <cstdlib>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "saltus/result/result.hpp"

namespace saltus::frontend {
namespace {

const ModelText falling{.name = "falling.toml",
                        .text = R"([model]
name = "falling"
[parameters]
g = 9.81
[states]
h = 1
v = 0
[dynamics]
h = "v"
v = "-g"
[simulate]
until = 1
)",
                        .files = {},
                        .settings = {"g=1.6", "simulate.until=2"},
                        .path = "falling.json"};

TEST(ModelInput, SettingsComeBehindThoseOfAStoredResult) {
  const auto input = read_input(falling, {"parameters.g=3.7", "h=2"});
  ASSERT_TRUE(input) << input.error().message;
  EXPECT_EQ(input->settings, (std::vector<std::string>{"simulate.until=2", "parameters.g=3.7", "h=2"}));
  EXPECT_EQ(input->file.simulate.until, 2.0);
}

TEST(ModelInput, AnOptionIsNotedAsASetting) {
  auto input = read_input(falling, {});
  ASSERT_TRUE(input);
  ASSERT_TRUE(apply_option(*input, "simulate.rtol", "1e-6", "--rtol 1e-6"));
  EXPECT_EQ(input->settings.back(), "simulate.rtol=1e-6");
  EXPECT_EQ(input->file.simulate.rtol, 1e-6);
  const auto refused = apply_option(*input, "simulate.rtol", "-1", "--rtol -1");
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().location.file, "--rtol -1");
  EXPECT_EQ(input->settings.back(), "simulate.rtol=1e-6");
}

TEST(ModelInput, TheLastWordOfAnOptionIsNoName) {
  const auto input = read_input(falling, {"rtol=1e-6"});
  ASSERT_FALSE(input);
  EXPECT_EQ(input.error().remedy, "write simulate.rtol=1e-6");
}

TEST(ModelInput, ARecordHasWhatItTakesToComputeItAgain) {
  const auto input = read_input(falling, {"h=2"});
  ASSERT_TRUE(input);
  setenv("SOURCE_DATE_EPOCH", "0", 1);
  result::Result result;
  result.branches.emplace_back();
  EXPECT_FALSE(complete_record(*input, result));
  EXPECT_EQ(result.date, "1970-01-01T00:00:00Z");
  EXPECT_EQ(result.model.text, falling.text);
  EXPECT_EQ(result.branches.front().model.settings, input->settings);
  setenv("SOURCE_DATE_EPOCH", "yesterday", 1);
  const auto note = complete_record(*input, result);
  ASSERT_TRUE(note);
  EXPECT_NE(note->find("yesterday"), std::string::npos);
  unsetenv("SOURCE_DATE_EPOCH");
}

}  // namespace
}  // namespace saltus::frontend
